//! Bodies of the host's own physics engine: telling of them, and reading what hands did to them.

use palpable_kernel::state::bodies::HostedImpulse;
use palpable_kernel::world::{HostedError, HostedInput, World};

use crate::arguments::{Strided, judge_optional, judge_versioned, put, put_versioned, value};
use crate::block::Block;
use crate::bodies::body_status;
use crate::panic::{Outcome, guarded};
use crate::status::{PALP_ENTRIES_REFUSED, PALP_OK, palp_status};
use crate::types::{palp_body_id, palp_pose, palp_quat, palp_refusal, palp_vec3, palp_world};

/// A body of the host's own physics engine, as the host has it before a frame. Start from
/// `PALP_HOSTED_INPUT_INIT`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_hosted_input {
    /// `sizeof(palp_hosted_input)`.
    pub struct_size: u32,
    /// A body of the kind `PALP_KIND_HOSTED`.
    pub body: palp_body_id,
    /// Where it is.
    pub pose: palp_pose,
    /// Velocity of its centre of mass, in m/s, at most 1000 a coordinate.
    pub velocity_m_s: palp_vec3,
    /// Angular velocity in the world, in rad/s, at most 3000 a coordinate.
    pub spin_rad_s: palp_vec3,
    /// Mass in kg, 1e-9 to 1e9; 0 for a body that nothing moves.
    pub mass_kg: f32,
    /// Centre of mass in the body's frame, in metres.
    pub centre: palp_vec3,
    /// Principal moments of inertia about the centre of mass, in kg m2, 1e-9 to 1e9; not looked at when
    /// `mass_kg` is 0.
    pub moments_kg_m2: palp_vec3,
    /// Orientation of the principal axes in the body's frame.
    pub axes: palp_quat,
}

/// What hands did to a hosted body in the last frame. Start from `PALP_HOSTED_STATE_INIT`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct palp_hosted_state {
    /// `sizeof(palp_hosted_state)`.
    pub struct_size: u32,
    /// Contacts that carried an impulse.
    pub contacts: u32,
    /// Impulse of the driven and dynamic bodies on it, in newton seconds, in the world.
    pub impulse_n_s: palp_vec3,
    /// Their angular impulse about its centre of mass, in newton metre seconds, in the world.
    pub angular_n_m_s: palp_vec3,
    /// Mean of the contacts' points, weighted by their normal impulses, in the world, in metres; says nothing
    /// when `contacts` is 0. The two impulses are all that an engine needs; this is where they came from.
    pub point: palp_vec3,
    /// Sum of the contacts' normal impulses, in newton seconds.
    pub push_n_s: f32,
}

impl palp_hosted_input {
    pub(crate) const NONE: Self = Self {
        struct_size: 0,
        body: palp_body_id {
            index1: 0,
            generation: 0,
        },
        pose: palp_pose::IDENTITY,
        velocity_m_s: palp_vec3::new([0.0; 3]),
        spin_rad_s: palp_vec3::new([0.0; 3]),
        mass_kg: 0.0,
        centre: palp_vec3::new([0.0; 3]),
        moments_kg_m2: palp_vec3::new([0.0; 3]),
        axes: palp_pose::IDENTITY.orientation,
    };

    const fn to_kernel(self) -> HostedInput {
        let q = self.axes;
        HostedInput {
            body: self.body.to_kernel(),
            pose: self.pose.to_kernel(),
            velocity: self.velocity_m_s.to_array(),
            spin: self.spin_rad_s.to_array(),
            mass_kg: self.mass_kg,
            centre: self.centre.to_array(),
            moments: self.moments_kg_m2.to_array(),
            axes: [q.x, q.y, q.z, q.w],
        }
    }
}

impl palp_hosted_state {
    const fn new(from: &HostedImpulse) -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            contacts: from.contacts,
            impulse_n_s: palp_vec3::new(from.impulse_n_s),
            angular_n_m_s: palp_vec3::new(from.angular_n_m_s),
            point: palp_vec3::new(from.point),
            push_n_s: from.push_n_s,
        }
    }
}

/// Does something with every entry; the first one that was refused.
fn for_each(
    count: usize,
    mut act: impl FnMut(usize) -> Result<(), palp_status>,
) -> Option<palp_refusal> {
    let mut first = None;
    for index in 0..count {
        if let Err(status) = act(index)
            && first.is_none()
        {
            first = Some(palp_refusal {
                index: index as u32,
                status,
            });
        }
    }
    first
}

