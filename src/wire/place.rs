//! Which of the inputs of a job is meant: that of the job itself, of the surface from which it measures distances, or
//! the same of a panel.

use crate::job::panel_place;

/// An input of a job.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct InputPlace {
    /// The panel of the figure whose job has it; none where the job itself does.
    pub panel: Option<usize>,
    /// Whether it is that of the surface from which distances are measured.
    pub is_other: bool,
}

impl InputPlace {
    /// JSON pointer to the input.
    pub fn pointer(self) -> String {
        let job = self.panel.map_or_else(String::new, panel_place);
        format!("{job}{}/input", if self.is_other { "/distance_to" } else { "" })
    }
}
