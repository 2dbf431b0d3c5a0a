//! Gives the appearance that a job sets for all faces to the faces that have none.

use super::attachments::AttachmentsInput;
use super::labels::{FaceSet, MAX_LABELS};
use super::looks::Look;
use crate::fault::Fault;

/// The name of the material of faces that had none.
const DEFAULT_MATERIAL: &str = "material";

impl AttachmentsInput {
    /// Applies a look to materials without one, and to the faces without material, which get a new material after the
    /// others.
    /// `n_faces` is the number of faces. Returns whether there are such faces.
    ///
    /// # Errors
    /// Numbers beyond 0 to 1, a picture without texture coordinates, and no room for a material, with pointers below
    /// the look.
    pub fn cover(&mut self, look: &Look, n_faces: usize) -> Result<bool, Vec<Fault>> {
        let faults = look.check(self.uvs.is_some());
        if !faults.is_empty() {
            return Err(faults);
        }
        self.looks.resize(self.materials.len(), Look::default());
        let mut is_bare = vec![true; n_faces];
        let mut covers = false;
        for (set, known) in self.materials.iter().zip(&mut self.looks) {
            for &face in &set.faces {
                let bare = usize::try_from(face).ok().and_then(|face| is_bare.get_mut(face));
                bare.into_iter().for_each(|bare| *bare = false);
            }
            if known.is_silent() {
                *known = look.clone();
                covers |= !set.faces.is_empty();
            }
        }
        let faces: Vec<u64> = (0..).zip(&is_bare).filter(|(_, bare)| **bare).map(|(face, _)| face).collect();
        if faces.is_empty() {
            return Ok(covers);
        }
        if self.materials.len() >= MAX_LABELS {
            let detail = format!(
                "{} materials and faces without one; at most {MAX_LABELS} are allowed: give one of them these faces",
                self.materials.len()
            );
            return Err(vec![Fault::new("", detail)]);
        }
        let name = self.free_name();
        self.materials.push(FaceSet { name, faces });
        self.looks.push(look.clone());
        Ok(true)
    }

    /// Returns a name that no material has.
    fn free_name(&self) -> String {
        let is_free = |name: &String| self.materials.iter().all(|set| set.name != *name);
        let numbered = (2_usize..).map(|number| format!("{DEFAULT_MATERIAL}-{number}"));
        std::iter::once(DEFAULT_MATERIAL.to_owned()).chain(numbered).find(is_free).expect("some number is free")
    }
}
