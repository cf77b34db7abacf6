//! The host's handle: making a world, filling it, telling it what the trackers see, stepping it and
//! reading what came out.

mod bodies;
mod chains;
mod hands;
mod loose;
mod pieces;
mod query;
mod snapshot;

pub use bodies::{AddBodyError, BodyDef, BodyError};
pub use chains::{AddChainError, ChainDef, ChainError, TIP_STEPS_MAX};
pub(crate) use hands::Joints;
pub use hands::{JointInput, JointUse, SetJointsError};
pub use loose::{HostedError, HostedInput};
pub use pieces::{AddPieceError, PieceDef, Shape};
pub use query::BodyPenetration;

use glam::Vec3;

use crate::frame::{self, Census, Clock, CostTable, FrameInput, FrameReport};
use crate::limits::{FRICTION_MAX, SPEED_MAX};
use crate::memory::header::{self, Header};
use crate::memory::{AttachError, BlockHead, Capacities, CreateError};
use crate::recording::{CallKind, Sink, calls};
use crate::state::State;
use crate::state::contacts::ContactPoint;
use crate::state::materials::{BUILT_IN_MATERIALS, Material, Surface};

/// Acceleration of free fall on Earth, in m/s2.
const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

/// A world in a block of the host's memory.
///
/// The block is the world: dropping this handle and attaching again to the same bytes, or to a copy
/// of them elsewhere, loses nothing.
pub struct World<'a> {
    pub(crate) state: State<'a>,
    /// Where calls are recorded, if anywhere. Not in the block: a copy of it records nothing.
    pub(crate) sink: Option<&'a mut dyn Sink>,
}

/// Why a material or a surface was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaterialError {
    /// No room: raise [`Capacities::materials`].
    Full,
    /// The world has no such material.
    Unknown,
    /// Restitution is outside 0 to 1, or friction outside 0 to [`FRICTION_MAX`], or one is not a number.
    BadSurface,
}

impl<'a> World<'a> {
    /// Makes an empty world in `memory`, which needs [`Capacities::bytes`] bytes aligned to
    /// [`crate::memory::BLOCK_ALIGNMENT`]. What the bytes held before does not matter.
    ///
    /// # Errors
    /// [`CreateError`] names what is wrong with the block or the capacities.
    pub fn create(memory: &'a mut [u8], capacities: &Capacities) -> Result<Self, CreateError> {
        header::judge(memory, capacities)?;
        let memory = &mut memory[..capacities.bytes()];
        memory.fill(0);
        let mut state = State::cut(memory, capacities);
        *state.header = Header::new(capacities);
        state.registers.gravity = GRAVITY;
        let stride = state.material_stride();
        state.materials.fill_built_in(stride);
        Ok(Self { state, sink: None })
    }

    /// Takes up a world that was made in `memory`, or copied there.
    ///
    /// # Errors
    /// [`AttachError`] when the block holds no world of this library, or a damaged one.
    pub fn attach(memory: &'a mut [u8]) -> Result<Self, AttachError> {
        let head = BlockHead::read(memory)?;
        Self::attach_known(memory, &head)
    }

    /// Takes up a world whose head was read and judged before: saves doing it twice.
    ///
    /// # Errors
    /// [`AttachError::NotAWorld`] when the block does not start with this head,
    /// [`AttachError::TooSmall`], [`AttachError::Misaligned`].
    pub fn attach_known(memory: &'a mut [u8], head: &BlockHead) -> Result<Self, AttachError> {
        if memory.len() < head.bytes() {
            return Err(AttachError::TooSmall);
        }
        if !head.starts(memory) {
            return Err(AttachError::NotAWorld);
        }
        if !header::is_aligned(memory) {
            return Err(AttachError::Misaligned);
        }
        let memory = &mut memory[..head.bytes()];
        Ok(Self {
            state: State::cut(memory, &head.capacities()),
            sink: None,
        })
    }

    /// The capacities that the world was made with.
    #[must_use]
    pub fn capacities(&self) -> Capacities {
        self.state.header.capacities
    }

    /// The most that was ever in use at once: what to ship as capacities.
    #[must_use]
    pub fn high_water(&self) -> Capacities {
        self.state.registers.high_water
    }

    /// Sets the acceleration of loose bodies, in m/s2. What is not finite, or has a coordinate beyond
    /// [`SPEED_MAX`] a second, is left out.
    pub fn set_gravity(&mut self, gravity: [f32; 3]) {
        self.recorded(
            CallKind::SetGravity,
            |to| to.pod(&gravity),
            |world| {
                let gravity = Vec3::from_array(gravity);
                let limit = Vec3::splat(SPEED_MAX);
                if gravity.abs().cmple(limit).all() {
                    world.state.registers.gravity = gravity;
                }
            },
        );
    }

