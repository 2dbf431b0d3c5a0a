//! What a job needs in memory while it runs.

use super::complete::Job;
use super::output::Output;
use crate::output::{Measured, Size};
use crate::scheme::forecast::Forecast;
use crate::scheme::letter::Letter;
use crate::scheme::operator::Children;
use crate::shape::tile::Tile;

/// What is refined along with the positions.
#[derive(Default)]
pub(super) struct Carried {
    /// Channels of vertices.
    pub(super) channels: u128,
    /// Frames beside the first.
    pub(super) frames: u128,
    /// Numbers a vertex, those of frames included.
    numbers: u128,
    /// Bytes a vertex for parameters and values of its own.
    local_bytes: u128,
    /// Bytes of a place of what has seams, and of a face, where these are numbered by the mesh.
    place_bytes: [u128; 2],
}

/// Old and new parameters of a vertex (4 of 8 bytes each), its values at the last upsampling (5), directions of edges.
const LOCAL_BYTES: u128 = 8 * (4 + 4 + 5) + 4;
/// Numbers in the mesh of a place, and of a face with its edges (24 bytes and 16 an edge), with a quarter of that
/// before.
const NUMBERED_BYTES: [u128; 2] = [8 + 2, (24 + 4 * 16) * 5 / 4];

/// What a job refines along, with so many frames beside the first.
pub(super) fn carried(job: &Job, frames: u128) -> Carried {
    let Some(mesh) = job.input.mesh() else { return Carried::default() };
    let own = mesh.attributes.is_some() || job.plan.latitude.is_some() || job.plan.perturbation.is_some();
    let local_bytes = if own { LOCAL_BYTES } else { 0 };
    let is_smooth = mesh.attachments.places().any(|places| !places.seams.linear);
    let [place, face] = if job.plan.perturbation.is_some() { NUMBERED_BYTES } else { [0, 0] };
    Carried {
        channels: mesh.attachments.channels.len() as u128,
        frames,
        numbers: mesh.attachments.width() as u128 + 3 * frames,
        local_bytes,
        place_bytes: if is_smooth { [local_bytes + place, face] } else { [0, 0] },
    }
}

/// Numbers of a vertex: those of the last level and of the next, or the same in the documented order, with those that
/// entered the last U; 8 bytes each, three a vertex.
const POINT_BYTES: u128 = 3 * 24;
/// Bytes a corner: vertex, edge, half of 8 an edge and a quarter of 4 a vertex are 13 for the topology of the last
/// level while it is written, a quarter of that for the one before; on the way normals of faces and vertices (24 each
/// of them, 12 a corner), triangles, and what is sorted. Measured: 28 in the largest case, which are triangles written
/// as STL.
const CORNER_BYTES: u128 = 32;
/// Bytes a number of a channel: of the last level, the next, and in the documented order.
const CHANNEL_BYTES: u128 = 3 * 8;
/// Bytes of a place with texture coordinates: two numbers as often as of channels, and the topology of places.
const UV_BYTES: u128 = 60;
/// Bytes of a place for the topology of places.
const PLACE_BYTES: u128 = 12;
/// Bytes of the numbers of a place of a channel: four at most.
const SEAMED_BYTES: u128 = 4 * 8;
/// Bytes of a vertex that is there once more where normals differ across a sharp edge, with the faces around it.
const SPLIT_VERTEX_BYTES: u128 = 160;

/// From so many bytes on a job is looked at more closely: that takes some 50 us, as much as a small job may take
/// itself. Half of it looks at twice as many jobs; twice of it counts jobs at up to 32 MiB that take a third of them.
const LARGE: u128 = 16 << 20;

/// Bytes of a job without those of limit positions.
pub(super) fn needed(job: &Job, forecast: &Forecast, sizes: &[Size], carried: &Carried) -> u128 {
    let by_rows = memory(forecast, sizes, carried);
    let from = if by_rows > LARGE { job.swept_from() } else { None };
    from.map_or(by_rows, |level| by_rows.min(swept(job, forecast, level, sizes, carried)))
}

