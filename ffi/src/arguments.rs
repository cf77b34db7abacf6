//! Judging what the host passes: pointers, arrays and structs that say their own size.

use core::mem::MaybeUninit;
use core::ops::Range;

use crate::hosted::{palp_hosted_input, palp_hosted_state};
use crate::recording::{palp_replay, palp_replayed};
use crate::skeleton::{palp_chain_def, palp_chain_state, palp_joint};
use crate::status::{
    PALP_BAD_STRIDE, PALP_BAD_STRUCT_SIZE, PALP_INSIDE_WORLD, PALP_MISALIGNED, PALP_NULL,
    PALP_WRONG_COUNT, palp_status,
};
use crate::types::{
    PALP_PAIR_CONTACTS, palp_body_def, palp_capacities, palp_contact, palp_costs, palp_coupling,
    palp_driven_state, palp_frame_input, palp_frame_report, palp_penetration_result,
    palp_piece_def, palp_piece_id, palp_pose, palp_vec3,
};

/// No struct of any version is larger, in bytes.
const STRUCT_BYTES_MAX: usize = 1024;

/// A struct that starts with its own size and may get more fields at its end.
///
/// # Safety
/// The type is `repr(C)`, starts with a `u32`, has no padding, and every pattern of bits is a value.
pub(crate) unsafe trait Versioned: Copy {
    /// Bytes of the versions before this one, the first of them first.
    const OLDER: &'static [usize];
    /// What fields are that an older version does not have.
    const MISSING: Self;
}

macro_rules! versioned {
    ($($name:ident: $older:expr, $bytes:expr, $missing:expr;)*) => {
        $(
            // SAFETY: the structs of the header are `repr(C)` and made of numbers and pointers; the
            // assertion below finds padding in the sum of their fields.
            unsafe impl Versioned for $name {
                const OLDER: &'static [usize] = &$older;
                const MISSING: Self = $missing;
            }
            const _: () = {
                let bytes: usize = $bytes;
                assert!(bytes == size_of::<$name>() && bytes <= STRUCT_BYTES_MAX);
            };
        )*
    };
}

const POINTER: usize = size_of::<*const u8>();

