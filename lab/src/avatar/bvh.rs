//! Motion capture.
