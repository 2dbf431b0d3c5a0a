//! Where a request has the parts of its job, so that faults point at what the client wrote.

use std::fmt;

use crate::fault::Fault;

/// The entry of a request that holds the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InputEntry {
    /// `/input/mesh`.
    Mesh,
    /// `/input/text`, a mesh file.
    Text,
    /// `/input/blob`, an uploaded mesh file.
    Blob,
    /// `/input/polygon`.
    Polygon,
    /// `/input/polygons`, a list.
    Polygons,
}

impl InputEntry {
    /// The fault of a mesh or of the polygon number `shape`, with a pointer below the request. No pointer leads into a
    /// file: there the sentence names the place.
    pub fn fault(self, shape: usize, fault: Fault) -> Fault {
        match self {
            Self::Mesh => fault.under("/input/mesh"),
            Self::Polygon => fault.under("/input/polygon"),
            Self::Polygons => fault.under(&format!("/input/polygons/{shape}")),
            Self::Text | Self::Blob => {
                let place = if fault.pointer.is_empty() { String::new() } else { format!("{}: ", fault.pointer) };
                let entry = if self == Self::Blob { "/input/blob" } else { "/input/text/data" };
                Fault::new(entry, format!("in the mesh, {place}{}", fault.detail))
            }
        }
    }
}

/// The fault of the output with an index among the outputs of a request. Where the request names none, as the format
/// was chosen otherwise, it stands where they are missing.
pub(super) fn output_fault(index: Option<usize>, fault: Fault) -> Fault {
    match index {
        Some(index) => fault.under(&format!("/outputs/{index}")),
        None => Fault::new("/outputs", fault.detail),
    }
}

/// A part of a job that can be at fault while it is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JobPart {
    /// The plan.
    Plan,
    /// The mesh, or the polygon of this number.
    Shape(usize),
    /// The output that is computed.
    Output,
    /// A place in the request as a whole.
    Request,
}

/// A fault that shows while a job is computed. Jobs share computations, and each request may have the part elsewhere.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JobFault {
    /// The part at fault.
    pub part: JobPart,
    /// The fault, with a pointer below the part.
    pub fault: Fault,
}

impl JobFault {
    /// A fault of a part, at a pointer below it.
    pub(super) fn new(part: JobPart, pointer: impl Into<String>, detail: impl fmt::Display) -> Self {
        Self { part, fault: Fault::new(pointer, detail.to_string()) }
    }
}

impl fmt::Display for JobFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.fault.detail)
    }
}

/// Where one request has the parts of a job with one output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JobEntries {
    /// The entry of the input.
    pub input: InputEntry,
    /// The index of the output; `None` where the request names no outputs.
    pub output: Option<usize>,
}

impl JobEntries {
    /// A fault of a computation, with a pointer below the request.
    pub fn fault(self, JobFault { part, fault }: JobFault) -> Fault {
        match part {
            JobPart::Plan => fault.under("/plan"),
            JobPart::Shape(shape) => self.input.fault(shape, fault),
            JobPart::Output => output_fault(self.output, fault),
            JobPart::Request => fault,
        }
    }
}
