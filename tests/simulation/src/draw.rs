//! Where a random host's decisions come from: a seed, or the bytes of a fuzzer.

use glam::{Quat, Vec3};
use palpable::math::Pose;

/// A source of decisions. Equal sources give equal hosts.
pub trait Draw {
    /// The next eight bits; zero when there are no more.
    fn byte(&mut self) -> u8;

    /// Whether there are no more.
    fn is_over(&self) -> bool;

    /// The next 16 bits, low byte first.
    fn half(&mut self) -> u16 {
        u16::from_le_bytes([self.byte(), self.byte()])
    }

    /// The next 32 bits, low byte first.
    fn word(&mut self) -> u32 {
        u32::from(self.half()) | u32::from(self.half()) << 16
    }

    /// A number below `bound`, which is 1 to 256.
    fn below(&mut self, bound: u32) -> u32 {
        (u32::from(self.byte()) * bound) >> 8
    }

    /// True once in `times`, which is 1 to 256.
    fn once_in(&mut self, times: u32) -> bool {
        self.below(times) == times - 1
    }

    /// From -1 to 1.
    fn signed(&mut self) -> f32 {
        f32::from(self.half().cast_signed()) / 32768.0
    }

    /// From `low` to `high`.
    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (f32::from(self.half()) / 65536.0)
    }

    /// A point of the cube from -1 to 1.
    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    /// An orientation; not evenly spread.
    fn turn(&mut self) -> Quat {
        let (v, w) = (self.vector(), self.signed());
        let turn = Quat::from_xyzw(v.x, v.y, v.z, w);
        if turn.length() < 1e-3 {
            Quat::IDENTITY
        } else {
            turn.normalize()
        }
    }

    /// A place of the cube from -1 to 1 times `reach_m`, any way round.
    fn pose(&mut self, reach_m: f32) -> Pose {
        let at = reach_m * self.vector();
        Pose::new(self.turn(), at)
    }

    /// A number of the kinds that break programs.
    fn bad_number(&mut self) -> f32 {
        match self.below(10) {
            0 => f32::NAN,
            1 => f32::INFINITY,
            2 => f32::NEG_INFINITY,
            3 => 1e-40 * self.signed(),
            4 => 3e38 * self.signed(),
            5 => 1e30 * self.signed(),
            6 => 1100.0 * self.signed(),
            7 => 0.0,
            8 => f32::from_bits(self.word()),
            _ => self.signed(),
        }
    }

    /// A pose with something wrong, or only strange: numbers of any kind, quaternions of any length or none.
    fn bad_pose(&mut self) -> Pose {
        let mut pose = self.pose(1.0);
        match self.below(4) {
            0 => pose.rotation = [0.0; 4],
            1 => {
                let scale = self.bad_number();
                pose.rotation = pose.rotation.map(|part| part * scale);
            }
            2 => pose.position[self.below(3) as usize] = self.bad_number(),
            _ => {
                pose.rotation = [(); 4].map(|()| self.bad_number());
                pose.position = [(); 3].map(|()| self.bad_number());
            }
        }
        pose
    }
}

/// Decisions from a seed (SplitMix64); they never end.
#[derive(Clone, Debug)]
pub struct Seeded(u64);

impl Seeded {
    /// The decisions of a seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

impl Draw for Seeded {
    fn byte(&mut self) -> u8 {
        (self.bits() >> 56) as u8
    }

    fn is_over(&self) -> bool {
        false
    }

    fn half(&mut self) -> u16 {
        (self.bits() >> 48) as u16
    }

    fn word(&mut self) -> u32 {
        (self.bits() >> 32) as u32
    }
}

/// Decisions from bytes, and zeros after their end.
#[derive(Clone, Debug)]
pub struct Bytes<'b>(&'b [u8]);

impl<'b> Bytes<'b> {
    /// The decisions of these bytes.
    #[must_use]
    pub const fn new(bytes: &'b [u8]) -> Self {
        Self(bytes)
    }
}

impl Draw for Bytes<'_> {
    fn byte(&mut self) -> u8 {
        match self.0.split_first() {
            Some((&first, rest)) => {
                self.0 = rest;
                first
            }
            None => 0,
        }
    }

    fn is_over(&self) -> bool {
        self.0.is_empty()
    }
}
