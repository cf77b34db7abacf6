//! Motion capture: BVH files, and what they make the avatar do.
//!
//! A BVH file is a tree of joints with offsets and channels, then one line of numbers a frame. Rotations are
//! in degrees, composed in the order of the channels; position channels are added to the offset. Units and rest postures differ from file to file, so the avatar is led by where
//! the joints are, not by how they are turned:
//!
//! * the root's frame comes from the two hips and the line from them to the shoulders;
//! * upper arms, thighs and the neck give swings; elbows and knees give bends, and their planes the twists;
//! * ankles give dorsiflexion. What joints' places do not tell (pronation, wrists, inversion, the neck's
//!   turning) stays zero. A bending trunk gets only the turn between hips and shoulders.
//!
//! Size follows the legs: thigh and shank of the file become those of the avatar. The lowest ankle of the
//! motion stands as high as a standing avatar's, and the first frame is at the origin.

mod names;
mod read;
mod retarget;

pub use read::{BvhError, Fault, Motion, parse, read};
pub use retarget::Frame;