/// Tells the host which entry was refused.
///
/// # Safety
/// The pointer is null, or was judged and is writable.
unsafe fn tell(refusal: *mut palp_refusal, first: Option<palp_refusal>, count: u32) -> Outcome {
    let none = palp_refusal {
        index: count,
        status: PALP_OK,
    };
    // SAFETY: the caller vouches.
    unsafe { put(refusal, first.unwrap_or(none)) };
    Ok(first.map_or(PALP_OK, |_| PALP_ENTRIES_REFUSED))
}

fn set_one(world: &mut World, input: &palp_hosted_input) -> Result<(), palp_status> {
    world
        .set_hosted([input.to_kernel()])
        .map_err(|HostedError { error, .. }| body_status(error))
}

/// Tells where the host's own bodies are, how they move and what they weigh; call it once before each frame
/// with all that move. Driven bodies make room for them, push, squeeze and hold them, as if gravity and
/// contacts alone moved them in the frame; `palp_hosted_impulses` gives what that did to them.
///
/// `inputs` are `count` structs, `stride` bytes from one to the next, so that they may lie in larger structs
/// of the host's; a stride of 0 is refused. Every entry that is good is taken, the others stay as they were:
/// then the status is `PALP_ENTRIES_REFUSED`, and `refusal`, which may be null, names the first of them and
/// says why. Costs a pass over the pieces of the bodies that moved.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_hosted_set(
    world: *mut palp_world,
    inputs: *const palp_hosted_input,
    count: u32,
    stride: u32,
    refusal: *mut palp_refusal,
) -> palp_status {
    guarded(|| {
        judge_optional(refusal)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let block = Block::of(world)?;
            let entry = size_of::<palp_hosted_input>();
            let inputs = Strided::judged(inputs, count, stride as usize, entry, &block.range())?;
            let first = block.change(|world| {
                Ok(for_each(inputs.count, |index| {
                    set_one(world, &inputs.versioned(index)?)
                }))
            })?;
            tell(refusal, first, count)
        }
    })
}

/// What driven and dynamic bodies did to a hosted body in the last frame. The host's engine is to apply it
/// before its own step. `state->struct_size` is set by the host.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_hosted_impulse(
    world: *const palp_world,
    body: palp_body_id,
    state: *mut palp_hosted_state,
) -> palp_status {
    guarded(|| {
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let stated = judge_versioned(state)?;
            let found = Block::of(world)?
                .read(|world| world.hosted_impulse(body.to_kernel()).map_err(body_status))?;
            put_versioned(state, stated, &palp_hosted_state::new(&found));
        }
        Ok(PALP_OK)
    })
}

/// As `palp_hosted_impulse`, for many bodies at once: `bodies` are `count` ids, `body_stride` bytes from one
/// to the next, and `states` as many results, `state_stride` bytes apart, so that both may lie in larger
/// structs of the host's; a stride of 0 is refused. The `struct_size` of each state is set by the host.
/// Every entry that is good is answered, the others stay as they were: then the status is
/// `PALP_ENTRIES_REFUSED`, and `refusal`, which may be null, names the first of them and says why.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn palp_hosted_impulses(
    world: *const palp_world,
    bodies: *const palp_body_id,
    body_stride: u32,
    states: *mut palp_hosted_state,
    state_stride: u32,
    count: u32,
    refusal: *mut palp_refusal,
) -> palp_status {
    guarded(|| {
        judge_optional(refusal)?;
        // SAFETY: the header's rules for pointers and threads.
        unsafe {
            let block = Block::of(world)?;
            let range = block.range();
            let id = size_of::<palp_body_id>();
            let bodies = Strided::judged(bodies, count, body_stride as usize, id, &range)?;
            let entry = size_of::<palp_hosted_state>();
            let states = Strided::judged(
                states.cast_const(),
                count,
                state_stride as usize,
                entry,
                &range,
            )?;
            let first = block.read(|world| {
                Ok(for_each(bodies.count, |index| {
                    let stated = states.stated_bytes(index)?;
                    let body = value(bodies.at(index))?.to_kernel();
                    let found = world.hosted_impulse(body).map_err(body_status)?;
                    let result = palp_hosted_state::new(&found);
                    put_versioned(states.at(index).cast_mut(), stated, &result);
                    Ok(())
                }))
            })?;
            tell(refusal, first, count)
        }
    })
}
