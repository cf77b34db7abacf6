//! The arguments of each call: writing those that are more than a struct, and reading them all to make the
//! call again.

use arrayvec::ArrayVec;

use super::CallKind;
use super::list::List;
use super::outcome::{Outcome, Told};
use super::pen::Put;
use super::words::Words;
use crate::frame::{Budget, CostTable, Deadline, FrameInput};
use crate::geometry::chain::{Hinge, JointDef};
use crate::limits::{CHAIN_HINGES_MAX, PIECE_VERTICES_MAX};
use crate::math::Pose;
use crate::memory::{BodyId, ChainId, PieceId};
use crate::state::bodies::BodyKind;
use crate::state::materials::{Material, Surface};
use crate::state::pieces::Groups;
use crate::world::{BodyDef, ChainDef, HostedInput, Joints, PieceDef, Shape, World};

/// One more than a chain can have: so many are refused like any larger number.
const JOINTS_RECORDED: usize = CHAIN_HINGES_MAX + 1;

/// One more than a piece can have.
const POINTS_RECORDED: usize = PIECE_VERTICES_MAX + 1;

/// Makes a call with recorded arguments; `None` when they are not the arguments of such a call.
pub(super) fn make(world: &mut World, kind: CallKind, words: &mut Words) -> Option<Outcome> {
    match kind {
        CallKind::Step | CallKind::Load | CallKind::SetGravity => whole_world(world, kind, words),
        CallKind::AddMaterial | CallKind::SetSurface => materials(world, kind, words),
        CallKind::AddBody | CallKind::RemoveBody | CallKind::PlaceBody => {
            bodies(world, kind, words)
        }
        CallKind::SetVelocity
        | CallKind::ApplyForce
        | CallKind::ApplyImpulse
        | CallKind::SetHosted => loose(world, kind, words),
        CallKind::SetTarget | CallKind::SetPieceTargets | CallKind::SetJoints => {
            tracked(world, kind, words)
        }
        CallKind::AddPiece
        | CallKind::AddLinkPiece
        | CallKind::RemovePiece
        | CallKind::SetGroups => pieces(world, kind, words),
        CallKind::AddChain | CallKind::RemoveChain | CallKind::SetChainOptions => {
            chains(world, kind, words)
        }
        CallKind::SetAngles | CallKind::SetLinkPoses | CallKind::SetTip | CallKind::PlaceAngles => {
            links(world, kind, words)
        }
    }
}

fn whole_world(world: &mut World, kind: CallKind, words: &mut Words) -> Option<Outcome> {
    Some(match kind {
        CallKind::Step => {
            let input = read_input(words)?;
            world.step(&input).outcome(world)
        }
        CallKind::Load => world.load(words.rest()).outcome(world),
        _ => {
            let gravity = words.pod()?;
            words.end()?;
            world.set_gravity(gravity);
            Outcome::default()
        }
    })
}

fn materials(world: &mut World, kind: CallKind, words: &mut Words) -> Option<Outcome> {
    if kind == CallKind::AddMaterial {
        words.end()?;
        return Some(world.add_material().outcome(world));
    }
    let [a, b] = words.pod::<[Material; 2]>()?;
    let surface: Surface = words.pod()?;
    words.end()?;
    Some(world.set_surface(a, b, surface).outcome(world))
}

fn bodies(world: &mut World, kind: CallKind, words: &mut Words) -> Option<Outcome> {
    if kind == CallKind::AddBody {
        let def = read_body(words)?;
        return Some(world.add_body(&def).outcome(world));
    }
    let id: BodyId = words.pod()?;
    Some(if kind == CallKind::RemoveBody {
        words.end()?;
        world.remove_body(id).outcome(world)
    } else {
        let pose: Pose = words.pod()?;
        words.end()?;
        world.place_body(id, &pose).outcome(world)
    })
}

fn loose(world: &mut World, kind: CallKind, words: &mut Words) -> Option<Outcome> {
    if kind == CallKind::SetHosted {
        let input: HostedInput = words.pod()?;
        words.end()?;
        return Some(world.set_hosted([input]).outcome(world));
    }
    let id: BodyId = words.pod()?;
    let [a, b] = words.pod::<[[f32; 3]; 2]>()?;
    words.end()?;
    let told = match kind {
        CallKind::SetVelocity => world.set_velocity(id, a, b),
        CallKind::ApplyForce => world.apply_force(id, a, b),
        _ => world.apply_impulse(id, a, b),
    };
    Some(told.outcome(world))
}

fn tracked(world: &mut World, kind: CallKind, words: &mut Words) -> Option<Outcome> {
    let id: BodyId = words.pod()?;
    Some(match kind {
        CallKind::SetTarget => {
            let target: Pose = words.pod()?;
            words.end()?;
            world.set_target(id, &target).outcome(world)
        }
        CallKind::SetPieceTargets => {
            let poses = List::read(words)?;
            words.end()?;
            world.set_listed_targets(id, poses).outcome(world)
        }
        _ => {
            let joints = read_joints(words)?;
            world.set_listed_joints(id, &joints).outcome(world)
        }
    })
}