/// Bytes a vertex, or a place with texture coordinates, that writers hold besides what they write: positions with their
/// copies, normals and what these are summed up in, or what stands in pictures. Measured: 68, for glb with creases.
const HELD_BYTES: u128 = 72;
/// The same of writers that hold none of them: buffers, which do not grow with the mesh.
const STREAMED_BYTES: u128 = 8;
/// Bytes of the planes of a sweep a vertex, and at most, which sixteen threads take. Measured: 22 where two patches
/// have 128 cells a side.
const PLANE_BYTES: [u128; 2] = [32, 64 << 20];
/// Bytes a corner of the input: the topology of patches, their kinds and tables, and which stars each thread made.
const PATCH_BYTES: u128 = 256;

/// Bytes of a job whose mesh is refined by rows up to a level and patch by patch from there on: the net of that level,
/// the points of the last, and what their writers hold, as if all were held at once.
fn swept(job: &Job, forecast: &Forecast, level: usize, sizes: &[Size], carried: &Carried) -> u128 {
    let last = forecast.levels.last().copied().unwrap_or_default();
    let count = forecast.levels.get(level).copied().unwrap_or(last);
    let before = Forecast { levels: vec![count], peak: count, work: 0, topology_bytes: 0 };
    let given = forecast.levels.first().map_or(0, |count| count.corners);
    // writers that hold nothing of held meshes either stream any faces
    let streams_all = |mesh, output: &Output| output.format.streams(mesh, &output.options).contains(&Tile::Triangle);
    let streams = |mesh| job.outputs.iter().all(|output| streams_all(mesh, output));
    let streams = job.input.mesh().is_some_and(streams);
    let held = if streams { STREAMED_BYTES } else { HELD_BYTES };
    let is_split = last.unfolded + last.split_vertices > 0;
    // the normals of the first frame, and copies of the positions of all others where their vertices are split
    let of_frames = if carried.frames == 0 { 0 } else { 24 + if is_split { 24 * carried.frames } else { 0 } };
    let [of_planes, most] = PLANE_BYTES;
    let parts = [
        (last.vertices, 24 + 8 * carried.numbers + held + of_frames),
        (last.unfolded, held + of_frames),
        (last.uvs, 16),
        (last.seamed, SEAMED_BYTES),
        (last.split_vertices, SPLIT_VERTEX_BYTES * (1 + carried.frames)),
        (given, PATCH_BYTES),
        (last.vertices.saturating_mul(of_planes).min(most), 1),
        (sizes.iter().map(|size| size.bytes()).max().unwrap_or(0), 1),
        (memory(&before, &[], carried), 1),
    ];
    parts.iter().fold(0, |sum: u128, (n, bytes)| sum.saturating_add(n.saturating_mul(*bytes)))
}

/// Bytes of a job that is refined by rows, without those of limit positions: points, topologies, what is refined along
/// and its topologies, copies of vertices on sharp edges, and the largest result. Each counts as if all were held at
/// once with the largest net.
pub(super) fn memory(forecast: &Forecast, sizes: &[Size], carried: &Carried) -> u128 {
    let count = forecast.peak;
    let [of_place, of_face] = carried.place_bytes;
    let last = forecast.levels.last().copied().unwrap_or_default();
    let parts = [
        (count.vertices, POINT_BYTES + CHANNEL_BYTES * carried.numbers + carried.local_bytes),
        (count.corners, CORNER_BYTES),
        (count.faces, of_face),
        (forecast.topology_bytes, 1),
        (count.uvs, UV_BYTES + of_place),
        (count.seamed, 3 * SEAMED_BYTES + PLACE_BYTES + of_place),
        (last.unfolded - last.unfolded.min(last.uvs), PLACE_BYTES),
        (last.split_vertices, SPLIT_VERTEX_BYTES * (1 + carried.frames)),
        (sizes.iter().map(|size| size.bytes()).max().unwrap_or(0), 1),
    ];
    parts.iter().fold(0, |sum: u128, (n, bytes)| sum.saturating_add(n.saturating_mul(*bytes)))
}

