//! Transforms of nodes, in f64.

use std::collections::BTreeMap;

use serde_json::value::RawValue;

use crate::input::transform::{AFFINE, Transform};

/// The transform properties of a node, as in the text.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Placement {
    matrix: Option<[f64; 16]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
    translation: Option<[f64; 3]>,
}

/// The members of an object as raw JSON.
pub(super) type RawMembers<'a> = BTreeMap<String, &'a RawValue>;

impl Placement {
    /// Reads the placements of all nodes of a document; `None` for nodes without transform properties.
    ///
    /// # Errors
    /// The document is not valid glTF.
    pub(super) fn all(json: &[u8]) -> serde_json::Result<Vec<Option<Box<Self>>>> {
        let document: RawMembers<'_> = serde_json::from_slice(json)?;
        let Some(nodes) = document.get("nodes") else { return Ok(Vec::new()) };
        let nodes: Vec<&RawValue> = serde_json::from_str(nodes.get())?;
        let placement = |node: &&RawValue| {
            let node: RawMembers<'_> = serde_json::from_str(node.get())?;
            let text = |name: &str| node.get(name).map_or("null", |value| value.get());
            let placement = Self {
                matrix: serde_json::from_str(text("matrix"))?,
                rotation: serde_json::from_str(text("rotation"))?,
                scale: serde_json::from_str(text("scale"))?,
                translation: serde_json::from_str(text("translation"))?,
            };
            Ok((placement != Self::default()).then(|| Box::new(placement)))
        };
        nodes.iter().map(placement).collect()
    }

    /// Returns the map of the node: its matrix, or its scale, then rotation, then translation. A rotation is normalised
    /// if its length is near 1.
    ///
    /// # Errors
    /// The matrix is not affine, the rotation is not a unit quaternion, or both forms are given.
    pub(super) fn transform(&self) -> Result<Transform, String> {
        let Self { matrix, rotation, scale, translation } = self;
        if matrix.is_some() && (rotation.is_some() || scale.is_some() || translation.is_some()) {
            return Err("its place is a matrix and parts of one; give either".to_owned());
        }
        if let Some(matrix) = matrix {
            let [a, b, c, d] = std::array::from_fn(|j| matrix[4 * j + 3]);
            if [a, b, c, d - 1.0].iter().any(|x| x.abs() > AFFINE) {
                return Err(format!("the last row of its matrix is {a}, {b}, {c}, {d}; it has to be 0, 0, 0, 1"));
            }
            let column = |j: usize| std::array::from_fn(|i| matrix[4 * j + i]);
            return Ok(Transform([column(0), column(1), column(2), column(3)]));
        }
        let [x, y, z, w] = self.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        let Transform(rotation) = Transform::rotation([x, y, z, w]).ok_or_else(|| {
            let length = (x * x + y * y + z * z + w * w).sqrt();
            format!("the length of its rotation {x}, {y}, {z}, {w} is {length}; a rotation is a quaternion of length 1")
        })?;
        let scale = self.scale.unwrap_or([1.0; 3]);
        let column = |j: usize| rotation[j].map(|entry| entry * scale[j]);
        Ok(Transform([column(0), column(1), column(2), self.translation.unwrap_or([0.0; 3])]))
    }
}