fn pieces(world: &mut World, kind: CallKind, words: &mut Words) -> Option<Outcome> {
    let mut points = ArrayVec::new();
    Some(match kind {
        CallKind::AddPiece => {
            let body: BodyId = words.pod()?;
            let def = read_piece(words, &mut points)?;
            world.add_piece(body, &def).outcome(world)
        }
        CallKind::AddLinkPiece => {
            let (chain, hinge) = (words.pod::<ChainId>()?, words.pod()?);
            let def = read_piece(words, &mut points)?;
            world.add_link_piece(chain, hinge, &def).outcome(world)
        }
        CallKind::RemovePiece => {
            let piece: PieceId = words.pod()?;
            words.end()?;
            world.remove_piece(piece).outcome(world)
        }
        _ => {
            let (piece, groups) = (words.pod::<PieceId>()?, words.pod::<Groups>()?);
            words.end()?;
            world.set_groups(piece, groups).outcome(world)
        }
    })
}

fn chains(world: &mut World, kind: CallKind, words: &mut Words) -> Option<Outcome> {
    if kind == CallKind::AddChain {
        let body: BodyId = words.pod()?;
        let mut joints = ArrayVec::new();
        let def = read_chain(words, &mut joints)?;
        return Some(world.add_chain(body, &def).outcome(world));
    }
    let id: ChainId = words.pod()?;
    Some(if kind == CallKind::RemoveChain {
        words.end()?;
        world.remove_chain(id).outcome(world)
    } else {
        let options = words.pod()?;
        words.end()?;
        world.set_chain_options(id, &options).outcome(world)
    })
}

fn links(world: &mut World, kind: CallKind, words: &mut Words) -> Option<Outcome> {
    let id: ChainId = words.pod()?;
    if kind == CallKind::SetLinkPoses {
        let poses: ArrayVec<Pose, JOINTS_RECORDED> = words.list()?;
        words.end()?;
        return Some(world.set_link_poses(id, &poses).outcome(world));
    }
    if kind == CallKind::SetTip {
        let tip: Pose = words.pod()?;
        let posture: ArrayVec<f32, JOINTS_RECORDED> = words.list()?;
        words.end()?;
        return Some(world.set_tip(id, &tip, &posture).outcome(world));
    }
    let angles: ArrayVec<f32, JOINTS_RECORDED> = words.list()?;
    words.end()?;
    Some(if kind == CallKind::SetAngles {
        world.set_angles(id, &angles).outcome(world)
    } else {
        world.place_angles(id, &angles).outcome(world)
    })
}

/// Names every field: one that is not recorded would make replays differ.
pub(crate) fn put_input(to: &mut dyn Put, input: &FrameInput) {
    let FrameInput {
        dt_s,
        budget,
        deadline,
        focus,
    } = input;
    let Budget {
        advance_units,
        impulse_units,
        reach_steps,
    } = budget;
    to.pod(dt_s);
    to.pod(&[*advance_units, *impulse_units, *reach_steps]);
    let time_ns = deadline.map_or(0, |deadline| deadline.time_ns);
    to.pod(&[
        u32::from(deadline.is_some()),
        time_ns as u32,
        (time_ns >> 32) as u32,
    ]);
    to.pod(&deadline.map_or(CostTable::default(), |deadline| deadline.costs));
    to.pod(&u32::from(focus.is_some()));
    to.pod(&focus.unwrap_or_default());
}

fn read_input(words: &mut Words) -> Option<FrameInput> {
    let dt_s = words.pod()?;
    let [advance_units, impulse_units, reach_steps] = words.pod()?;
    let [has_deadline, low, high] = words.pod::<[u32; 3]>()?;
    let costs: CostTable = words.pod()?;
    let has_focus: u32 = words.pod()?;
    let focus: [f32; 3] = words.pod()?;
    words.end()?;
    Some(FrameInput {
        dt_s,
        budget: Budget {
            advance_units,
            impulse_units,
            reach_steps,
        },
        deadline: (has_deadline != 0).then_some(Deadline {
            time_ns: u64::from(low) | u64::from(high) << 32,
            costs,
        }),
        focus: (has_focus != 0).then_some(focus),
    })
}

pub(crate) fn put_body(to: &mut dyn Put, def: &BodyDef) {
    let BodyDef {
        kind,
        pose,
        coupling,
    } = def;
    to.pod(&kind.code());
    to.pod(pose);
    to.pod(coupling);
}