/// Bytes of the coarser levels of detail of a mesh, which are held with the finest one, and the share of its work that
/// they take.
pub(super) fn details(job: &Job, forecast: &Forecast, carried: &Carried) -> (u128, u128) {
    let last = forecast.levels.last().map_or(1, |count| count.corners.max(1));
    let coarser = job.details.iter().filter(|detail| detail.levels != job.levels);
    coarser.fold((0, 0), |(bytes, work), detail| {
        let count = forecast.levels.get(detail.levels as usize).copied().unwrap_or_default();
        let level = Forecast { levels: vec![count], peak: count, work: 0, topology_bytes: 0 };
        let share = forecast.work.saturating_mul(count.corners) / last;
        (memory(&level, &[], carried).saturating_add(bytes), share.saturating_add(work))
    })
}

/// Bytes that a surface of this forecast takes besides while distances are measured from it: its positions once more,
/// and its triangles in their tree, of which there are fewer than corners.
pub(super) fn measured_from(forecast: &Forecast) -> u128 {
    let last = forecast.levels.last().copied().unwrap_or_default();
    let triangles = last.corners.saturating_mul(Measured::NODE_BYTES);
    last.vertices.saturating_mul(24).saturating_add(triangles)
}

/// Rows that are on their way from the sweep to the output at once, at most.
const ROWS_ON_THE_WAY: u128 = 1 << 20;
/// Bytes of a row on its way: its point in a window of a patch, and twice (one is made while the other is written) as
/// a point in the documented order.
const ROW_BYTES: u128 = 3 * 24;

/// Bytes of a job whose mesh is refined while the result is written, from a whole net of that level on, without those
/// of the result.
pub(super) fn on_demand(forecast: &Forecast, level: usize, sizes: &[Size]) -> u128 {
    let last = forecast.levels.last().copied().unwrap_or_default();
    let count = forecast.levels.get(level).copied().unwrap_or(last);
    let given = forecast.levels.first().map_or(0, |count| count.corners);
    let bytes = sizes.iter().map(|size| size.bytes()).max().unwrap_or(0);
    let bytes_a_row = bytes / last.vertices.min(last.faces).max(1);
    let rows = ROWS_ON_THE_WAY.min(last.vertices).saturating_mul(ROW_BYTES + 2 * bytes_a_row);
    let held =
        memory(&Forecast { levels: vec![count], peak: count, work: 0, topology_bytes: 0 }, &[], &Carried::default());
    held.saturating_add(given.saturating_mul(PATCH_BYTES)).saturating_add(rows).saturating_add(PLANE_BYTES[1])
}

/// Bytes of the discs around vertices that limits compare, of 16,384 vertices at a time: those near extraordinary
/// vertices, within three rings, or of all where faces are triangles or where vertices or edges carry something.
pub(super) fn compared_discs(job: &Job, forecast: &Forecast) -> u128 {
    /// Measured: 160 for loop, 640 for butterfly, 980 for sqrt-3, 1,290 with latitude lines.
    const DISC_BYTES: u128 = 1408;
    const AT_A_TIME: u128 = 16_384;
    const NEAR: u128 = 49;
    let Some(mesh) = job.input.mesh() else { return 0 };
    if job.plan.perturbation.is_some() {
        return 0;
    }
    let vertices = forecast.levels.last().map_or(0, |count| count.vertices).min(AT_A_TIME);
    let topology = &mesh.topology;
    let carries = mesh.attributes.is_some() || job.plan.latitude.is_some();
    let of_triangles = job.plan.tile() == Tile::Triangle || job.plan.word.cycle.iter().any(joins_triangles);
    let discs = if carries || of_triangles {
        vertices
    } else {
        let regular = |v: &usize| topology.boundary_edges(*v).is_none() && topology.ring(*v).take(5).count() == 4;
        let uneven = (0..topology.n_vertices()).filter(|v| !regular(v)).count() + mesh.creases.len();
        let faces = (0..topology.n_faces()).filter(|&f| topology.face(f).len() != 4).count();
        vertices.min(NEAR * (uneven + faces) as u128)
    };
    DISC_BYTES * discs
}

/// Whether an operator makes triangles across old ones, as sqrt-3 does, which keeps vertices.
fn joins_triangles(letter: &Letter) -> bool {
    letter.facts().rebuilds && letter.facts().children == Children::Vertices
}
