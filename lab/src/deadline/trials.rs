//! Adversarial scenes: what a frame may have to do at the worst, frame after frame.
//!
//! Every tracker is a pure function of the frame, so that two runs are told the same.

use glam::{DQuat, DVec3, Quat, Vec3};
use palpable::math::Pose;
use palpable::memory::Capacities;
use palpable::state::bodies::{BodyKind, Coupling};
use palpable::world::{BodyDef, Shape, World};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::set::{Cast, Set};
use crate::avatar::motions::{MOTION_HEIGHT_M, MotionKind, Script};
use crate::avatar::{AvatarPlan, Style, Trunk};
use crate::figures::Figure;
use crate::figures::scenes::AVATAR_OPTIONS;
use crate::hand::{Hand, HandPose};
use crate::hand_scene::{SceneError, locals, wrist};
use crate::memory::Block;
use crate::reference::Judge;
use crate::script::HandTarget;

/// Frames a second of all trials.
pub const RATE_HZ: f32 = 90.0;

/// An avatar that furniture holds farther than this from its tracker snaps to it as soon as nothing is in the way
/// there, in metres: what a host asks for whose users walk through furniture. Otherwise it would stand behind the
/// first wall for most of the run, away from everything.
const AVATAR_SNAPS_M: f32 = 0.6;

/// How high its soles are tracked above the floor, in metres, which is not to be in the way when it snaps.
const WALKS_ABOVE_M: f32 = 0.02;

/// An adversarial scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Trial {
    /// Both hands rummage in a pile of twenty boxes, pressed to the floor.
    HandsInPile,
    /// A hand whose tracker jumps anywhere in the gallery in every frame.
    Teleports,
    /// 64 loose bodies that gravity shakes, and a paddle among them.
    Loose64,
    /// An avatar of 3648 triangles walks into the walls and furniture of the gallery.
    AvatarInRoom,
    /// The avatar in a cell so narrow that all five chains touch, in ever new postures.
    AllChains,
    /// Bodies, pieces and vertices full to the last, pairs and contacts too few.
    FullPools,
}

impl Trial {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::HandsInPile,
        Self::Teleports,
        Self::Loose64,
        Self::AvatarInRoom,
        Self::AllChains,
        Self::FullPools,
    ];

    /// What the report calls it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::HandsInPile => "two hands in a pile",
            Self::Teleports => "teleports every frame",
            Self::Loose64 => "64 loose bodies",
            Self::AvatarInRoom => "avatar in a room",
            Self::AllChains => "all chains in contact",
            Self::FullPools => "full pools",
        }
    }

    /// What its world needs.
    #[must_use]
    pub const fn capacities(self) -> Capacities {
        let usual = Capacities {
            bodies: 96,
            pieces: 192,
            vertices: 4096,
            pairs: 4096,
            contacts: 1024,
            materials: 0,
            chains: 8,
            joints: 64,
        };
        match self {
            Self::FullPools => Capacities {
                bodies: 46,
                pieces: 69,
                vertices: 552,
                pairs: 160,
                contacts: 48,
                materials: 0,
                chains: 0,
                joints: 0,
            },
            _ => usual,
        }
    }
}

/// What the trials are made of.
pub struct Kit {
    hand: Hand,
    plan: AvatarPlan,
    figure: Figure,
    wall: Script,
    table: Script,
}

/// Numbers that depend on the frame alone.
fn chance(frame: u32, salt: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(u64::from(frame) << 8 | salt)
}

fn between(random: &mut Pcg64Mcg, low: f32, high: f32) -> f32 {
    low + (high - low) * random.random::<f32>()
}

/// A smooth way to and fro: amplitude and turns a second.
fn sway(frame: u32, amplitude: f32, hz: f32, phase: f32) -> f32 {
    let t = frame as f32 / RATE_HZ;
    amplitude * (std::f32::consts::TAU * (hz * t + phase)).sin()
}

fn hand_at(position: Vec3, turn: Quat, weight: f64) -> HandTarget {
    HandTarget {
        orientation: turn.as_dquat(),
        position: position.as_dvec3(),
        from: HandPose::Flat,
        to: HandPose::Relaxed,
        weight,
        free: false,
        resting: false,
    }
}

