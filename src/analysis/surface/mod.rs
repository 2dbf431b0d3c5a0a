//! The analysis of surface schemes: their regular rules, and the eigenvalues, masks and characteristic maps of
//! extraordinary vertices and faces.
//!
//! A local subdivision matrix maps the points of some rings around a vertex of valence n to the points around its
//! child. Rotations decompose it into one block for each Fourier index. Limits are C^1 at the vertex if the eigenvalue
//! 1 is followed by a double eigenvalue with the indices 1 and n - 1, and if the characteristic map, the limit of its
//! eigenvectors, is regular and injective. Both conditions are proved here, including rounding errors, or reported as
//! open.
//!
//! Source: Reif, CAGD 12 (1995), 153-174; Peters and Reif, Subdivision Surfaces (2008).

mod blocks;
mod boundary;
mod characteristic;
mod convergence;
mod enclosure;
mod fan;
mod iterated;
mod latitude;
mod layout;
mod local;
mod quotient;
mod regular;
mod reproduction;
mod sectors;
mod smoothness;
mod spectrum;
mod star;
mod study;
mod survey;
mod verdict;

pub use boundary::{BoundaryReport, Sided};
pub use latitude::latitude_curves;
pub use quotient::Quotient;
pub use regular::RegularMask;
pub use sectors::{NetKind, PlaneNet};
pub use smoothness::{RegularSmoothness, SmoothnessProof};
pub use spectrum::{LocalEigenvalue, PointWeight};
pub use study::{SurfaceStudy, ValenceReport};
pub use survey::Extraordinary;
pub use verdict::{Criterion, Status, evidence, verdict};