fn read_body(words: &mut Words) -> Option<BodyDef> {
    let code: u32 = words.pod()?;
    let kinds = [
        BodyKind::Fixed,
        BodyKind::Dynamic,
        BodyKind::Driven,
        BodyKind::Hosted,
    ];
    let def = BodyDef {
        kind: kinds.into_iter().find(|kind| kind.code() == code)?,
        pose: words.pod()?,
        coupling: words.pod()?,
    };
    words.end()?;
    Some(def)
}

/// `most` is how many pieces a body can have.
pub(crate) fn put_joints(to: &mut dyn Put, joints: &Joints, most: usize) {
    let Joints {
        joints,
        root,
        piece_joints,
        piece_offsets,
        reach_m,
    } = joints;
    joints.put(to, u32::MAX as usize - 1);
    to.pod(&u32::try_from(*root).unwrap_or(u32::MAX));
    piece_joints.put(to, most);
    piece_offsets.put(to, most);
    to.pod(reach_m);
}

fn read_joints<'l>(words: &mut Words<'l>) -> Option<Joints<'l>> {
    let joints = Joints {
        joints: List::read(words)?,
        root: words.pod::<u32>()? as usize,
        piece_joints: List::read(words)?,
        piece_offsets: List::read(words)?,
        reach_m: words.pod()?,
    };
    words.end()?;
    Some(joints)
}

pub(crate) fn put_piece(to: &mut dyn Put, def: &PieceDef) {
    let PieceDef {
        shape,
        radius_m,
        local,
        material,
        density_kg_m3,
    } = def;
    match shape {
        Shape::Point => to.pod(&0_u32),
        Shape::Segment(a, b) => {
            to.pod(&1_u32);
            to.pod(&[*a, *b]);
        }
        Shape::Box(half) => {
            to.pod(&2_u32);
            to.pod(half);
        }
        Shape::Hull(points) => {
            to.pod(&3_u32);
            to.list(points, PIECE_VERTICES_MAX);
        }
    }
    to.pod(radius_m);
    to.pod(local);
    to.pod(material);
    to.pod(density_kg_m3);
}

fn read_piece<'p>(
    words: &mut Words,
    points: &'p mut ArrayVec<[f32; 3], POINTS_RECORDED>,
) -> Option<PieceDef<'p>> {
    let shape = match words.pod::<u32>()? {
        0 => Shape::Point,
        1 => {
            let [a, b] = words.pod()?;
            Shape::Segment(a, b)
        }
        2 => Shape::Box(words.pod()?),
        3 => {
            *points = words.list()?;
            Shape::Hull(points)
        }
        _ => return None,
    };
    let def = PieceDef {
        shape,
        radius_m: words.pod()?,
        local: words.pod()?,
        material: words.pod()?,
        density_kg_m3: words.pod()?,
    };
    words.end()?;
    Some(def)
}

pub(crate) fn put_chain(to: &mut dyn Put, def: &ChainDef) {
    let ChainDef {
        joints,
        base,
        options,
    } = def;
    let joints = &joints[..joints.len().min(JOINTS_RECORDED)];
    to.pod(&(joints.len() as u32));
    for joint in joints {
        put_joint(to, joint);
    }
    to.pod(&u32::from(base.is_some()));
    let (chain, hinge) = base.unwrap_or_default();
    to.pod(&chain);
    to.pod(&hinge);
    to.pod(options);
}

fn put_joint(to: &mut dyn Put, joint: &JointDef) {
    match joint {
        JointDef::Hinge(hinge) => {
            to.pod(&0_u32);
            to.pod(hinge);
        }
        JointDef::Ball {
            rest,
            twist_low_rad,
            twist_high_rad,
            cone,
        } => {
            to.pod(&1_u32);
            to.pod(rest);
            to.pod(&[*twist_low_rad, *twist_high_rad]);
            to.pod(cone);
        }
    }
}

fn read_joint(words: &mut Words) -> Option<JointDef> {
    match words.pod::<u32>()? {
        0 => Some(JointDef::Hinge(words.pod::<Hinge>()?)),
        1 => {
            let rest = words.pod()?;
            let [twist_low_rad, twist_high_rad] = words.pod()?;
            Some(JointDef::Ball {
                rest,
                twist_low_rad,
                twist_high_rad,
                cone: words.pod()?,
            })
        }
        _ => None,
    }
}

fn read_chain<'j>(
    words: &mut Words,
    joints: &'j mut ArrayVec<JointDef, JOINTS_RECORDED>,
) -> Option<ChainDef<'j>> {
    for _ in 0..words.pod::<u32>()? {
        joints.try_push(read_joint(words)?).ok()?;
    }
    let is_on_chain = words.pod::<u32>()?;
    let on = (words.pod()?, words.pod()?);
    let base = match is_on_chain {
        0 => None,
        1 => Some(on),
        _ => return None,
    };
    let def = ChainDef {
        joints,
        base,
        options: words.pod()?,
    };
    words.end()?;
    Some(def)
}
