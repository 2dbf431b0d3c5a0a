//! A mesh for formats that know one value of each kind a vertex, such as its normal: vertices are split on seams,
//! and on sharp and hard edges where there are normals.

use crate::output::hard_edges::HardEdges;
use crate::output::scene::{MeshSource, Shape};
use crate::output::split_vertices::SplitVertices;
use crate::watch::{Stopped, Watch};

/// A shape with a vertex for each place of what has seams.
pub(super) struct Sides<'a> {
    whole: Shape<'a>,
    unfolded: Option<Box<dyn MeshSource + 'a>>,
}

/// The sides of vertices, which sharp and hard edges split too.
pub(super) struct SplitSides<'a> {
    sides: &'a Sides<'a>,
    split_vertices: Option<SplitVertices<'a>>,
    /// The mesh with whole vertices, split on sharp and hard edges only.
    smooth: Option<SplitVertices<'a>>,
}

impl<'a> Sides<'a> {
    /// That of a shape.
    pub(super) fn of(whole: Shape<'a>) -> Self {
        let unfolded = if let Shape::Mesh(mesh) = whole { mesh.unfolded() } else { None };
        Self { whole, unfolded }
    }

    fn shape(&self) -> Shape<'_> {
        self.unfolded.as_deref().map_or(self.whole, Shape::Mesh)
    }

    /// The parts of this shape, where there are normals between sharp edges and those that are `hard`.
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
    /// The shape to be written.
    pub(super) fn shape(&self) -> Shape<'_> {
        self.split_vertices.as_ref().map_or(self.sides.shape(), |split_vertices| Shape::Mesh(split_vertices))
    }

    /// Where the shape is split on seams, the mesh that is not, from which its normals come.
    pub(super) fn smooth(&self) -> Option<&dyn MeshSource> {
        let (Some(_), Shape::Mesh(whole)) = (&self.sides.unfolded, self.sides.whole) else { return None };
        Some(self.smooth.as_ref().map_or(whole, |split_vertices| split_vertices))
    }
}
