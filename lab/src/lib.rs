//! The std side of Palpable: scenes, motions, independent references and reports. Hosts never link
//! this.

pub mod hand;
pub mod reference;
pub mod report;
