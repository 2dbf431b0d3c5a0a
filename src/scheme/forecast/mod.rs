//! The forecast: exact counts of every level, before any memory is allocated for them.

mod census;
mod collar;
mod count;
mod delta;
mod duals;
mod fans;
mod meshes;
mod polygons;
mod sizes;
mod tally;

pub use census::Census;
pub(super) use census::sum;
pub use count::Count;
pub use delta::check_delta;
pub use duals::{MAX_FORECAST_BYTES, forecast_bytes};
pub use meshes::of_mesh;
pub use polygons::of_polygons;
pub use tally::{Forecast, ForecastError};
