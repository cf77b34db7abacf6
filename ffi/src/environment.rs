//! The float environment of the calling thread: rounding, flushing small numbers to zero, traps.
//!
//! Rust code may assume the standard one, and equal bits need it. Hosts change theirs (audio engines flush to
//! zero), so each call sets the standard one and gives the host its own back.

/// Puts the host's environment back when dropped.
pub(crate) struct Environment {
    /// The host's, when it is not the standard one.
    hosts: Option<Register>,
}

impl Environment {
    /// Sets the standard environment, where this processor is one whose register is known here.
    pub(crate) fn standard() -> Self {
        let hosts = read();
        let differs = hosts & CONTROL != STANDARD;
        if differs {
            write(STANDARD);
        }
        Self {
            hosts: differs.then_some(hosts),
        }
    }
}

impl Drop for Environment {
    fn drop(&mut self) {
        if let Some(hosts) = self.hosts {
            write(hosts);
        }
    }
}

#[cfg(target_arch = "x86_64")]
use x86_64::{CONTROL, Register, STANDARD, read, write};

#[cfg(target_arch = "aarch64")]
use aarch64::{CONTROL, Register, STANDARD, read, write};

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
use other::{CONTROL, Register, STANDARD, read, write};

#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use core::arch::asm;

    /// MXCSR.
    pub(super) type Register = u32;

    /// All but the flags that tell what happened so far.
    pub(super) const CONTROL: Register = 0xffc0;

    /// Round to nearest, keep small numbers, trap nothing: what a process starts with.
    pub(super) const STANDARD: Register = 0x1f80;

    pub(super) fn read() -> Register {
        let mut value: Register = 0;
        // SAFETY: stores four bytes where there are four.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut value, options(nostack, preserves_flags)) };
        value
    }

    /// Code that is not to run in the environment before stays behind this: it reads memory, and the
    /// compiler must take it that memory was written.
    pub(super) fn write(value: Register) {
        // SAFETY: the value is the standard one, or one that was read from the register.
        unsafe {
            asm!("ldmxcsr [{}]", in(reg) &raw const value, options(nostack, preserves_flags))
        };
    }
}

#[cfg(target_arch = "aarch64")]
mod aarch64 {
    use core::arch::asm;

    /// FPCR.
    pub(super) type Register = u64;

    pub(super) const CONTROL: Register = !0;

    /// Round to nearest, keep small numbers, trap nothing: what a process starts with.
    pub(super) const STANDARD: Register = 0;

    pub(super) fn read() -> Register {
        let value: Register;
        // SAFETY: reads a register that every thread may read.
        unsafe { asm!("mrs {}, fpcr", out(reg) value, options(nostack, preserves_flags)) };
        value
    }

    /// Code that is not to run in the environment before stays behind this: it reads memory, and the
    /// compiler must take it that memory was written.
    pub(super) fn write(value: Register) {
        // SAFETY: the value is the standard one, or one that was read from the register.
        unsafe { asm!("msr fpcr, {}", in(reg) value, options(nostack, preserves_flags)) };
    }
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
mod other {
    /// Nothing is known of this processor's register; the kernel's report says whether it flushes.
    pub(super) type Register = u32;

    pub(super) const CONTROL: Register = 0;
    pub(super) const STANDARD: Register = 0;

    pub(super) const fn read() -> Register {
        STANDARD
    }

    pub(super) const fn write(_: Register) {}
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::{read, write};
    use crate::frame::palp_frame_step;
    use crate::status::PALP_OK;
    use crate::types::{palp_frame_input, palp_frame_report, palp_world};
    use palpable_kernel::frame::{FrameInput, FrameReport};
    use palpable_kernel::math::Pose;
    use palpable_kernel::memory::{BodyId, Capacities};
    use palpable_kernel::state::bodies::BodyKind;
    use palpable_kernel::world::{BodyDef, PieceDef, Shape, World};

    /// Flush results and operands, and round up.
    const HOSTS: u32 = 0x1f80 | 0x8040 | 0x4000;