// Bytes of older versions, then the sum of the fields' bytes.
versioned! {
    palp_capacities: [7 * 4], 9 * 4, palp_capacities {
        struct_size: 0, bodies: 0, pieces: 0, vertices: 0, pairs: 0, contacts: 0, materials: 0,
        chains: 0, joints: 0,
    };
    palp_body_def: [2 * 4 + 28 + 6 * 4], 2 * 4 + 28 + 7 * 4, palp_body_def {
        struct_size: 0, kind: 0, pose: palp_pose::IDENTITY, coupling: palp_coupling::DEFAULT,
    };
    palp_piece_def: [], 2 * 4 + POINTER + 2 * 4 + 2 * 12 + 3 * 4 + 28, palp_piece_def {
        struct_size: 0, shape: 0, points: core::ptr::null(), point_count: 0, point_stride: 0,
        a: palp_vec3::new([0.0; 3]), b: palp_vec3::new([0.0; 3]), radius_m: 0.0,
        density_kg_m3: 700.0, material: 0, local_pose: palp_pose::IDENTITY,
    };
    palp_joint: [], 2 * 4 + 28 + 12 + 2 * 4 + 12 + 4 + 12 * 12, palp_joint::NONE;
    palp_chain_def: [], 2 * 4 + POINTER + 4 + 8 + 4 + 24, palp_chain_def::NONE;
    palp_chain_state: [], 5 * 4, palp_chain_state {
        struct_size: 0, flags: 0, steps: 0, missed_m: 0.0, deviation_rad: 0.0,
    };
    palp_frame_input: [4 * 4, 5 * 4], 6 * 4 + 8 * 4 + 4 + 12, palp_frame_input {
        struct_size: 0, dt_s: 0.0, advance_units: u32::MAX, impulse_units: u32::MAX,
        reach_steps: u32::MAX, deadline_ns: 0, costs: palp_costs::FREE, has_focus: 0,
        focus: palp_vec3::new([0.0; 3]),
    };
    palp_frame_report: [2 * 4 + 8 + 6 * 4, 2 * 4 + 8 + 8 * 4], 2 * 4 + 8 + 14 * 4, palp_frame_report {
        struct_size: 0, flags: 0, frame: 0, advance_units: 0, impulse_units: 0, contacts: 0,
        impulses: 0, lost_s: 0.0, reach_steps: 0, events: 0, events_dropped: 0, driven_cut: 0,
        chains_cut: 0, loose_cut: 0, kept: 0, floor_ns: 0, priced_ns: 0,
    };
    palp_driven_state: [3 * 4 + 12], 3 * 4 + 2 * 12, palp_driven_state {
        struct_size: 0, flags: 0, displacement_m: 0.0, force_n: palp_vec3::new([0.0; 3]),
        reaction_n: palp_vec3::new([0.0; 3]),
    };
    palp_hosted_input: [], 2 * 4 + 4 + 28 + 4 * 12 + 4 + 16, palp_hosted_input::NONE;
    palp_hosted_state: [], 2 * 4 + 3 * 12 + 4, palp_hosted_state {
        struct_size: 0, contacts: 0, impulse_n_s: palp_vec3::new([0.0; 3]),
        angular_n_m_s: palp_vec3::new([0.0; 3]), point: palp_vec3::new([0.0; 3]), push_n_s: 0.0,
    };
    palp_replay: [], 2 * 4 + POINTER + size_of::<usize>() + 3 * 8, palp_replay::NONE;
    palp_replayed: [], 2 * 4 + 4 * 8 + 4 * 4, palp_replayed::NONE;
    palp_penetration_result: [], 4 * 4 + 3 * 12 + 2 * 8 + 4 * 56, palp_penetration_result {
        struct_size: 0, contact_count: 0, depth_m: 0.0, distance_m: 0.0,
        normal: palp_vec3::new([0.0; 3]), point_a: palp_vec3::new([0.0; 3]),
        point_b: palp_vec3::new([0.0; 3]), piece_a: palp_piece_id::NULL,
        piece_b: palp_piece_id::NULL, contacts: [palp_contact::NONE; PALP_PAIR_CONTACTS as usize],
    };
}

/// Refuses a pointer that is null or not aligned to its type.
pub(crate) fn judge<T>(pointer: *const T) -> Result<(), palp_status> {
    if pointer.is_null() {
        return Err(PALP_NULL);
    }
    if !pointer.is_aligned() {
        return Err(PALP_MISALIGNED);
    }
    Ok(())
}

/// Like [`judge`], but null is fine.
pub(crate) fn judge_optional<T>(pointer: *const T) -> Result<(), palp_status> {
    if pointer.is_null() {
        return Ok(());
    }
    judge(pointer)
}

/// The value behind a pointer.
///
/// # Safety
/// A pointer that is neither null nor misaligned is readable, and any bits there are a `T`.
pub(crate) unsafe fn value<T: Copy>(pointer: *const T) -> Result<T, palp_status> {
    judge(pointer)?;
    // SAFETY: neither null nor misaligned; the caller vouches for the rest.
    Ok(unsafe { pointer.read() })
}

/// Writes a result unless the host does not want it.
///
/// # Safety
/// The pointer is null, or was judged and is writable.
pub(crate) unsafe fn put<T>(pointer: *mut T, value: T) {
    if !pointer.is_null() {
        // SAFETY: the caller vouches.
        unsafe { pointer.write(value) }
    }
}

/// The size that a struct says it has.
///
/// # Safety
/// A pointer that is neither null nor misaligned is readable for as many bytes as its first four say.
unsafe fn stated_bytes<T: Versioned>(pointer: *const T) -> Result<usize, palp_status> {
    judge(pointer)?;
    // SAFETY: the struct starts with its size, and the pointer was judged.
    let bytes = unsafe { pointer.cast::<u32>().read() } as usize;
    let newer_or_equal = (size_of::<T>()..=STRUCT_BYTES_MAX).contains(&bytes);
    if newer_or_equal || T::OLDER.contains(&bytes) {
        return Ok(bytes);
    }
    Err(PALP_BAD_STRUCT_SIZE)
}