    /// Adds a material, without friction or restitution against any other.
    ///
    /// # Errors
    /// [`MaterialError::Full`].
    pub fn add_material(&mut self) -> Result<Material, MaterialError> {
        self.recorded(CallKind::AddMaterial, |_| {}, Self::take_material)
    }

    fn take_material(&mut self) -> Result<Material, MaterialError> {
        let used = self.state.registers.materials;
        if used >= self.state.header.capacities.materials {
            return Err(MaterialError::Full);
        }
        self.state.registers.materials += 1;
        self.state.note_use();
        Ok(Material(BUILT_IN_MATERIALS + used))
    }

    /// Sets how two materials meet, in either order.
    ///
    /// # Errors
    /// [`MaterialError::Unknown`], [`MaterialError::BadSurface`].
    pub fn set_surface(
        &mut self,
        a: Material,
        b: Material,
        surface: Surface,
    ) -> Result<(), MaterialError> {
        self.recorded(
            CallKind::SetSurface,
            |to| {
                to.pod(&[a, b]);
                to.pod(&surface);
            },
            |world| world.take_surface(a, b, surface),
        )
    }

    fn take_surface(
        &mut self,
        a: Material,
        b: Material,
        surface: Surface,
    ) -> Result<(), MaterialError> {
        if !self.has_material(a) || !self.has_material(b) {
            return Err(MaterialError::Unknown);
        }
        let restitution = (0.0..=1.0).contains(&surface.restitution);
        let friction = (0.0..=FRICTION_MAX).contains(&surface.friction);
        if !restitution || !friction {
            return Err(MaterialError::BadSurface);
        }
        let stride = self.state.material_stride();
        self.state.materials.set_pair(stride, a.0, b.0, surface);
        Ok(())
    }

    pub(crate) fn has_material(&self, material: Material) -> bool {
        material.0 < BUILT_IN_MATERIALS + self.state.registers.materials
    }

    /// Steps the world by one frame.
    ///
    /// Spends at most the budget's units; the report says what was spent and what was cut.
    pub fn step(&mut self, input: &FrameInput) -> FrameReport {
        self.recorded(
            CallKind::Step,
            |to| calls::put_input(to, input),
            |world| frame::step(&mut world.state, input, None),
        )
    }

    /// Steps the world by one frame with a clock as a backstop: it is asked before all units, and none are
    /// begun that would not be over before `ends_ns`, in the clock's nanoseconds, by the prices of the input's
    /// deadline; without prices they take no time. Closing the frame comes after that and is part of its floor:
    /// the end is best set by [`World::floor_ns`] before the frame is to be over, and by what an interrupt takes, which
    /// the lab's `calibrate` measures too. Where the clock cuts, the report says [`FrameReport::LATE`], and stepping with [`FrameReport::spent`] as the budget gives the same bits.
    ///
    /// A recording has such a frame as one with that budget, written when it is over.
    pub fn step_by_clock(
        &mut self,
        input: &FrameInput,
        now_ns: &dyn Fn() -> u64,
        ends_ns: u64,
    ) -> FrameReport {
        let clock = Clock { now_ns, ends_ns };
        let report = frame::step(&mut self.state, input, Some(clock));
        if self.is_recording() {
            let again = FrameInput {
                budget: report.spent(),
                deadline: None,
                ..*input
            };
            let told = FrameReport {
                flags: report.flags & !FrameReport::OF_TIME,
                ..report
            };
            self.recorded(CallKind::Step, |to| calls::put_input(to, &again), |_| told);
        }
        report
    }

    /// What is in the world, as far as a frame pays for it whatever happens.
    #[must_use]
    pub fn census(&self) -> Census {
        Census::of(&self.state)
    }

    /// What the next frame costs whatever happens, in nanoseconds: a deadline below it leaves nothing for
    /// contact, and the last safe poses are published.
    #[must_use]
    pub fn floor_ns(&self, costs: &CostTable) -> u64 {
        costs.floor_ns(&self.census())
    }

    /// The contacts of the last frame.
    #[must_use]
    pub fn contacts(&self) -> &[ContactPoint] {
        &self.state.contacts.list[..self.state.registers.contacts as usize]
    }

    /// A hash of the whole state but for the count of frames: equal for equal histories, on every
    /// processor, and constant while everything rests.
    ///
    /// The order of calls does not show while it leads to the same ids. What was removed does: the pools keep
    /// the order in which shapes came, slots keep what they held, and marks keep the most that was in use.
    /// None of that changes what is published.
    #[must_use]
    pub fn hash(&self) -> u64 {
        self.state.hash()
    }
}
