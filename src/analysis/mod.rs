//! Analysis: what can be said of a scheme and of the limit of a net, without ever refining a whole job.

pub mod curve;
pub mod limit;
pub mod revolution;
pub mod surface;
