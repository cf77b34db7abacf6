//! Random hosts, and what must hold of every frame whatever they do. Hosts never link this.
//!
//! It has no dependency but the kernel and its vectors, so that the kernel's tests, the fuzz targets and the
//! lab's simulator share it.

pub mod cast;
pub mod damage;
pub mod draw;
pub mod host;
pub mod invariants;
pub mod memory;
pub mod overlap;
pub mod play;
pub mod put;
pub mod reference;
pub mod scene;
pub mod tally;
pub mod tracker;
