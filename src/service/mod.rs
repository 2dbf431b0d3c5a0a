//! The service: finds, joins or makes artifacts; knows no HTTP.

pub mod accepting;
pub mod account;
pub mod clock;
pub mod computation;
pub mod desk;
pub mod disk_counts;
pub mod driving;
mod fields;
pub mod job_key;
pub mod jobs;
pub mod kept_work;
pub mod lent;
mod line;
pub mod peer;
pub mod pool;
pub mod queue;
pub mod read_lane;
mod reads;
pub mod result_buffer;
pub mod store;
pub mod streaming;
pub mod task;
pub mod tiers;
pub mod under_way;
pub mod uploads;
pub mod variant;
pub mod writer;