impl Kit {
    /// With the lab's hand.
    #[must_use]
    pub fn new(hand: Hand) -> Self {
        let plan = AvatarPlan::new(MOTION_HEIGHT_M, Style::Hulls, Trunk::Rigid);
        Self {
            figure: Figure::of_avatar(&plan),
            plan,
            hand,
            wall: Script::new(MotionKind::PushWall),
            table: Script::new(MotionKind::Table),
        }
    }

    /// Sets a trial in a world of its own and does something there.
    ///
    /// # Errors
    /// [`SceneError`] when the trial could not be set, and what `act` comes to.
    pub fn stage<T>(
        &self,
        trial: Trial,
        act: impl FnOnce(&mut World, &Cast, &Judge) -> Result<T, SceneError>,
    ) -> Result<T, SceneError> {
        let capacities = trial.capacities();
        let mut block = Block::new(&capacities);
        let made = World::create(block.bytes(), &capacities);
        let mut world = made.map_err(|why| SceneError(format!("{why:?}")))?;
        let mut set = Set::new(&mut world);
        self.fill(trial, &mut set)?;
        let (cast, judge) = (set.cast, set.judge);
        act(&mut world, &cast, &judge)
    }

    /// Fills an empty world.
    ///
    /// # Errors
    /// [`SceneError`] names what was refused.
    fn fill(&self, trial: Trial, set: &mut Set) -> Result<(), SceneError> {
        match trial {
            Trial::HandsInPile => self.pile(set),
            Trial::Teleports => self.jumpy(set),
            Trial::Loose64 => self.shaken(set),
            Trial::AvatarInRoom => self.visitor(set),
            Trial::AllChains => self.prisoner(set),
            Trial::FullPools => full(set),
        }
    }

    /// What the trackers see in a frame.
    ///
    /// # Errors
    /// [`SceneError`] when an id is stale.
    pub fn tell(
        &self,
        trial: Trial,
        world: &mut World,
        cast: &Cast,
        frame: u32,
    ) -> Result<(), SceneError> {
        let told = match trial {
            Trial::HandsInPile => (0..2).try_for_each(|side| {
                let seen = rummaging(frame, side);
                self.tell_hand(world, cast, side, &seen)
            }),
            Trial::Teleports => self.tell_hand(world, cast, 0, &anywhere(frame)),
            Trial::Loose64 => {
                let tilt = |hz, phase| sway(frame, 7.0, hz, phase);
                world.set_gravity([tilt(0.31, 0.0), -9.81, tilt(0.23, 0.3)]);
                let at = Vec3::new(
                    sway(frame, 0.3, 0.7, 0.0),
                    0.12 + sway(frame, 0.08, 0.45, 0.2),
                    sway(frame, 0.3, 0.53, 0.1),
                );
                let turn = Quat::from_rotation_y(sway(frame, 1.5, 0.4, 0.0));
                world
                    .set_target(cast.driven[0], &Pose::new(turn, at))
                    .map_err(|e| SceneError(format!("{e:?}")))
            }
            Trial::AvatarInRoom => self.tell_avatar(world, cast, &self.walking(frame)),
            Trial::AllChains => self.tell_avatar(world, cast, &self.writhing(frame)),
            Trial::FullPools => (0..cast.driven.len()).try_for_each(|index| {
                let mut random = chance(frame / 20, index as u64);
                let mut to = |most: f32| between(&mut random, -most, most);
                let at = Vec3::new(to(0.9), 0.15 + to(0.3), to(0.9));
                let turn = Quat::from_rotation_y(to(3.0));
                world
                    .set_target(cast.driven[index], &Pose::new(turn, at))
                    .map_err(|e| SceneError(format!("{e:?}")))
            }),
        };
        told.map_err(|e| SceneError(format!("frame {frame}: {e}")))
    }

    fn tell_hand(
        &self,
        world: &mut World,
        cast: &Cast,
        side: usize,
        seen: &HandTarget,
    ) -> Result<(), SceneError> {
        let body = cast.driven[side];
        world
            .set_target(body, &wrist(seen))
            .map_err(|e| SceneError(format!("{e:?}")))?;
        world
            .set_piece_targets(body, &locals(&self.hand, seen))
            .map_err(|e| SceneError(format!("{e:?}")))?;
        Ok(())
    }

