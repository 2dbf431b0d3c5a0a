//! The outputs of a job.

use std::borrow::Cow;
use std::sync::Arc;

use super::entry::output_fault;
use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::{Counts, Format, Size, description};

/// One result that is asked for.
#[derive(Debug, Clone)]
pub struct Output {
    /// Name among the outputs of its job.
    pub name: String,
    /// The format.
    pub format: &'static dyn Format,
    /// The format's options.
    pub options: Values,
    /// The frame of the mesh that it shows; all of them, or the only one, where none is named.
    pub frame: Option<usize>,
    /// What the bytes say of their job, where they are to say it: printable ASCII characters.
    pub description: Option<Arc<str>>,
    /// The index of the output in the request; `None` where the request names no outputs.
    pub index: Option<usize>,
}

impl Output {
    /// What of these counts the output shows: frames only where it names none.
    pub(super) fn shown<'a>(&self, counts: &'a Counts) -> Cow<'a, Counts> {
        match self.frame {
            Some(_) if counts.frames > 0 => Cow::Owned(Counts { frames: 0, ..counts.clone() }),
            _ => Cow::Borrowed(counts),
        }
    }

    /// Bytes that it takes, of these counts.
    pub(super) fn size(&self, counts: &Counts) -> Size {
        self.described(self.format.size(&self.shown(counts), &self.options))
    }

    /// The size of bytes that take so much without their description.
    pub(super) fn described(&self, bare: Size) -> Size {
        match &self.description {
            Some(text) => description::size(self.format.name(), text, bare),
            None => bare,
        }
    }

    /// A fault of this output, with a pointer below the request.
    pub(super) fn fault(&self, fault: Fault) -> Fault {
        output_fault(self.index, fault)
    }
}
