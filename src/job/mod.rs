//! The job: what is to be made, under which limits, by which key; pure, without I/O, clock or randomness.

mod analysis;
pub mod codec;
mod complete;
mod composed;
mod curves;
mod details;
mod draft;
mod entry;
mod error;
mod estimate;
mod films;
mod finest;
mod fit;
mod form;
mod input;
mod inquiry;
mod kernels;
pub mod key;
mod levels;
mod limit_cost;
pub mod limits;
mod matrices;
mod memory;
mod output;
mod places;
mod report;
mod run;
mod scan;
mod search;
mod shape_items;
mod shown;
mod size;
mod steering;
mod surface_analysis;
mod time;
mod work;

pub use analysis::{
    Analysis, DEFAULT_NODES, DEFAULT_SCAN_NODES, Findings, MAX_NODES, MAX_VALUES, SchemeFindings, Wishes,
};
pub use complete::{Figure, Job};
pub use draft::Draft;
pub use entry::{InputEntry, JobEntries, JobFault, JobPart};
pub use error::RunError;
pub use estimate::panel_place;
pub use form::Form;
pub use input::Input;
pub use inquiry::{Inquiry, is_for_meshes};
pub use levels::{Levels, Resolved};
pub use matrices::{FoundMatrices, MatricesWish};
pub use output::Output;
pub use report::Report;
pub use run::{run, run_keeping};
pub use scan::{MAX_STEPS, ScanWish};
pub use search::{Search, SearchCost, SearchError};
pub use surface_analysis::{MAX_VALENCE, SurfaceAnalysis, SurfaceFindings};
pub use work::{KeepNothing, KeepWork, Refined, Work};
