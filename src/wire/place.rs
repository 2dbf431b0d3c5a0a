//! The place of an input within a request: the job itself, a panel of its figure, or the surface from which either
//! measures distances.

use crate::job::panel_place;

/// The place of an input of a job.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct InputPlace {
    /// The panel of the figure whose job has the input; `None` for the job itself.
    pub panel: Option<usize>,
    /// Whether the input is the surface from which distances are measured.
    pub is_other: bool,
}

impl InputPlace {
    /// Returns the JSON pointer to the input.
    pub fn pointer(self) -> String {
        let job = self.panel.map_or_else(String::new, panel_place);
        format!("{job}{}/input", if self.is_other { "/distance_to" } else { "" })
    }
}
