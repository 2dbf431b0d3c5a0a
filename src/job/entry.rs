//! Where a request holds the parts of its job, so that faults point at what the client wrote.

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
    /// Returns the fault of a mesh, or of polygon `shape`, with a pointer into the request. For files, the pointer
    /// leads to the file as a whole, and the message names the place.
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

/// Returns the fault of an output with its index in the request. If the request names no outputs, because the format
/// was chosen otherwise, the fault points at the missing list.
pub(super) fn output_fault(index: Option<usize>, fault: Fault) -> Fault {
    match index {
        Some(index) => fault.under(&format!("/outputs/{index}")),
        None => Fault::new("/outputs", fault.detail),
    }
}

/// A part of a job that may be at fault during the computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JobPart {
    /// The plan.
    Plan,
    /// The mesh, or the polygon with this index.
    Shape(usize),
    /// The output that is being computed.
    Output,
    /// The request as a whole.
    Request,
}

/// A fault found during the computation of a job. Jobs share computations, and requests may hold the part in different
/// places.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JobFault {
    /// The part at fault.
    pub part: JobPart,
    /// The fault, with a pointer below the part.
    pub fault: Fault,
}

impl JobFault {
    /// Creates a fault of a part, at a pointer below the part.
    pub(super) fn new(part: JobPart, pointer: impl Into<String>, detail: impl fmt::Display) -> Self {
        Self { part, fault: Fault::new(pointer, detail.to_string()) }
    }
}

impl fmt::Display for JobFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.fault.detail)
    }
}

/// Where one request holds the parts of a job with one output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JobEntries {
    /// The entry of the input.
    pub input: InputEntry,
    /// The index of the output; `None` if the request names no outputs.
    pub output: Option<usize>,
}

impl JobEntries {
    /// Returns a fault of a computation with a pointer into the request.
    pub fn fault(self, JobFault { part, fault }: JobFault) -> Fault {
        match part {
            JobPart::Plan => fault.under("/plan"),
            JobPart::Shape(shape) => self.input.fault(shape, fault),
            JobPart::Output => output_fault(self.output, fault),
            JobPart::Request => fault,
        }
    }
}
