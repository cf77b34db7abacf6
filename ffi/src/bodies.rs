//! Adding, removing, placing and reading bodies, and where trackers want them.

use palpable_kernel::math::Pose;
use palpable_kernel::state::bodies::{BodyKind, Coupling};
use palpable_kernel::world::{AddBodyError, BodyDef, BodyError};

use crate::arguments::{
    array, judge, judge_optional, judge_versioned, put, put_versioned, value, versioned,
};
use crate::block::Block;
use crate::panic::guarded;
use crate::status::{
    PALP_BAD_COUPLING, PALP_BAD_ENUM, PALP_BAD_FORCE, PALP_BAD_MASS, PALP_BAD_POSE,
    PALP_BAD_VELOCITY, PALP_FULL_BODIES, PALP_OK, PALP_SAME_BODY, PALP_STALE_BODY,
    PALP_WRONG_COUNT, PALP_WRONG_KIND, palp_status,
};
use crate::types::{
    PALP_KIND_DRIVEN, PALP_KIND_DYNAMIC, PALP_KIND_FIXED, PALP_KIND_HOSTED, palp_body_def,
    palp_body_id, palp_driven_state, palp_pose, palp_vec3, palp_world,
};

const fn add_status(error: AddBodyError) -> palp_status {
    match error {
        AddBodyError::Full => PALP_FULL_BODIES,
        AddBodyError::BadPose => PALP_BAD_POSE,
        AddBodyError::BadCoupling => PALP_BAD_COUPLING,
    }
}

pub(crate) const fn body_status(error: BodyError) -> palp_status {
    match error {
        BodyError::Stale => PALP_STALE_BODY,
        BodyError::WrongKind => PALP_WRONG_KIND,
        BodyError::BadPose => PALP_BAD_POSE,
        BodyError::WrongCount => PALP_WRONG_COUNT,
        BodyError::BadVelocity => PALP_BAD_VELOCITY,
        BodyError::BadForce => PALP_BAD_FORCE,
        BodyError::BadMass => PALP_BAD_MASS,
        BodyError::SameBody => PALP_SAME_BODY,
    }
}

fn body_def(def: &palp_body_def) -> Result<BodyDef, palp_status> {
    let kind = match def.kind {
        PALP_KIND_FIXED => BodyKind::Fixed,
        PALP_KIND_DYNAMIC => BodyKind::Dynamic,
        PALP_KIND_DRIVEN => BodyKind::Driven,
        PALP_KIND_HOSTED => BodyKind::Hosted,
        _ => return Err(PALP_BAD_ENUM),
    };
    let spring = &def.coupling;
    let known = spring.snap <= Coupling::SNAP_NEAR && spring.push <= Coupling::PUSH_WITH_MASS;
    if kind == BodyKind::Driven && !known {
        return Err(PALP_BAD_ENUM);
    }
    Ok(BodyDef {
        kind,
        pose: def.pose.to_kernel(),
        coupling: def.coupling.to_kernel(),
    })
}

/// Adds a body without pieces.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_body_add(
    world: *mut palp_world,
    def: *const palp_body_def,
    body: *mut palp_body_id,
) -> palp_status {
    guarded(|| {
        judge(body)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let def = body_def(&versioned(def)?)?;
            let id = Block::of(world)?.change(|world| world.add_body(&def).map_err(add_status))?;
            put(body, palp_body_id::new(id));
        }
        Ok(PALP_OK)
    })
}

/// Removes a body, its pieces and its chains. Costs one pass over all pieces' vertices for each of its
/// pieces.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_body_remove(
    world: *mut palp_world,
    body: palp_body_id,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            Block::of(world)?
                .change(|world| world.remove_body(body.to_kernel()).map_err(body_status))?;
        }
        Ok(PALP_OK)
    })
}

/// Puts a body elsewhere at once, without a way there. A driven body forgets its displacement, a
/// dynamic one keeps its velocity. Overlap made so is reported by the next frame and never gets
/// deeper.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_body_place(
    world: *mut palp_world,
    body: palp_body_id,
    pose: *const palp_pose,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let pose = value(pose)?.to_kernel();
            Block::of(world)?.change(|world| {
                world
                    .place_body(body.to_kernel(), &pose)
                    .map_err(body_status)
            })?;
        }
        Ok(PALP_OK)
    })
}

/// Sets the velocity of a dynamic body's centre of mass in m/s and its angular velocity in rad/s,
/// both in the world, and wakes it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_body_set_velocity(
    world: *mut palp_world,
    body: palp_body_id,
    linear_m_s: *const palp_vec3,
    angular_rad_s: *const palp_vec3,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let linear = value(linear_m_s)?.to_array();
            let angular = value(angular_rad_s)?.to_array();
            Block::of(world)?.change(|world| {
                world
                    .set_velocity(body.to_kernel(), linear, angular)
                    .map_err(body_status)
            })?;
        }
        Ok(PALP_OK)
    })
}

