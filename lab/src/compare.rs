//! The kernel beside what engines do for hands today: a dynamic body of the same convex parts, pulled to
//! the tracker. Same scenes, same trackers, same judge, same run.

pub mod arm;
pub mod drive;
pub mod grip;
pub mod judging;
pub mod kernel;
pub mod peer;
pub mod peer_arm;
pub mod play;
pub mod scenes;
pub mod setting;
pub mod slaps;