/// Reads a struct of any version: fields it does not have yet are [`Versioned::MISSING`], fields that
/// this library does not have yet must be zero.
///
/// # Safety
/// A pointer that is neither null nor misaligned is readable for as many bytes as its first four say.
pub(crate) unsafe fn versioned<T: Versioned>(pointer: *const T) -> Result<T, palp_status> {
    // SAFETY: the same contract.
    let stated = unsafe { stated_bytes(pointer) }?;
    let known = stated.min(size_of::<T>());
    let mut result = MaybeUninit::new(T::MISSING);
    // SAFETY: `known` bytes are readable by contract and fit in `T`; the ranges are apart, one being
    // a local.
    unsafe {
        core::ptr::copy_nonoverlapping(
            pointer.cast::<u8>(),
            result.as_mut_ptr().cast::<u8>(),
            known,
        );
    }
    // SAFETY: the struct is readable for its stated size.
    let newer =
        unsafe { core::slice::from_raw_parts(pointer.cast::<u8>().add(known), stated - known) };
    if newer.iter().any(|&byte| byte != 0) {
        return Err(PALP_BAD_STRUCT_SIZE);
    }
    // SAFETY: whole from the start, and any bits are a value.
    Ok(unsafe { result.assume_init() })
}

/// Judges a struct that a result is to go to; the size it says it has.
///
/// # Safety
/// A pointer that is neither null nor misaligned is readable for as many bytes as its first four say.
pub(crate) unsafe fn judge_versioned<T: Versioned>(pointer: *mut T) -> Result<usize, palp_status> {
    // SAFETY: the same contract.
    unsafe { stated_bytes(pointer) }
}

/// Writes as much of a result as the host's version of the struct has, its size left as it is.
/// Fields that this library does not have yet become zero.
///
/// # Safety
/// [`judge_versioned`] gave `stated` for this pointer, and so many bytes are writable.
pub(crate) unsafe fn put_versioned<T: Versioned>(pointer: *mut T, stated: usize, result: &T) {
    let size = size_of::<u32>();
    let known = stated.min(size_of::<T>());
    let from = core::ptr::from_ref(result).cast::<u8>();
    let to = pointer.cast::<u8>();
    // SAFETY: `known` is at most the size of both, at least the first version's, and the host's
    // struct cannot overlap a local one.
    unsafe {
        core::ptr::copy_nonoverlapping(from.add(size), to.add(size), known - size);
        to.add(known).write_bytes(0, stated - known);
    }
}

/// Refuses `bytes` bytes at an address that reach into the block.
pub(crate) fn judge_outside(
    block: &Range<usize>,
    address: usize,
    bytes: usize,
) -> Result<(), palp_status> {
    let end = address.checked_add(bytes).ok_or(PALP_WRONG_COUNT)?;
    if bytes > 0 && address < block.end && block.start < end {
        return Err(PALP_INSIDE_WORLD);
    }
    Ok(())
}

/// An array of the host outside the world's block. Null is an empty array when there are to be no
/// entries.
///
/// # Safety
/// A pointer that is neither null nor misaligned is readable for `count` entries while `'a` lasts,
/// any bits there are a `T`, and nobody writes to them meanwhile.
pub(crate) unsafe fn array<'a, T: Copy>(
    pointer: *const T,
    count: u32,
    block: &Range<usize>,
) -> Result<&'a [T], palp_status> {
    if count == 0 {
        return Ok(&[]);
    }
    judge(pointer)?;
    let bytes = (count as usize)
        .checked_mul(size_of::<T>())
        .filter(|&bytes| isize::try_from(bytes).is_ok())
        .ok_or(PALP_WRONG_COUNT)?;
    judge_outside(block, pointer.addr(), bytes)?;
    // SAFETY: judged, not too long, outside the block; the caller vouches for the rest.
    Ok(unsafe { core::slice::from_raw_parts(pointer, count as usize) })
}