/// The velocity of a dynamic body's centre of mass in m/s and its angular velocity in rad/s, both in
/// the world. Either pointer may be null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_body_velocity(
    world: *const palp_world,
    body: palp_body_id,
    linear_m_s: *mut palp_vec3,
    angular_rad_s: *mut palp_vec3,
) -> palp_status {
    guarded(|| {
        judge_optional(linear_m_s)?;
        judge_optional(angular_rad_s)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let (linear, angular) = Block::of(world)?
                .read(|world| world.velocity(body.to_kernel()).map_err(body_status))?;
            put(linear_m_s, palp_vec3::new(linear));
            put(angular_rad_s, palp_vec3::new(angular));
        }
        Ok(PALP_OK)
    })
}

/// The mass of a dynamic body in kg.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_body_mass(
    world: *const palp_world,
    body: palp_body_id,
    mass_kg: *mut f32,
) -> palp_status {
    guarded(|| {
        judge(mass_kg)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let mass = Block::of(world)?
                .read(|world| world.mass_kg(body.to_kernel()).map_err(body_status))?;
            put(mass_kg, mass);
        }
        Ok(PALP_OK)
    })
}

/// Adds a force in newtons and a torque about the centre of mass in newton metres, both in the world, that
/// act on a dynamic body over the whole of the next frame, and wakes it. Each coordinate of a frame's sum is
/// at most 1e9.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_body_apply_force(
    world: *mut palp_world,
    body: palp_body_id,
    force_n: *const palp_vec3,
    torque_n_m: *const palp_vec3,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let force = value(force_n)?.to_array();
            let torque = value(torque_n_m)?.to_array();
            Block::of(world)?.change(|world| {
                world
                    .apply_force(body.to_kernel(), force, torque)
                    .map_err(body_status)
            })?;
        }
        Ok(PALP_OK)
    })
}

/// Changes a dynamic body's motion at once by an impulse in newton seconds at a point, both in the world,
/// and wakes it. The next frame slows what became faster than 1000 m/s or 3000 rad/s.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_body_apply_impulse(
    world: *mut palp_world,
    body: palp_body_id,
    impulse_n_s: *const palp_vec3,
    point: *const palp_vec3,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let impulse = value(impulse_n_s)?.to_array();
            let point = value(point)?.to_array();
            Block::of(world)?.change(|world| {
                world
                    .apply_impulse(body.to_kernel(), impulse, point)
                    .map_err(body_status)
            })?;
        }
        Ok(PALP_OK)
    })
}

/// Whether a dynamic body sleeps, 1 or 0: it and all that it leans on have been still for a while.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_body_is_asleep(
    world: *const palp_world,
    body: palp_body_id,
    asleep: *mut u32,
) -> palp_status {
    guarded(|| {
        judge(asleep)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let sleeps = Block::of(world)?
                .read(|world| world.is_asleep(body.to_kernel()).map_err(body_status))?;
            put(asleep, u32::from(sleeps));
        }
        Ok(PALP_OK)
    })
}

/// Tells where a driven body's tracker is. Call it every frame: a frame without it, or with one that
/// is refused, counts the tracker as lost and keeps the last target.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_body_set_target(
    world: *mut palp_world,
    body: palp_body_id,
    target: *const palp_pose,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let target = value(target)?.to_kernel();
            Block::of(world)?.change(|world| {
                world
                    .set_target(body.to_kernel(), &target)
                    .map_err(body_status)
            })?;
        }
        Ok(PALP_OK)
    })
}

/// Tells where a driven body's pieces are to be in its frame, in the order they were added: the
/// fingers of a tracked hand. A piece on a link of a chain is to be there in the link's frame. They move there over the frame, as far as contact allows. Refused as a
/// whole when `count` is not the number of pieces or any pose is bad.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_body_set_piece_targets(
    world: *mut palp_world,
    body: palp_body_id,
    poses: *const palp_pose,
    count: u32,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let block = Block::of(world)?;
            let poses = kernel_poses(array(poses, count, &block.range())?);
            block.change(|world| {
                world
                    .set_piece_targets(body.to_kernel(), poses)
                    .map_err(body_status)
            })?;
        }
        Ok(PALP_OK)
    })
}

/// The poses as the kernel's own, which lie in memory alike.
pub(crate) fn kernel_poses(poses: &[palp_pose]) -> &[Pose] {
    // SAFETY: size, alignment and offsets are equal (asserted where the type is declared), and any
    // bits are seven floats.
    unsafe { core::slice::from_raw_parts(poses.as_ptr().cast::<Pose>(), poses.len()) }
}

/// The published pose of a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_body_pose(
    world: *const palp_world,
    body: palp_body_id,
    pose: *mut palp_pose,
) -> palp_status {
    guarded(|| {
        judge(pose)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let found = Block::of(world)?
                .read(|world| world.pose(body.to_kernel()).map_err(body_status))?;
            put(pose, palp_pose::new(&found));
        }
        Ok(PALP_OK)
    })
}

/// What the last frame did to a driven body. `state->struct_size` is set by the host.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_driven_report(
    world: *const palp_world,
    body: palp_body_id,
    state: *mut palp_driven_state,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let stated = judge_versioned(state)?;
            let report = Block::of(world)?
                .read(|world| world.driven_report(body.to_kernel()).map_err(body_status))?;
            put_versioned(state, stated, &palp_driven_state::new(&report));
        }
        Ok(PALP_OK)
    })
}
