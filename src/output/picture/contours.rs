//! The lines in a drawing of a surface: its outline, its boundary, and its hard edges.

use rayon::prelude::*;

use crate::output::hard_edges::edges_of;
use crate::output::normals;
use crate::output::scene::{MeshSource, each_face};
use crate::raster::Camera;
use crate::shape::topology::index;
use crate::watch::{Stopped, Watch};

/// Bytes of memory per half-edge of the mesh: a side of an edge (12), half of an edge as it is drawn (measured: 52), a
/// face, and a share of the edges of the input, which are drawn too.
pub(crate) const CONTOUR_CORNER_BYTES: u128 = 12 + 26 + 1 + 10;

/// Returns the edges of a mesh that are drawn: those with one face or more than two, those in `hard` (the lower end
/// first, ascending), and those between a face whose outside the camera sees and one whose inside it would see.
pub(super) fn contours(
    mesh: &dyn MeshSource,
    positions: &[[f64; 3]],
    hard: &[[u32; 2]],
    camera: &Camera,
    watch: &Watch,
) -> Result<Vec<[u32; 2]>, Stopped> {
    let scale = normals::scale(positions);
    let mut shows_outside = Vec::with_capacity(mesh.n_faces());
    let mut sides: Vec<[u32; 3]> = Vec::with_capacity(mesh.n_half_edges());
    each_face(mesh, watch, |face| {
        let number = index(shows_outside.len());
        let upright = normals::area_vector(face, positions, scale);
        shows_outside.push(camera.is_before(positions[face[0] as usize], upright));
        sides.extend(edges_of(face).map(|[a, b]| [a, b, number]));
    })?;
    sides.par_sort_unstable();
    let is_drawn = |sides: &&[[u32; 3]]| match sides {
        [[a, b, f], [.., g]] => {
            shows_outside[*f as usize] != shows_outside[*g as usize] || hard.binary_search(&[*a, *b]).is_ok()
        }
        _ => true,
    };
    let edges = sides.chunk_by(|a, b| a[..2] == b[..2]).filter(is_drawn);
    Ok(edges.map(|sides| [sides[0][0], sides[0][1]]).collect())
}
