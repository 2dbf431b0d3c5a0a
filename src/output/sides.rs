//! A mesh for formats that know one normal and one pair of texture coordinates a vertex: vertices are parted on seams,
//! and on sharp edges where there are normals.

use crate::output::parted::Parted;
use crate::output::scene::{MeshSource, Shape};
use crate::shape::source::UvSource;
use crate::watch::{Stopped, Watch};

/// A shape with a vertex for each place that has texture coordinates.
pub(super) struct Sides<'a> {
    whole: Shape<'a>,
    unfolded: Option<Box<dyn MeshSource + 'a>>,
}

/// The same, parted on sharp edges too.
pub(super) struct Parts<'a> {
    sides: &'a Sides<'a>,
    parted: Option<Parted<'a>>,
    /// The mesh with whole vertices, parted on sharp edges only.
    smooth: Option<Parted<'a>>,
}

impl<'a> Sides<'a> {
    /// That of a shape.
    pub(super) fn of(whole: Shape<'a>) -> Self {
        let unfolded = if let Shape::Mesh(mesh) = whole { mesh.uvs().and_then(UvSource::unfolded) } else { None };
        Self { whole, unfolded }
    }

    fn shape(&self) -> Shape<'_> {
        self.unfolded.as_deref().map_or(self.whole, Shape::Mesh)
    }

    /// The parts of this shape, between sharp edges where there are normals.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub(super) fn parted(&'a self, normals: bool, watch: &Watch) -> Result<Parts<'a>, Stopped> {
        let of = |shape, wanted: bool| if wanted { Parted::of(shape, watch) } else { Ok(None) };
        Ok(Parts {
            sides: self,
            parted: of(self.shape(), normals)?,
            smooth: of(self.whole, normals && self.unfolded.is_some())?,
        })
    }
}

impl Parts<'_> {
    /// The shape to be written.
    pub(super) fn shape(&self) -> Shape<'_> {
        self.parted.as_ref().map_or(self.sides.shape(), |parted| Shape::Mesh(parted))
    }

    /// Where the shape is parted on seams, the mesh that is not, from which its normals come.
    pub(super) fn smooth(&self) -> Option<&dyn MeshSource> {
        let (Some(_), Shape::Mesh(whole)) = (&self.sides.unfolded, self.sides.whole) else { return None };
        Some(self.smooth.as_ref().map_or(whole, |parted| parted))
    }
}
