//! The analysis of a curve scheme from its mask alone: the factors of its symbol, certified bounds of its smoothness,
//! and its behaviour around a point.

mod local;
mod lower;
mod matrices;
mod norms;
mod powers;
mod radius;
mod reduction;
mod report;
mod stability;
mod symbol;
mod upper;
mod values;
mod verdict;

pub use lower::Lower;
pub(super) use matrices::ExactMatrix;
pub use norms::SmoothnessCertificate;
pub use powers::Powers;
pub use radius::RadiusBounds;
pub(super) use radius::radius_bounds;
pub use reduction::Reduction;
pub use report::SmoothnessReport;
pub use symbol::Symbol;
pub use upper::Upper;
pub use values::BasicFunction;
pub use verdict::{Radius, Smoothness};
