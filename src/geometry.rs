//! Questions about convex pieces at poses. Nothing here knows about frames or bodies.
//!
//! A pair is always computed in the frame of its second piece, so that accuracy does not depend on
//! how far both are from the origin.

pub mod convex;
pub(crate) mod double;
pub mod hull;
pub mod mass;

pub(crate) mod difference;
pub mod distance;
pub(crate) mod expansion;
pub mod penetration;
pub mod reach_cone;
pub mod relative;
pub mod separation;
pub(crate) mod simplex;
pub mod warm;

pub mod manifold;
pub mod union;

pub mod chain;
pub mod linkage;
pub mod motion;
pub mod time_of_contact;