/// The versioned structs of an array of the host outside the world's block, `stride` bytes apart, or as
/// far as the first one says that it is long when that is 0. Each goes to `take` with its index.
///
/// # Safety
/// A pointer that is neither null nor misaligned is readable for `count` structs `stride` bytes apart,
/// each for as many bytes as its first four say.
pub(crate) unsafe fn each_versioned<T: Versioned>(
    pointer: *const T,
    count: u32,
    stride: u32,
    block: &Range<usize>,
    mut take: impl FnMut(usize, &T) -> Result<(), palp_status>,
) -> Result<(), palp_status> {
    if count == 0 {
        return Ok(());
    }
    judge_outside(block, pointer.addr(), size_of::<u32>())?;
    // SAFETY: the same contract.
    let stated = unsafe { stated_bytes(pointer) }?;
    let stride = if stride == 0 { stated } else { stride as usize };
    let entries = Strided::judged(pointer, count, stride, stated, block)?;
    for index in 0..entries.count {
        // SAFETY: readable by contract.
        let entry = unsafe { entries.versioned(index)? };
        take(index, &entry)?;
    }
    Ok(())
}

/// Entries of an array of the host outside the world's block, some bytes apart.
pub(crate) struct Strided<T> {
    first: *const T,
    stride: usize,
    /// How many there are.
    pub count: usize,
}

impl<T> Strided<T> {
    /// An array whose entries take at least `entry` bytes. Null is an empty array when there are to be no
    /// entries.
    pub(crate) fn judged(
        first: *const T,
        count: u32,
        stride: usize,
        entry: usize,
        block: &Range<usize>,
    ) -> Result<Self, palp_status> {
        let count = count as usize;
        if count == 0 {
            return Ok(Self {
                first,
                stride,
                count,
            });
        }
        judge(first)?;
        if stride < entry || !stride.is_multiple_of(align_of::<T>()) {
            return Err(PALP_BAD_STRIDE);
        }
        let bytes = stride
            .checked_mul(count - 1)
            .and_then(|bytes| bytes.checked_add(entry))
            .filter(|&bytes| isize::try_from(bytes).is_ok())
            .ok_or(PALP_WRONG_COUNT)?;
        judge_outside(block, first.addr(), bytes)?;
        Ok(Self {
            first,
            stride,
            count,
        })
    }

    /// An entry's address, aligned because the first one and the stride are.
    pub(crate) fn at(&self, index: usize) -> *const T {
        debug_assert!(index < self.count);
        self.first.wrapping_byte_add(index * self.stride)
    }
}

impl<T: Versioned> Strided<T> {
    /// The size that an entry says it has: no more than the stride, or entries would overlap.
    ///
    /// # Safety
    /// The entry is readable for as many bytes as its first four say.
    pub(crate) unsafe fn stated_bytes(&self, index: usize) -> Result<usize, palp_status> {
        // SAFETY: the same contract.
        let stated = unsafe { stated_bytes(self.at(index)) }?;
        if stated > self.stride {
            return Err(PALP_BAD_STRUCT_SIZE);
        }
        Ok(stated)
    }

