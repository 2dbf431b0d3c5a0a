//! The memory that a job needs during its run.

use super::complete::Job;
use super::output::Output;
use crate::output::{Measured, Size};
use crate::scheme::forecast::Forecast;
use crate::scheme::letter::Letter;
use crate::scheme::operator::Children;
use crate::shape::tile::Tile;

/// Data that is refined along with the positions.
#[derive(Default)]
pub(super) struct CarriedCounts {
    /// Number of vertex channels.
    pub(super) channels: u128,
    /// Number of frames after the first.
    pub(super) frames: u128,
    /// Number of values per vertex, including those of frames.
    numbers: u128,
    /// Bytes per vertex for vertex parameters and local values.
    local_bytes: u128,
    /// Bytes per place of attributes with seams, and per face, if these are numbered by the mesh.
    place_bytes: [u128; 2],
}

/// Old and new parameters of a vertex (4 of 8 bytes each), its values at the last upsampling (5), and edge directions.
const LOCAL_BYTES: u128 = 8 * (4 + 4 + 5) + 4;
/// Bytes of the indices in the mesh per place, and per face with its edges (24 bytes, and 16 per edge), with a quarter
/// of that for the level before.
const NUMBERED_BYTES: [u128; 2] = [8 + 2, (24 + 4 * 16) * 5 / 4];

/// Returns the data that a job refines along with the positions, with `frames` frames after the first.
pub(super) fn carried(job: &Job, frames: u128) -> CarriedCounts {
    let Some(mesh) = job.input.mesh() else { return CarriedCounts::default() };
    let own = mesh.attributes.is_some() || job.plan.latitude.is_some() || job.plan.perturbation.is_some();
    let local_bytes = if own { LOCAL_BYTES } else { 0 };
    let is_smooth = mesh.attachments.places().any(|places| !places.seams.linear);
    let [place, face] = if job.plan.perturbation.is_some() { NUMBERED_BYTES } else { [0, 0] };
    CarriedCounts {
        channels: mesh.attachments.channels.len() as u128,
        frames,
        numbers: mesh.attachments.width() as u128 + 3 * frames,
        local_bytes,
        place_bytes: if is_smooth { [local_bytes + place, face] } else { [0, 0] },
    }
}

/// Bytes per vertex for its coordinates: those of the last level, of the next one or in the documented order, and of
/// the anchor; three values of 8 bytes each.
const REFINED_POINT_BYTES: u128 = 3 * 24;
/// Bytes per corner. Vertex, edge, half of 8 per edge and a quarter of 4 per vertex are 13 for the topology of the last
/// level while it is written, and a quarter of that for the level before; in addition normals of faces and vertices (24
/// each, 12 per corner), triangles, and sorted lists. Measured: 28 in the largest case, triangles written as STL.
const TOPOLOGY_CORNER_BYTES: u128 = 32;
/// Bytes per value of a channel: of the last level, of the next one, and in the documented order.
const CHANNEL_BYTES: u128 = 3 * 8;
/// Bytes per place with texture coordinates: two values as for channels, and the topology of the places.
const UV_BYTES: u128 = 60;
/// Bytes per place for the topology of the places.
const TOPOLOGY_PLACE_BYTES: u128 = 12;
/// Bytes per place for the values of a channel, at most four.
const SEAMED_BYTES: u128 = 4 * 8;
/// Bytes per vertex that is duplicated where normals differ across a sharp edge, with the faces around it.
const SPLIT_VERTEX_BYTES: u128 = 160;

/// Bytes from which the memory of a job is computed more precisely, which takes some 50 us, as long as a small job.
/// Half of it would affect twice as many jobs; twice of it would overestimate jobs of up to 32 MiB that take a third
/// of that.
const LARGE_JOB_BYTES: u128 = 16 << 20;

/// Returns the memory of a job in bytes, without that of limit positions.
pub(super) fn needed(job: &Job, forecast: &Forecast, sizes: &[Size], carried: &CarriedCounts) -> u128 {
    let by_rows = memory(forecast, sizes, carried);
    let from = if by_rows > LARGE_JOB_BYTES { job.swept_from() } else { None };
    from.map_or(by_rows, |level| by_rows.min(swept(job, forecast, level, sizes, carried)))
}

