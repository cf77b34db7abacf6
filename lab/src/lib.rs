//! The std side of Palpable: scenes, motions, independent references and reports. Hosts never link
//! this.

pub mod accuracy;
pub mod avatar;
pub mod compare;
pub mod deadline;
pub mod figures;
pub mod gallery;
pub mod hand;
pub mod hand_scene;
pub mod replay;
pub mod report;
pub mod run;
pub mod script;
pub mod simulate;
pub mod slaps;

pub use palpable_simulation::{memory, reference};