    #[repr(C, align(64))]
    #[derive(Clone, Copy)]
    struct Line([u8; 64]);

    /// Memory with a world in it: a sphere that a force of 1e-38 N accelerates.
    struct Room {
        lines: Vec<Line>,
        body: BodyId,
    }

    impl Room {
        fn new() -> Self {
            let lines = vec![Line([0; 64]); Capacities::ROOM.bytes().div_ceil(64)];
            let mut room = Self {
                lines,
                body: BodyId::NULL,
            };
            let body = room.with(|world| {
                world.set_gravity([0.0; 3]);
                let body = world
                    .add_body(&BodyDef::new(BodyKind::Dynamic, Pose::IDENTITY))
                    .unwrap();
                world
                    .add_piece(body, &PieceDef::new(Shape::Point, 0.1))
                    .unwrap();
                body
            });
            room.body = body;
            room
        }

        fn start(&mut self) -> *mut u8 {
            self.lines.as_mut_ptr().cast()
        }

        fn with<R>(&mut self, act: impl FnOnce(&mut World) -> R) -> R {
            let bytes = self.lines.len() * 64;
            // SAFETY: lines are bytes without padding, and nobody else has them.
            let memory = unsafe { core::slice::from_raw_parts_mut(self.start(), bytes) };
            let mut world = if memory[0] == 0 {
                World::create(memory, &Capacities::ROOM).unwrap()
            } else {
                World::attach(memory).unwrap()
            };
            act(&mut world)
        }

        fn push(&mut self) {
            let body = self.body;
            self.with(|world| {
                world
                    .apply_force(body, [1e-38, 0.0, 0.0], [0.0; 3])
                    .unwrap()
            });
        }

        fn hash(&mut self) -> u64 {
            self.with(|world| world.hash())
        }
    }

    /// Steps through the C interface; the report's flags.
    fn step(room: &mut Room) -> u32 {
        // SAFETY: plain numbers, for which zeros are good.
        let (mut input, mut report): (palp_frame_input, palp_frame_report) =
            unsafe { (core::mem::zeroed(), core::mem::zeroed()) };
        input.struct_size = size_of::<palp_frame_input>() as u32;
        input.dt_s = 1.0 / 90.0;
        (input.advance_units, input.impulse_units, input.reach_steps) = (99, 99, 99);
        report.struct_size = size_of::<palp_frame_report>() as u32;
        let world = room.start().cast::<palp_world>();
        // SAFETY: the block holds a world, and the structs say their sizes.
        let status = unsafe { palp_frame_step(world, &raw const input, &raw mut report) };
        assert_eq!(status, PALP_OK);
        report.flags
    }

    /// Runs something as a host with its own environment would; what the register is behind it.
    fn in_environment<R>(hosts: u32, act: impl FnOnce() -> R) -> (R, u32) {
        let before = read();
        write(hosts);
        let result = act();
        let after = read();
        write(before);
        (result, after)
    }

    #[test]
    fn the_hosts_environment_changes_no_bit_and_comes_back() {
        let (mut plain, mut flushed) = (Room::new(), Room::new());
        for _ in 0..10 {
            plain.push();
            step(&mut plain);
            flushed.push();
            let (flags, after) = in_environment(HOSTS, || step(&mut flushed));
            assert_eq!(flags, 0);
            assert_eq!(after, HOSTS);
        }
        assert_eq!(plain.hash(), flushed.hash());
    }

    #[test]
    fn the_environment_would_change_bits() {
        // Without the C library's care, or the test above shows nothing.
        let (mut plain, mut flushed) = (Room::new(), Room::new());
        let input = FrameInput::unlimited(1.0 / 90.0);
        for _ in 0..10 {
            plain.push();
            plain.with(|world| world.step(&input));
            flushed.push();
            let (report, _) = in_environment(HOSTS, || flushed.with(|world| world.step(&input)));
            assert_ne!(report.flags & FrameReport::FLUSHES_TO_ZERO, 0);
        }
        assert_ne!(plain.hash(), flushed.hash());
    }
}
