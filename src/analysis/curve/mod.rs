//! The limits of refined polygons: points, tangents, distances, and whether they exist.

mod convergence;
mod cycle;
mod distance;
mod exact_cycle;
mod exact_steps;
mod limit;
mod rows;
mod tolerance;

pub use convergence::warnings;
pub use cycle::{CycleMask, NoMask, is_static};
pub use distance::{Distances, MAX_CURVE_WORK, NoBound};
pub use exact_cycle::ExactCycle;
pub use exact_steps::{ExactStep, exact_steps};
pub use limit::{Limit, NoLimit, check, positions, refine_to_limit};
pub use rows::{LimitRows, WeightRow};
pub use tolerance::{Reached, reach, search_bytes};
