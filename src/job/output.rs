//! The outputs of a job.

use super::entry::output_fault;
use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::Format;

/// One result that is asked for.
#[derive(Debug, Clone)]
pub struct Output {
    /// Name among the outputs of its job.
    pub name: String,
    /// The format.
    pub format: &'static dyn Format,
    /// The format's options.
    pub options: Values,
    /// The index of the output in the request; `None` where the request names no outputs.
    pub index: Option<usize>,
}

impl Output {
    /// A fault of this output, with a pointer below the request.
    pub(super) fn fault(&self, fault: Fault) -> Fault {
        output_fault(self.index, fault)
    }
}
