//! What a job needs in memory while it runs.

use super::{Input, Job};
use crate::output::Size;
use crate::scheme::forecast::Forecast;

/// What is refined along with the positions.
pub(super) struct Carried {
    /// Channels of vertices.
    pub(super) channels: u128,
    /// Numbers a vertex.
    numbers: u128,
    /// Bytes a vertex for parameters and values of its own.
    local_bytes: u128,
    /// The same of a place with texture coordinates, and bytes a face, where these are numbered by the mesh.
    uv_bytes: [u128; 2],
}

/// Old and new parameters of a vertex (4 of 8 bytes each), its values at the last upsampling (5), directions of edges.
const LOCAL_BYTES: u128 = 8 * (4 + 4 + 5) + 4;
/// Numbers in the mesh of a place, and of a face with its edges (24 bytes and 16 an edge), with a quarter of that before.
const NUMBERED_BYTES: [u128; 2] = [8 + 2, (24 + 4 * 16) * 5 / 4];

/// What a job refines along.
pub(super) fn carried(job: &Job) -> Carried {
    match &job.input {
        Input::Mesh(mesh) => {
            let own = mesh.attributes.is_some() || job.plan.latitude.is_some() || job.plan.perturbation.is_some();
            let local_bytes = if own { LOCAL_BYTES } else { 0 };
            let smooth_uvs = mesh.attachments.uvs.as_ref().is_some_and(|uvs| !uvs.linear);
            let [place, face] = if job.plan.perturbation.is_some() { NUMBERED_BYTES } else { [0, 0] };
            Carried {
                channels: mesh.attachments.channels.len() as u128,
                numbers: mesh.attachments.width() as u128,
                local_bytes,
                uv_bytes: if smooth_uvs { [local_bytes + place, face] } else { [0, 0] },
            }
        }
        Input::Polygons(_) => Carried { channels: 0, numbers: 0, local_bytes: 0, uv_bytes: [0, 0] },
    }
}

/// Bytes without those of limit positions: old and new points (24 bytes each), the topology before the last split (about 17
/// bytes a face after it), normals and indices of a picture, three times the numbers of channels, texture coordinates with
/// their topology and what their places carry, the topologies of schemes that make their own, copies of vertices on sharp
/// edges with the faces around them, and the largest result.
pub(super) fn memory(forecast: &Forecast, sizes: &[Size], carried: &Carried) -> u128 {
    let count = forecast.peak;
    let [of_place, of_face] = carried.uv_bytes;
    let net = count
        .vertices
        .saturating_mul(72 + 24 * carried.numbers + carried.local_bytes)
        .saturating_add(count.faces.saturating_mul(44 + of_face));
    let net = net.saturating_add(forecast.topology_bytes).saturating_add(count.uvs.saturating_mul(60 + of_place));
    let last = forecast.levels.last().copied().unwrap_or_default();
    let net = net.saturating_add(last.parted.saturating_mul(160));
    net.saturating_add(sizes.iter().map(|size| size.bytes()).max().unwrap_or(0))
}
