//! The outputs of a job.

use std::borrow::Cow;
use std::sync::Arc;

use super::entry::output_fault;
use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::{Counts, Format, Size, description};

/// One requested result.
#[derive(Debug, Clone)]
pub struct Output {
    /// The name among the outputs of the job.
    pub name: String,
    /// The format.
    pub format: &'static dyn Format,
    /// The options of the format.
    pub options: Values,
    /// The frame of the mesh to show; if `None`, all frames, or the only one.
    pub frame: Option<usize>,
    /// The description of the job that the bytes contain, if requested; printable ASCII characters.
    pub description: Option<Arc<str>>,
    /// The index of the output in the request; `None` if the request names no outputs.
    pub index: Option<usize>,
}

impl Output {
    /// Returns the part of the counts that the output shows: frames only if it names none.
    pub(super) fn shown<'a>(&self, counts: &'a Counts) -> Cow<'a, Counts> {
        match self.frame {
            Some(_) if counts.frames > 0 => Cow::Owned(Counts { frames: 0, ..counts.clone() }),
            _ => Cow::Borrowed(counts),
        }
    }

    /// Returns the size of the output for these counts.
    pub(super) fn size(&self, counts: &Counts) -> Size {
        self.described(self.format.size(&self.shown(counts), &self.options))
    }

    /// Returns the size including the description.
    pub(super) fn described(&self, bare: Size) -> Size {
        match &self.description {
            Some(text) => description::size(self.format.facts().description, text, bare),
            None => bare,
        }
    }

    /// Returns a fault of this output with a pointer into the request.
    pub(super) fn fault(&self, fault: Fault) -> Fault {
        output_fault(self.index, fault)
    }
}
