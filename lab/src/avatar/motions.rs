//! Scripted motions.
