//! `planish figures`: a folder of jobs to pictures, and what has changed of them.

mod compare;
mod manifest;
mod report;
mod rendered;
mod set;

pub(super) use set::FigureOptions;
