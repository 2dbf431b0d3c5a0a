//! Solids: the limit surface of a cage as faces that CAD programs know, exact where it is bicubic.

pub mod caps;
pub mod evaluate;

mod brep;
mod build;
mod cap;
mod certificate;
mod distance;
mod edges;
mod error;
mod forecast;
mod interpolated;
mod isolate;
mod level;
mod limit;
mod measure;
mod net;
mod pack;
mod patch;
mod request;
mod rounding;
mod sector;
mod spline;

pub use brep::{Brep, Edge, Face, Shell};
pub use build::{Solid, check, solid};
pub use caps::DeviationMethod;
pub use certificate::Certificate;
pub use error::SolidError;
pub use forecast::{CageCounts, SolidForecast, operations};
pub use isolate::Isolated;
pub use request::{Continuity, Pack, SolidRequest};
pub use sector::SectorKind;
pub use spline::{BSplineCurve, BSplineSurface};