/// Bytes per vertex, or per place with texture coordinates, that writers hold besides their output: positions with
/// their copies, normals and their sums, or picture data. Measured: 68, for glb with creases.
const HELD_BYTES: u128 = 72;
/// Bytes per vertex for writers that hold no such data: buffers, which do not grow with the mesh.
const STREAMED_BYTES: u128 = 8;
/// Bytes of the planes of a sweep: per vertex, and at most, for sixteen threads. Measured: 22 where two patches have
/// 128 cells per side.
const PLANE_BYTES: [u128; 2] = [32, 64 << 20];
/// Bytes per corner of the input: the topology of patches, their kinds and tables, and each thread's refined stars.
const PATCH_BYTES: u128 = 256;

/// Returns the memory in bytes of a job whose mesh is refined by rows up to a level and by a sweep from there on: the
/// net of that level, the points of the last level, and the data of writers, as if all were held at once.
fn swept(job: &Job, forecast: &Forecast, level: usize, sizes: &[Size], carried: &CarriedCounts) -> u128 {
    let last = forecast.levels.last().copied().unwrap_or_default();
    let count = forecast.levels.get(level).copied().unwrap_or(last);
    let before = Forecast { levels: vec![count], peak: count, work: 0, topology_bytes: 0 };
    let given = forecast.levels.first().map_or(0, |count| count.corners);
    // writers that stream any faces hold no data of stored meshes either
    let streams_all = |mesh, output: &Output| output.format.streams(mesh, &output.options).contains(&Tile::Triangle);
    let streams = |mesh| job.outputs.iter().all(|output| streams_all(mesh, output));
    let streams = job.input.mesh().is_some_and(streams);
    let held = if streams { STREAMED_BYTES } else { HELD_BYTES };
    let is_split = last.unfolded + last.split_vertices > 0;
    // the normals of the first frame, and copies of the positions of all others if their vertices are split
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

/// Returns the memory in bytes of a job that is refined by rows, without that of limit positions: points, topologies,
/// data refined along and its topologies, copies of vertices on sharp edges, and the largest result, as if all were
/// held at once with the largest net.
pub(super) fn memory(forecast: &Forecast, sizes: &[Size], carried: &CarriedCounts) -> u128 {
    let count = forecast.peak;
    let [of_place, of_face] = carried.place_bytes;
    let last = forecast.levels.last().copied().unwrap_or_default();
    let parts = [
        (count.vertices, REFINED_POINT_BYTES + CHANNEL_BYTES * carried.numbers + carried.local_bytes),
        (count.corners, TOPOLOGY_CORNER_BYTES),
        (count.faces, of_face),
        (forecast.topology_bytes, 1),
        (count.uvs, UV_BYTES + of_place),
        (count.seamed, 3 * SEAMED_BYTES + TOPOLOGY_PLACE_BYTES + of_place),
        (last.unfolded - last.unfolded.min(last.uvs), TOPOLOGY_PLACE_BYTES),
        (last.split_vertices, SPLIT_VERTEX_BYTES * (1 + carried.frames)),
        (sizes.iter().map(|size| size.bytes()).max().unwrap_or(0), 1),
    ];
    parts.iter().fold(0, |sum: u128, (n, bytes)| sum.saturating_add(n.saturating_mul(*bytes)))
}

/// Returns the memory in bytes of the coarser levels of detail of a mesh, which are held with the finest one, and their
/// share of the work.
pub(super) fn details(job: &Job, forecast: &Forecast, carried: &CarriedCounts) -> (u128, u128) {
    let last = forecast.levels.last().map_or(1, |count| count.corners.max(1));
    let coarser = job.details.iter().filter(|detail| detail.levels != job.levels);
    coarser.fold((0, 0), |(bytes, work), detail| {
        let count = forecast.levels.get(detail.levels as usize).copied().unwrap_or_default();
        let level = Forecast { levels: vec![count], peak: count, work: 0, topology_bytes: 0 };
        let share = forecast.work.saturating_mul(count.corners) / last;
        (memory(&level, &[], carried).saturating_add(bytes), share.saturating_add(work))
    })
}

/// Returns the additional memory in bytes of a surface from which distances are measured: a copy of its positions, and
/// the tree of its triangles, which are fewer than corners.
pub(super) fn measured_from(forecast: &Forecast) -> u128 {
    let last = forecast.levels.last().copied().unwrap_or_default();
    let triangles = last.corners.saturating_mul(Measured::NODE_BYTES);
    last.vertices.saturating_mul(24).saturating_add(triangles)
}

/// Maximum number of rows in transit from the sweep to the output. It is as many as `output/stream` takes at a time;
/// half of it would book too little, twice of it more than is used.
const ROWS_ON_THE_WAY: u128 = 1 << 20;
/// Bytes per row in transit: its point in a window of a patch, and its point in the documented order twice, as one
/// buffer is filled while the other is written.
const TRANSIT_ROW_BYTES: u128 = 3 * 24;

/// Returns the memory in bytes of a job whose mesh is refined while the result is written, starting from a whole net of
/// `level`, without that of the result.
pub(super) fn on_demand(forecast: &Forecast, level: usize, sizes: &[Size]) -> u128 {
    let last = forecast.levels.last().copied().unwrap_or_default();
    let count = forecast.levels.get(level).copied().unwrap_or(last);
    let given = forecast.levels.first().map_or(0, |count| count.corners);
    let bytes = sizes.iter().map(|size| size.bytes()).max().unwrap_or(0);
    let bytes_a_row = bytes / last.vertices.min(last.faces).max(1);
    let rows = ROWS_ON_THE_WAY.min(last.vertices).saturating_mul(TRANSIT_ROW_BYTES + 2 * bytes_a_row);
    let held = memory(
        &Forecast { levels: vec![count], peak: count, work: 0, topology_bytes: 0 },
        &[],
        &CarriedCounts::default(),
    );
    held.saturating_add(given.saturating_mul(PATCH_BYTES)).saturating_add(rows).saturating_add(PLANE_BYTES[1])
}

/// Returns the memory in bytes of the discs around vertices that limits compare, 16,384 vertices at a time: vertices
/// within three rings of extraordinary ones, or all vertices if faces are triangles or vertices or edges have
/// parameters.
pub(super) fn compared_discs(job: &Job, forecast: &Forecast) -> u128 {
    /// Memory in bytes of a disc. Measured: 160 to 980 where faces are triangles, 1,290 with latitude lines.
    const DISC_BYTES: u128 = 1408;
    /// Number of vertices whose discs are compared at a time.
    const VERTICES_PER_CHUNK: u128 = 16_384;
    /// Number of vertices within three rings of an extraordinary vertex, counted as in a regular grid: 7 x 7.
    const DISCS_A_CENTRE: u128 = 49;
    let Some(mesh) = job.input.mesh() else { return 0 };
    if job.plan.perturbation.is_some() {
        return 0;
    }
    let vertices = forecast.levels.last().map_or(0, |count| count.vertices).min(VERTICES_PER_CHUNK);
    let topology = &mesh.topology;
    let carries = mesh.attributes.is_some() || job.plan.latitude.is_some();
    let of_triangles = job.plan.tile() == Tile::Triangle || job.plan.word.cycle.iter().any(joins_triangles);
    let discs = if carries || of_triangles {
        vertices
    } else {
        let regular = |v: &usize| topology.boundary_edges(*v).is_none() && topology.ring(*v).take(5).count() == 4;
        let uneven = (0..topology.n_vertices()).filter(|v| !regular(v)).count() + mesh.creases.len();
        let faces = (0..topology.n_faces()).filter(|&f| topology.face(f).len() != 4).count();
        vertices.min(DISCS_A_CENTRE * (uneven + faces) as u128)
    };
    DISC_BYTES * discs
}

/// Returns whether an operator makes triangles across old ones but keeps vertices, like sqrt-3.
fn joins_triangles(letter: &Letter) -> bool {
    letter.facts().rebuilds && letter.facts().children == Children::Vertices
}