    /// An entry of any version.
    ///
    /// # Safety
    /// The entry is readable for as many bytes as its first four say.
    pub(crate) unsafe fn versioned(&self, index: usize) -> Result<T, palp_status> {
        // SAFETY: the same contract.
        unsafe {
            self.stated_bytes(index)?;
            versioned(self.at(index))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::types::palp_frame_input;

    #[repr(C)]
    struct Newer {
        input: palp_frame_input,
        more: u32,
    }

    fn newer(more: u32) -> Newer {
        let mut input = palp_frame_input::MISSING;
        input.struct_size = size_of::<Newer>() as u32;
        Newer { input, more }
    }

    fn read(input: &Newer) -> Result<palp_frame_input, palp_status> {
        // SAFETY: the struct is as long as it says.
        unsafe { versioned(core::ptr::from_ref(input).cast::<palp_frame_input>()) }
    }

    #[test]
    fn a_newer_struct_is_read_while_its_new_fields_are_zero() {
        assert!(read(&newer(0)).is_ok());
        assert_eq!(read(&newer(1)), Err(PALP_BAD_STRUCT_SIZE));
    }

    #[test]
    fn a_newer_struct_gets_zeros_in_its_new_fields() {
        let mut target = newer(7);
        let result = palp_frame_input {
            dt_s: 0.5,
            ..palp_frame_input::MISSING
        };
        let pointer = core::ptr::from_mut(&mut target).cast::<palp_frame_input>();
        // SAFETY: the struct is as long as it says.
        unsafe {
            let stated = judge_versioned(pointer).unwrap();
            put_versioned(pointer, stated, &result);
        }
        assert_eq!(target.more, 0);
        assert_eq!(target.input.dt_s, 0.5);
        assert_eq!(target.input.struct_size as usize, size_of::<Newer>());
    }

    /// The leading fields of a struct, as an older header declares it.
    fn older<T: Versioned>(bytes: usize, fields: &[u32]) -> Result<T, palp_status> {
        let mut words = [0xdead_beef; 16];
        words[0] = bytes as u32;
        words[1..=fields.len()].copy_from_slice(fields);
        // SAFETY: the array is longer than any version of the structs asked for, and aligned like them.
        unsafe { versioned(words.as_ptr().cast::<T>()) }
    }

    #[test]
    fn an_input_without_steps_for_chains_limits_none() {
        let read: palp_frame_input = older(16, &[0.25f32.to_bits(), 7, 8]).unwrap();
        assert_eq!((read.advance_units, read.impulse_units), (7, 8));
        assert_eq!(read.reach_steps, u32::MAX);
    }

    #[test]
    fn capacities_without_chains_have_none() {
        let read: palp_capacities = older(28, &[1, 2, 3, 4, 5, 6]).unwrap();
        assert_eq!((read.bodies, read.materials), (1, 6));
        assert_eq!((read.chains, read.joints), (0, 0));
    }

    #[test]
    fn capacities_without_chains_are_not_written_beyond_their_end() {
        let mut words = [28, 0, 0, 0, 0, 0, 0, 77, 78];
        let pointer = words.as_mut_ptr().cast::<palp_capacities>();
        let result = palp_capacities::new(&palpable_kernel::memory::Capacities::ROOM);
        // SAFETY: the array is as long as the newest version, and aligned like it.
        unsafe {
            let stated = judge_versioned(pointer).unwrap();
            put_versioned(pointer, stated, &result);
        }
        assert_eq!(words[1], result.bodies);
        assert_eq!((words[0], words[7], words[8]), (28, 77, 78));
    }

    #[test]
    fn sizes_of_no_version_are_refused() {
        for bytes in [0, 3, 4, 15, 17, 19, 4096, u32::MAX] {
            let mut wrong = newer(0);
            wrong.input.struct_size = bytes;
            assert_eq!(read(&wrong), Err(PALP_BAD_STRUCT_SIZE));
        }
    }

    #[test]
    fn arrays_that_reach_into_the_block_are_refused() {
        let block = 128..256;
        assert_eq!(judge_outside(&block, 64, 64), Ok(()));
        assert_eq!(judge_outside(&block, 64, 65), Err(PALP_INSIDE_WORLD));
        assert_eq!(judge_outside(&block, 255, 1), Err(PALP_INSIDE_WORLD));
        assert_eq!(judge_outside(&block, 256, 10), Ok(()));
        assert_eq!(judge_outside(&block, 0, 1000), Err(PALP_INSIDE_WORLD));
        assert_eq!(judge_outside(&block, usize::MAX, 2), Err(PALP_WRONG_COUNT));
    }
}
