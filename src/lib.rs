//! Palpable.
#![no_std]
#![forbid(unsafe_code)]

pub mod geometry;
pub mod limits;
pub mod math;
pub mod memory;
pub mod state;

mod advance;
mod contacts;
pub mod couple;
mod impulses;
mod pairs;
mod publish;

pub mod frame;
pub mod world;
