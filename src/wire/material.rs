//! Materials as clients write them.

use std::sync::Arc;

use super::look::looks;
use super::whole;
use crate::fault::{Fault, under};
use crate::shape::labels::FaceSet;
use crate::shape::looks::Look;
use crate::shape::textures::Image;

looks! {
    /// Some faces under one name, and how they look. Pictures and glTF show what is said here; what is left out is left
    /// to them.
    pub struct MaterialRequest {
        /// The name: 1 to 64 bytes without blanks, control characters and `#`.
        pub name: String,
        /// Faces, counted from 0.
        #[serde(deserialize_with = "whole::list")]
        pub faces: Vec<u64>,
    }
}

/// Returns the faces of all materials, and their looks, whose numbers are unchecked.
///
/// # Errors
/// Colours, masks and pictures that are invalid, with pointers below the mesh.
pub(super) fn materials(requests: Vec<MaterialRequest>) -> Result<(Vec<FaceSet>, Vec<Look>), Vec<Fault>> {
    let (mut sets, mut looks, mut faults) = (Vec::new(), Vec::new(), Vec::new());
    // several materials share one decoded picture
    let mut images: Vec<(String, Arc<Image>)> = Vec::new();
    for (i, mut request) in requests.into_iter().enumerate() {
        let set = FaceSet { name: std::mem::take(&mut request.name), faces: std::mem::take(&mut request.faces) };
        match request.look(&mut images) {
            Ok(look) => looks.push(look),
            Err(fault) => faults.extend(under(&format!("/materials/{i}"), vec![fault])),
        }
        sets.push(set);
    }
    if faults.is_empty() { Ok((sets, looks)) } else { Err(faults) }
}