    fn tell_avatar(
        &self,
        world: &mut World,
        cast: &Cast,
        seen: &crate::avatar::Target,
    ) -> Result<(), SceneError> {
        world
            .set_target(cast.driven[0], &seen.root)
            .map_err(|e| SceneError(format!("{e:?}")))?;
        for (&chain, angles) in cast.chains.iter().zip(&seen.angles) {
            world
                .set_angles(chain, angles)
                .map_err(|e| SceneError(format!("{e:?}")))?;
        }
        Ok(())
    }

    fn pile(&self, set: &mut Set) -> Result<(), SceneError> {
        set.bin(0.6, 0.5, 0.6)?;
        for index in 0..20_u32 {
            let at = Pose::at(
                0.2 * (index % 4) as f32 - 0.3,
                0.06 + 0.12 * (index / 8) as f32,
                0.22 * (index / 4 % 2) as f32 - 0.11,
            );
            set.loose(at, Shape::Box([0.05, 0.04, 0.06]), 0.0)?;
        }
        for side in 0..2 {
            set.hand(&self.hand, &rummaging(0, side))?;
        }
        Ok(())
    }

    fn jumpy(&self, set: &mut Set) -> Result<(), SceneError> {
        set.gallery()?;
        for index in 0..6_u32 {
            let at = Pose::at(0.15 * index as f32 - 0.4, 0.85, -0.5);
            set.loose(at, Shape::Point, 0.04)?;
        }
        set.hand(
            &self.hand,
            &hand_at(Vec3::new(0.0, 1.3, 0.0), Quat::IDENTITY, 0.0),
        )
    }

    fn shaken(&self, set: &mut Set) -> Result<(), SceneError> {
        set.bin(0.5, 0.5, 2.0)?;
        for index in 0..64_u32 {
            let at = Pose::at(
                0.22 * (index % 4) as f32 - 0.33,
                0.4 + 0.13 * (index / 16) as f32,
                0.22 * (index / 4 % 4) as f32 - 0.33,
            );
            let mut random = chance(index, 99);
            match index % 4 {
                0 => set.loose(at, Shape::Point, 0.05)?,
                1 => set.loose(at, Shape::Box([0.04, 0.05, 0.03]), 0.0)?,
                2 => set.loose(
                    at,
                    Shape::Segment([-0.03, 0.0, 0.0], [0.03, 0.0, 0.0]),
                    0.03,
                )?,
                _ => {
                    let mut on = || between(&mut random, -0.05, 0.05);
                    let points: Vec<[f32; 3]> = (0..16).map(|_| [on(), on(), on()]).collect();
                    set.loose(at, Shape::Hull(&points), 0.005)?;
                }
            }
        }
        set.paddle(Pose::at(0.0, 0.15, 0.0), [0.03, 0.04, 0.01], 3)
    }

    fn visitor(&self, set: &mut Set) -> Result<(), SceneError> {
        set.gallery()?;
        let coupling = Coupling {
            divergence_m: AVATAR_SNAPS_M,
            snap: Coupling::SNAP_WHEN_FREE,
            ..Coupling::DEFAULT
        };
        let body = BodyDef {
            coupling,
            ..BodyDef::new(BodyKind::Driven, self.walking(0).root)
        };
        set.figure(&self.figure, &body, &AVATAR_OPTIONS)
    }

    /// The script of the pushed wall, wandering through the gallery.
    fn walking(&self, frame: u32) -> crate::avatar::Target {
        let mut seen = self.wall.target(frame % self.wall.frames);
        let t = frame as f32 / RATE_HZ;
        let away = Vec3::new(
            1.2 + 2.4 * (0.35 * t).sin(),
            seen.root.translation().y + WALKS_ABOVE_M,
            0.9 + 1.1 * (0.47 * t).sin(),
        );
        seen.root = Pose::new(Quat::from_rotation_y(0.6 * t), away);
        seen
    }

