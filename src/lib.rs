//! A hard-real-time contact kernel: a tracked hand or avatar never reaches through the virtual world.
//!
//! A host gives the kernel one block of memory, fills it with bodies made of convex pieces, tells it
//! every frame what its trackers see, and draws the poses that come back. Driven bodies follow their
//! trackers and stop at fixed ones, whatever the speed; loose bodies are pushed, fall, roll and rest.
//! It is what Schmidl and Lin described in 2004 ("Geometry-driven physical interaction between avatars
//! and virtual environments"), with motion that is continuous and work that is bounded.
//!
//! # The frame
//!
//! ```text
//! tracker --> 1 couple      where driven things want to be         [`couple`]
//!             2 pairs       which pieces may touch this frame
//!             3 contacts    how deep, and the way out
//!             4 reach       a way around the contacts          [`reach`]
//!             5 advance     along a path that never overlaps
//!             6 impulses    what the loose objects do
//!             publish  -->  poses for the host to draw
//! ```
//!
//! Stages 3 to 5 take turns until a driven body is where its tracker wants it, nothing is gained any
//! more, or the budget is spent. What did not move last frame and is asked the same again is not asked.
//!
//! # Skeletons
//!
//! A driven body may carry chains of joints: an avatar's arms, a hand's fingers. A joint is a hinge, or a
//! ball of three hinges with a reach cone; pieces hang on links. The host tells target angles
//! ([`world::World::set_angles`]), tracked link poses ([`world::World::set_link_poses`]) or the tip's pose
//! alone ([`world::World::set_tip`]); free chains follow to the bit. In contact a chain takes the angles
//! nearest to the tracked ones that keep its links outside the contact planes and within the limits, and
//! what it cannot evade the root does. Links move along certified ways, as everything driven does.
//! [`human`] has joints, ranges and lengths of people.
//!
//! # Deadlines
//!
//! Work is counted in units ([`frame::Budget`]); a stage that is refused one ends there, safe wherever that
//! is. A host that thinks in time gives a [`frame::Deadline`] with the prices of its machine
//! ([`frame::CostTable`]): the frame's floor is paid first, then driven bodies, then loose ones. A clock may
//! stand behind it ([`world::World::step_by_clock`]). Whatever ended a frame, the units that it reports
//! replay it. Who was cut goes first in the next frame; then what the viewer looks at. An island of loose
//! bodies that is too large for a frame moves on in turns.
//!
//! # Recording
//!
//! A world that has a sink ([`world::World::record_to`]) hands it the state as it is, then every call that
//! changes the world: what it was given, and what it came to. [`recording::Replay`] makes the calls again,
//! here or on another processor, and names the first frame that comes to another state. [`recording`] has
//! the format.
//!
//! # Modules
//!
//! [`frame`] holds the stages together, [`world`] is the host's handle, [`geometry`] answers questions
//! about pieces and knows nothing of frames, [`recording`] writes the host's calls down, [`state`] says what the columns mean that [`memory`] cuts
//! from the block, [`limits`] has every bound with its reason.
//!
//! # Promises
//!
//! * Nothing shows overlap: from a world without overlap no published driven pose overlaps a fixed body
//!   by more than [`limits::OVERLAP_SLOP_M`], at any speed and any budget; loose bodies, links of one
//!   body and driven bodies overlap each other by no more than 1 mm.
//! * Joints keep their ranges and balls their reach cones, wherever a frame is cut.
//! * Free motion has no lag: with nothing in the way the published pose equals the target to the bit.
//! * Rest is rest: with a still tracker, poses stop changing by a single bit.
//! * Same input, same bits, on every processor and at every optimisation level; in a thread that puts small
//!   numbers to zero the report says so ([`frame::FrameReport::FLUSHES_TO_ZERO`]), and bits may differ.
//! * No allocation, no unsafe code, no global state: the block is the world, and a copy of it is a
//!   snapshot.
//! * Bad input gets a named error or a documented clamp, and the last good state stays: [`faults`] is the table.
//!
//! Not promised: overlap that the host itself makes is reported and undone, not prevented; until it is, links show
//! it with what positions in the world are rounded by where they are, 0.03 mm a kilometre from the origin. A driven
//! body that a loose object stops in the middle of a frame may be met by another driven body that moved beside
//! it.
//!
//! # Units
//!
//! Metres, kilograms, seconds, radians, newtons. Axes are OpenXR's: right-handed, +Y up, -Z forward;
//! quaternions are x y z w; a pose is orientation then position.
//!
//! # Example
//!
//! ```
//! use palpable::{frame::FrameInput, math::Pose, memory::Capacities, state::bodies::BodyKind};
//! use palpable::world::{BodyDef, PieceDef, Shape, World};
//! let mut memory = vec![0; Capacities::ROOM.bytes() + 64];
//! let start = memory.as_ptr().align_offset(64);
//! let mut world = World::create(&mut memory[start..], &Capacities::ROOM).unwrap();
//! let table = world.add_body(&BodyDef::new(BodyKind::Fixed, Pose::at(0.0, 0.7, 0.0))).unwrap();
//! world.add_piece(table, &PieceDef::new(Shape::Box([0.8, 0.02, 0.4]), 0.0)).unwrap();
//! let hand = world.add_body(&BodyDef::new(BodyKind::Driven, Pose::at(0.0, 1.0, 0.0))).unwrap();
//! world.add_piece(hand, &PieceDef::new(Shape::Point, 0.05)).unwrap();
//! world.set_target(hand, &Pose::at(0.0, 0.65, 0.0)).unwrap(); // the tracker is under the table top
//! world.step(&FrameInput::unlimited(1.0 / 90.0));
//! assert!(world.pose(hand).unwrap().position[1] >= 0.77); // the hand is on it
//! ```
#![no_std]
#![forbid(unsafe_code)]

pub mod faults;
pub mod geometry;
pub mod human;
pub mod limits;
pub mod math;
pub mod memory;
pub mod state;

pub mod couple;

mod advance;
mod contacts;
mod driven;
mod events;
pub mod impulses;
mod pairs;
mod publish;
pub mod reach;

pub mod frame;
pub mod recording;
pub mod world;

/// The examples of the README, compiled and run as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
