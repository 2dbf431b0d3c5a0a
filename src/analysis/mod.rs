//! The analysis of schemes and of the limits of nets, without the refinement of a whole job.

pub mod circles;
pub mod curve;
pub mod limit;
pub mod matrices;
mod no_level;
pub mod scan;
pub mod smoothness;
mod study;
pub mod surface;
pub mod theorems;
pub mod tolerance;

pub use no_level::NoLevel;
pub use study::{LevelMask, Study};