    fn prisoner(&self, set: &mut Set) -> Result<(), SceneError> {
        let (half, high) = (0.42, 1.9);
        set.bin(half, half, high)?;
        set.fixed_box(
            Pose::at(0.0, high + 0.1, 0.0),
            [half + 0.2, 0.1, half + 0.2],
        )?;
        let mut root = self.plan.neutral().root;
        root.position[1] += 0.03;
        let body = BodyDef::new(BodyKind::Driven, root);
        set.figure(&self.figure, &body, &AVATAR_OPTIONS)
    }

    /// Postures that leave the cell on all sides.
    fn writhing(&self, frame: u32) -> crate::avatar::Target {
        let spread = self.table.target(200 + frame % 300);
        let mut seen = self.plan.neutral();
        for (chain, angles) in seen.angles.iter_mut().enumerate() {
            for (hinge, angle) in angles.iter_mut().enumerate() {
                let phase = 0.17 * hinge as f32 + 0.29 * chain as f32;
                let other = spread.angles[chain].get(hinge).copied().unwrap_or(0.0);
                *angle = 0.5 * other + sway(frame, 1.2, 0.3 + 0.05 * hinge as f32, phase);
            }
        }
        let (mut kept, _) = self.plan.kept(&seen);
        let lean = Vec3::new(
            sway(frame, 0.3, 0.2, 0.0),
            0.03 + sway(frame, 0.1, 0.3, 0.0),
            sway(frame, 0.3, 0.27, 0.4),
        );
        kept.root = kept.root.moved(lean);
        kept
    }
}

fn rummaging(frame: u32, side: usize) -> HandTarget {
    let phase = 0.5 * side as f32;
    let at = Vec3::new(
        sway(frame, 0.5, 0.41, phase),
        0.14 + sway(frame, 0.2, 0.83, phase + 0.25),
        (side as f32 - 0.5) * 0.3 + sway(frame, 0.25, 0.29, phase),
    );
    let turn = Quat::from_rotation_y(sway(frame, 0.8, 0.37, phase));
    let weight = 0.5 + 0.5 * f64::from(sway(frame, 1.0, 0.9, phase));
    let mut seen = hand_at(at, turn, weight);
    if frame == 0 {
        seen.position = DVec3::new(0.0, 0.75, if side == 0 { -0.25 } else { 0.25 });
        seen.orientation = DQuat::IDENTITY;
    }
    seen
}

fn anywhere(frame: u32) -> HandTarget {
    let mut random = chance(frame, 5);
    let at = Vec3::new(
        between(&mut random, -2.0, 6.0),
        between(&mut random, -0.1, 3.1),
        between(&mut random, -2.1, 2.1),
    );
    let axis = Vec3::new(
        between(&mut random, -2.0, 2.0),
        between(&mut random, -2.0, 2.0),
        between(&mut random, -2.0, 2.0),
    );
    hand_at(
        at,
        Quat::from_scaled_axis(axis),
        f64::from(random.random::<f32>()),
    )
}

/// Four paddles of five, a bin, 26 loose boxes and a dozen fixed ones: exactly what the pools hold.
fn full(set: &mut Set) -> Result<(), SceneError> {
    set.bin(1.0, 1.0, 0.8)?;
    for index in 0..8_u32 {
        let at = Pose::at(
            0.5 * (index % 4) as f32 - 0.75,
            0.1,
            1.0 * (index / 4) as f32 - 0.5,
        );
        set.fixed_box(at, [0.05, 0.1, 0.08])?;
    }
    for index in 0..25_u32 {
        let at = Pose::at(
            0.3 * (index % 5) as f32 - 0.6,
            0.35 + 0.12 * (index / 15) as f32,
            0.25 * (index / 5 % 3) as f32 - 0.25,
        );
        set.loose(at, Shape::Box([0.05, 0.05, 0.05]), 0.0)?;
    }
    for index in 0..8 {
        let at = Pose::at(0.0, 0.7, 0.2 * index as f32 - 0.7);
        let count = if index == 0 { 3 } else { 4 };
        set.paddle(at, [0.03, 0.02, 0.02], count)?;
    }
    Ok(())
}
