//! A mesh for formats with one value of each kind per vertex, such as its normal: vertices are split on seams, and, if
//! there are normals, on sharp and hard edges.

use crate::output::hard_edges::HardEdges;
use crate::output::scene::{MeshSource, Shape};
use crate::output::split_vertices::SplitVertices;
use crate::watch::{Stopped, Watch};

/// A shape with a vertex for each place of attributes with seams.
pub(super) struct Sides<'a> {
    whole: Shape<'a>,
    unfolded: Option<Box<dyn MeshSource + 'a>>,
}

/// The sides of vertices, also split on sharp and hard edges.
pub(super) struct SplitSides<'a> {
    sides: &'a Sides<'a>,
    split_vertices: Option<SplitVertices<'a>>,
    /// The mesh with whole vertices, split on sharp and hard edges only.
    smooth: Option<SplitVertices<'a>>,
}

impl<'a> Sides<'a> {
    /// Unfolds a shape at its seams, if it has any.
    pub(super) fn of(whole: Shape<'a>) -> Self {
        let unfolded = if let Shape::Mesh(mesh) = whole { mesh.unfolded() } else { None };
        Self { whole, unfolded }
    }

    fn shape(&self) -> Shape<'_> {
        self.unfolded.as_deref().map_or(self.whole, Shape::Mesh)
    }

    /// Splits this shape at sharp edges and those that are `hard`, if `normals` are written.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub(super) fn split_vertices(
        &'a self,
        normals: bool,
        hard: &HardEdges,
        watch: &Watch,
    ) -> Result<SplitSides<'a>, Stopped> {
        let (mut split_vertices, mut smooth) = (None, None);
        if normals {
            let whole = SplitVertices::of(self.whole, hard, watch)?;
            if let (Some(unfolded), Shape::Mesh(mesh)) = (self.unfolded.as_deref(), self.whole) {
                let hard = hard.among(mesh, unfolded, watch)?;
                split_vertices = SplitVertices::of(Shape::Mesh(unfolded), &hard, watch)?;
                smooth = whole;
            } else {
                split_vertices = whole;
            }
        }
        Ok(SplitSides { sides: self, split_vertices, smooth })
    }
}

impl SplitSides<'_> {
    /// Returns the shape to be written.
    pub(super) fn shape(&self) -> Shape<'_> {
        self.split_vertices.as_ref().map_or(self.sides.shape(), |split_vertices| Shape::Mesh(split_vertices))
    }

    /// Returns the mesh that is not split on seams, which determines the normals, if the shape is split on seams.
    pub(super) fn smooth(&self) -> Option<&dyn MeshSource> {
        let (Some(_), Shape::Mesh(whole)) = (&self.sides.unfolded, self.sides.whole) else { return None };
        Some(self.smooth.as_ref().map_or(whole, |split_vertices| split_vertices))
    }
}
