//! `planish figures`: a folder of jobs to pictures, and what has changed of them.

mod compare;
mod manifest;
mod rendered;
mod report;
mod set;

pub(super) use set::FigureOptions;
