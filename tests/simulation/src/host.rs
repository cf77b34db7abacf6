//! A random host: it tracks, and calls whatever a host may call, in any order, sound or not.

use glam::{Quat, Vec3};
use palpable::frame::{Budget, CostTable, Deadline, FrameInput};
use palpable::math::Pose;
use palpable::memory::{BodyId, ChainId, PieceId};
use palpable::state::bodies::{BodyKind, Coupling};
use palpable::state::materials::{Material, Surface};
use palpable::state::pieces::Groups;
use palpable::world::{BodyDef, HostedInput, JointInput, World};

use crate::cast::Cast;
use crate::draw::Draw;
use crate::invariants::Broken;
use crate::scene::{self, Recipe, Style};
use crate::tally::Tally;
use crate::tracker::{Seen, Tracker};

/// Length of a usual frame, in seconds.
const FRAME_S: f32 = 1.0 / 90.0;

macro_rules! calls {
    ($($(#[$meta:meta])* $name:ident = $text:literal,)*) => {
        /// What a host may call.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Call { $(#[doc = $text] $name,)* }

        impl Call {
            /// All, in the order of their numbers.
            pub const ALL: &[Self] = &[$(Self::$name,)*];
            /// How many there are.
            pub const COUNT: usize = Self::ALL.len();

            /// As it is called.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$name => $text,)* }
            }
        }
    };
}

calls! {
    AddBody = "add_body",
    RemoveBody = "remove_body",
    PlaceBody = "place_body",
    AddPiece = "add_piece",
    RemovePiece = "remove_piece",
    SetGroups = "set_groups",
    AddChain = "add_chain",
    RemoveChain = "remove_chain",
    AddLinkPiece = "add_link_piece",
    SetChainOptions = "set_chain_options",
    PlaceAngles = "place_angles",
    SetVelocity = "set_velocity",
    ApplyForce = "apply_force",
    ApplyImpulse = "apply_impulse",
    AddMaterial = "add_material",
    SetSurface = "set_surface",
    SetGravity = "set_gravity",
    Penetration = "penetration",
    Save = "save",
    Load = "load",
    Attach = "attach",
    SetTarget = "set_target",
    SetPieceTargets = "set_piece_targets",
    SetJoints = "set_joints",
    SetAngles = "set_angles",
    SetLinkPoses = "set_link_poses",
    SetTip = "set_tip",
    SetHosted = "set_hosted",
}

/// The first of the calls that tracking makes; those before it come at random.
const FIRST_OF_TRACKING: usize = Call::SetTarget as usize;

/// Whether a call was taken.
type Taken = bool;

/// A state that the host may roll back to.
#[derive(Clone, Debug)]
struct Saved {
    bytes: Vec<u8>,
    cast: Cast,
    trackers: Vec<Tracker>,
    frames: u64,
}

/// Ids of things that are gone.
#[derive(Clone, Debug, Default)]
struct Gone {
    bodies: Vec<BodyId>,
    pieces: Vec<PieceId>,
    chains: Vec<ChainId>,
}

/// A random host and what it knows.
#[derive(Debug)]
pub struct Host {
    /// How it behaves.
    pub style: Style,
    /// What it put into the world.
    pub cast: Cast,
    trackers: Vec<Tracker>,
    gone: Gone,
    saved: Option<Saved>,
    /// It wants its world copied to another block, and taken up there.
    pub moves_house: bool,
    /// After a rollback: the frames that its world has stepped.
    pub rolled_back: Option<u64>,
    /// Frames that its world has stepped.
    pub frames: u64,
    dt_s: f32,
}

impl Host {
    /// Makes a scene in an empty world.
    pub fn new(draw: &mut impl Draw, style: Style, world: &mut World) -> Self {
        let mut cast = Cast::default();
        scene::build(draw, &style, world, &mut cast);
        if draw.once_in(8) {
            world.set_gravity([0.0; 3]);
        }
        let mut host = Self {
            style,
            cast,
            trackers: Vec::new(),
            gone: Gone::default(),
            saved: None,
            moves_house: false,
            rolled_back: None,
            frames: 0,
            dt_s: FRAME_S,
        };
        host.track_all(world);
        host
    }

    /// Gives every driven body a tracker.
    fn track_all(&mut self, world: &World) {
        for body in self
            .cast
            .bodies
            .iter()
            .filter(|b| b.kind == BodyKind::Driven)
        {
            let known = self.trackers.iter().any(|tracker| tracker.body == body.id);
            if !known {
                let pose = world.pose(body.id).unwrap_or_default();
                self.trackers.push(Tracker::new(body.id, pose));
            }
        }
        let cast = &self.cast;
        self.trackers
            .retain(|tracker| cast.body(tracker.body).is_some());
    }

    /// Does what a host does before a frame.
    ///
    /// # Errors
    /// When a call was refused and changed the world all the same.
    pub fn act(
        &mut self,
        draw: &mut impl Draw,
        world: &mut World,
        tally: &mut Tally,
    ) -> Result<(), Broken> {
        if draw.once_in(self.style.calm) {
            for _ in 0..1 + draw.below(4) {
                let call = Call::ALL[draw.below(FIRST_OF_TRACKING as u32) as usize];
                self.call(draw, world, call, tally)?;
            }
            self.track_all(world);
        }
        self.track(draw, world, tally)
    }

    /// Makes a call and counts it; now and then it looks whether a refused one changed anything.
    fn call(
        &mut self,
        draw: &mut impl Draw,
        world: &mut World,
        call: Call,
        tally: &mut Tally,
    ) -> Result<(), Broken> {
        let before = draw.once_in(16).then(|| world.hash());
        let taken = self.make(draw, world, call);
        tally.calls[call as usize][usize::from(!taken)] += 1;
        if !taken && before.is_some_and(|before| before != world.hash()) {
            return Err(Broken::new("a refused call changed the world", call));
        }
        Ok(())
    }

    fn make(&mut self, draw: &mut impl Draw, world: &mut World, call: Call) -> Taken {
        match call {
            Call::AddBody => self.add_body(draw, world),
            Call::RemoveBody => self.remove_body(draw, world),
            Call::PlaceBody => self.place_body(draw, world),
            Call::AddPiece => self.add_piece(draw, world),
            Call::RemovePiece => self.remove_piece(draw, world),
            Call::SetGroups => self.set_groups(draw, world),
            Call::AddChain => self.add_chain(draw, world),
            Call::RemoveChain => self.remove_chain(draw, world),
            Call::AddLinkPiece => self.add_link_piece(draw, world),
            Call::SetChainOptions => self.set_chain_options(draw, world),
            Call::PlaceAngles => self.place_angles(draw, world),
            Call::SetVelocity | Call::ApplyForce | Call::ApplyImpulse => {
                self.push(draw, world, call)
            }
            Call::AddMaterial => world.add_material().is_ok(),
            Call::SetSurface => set_surface(draw, world),
            Call::SetGravity => set_gravity(draw, world),
            Call::Penetration => self.ask(draw, world),
            Call::Save => self.save(world),
            Call::Load => self.load(draw, world),
            Call::Attach => {
                self.moves_house = true;
                true
            }
            _ => false,
        }
    }

    /// A body, or rarely one that is gone or never was.
    fn body(&self, draw: &mut impl Draw) -> BodyId {
        let of = |index: u32| self.cast.bodies.get(index as usize).map(|body| body.id);
        let (index1, generation) = garbage(draw);
        any_id(draw, self.cast.bodies.len(), of, &self.gone.bodies)
            .unwrap_or(BodyId { index1, generation })
    }

    fn piece(&self, draw: &mut impl Draw) -> PieceId {
        let of = |index: u32| self.cast.pieces.get(index as usize).map(|piece| piece.id);
        let (index1, generation) = garbage(draw);
        any_id(draw, self.cast.pieces.len(), of, &self.gone.pieces)
            .unwrap_or(PieceId { index1, generation })
    }

    fn chain(&self, draw: &mut impl Draw) -> ChainId {
        let of = |index: u32| self.cast.chains.get(index as usize).map(|chain| chain.id);
        let (index1, generation) = garbage(draw);
        any_id(draw, self.cast.chains.len(), of, &self.gone.chains)
            .unwrap_or(ChainId { index1, generation })
    }

    fn pose(&self, draw: &mut impl Draw) -> Pose {
        match draw.below(16) {
            0 => draw.bad_pose(),
            1 => draw.pose(1024.0),
            _ => draw.pose(1.2).moved(self.style.home),
        }
    }

    fn add_body(&mut self, draw: &mut impl Draw, world: &mut World) -> Taken {
        if draw.once_in(4) {
            let def = BodyDef {
                kind: BodyKind::Driven,
                pose: self.pose(draw),
                coupling: Coupling {
                    stiffness_n_per_m: draw.bad_number(),
                    mass_kg: draw.bad_number(),
                    ..Coupling::DEFAULT
                },
            };
            return self.cast.add_body(world, &def).is_ok();
        }
        if draw.once_in(8) {
            return scene::add_figure(draw, &self.style, world, &mut self.cast).is_some();
        }
        use BodyKind::{Driven, Dynamic, Fixed, Hosted};
        let kind = [Fixed, Dynamic, Driven, Hosted, Dynamic, Fixed][draw.below(6) as usize];
        // A refused piece leaves the body without it: a body alone is what is refused as a whole.
        scene::add_body(draw, &self.style, world, &mut self.cast, kind, 0.15).is_some()
    }

    fn remove_body(&mut self, draw: &mut impl Draw, world: &mut World) -> Taken {
        let id = self.body(draw);
        let taken = self.cast.remove_body(world, id).is_ok();
        if taken {
            self.gone.bodies.push(id);
        }
        taken
    }

    fn place_body(&mut self, draw: &mut impl Draw, world: &mut World) -> Taken {
        let (id, pose) = (self.body(draw), self.pose(draw));
        self.cast.place_body(world, id, &pose).is_ok()
    }

    fn add_piece(&mut self, draw: &mut impl Draw, world: &mut World) -> Taken {
        let half_m = [0.05, 0.1, 0.001, 3.0][draw.below(4) as usize];
        let mut recipe = Recipe::draw(draw, half_m);
        if draw.once_in(2) {
            recipe.local = draw.pose(0.1);
        }
        let mut def = recipe.def();
        match draw.below(16) {
            0 => def.radius_m = draw.bad_number(),
            1 => def.density_kg_m3 = draw.bad_number(),
            2 => def.local = draw.bad_pose(),
            3 => def.material = Material(draw.word()),
            _ => {}
        }
        let id = self.body(draw);
        self.cast.add_piece(world, id, &def).is_ok()
    }

    fn remove_piece(&mut self, draw: &mut impl Draw, world: &mut World) -> Taken {
        let id = self.piece(draw);
        let taken = self.cast.remove_piece(world, id).is_ok();
        if taken {
            self.gone.pieces.push(id);
        }
        taken
    }

    fn set_groups(&mut self, draw: &mut impl Draw, world: &mut World) -> Taken {
        let id = self.piece(draw);
        let mut some = || draw.below(4) & draw.below(4);
        let groups = Groups {
            member_of: some(),
            passes: some(),
        };
        self.cast.set_groups(world, id, groups).is_ok()
    }

    fn add_chain(&mut self, draw: &mut impl Draw, world: &mut World) -> Taken {
        let id = self.body(draw);
        let base = draw.once_in(3).then(|| (self.chain(draw), draw.below(4)));
        scene::add_chain(draw, world, &mut self.cast, id, base).is_some()
    }

    fn remove_chain(&mut self, draw: &mut impl Draw, world: &mut World) -> Taken {
        let id = self.chain(draw);
        let taken = self.cast.remove_chain(world, id).is_ok();
        if taken {
            self.gone.chains.push(id);
        }
        taken
    }

    fn add_link_piece(&mut self, draw: &mut impl Draw, world: &mut World) -> Taken {
        let (id, hinge) = (self.chain(draw), draw.below(6));
        let recipe = Recipe::draw(draw, 0.05);
        self.cast
            .add_link_piece(world, id, hinge, &recipe.def())
            .is_ok()
    }

    fn set_chain_options(&mut self, draw: &mut impl Draw, world: &mut World) -> Taken {
        let id = self.chain(draw);
        let mut options = scene::options(draw);
        if draw.once_in(4) {
            options.flags |= draw.below(256);
            options.attraction_s = draw.bad_number();
            options.tip[0] = draw.bad_number();
        }
        self.cast.set_chain_options(world, id, &options).is_ok()
    }

    fn place_angles(&mut self, draw: &mut impl Draw, world: &mut World) -> Taken {
        let id = self.chain(draw);
        let angles = self.angles(draw, id);
        self.cast.place_angles(world, id, &angles).is_ok()
    }

    /// Angles for a chain; rarely too few or not finite.
    fn angles(&self, draw: &mut impl Draw, id: ChainId) -> Vec<f32> {
        let count = self.cast.chain(id).map_or(3, |chain| chain.hinges.len());
        let mut angles: Vec<f32> = (0..count).map(|_| 2.0 * draw.signed()).collect();
        if draw.once_in(16) {
            angles[0] = draw.bad_number();
        }
        if draw.once_in(32) {
            angles.pop();
        }
        angles
    }

    fn push(&mut self, draw: &mut impl Draw, world: &mut World, call: Call) -> Taken {
        let id = self.body(draw);
        let strong = [1.0, 20.0, 1000.0][draw.below(3) as usize];
        let mut linear = (strong * draw.vector()).to_array();
        let angular = (strong * draw.vector()).to_array();
        if draw.once_in(8) {
            linear[draw.below(3) as usize] = draw.bad_number();
        }
        match call {
            Call::SetVelocity => world.set_velocity(id, linear, angular).is_ok(),
            Call::ApplyForce => world.apply_force(id, linear, angular).is_ok(),
            _ => {
                let point = self.pose(draw).position;
                world.apply_impulse(id, linear, point).is_ok()
            }
        }
    }

    fn ask(&mut self, draw: &mut impl Draw, world: &mut World) -> Taken {
        let (a, b) = (self.body(draw), self.body(draw));
        let pose = self.pose(draw);
        let asked = world.penetration(a, b).is_ok();
        asked && world.penetration_at(a, &pose, b, &Pose::IDENTITY).is_ok()
    }

    fn save(&mut self, world: &World) -> Taken {
        let mut bytes = vec![0; world.snapshot_bytes()];
        let taken = world.save(&mut bytes).is_ok();
        self.saved = Some(Saved {
            bytes,
            cast: self.cast.clone(),
            trackers: self.trackers.clone(),
            frames: self.frames,
        });
        taken
    }

    /// Rolls back; rarely to a snapshot with a bit that is not as it was.
    fn load(&mut self, draw: &mut impl Draw, world: &mut World) -> Taken {
        let Some(saved) = &mut self.saved else {
            return false;
        };
        if draw.once_in(4) {
            let at = draw.word() as usize % saved.bytes.len();
            saved.bytes[at] ^= 1 << draw.below(8);
            let taken = world.load(&saved.bytes).is_ok();
            self.saved = None;
            // A flipped bit that is taken would go on with a cast that does not fit.
            return taken;
        }
        let taken = world.load(&saved.bytes).is_ok();
        if taken {
            let changes = self.cast.changes;
            self.cast = saved.cast.clone();
            self.cast.changes = changes + 1;
            self.trackers.clone_from(&saved.trackers);
            self.frames = saved.frames;
            self.rolled_back = Some(saved.frames);
        }
        taken
    }

    fn track(
        &mut self,
        draw: &mut impl Draw,
        world: &mut World,
        tally: &mut Tally,
    ) -> Result<(), Broken> {
        let mut count = |call: Call, taken: Taken| {
            tally.calls[call as usize][usize::from(!taken)] += 1;
        };
        let (home, clean) = (self.style.home, self.style.clean);
        let mut trackers = std::mem::take(&mut self.trackers);
        for tracker in &mut trackers {
            match tracker.see(draw, self.dt_s, home, clean) {
                Seen::Lost => {}
                Seen::Pose(pose) | Seen::Bad(pose) => {
                    let taken = world.set_target(tracker.body, &pose).is_ok();
                    count(Call::SetTarget, taken);
                }
            }
            if draw.once_in(4) {
                let (call, taken) = self.move_pieces(draw, world, tracker);
                count(call, taken);
            }
        }
        self.trackers = trackers;
        for index in 0..self.cast.chains.len() {
            if draw.once_in(3) {
                let (call, taken) = self.move_chain(draw, world, index);
                count(call, taken);
            }
        }
        for index in 0..self.cast.bodies.len() {
            if self.cast.bodies[index].kind == BodyKind::Hosted && draw.once_in(2) {
                let taken = self.move_hosted(draw, world, index);
                count(Call::SetHosted, taken);
            }
        }
        Ok(())
    }

    /// Tells where the pieces of a hand are seen.
    fn move_pieces(
        &mut self,
        draw: &mut impl Draw,
        world: &mut World,
        tracker: &Tracker,
    ) -> (Call, Taken) {
        let mut count = self.cast.pieces_of(tracker.body).count();
        if draw.once_in(64) {
            count += 1;
        }
        if draw.once_in(3) {
            let joint = |draw: &mut dyn FnMut() -> Pose| Some(tracker.pose.then(&draw()));
            let mut joints: Vec<Option<Pose>> =
                (0..count).map(|_| joint(&mut || draw.pose(0.1))).collect();
            joints.push(Some(tracker.pose));
            if draw.once_in(clean_joints(self.style.clean)) {
                joints[0] = [None, Some(draw.bad_pose())][draw.below(2) as usize];
            }
            let piece_joints: Vec<u32> = (0..count as u32).collect();
            let input = JointInput {
                joints: &joints,
                root: count,
                piece_joints: &piece_joints,
                piece_offsets: &[],
                reach_m: 0.5,
            };
            return (
                Call::SetJoints,
                world.set_joints(tracker.body, &input).is_ok(),
            );
        }
        let mut locals: Vec<Pose> = (0..count).map(|_| draw.pose(0.08)).collect();
        if draw.once_in(clean_joints(self.style.clean)) && count > 0 {
            locals[0] = draw.bad_pose();
        }
        let taken = world.set_piece_targets(tracker.body, &locals).is_ok();
        (Call::SetPieceTargets, taken)
    }

    fn move_chain(
        &mut self,
        draw: &mut impl Draw,
        world: &mut World,
        index: usize,
    ) -> (Call, Taken) {
        let (id, joints) = (self.cast.chains[index].id, self.cast.chains[index].joints);
        match draw.below(4) {
            0 => {
                let poses: Vec<Pose> = (0..joints).map(|_| self.pose(draw)).collect();
                (Call::SetLinkPoses, world.set_link_poses(id, &poses).is_ok())
            }
            1 => {
                let (tip, posture) = (self.pose(draw), self.angles(draw, id));
                (Call::SetTip, world.set_tip(id, &tip, &posture).is_ok())
            }
            2 => {
                // Near where they are: as a person moves.
                let now = world.angles(id).unwrap_or_default();
                let angles: Vec<f32> = now.iter().map(|q| q + 0.1 * draw.signed()).collect();
                (Call::SetAngles, world.set_angles(id, &angles).is_ok())
            }
            _ => {
                let angles = self.angles(draw, id);
                (Call::SetAngles, world.set_angles(id, &angles).is_ok())
            }
        }
    }

    fn move_hosted(&mut self, draw: &mut impl Draw, world: &mut World, index: usize) -> Taken {
        let body = self.cast.bodies[index].id;
        let now = world.pose(body).unwrap_or_default();
        let velocity = draw.vector();
        let pose = match draw.below(32) {
            0 => self.pose(draw),
            _ => now.moved(velocity * self.dt_s),
        };
        let mut input = HostedInput {
            body,
            pose,
            velocity: velocity.to_array(),
            spin: draw.vector().to_array(),
            mass_kg: [0.0, 0.1, 1.0, 100.0][draw.below(4) as usize],
            centre: (0.02 * draw.vector()).to_array(),
            moments: [0.01; 3],
            axes: Quat::IDENTITY.to_array(),
        };
        match draw.below(64) {
            0 => input.mass_kg = draw.bad_number(),
            1 => input.moments[0] = draw.bad_number(),
            2 => input.velocity[0] = draw.bad_number(),
            3 => input.axes = [0.0; 4],
            _ => {}
        }
        self.cast.set_hosted(world, input).is_ok()
    }

    /// What the next frame is given.
    pub fn input(&mut self, draw: &mut impl Draw) -> FrameInput {
        let dt_s = if self.style.uneven {
            time_step(draw)
        } else {
            FRAME_S
        };
        self.dt_s = if (1e-4..=0.1).contains(&dt_s) {
            dt_s
        } else {
            FRAME_S
        };
        let mut input = FrameInput::unlimited(dt_s);
        input.budget = budget(draw, self.style.budget);
        if self.style.budget > 0 && draw.below(4) == 0 {
            input.deadline = Some(deadline(draw));
        }
        if draw.below(8) == 0 {
            input.focus = Some(draw.vector().to_array());
        }
        if draw.below(256) == 0 {
            input.focus = Some([draw.bad_number(); 3]);
        }
        input
    }
}

/// Any time at any prices.
fn deadline(draw: &mut impl Draw) -> Deadline {
    let mut price = |most| match draw.below(8) {
        0 => 0,
        1 => u32::MAX,
        _ => draw.below(most),
    };
    let costs = CostTable {
        frame_ns: price(5_000),
        body_ns: price(100),
        piece_ns: price(50),
        chain_ns: price(500),
        boxes_ns: price(500),
        advance_unit_ns: price(3_000),
        impulse_unit_ns: price(3_000),
        reach_step_ns: price(9_000),
    };
    let time_ns = match draw.below(8) {
        0 => 0,
        1 => u64::MAX,
        _ => u64::from(draw.below(100_000)),
    };
    Deadline { time_ns, costs }
}

/// Once in so many calls a joint is bad.
const fn clean_joints(clean: u32) -> u32 {
    if clean < 8 { clean } else { 8 }
}

fn garbage(draw: &mut impl Draw) -> (u32, u32) {
    match draw.below(4) {
        0 => (0, 0),
        1 => (draw.below(16), draw.below(8)),
        2 => (u32::MAX, 1),
        _ => (draw.below(16), u32::MAX),
    }
}

/// One of those that are there, mostly; rarely one that is gone; nothing rarely too.
fn any_id<T: Copy>(
    draw: &mut impl Draw,
    count: usize,
    of: impl Fn(u32) -> Option<T>,
    gone: &[T],
) -> Option<T> {
    match draw.below(16) {
        0 => None,
        1 => gone.last().copied(),
        _ => of(draw.below(256) * count as u32 / 256),
    }
}

fn set_surface(draw: &mut impl Draw, world: &mut World) -> Taken {
    let [a, b] = [(); 2].map(|()| Material(draw.below(6)));
    let mut surface = Surface {
        restitution: draw.between(0.0, 1.0),
        friction: draw.between(0.0, 2.0),
    };
    if draw.once_in(4) {
        surface.friction = draw.bad_number();
    }
    world.set_surface(a, b, surface).is_ok()
}

/// Gravity of any kind; a bad one is left out without a word, so that all count as taken.
fn set_gravity(draw: &mut impl Draw, world: &mut World) -> Taken {
    let gravity = match draw.below(4) {
        0 => Vec3::ZERO,
        1 => 10.0 * draw.vector(),
        2 => Vec3::new(0.0, draw.bad_number(), 0.0),
        _ => Vec3::new(0.0, -9.81, 0.0),
    };
    world.set_gravity(gravity.to_array());
    true
}

fn time_step(draw: &mut impl Draw) -> f32 {
    match draw.below(16) {
        0 => draw.bad_number(),
        1 => 0.0,
        2 => -FRAME_S,
        3 => 1e-4,
        4 => 0.1,
        5 => 1e-3,
        6..10 => draw.between(1e-4, 0.1),
        _ => FRAME_S,
    }
}

fn budget(draw: &mut impl Draw, style: u32) -> Budget {
    let mut units = || match style {
        0 => u32::MAX,
        1 => 0,
        2 => draw.below(40),
        _ => match draw.below(8) {
            0 => 0,
            1 => 1,
            2..5 => draw.below(40),
            _ => u32::MAX,
        },
    };
    Budget {
        advance_units: units(),
        impulse_units: units(),
        reach_steps: units(),
    }
}
