//! The job: what is to be made, under which limits, by which key; pure, without I/O, clock or randomness.

mod analysis;
pub mod codec;
mod complete;
mod curves;
mod details;
mod draft;
mod entry;
mod error;
mod finest;
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
mod mesh_survey;
mod output;
mod places;
mod run;
mod scan;
mod search;
mod shape_items;
mod size;
mod steering;
mod surface_analysis;
mod time;
mod tube_analysis;
mod work;

pub use analysis::{
    Analysis, DEFAULT_NODES, DEFAULT_SCAN_NODES, Findings, MAX_NODES, MAX_VALUES, SchemeFindings, Wishes,
};
pub use complete::Job;
pub use draft::Draft;
pub use entry::{InputEntry, JobEntries, JobFault, JobPart};
pub use error::RunError;
pub use form::Form;
pub use input::Input;
pub use inquiry::{Inquiry, is_for_meshes};
pub use levels::{Levels, Resolved};
pub use matrices::{FoundMatrices, MatricesWish};
pub use mesh_survey::Survey;
pub use output::Output;
pub use run::{Report, run, run_keeping};
pub use scan::{MAX_STEPS, ScanWish};
pub use search::{Search, SearchCost, SearchError};
pub use surface_analysis::{MAX_VALENCE, SurfaceAnalysis, SurfaceFindings};
pub use tube_analysis::{TubeAnalysis, TubeFindings, TubeInput};
pub use work::{KeepNothing, KeepWork, Refined, Work};
