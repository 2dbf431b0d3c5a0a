//! `planish figures`: renders a folder of jobs to pictures, and reports which of them have changed.

mod compare;
mod manifest;
mod rendered;
mod report;
mod set;

pub(super) use set::FigureOptions;
