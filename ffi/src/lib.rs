//! The C library of the Palpable contact kernel: `include/palpable.h` in Rust.
//!
//! A call judges its pointers and numbers, attaches to the block behind the handle, asks the kernel,
//! and writes results last. Nothing is kept between calls but a sink, nothing is allocated, and no panic leaves.
//! Doc comments of exported items become the header's comments and speak to C programmers.

#![deny(clippy::undocumented_unsafe_blocks)]
#![deny(unsafe_op_in_unsafe_fn)]
#![allow(
    clippy::missing_safety_doc,
    reason = "the head of the header says what every pointer must be"
)]

mod arguments;
mod block;
mod bodies;
mod chains;
mod contacts;
mod environment;
mod frame;
mod hands;
mod hosted;
mod human;
mod materials;
mod panic;
mod pieces;
mod query;
mod recording;
mod skeleton;
mod state;
mod status;
mod types;
mod world;
