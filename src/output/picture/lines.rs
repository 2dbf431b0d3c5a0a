//! The lines and dots of a picture of a mesh: its wireframe, the edges of the input on it, its tags, the control net.

use std::borrow::Cow;

use rayon::prelude::*;

use super::options::{CONTROL_COLOR, Options, POINT_COLOR, WIRE_COLOR};
use super::shading;
use crate::drawing::{Discs, LegendSample, Stroke};
use crate::math::parameter::Values;
use crate::output::hard_edges::edges_of;
use crate::output::options::{DIRECTION_ITEMS, ISOLINES, joined};
use crate::output::scene::{FaceChunk, MeshSource, Scene, Shape, each_face, in_chunks, positions};
use crate::raster::{Crowding, Strokes};
use crate::shape::directions::Direction;
use crate::shape::mesh::Mesh;
use crate::shape::topology::index;
use crate::watch::{Stopped, Watch};

const WIRE: [u8; 4] = [16, 28, 50, 255];
const CONTROL_NET_INK: [u8; 4] = [217, 93, 57, 255];
const CONTROL_POINT_INK: [u8; 4] = [176, 58, 32, 255];
const EXTRAORDINARY_DOT: [u8; 4] = [250, 204, 21, 255];
const EXTRAORDINARY_RING: [u8; 4] = [30, 30, 30, 255];

/// Opacity of a control net behind the surface. At half of it only short ticks beside the visible parts appear in
/// print; at twice of it the net seems to lie in front of the surface.
const FAINT_NET_OPACITY: f32 = 0.3;

/// Edges with a sharpness.
const CREASES: &str = "creases";
/// Edges along latitude lines.
const LATITUDE: &str = DIRECTION_ITEMS[0];
/// Edges along longitude lines.
const LONGITUDE: &str = DIRECTION_ITEMS[1];
/// Edges at which texture coordinates are cut.
const SEAMS: &str = "seams";
/// Extraordinary vertices of the input.
const EXTRAORDINARY: &str = "extraordinary";

/// The meaning of lines and dots, and of the colours of names.
pub(super) const LEGEND_ITEM: &str = "legend";

/// Lines that show tags of the input, with their colours, the undermost first.
const TAG_LINES: [(&str, [u8; 4]); 4] = [
    (SEAMS, [132, 204, 22, 255]),
    (LONGITUDE, [126, 34, 206, 255]),
    (LATITUDE, [4, 120, 87, 255]),
    (CREASES, [190, 18, 60, 255]),
];

/// The items that pictures of meshes can show, but for a legend.
pub(crate) const SURFACE_ITEMS: [&str; 10] =
    ["surface", "wireframe", ISOLINES, "control", "points", CREASES, LATITUDE, LONGITUDE, SEAMS, EXTRAORDINARY];

/// The items that pictures of meshes can show.
pub(crate) const SHOWN: [&str; 11] = joined(&SURFACE_ITEMS, &[LEGEND_ITEM]);

/// Returns whether the refined mesh itself is shown, and not only the control net.
pub(crate) fn shows_body(options: &Options<'_>) -> bool {
    SURFACE_ITEMS.iter().any(|item| !matches!(*item, "control" | "points") && shading::shows(options, item))
}

/// Returns the shown item that refers to single edges or vertices of the input, if any.
pub(crate) fn refers(options: &Values) -> Option<&'static str> {
    [ISOLINES, CREASES, LATITUDE, LONGITUDE, EXTRAORDINARY].into_iter().find(|item| options.has("show", item))
}

/// Returns the names of the shown lines and dots, with samples of them, the uppermost first.
pub(super) fn meanings(options: &Options<'_>) -> Vec<(&'static str, LegendSample)> {
    let unit = options.unit_px();
    let wide = unit * options.line_width();
    let line = |width: f32, color| LegendSample::Line(Stroke::solid(width * wide, color));
    let dot = |color, ring| {
        LegendSample::Disc(Discs { centres: Vec::new(), radius_px: 4.0 * unit, ring_px: 1.5 * unit, color, ring })
    };
    let wire = options.ink(&WIRE_COLOR, WIRE);
    let mut all = vec![
        ("points", "control points", dot(options.ink(&POINT_COLOR, CONTROL_POINT_INK), [255; 4])),
        ("control", "control net", line(1.6, options.ink(&CONTROL_COLOR, CONTROL_NET_INK))),
        (EXTRAORDINARY, EXTRAORDINARY, dot(EXTRAORDINARY_DOT, EXTRAORDINARY_RING)),
    ];
    all.extend(TAG_LINES.iter().rev().map(|(name, color)| (*name, *name, line(3.4, *color))));
    all.push((ISOLINES, "edges of the input", line(2.2, wire)));
    all.push(("wireframe", "edges of faces", line(1.3, wire)));
    all.into_iter().filter(|(item, ..)| shading::shows(options, item)).map(|(_, name, key)| (name, key)).collect()
}

/// All lines and dots of a picture, as pairs of vertices; dots join a vertex to itself.
pub(super) struct MeshLines<'a> {
    wires: Vec<[u32; 2]>,
    isolines: Vec<[u32; 2]>,
    /// The tagged edges and vertices, in the order of [`TAG_LINES`].
    tags: [Vec<[u32; 2]>; TAG_LINES.len()],
    extraordinary: Vec<[u32; 2]>,
    net: ControlLines<'a>,
}

impl<'a> MeshLines<'a> {
    /// Collects the lines and dots of a scene that are to be shown.
    pub(super) fn of(
        scene: &'a Scene<'a>,
        mesh: &dyn MeshSource,
        options: &Options<'_>,
        watch: &Watch,
    ) -> Result<Self, Stopped> {
        let shows = |item| shading::shows(options, item);
        let all = 0..mesh.input_cells()[1];
        let input = scene.control.mesh();
        let mut tags: [Vec<[u32; 2]>; TAG_LINES.len()] = Default::default();
        for ((name, _), lines) in TAG_LINES.iter().zip(&mut tags).filter(|((name, _), _)| shows(name)) {
            *lines = match (*name, input) {
                (SEAMS, _) => seams(mesh, watch)?,
                (name, Some(input)) => pieces(mesh, tagged(input, name).into_iter(), watch)?,
                (_, None) => Vec::new(),
            };
        }
        let dots = |input: &Mesh| extraordinary(input).map(|v| [v, v]).collect();
        let net = match scene.control.shape() {
            Shape::Mesh(net) if shows("control") || shows("points") => ControlLines::of(net, watch)?,
            _ => ControlLines::default(),
        };
        Ok(Self {
            wires: if shows("wireframe") { edges(mesh, watch)? } else { Vec::new() },
            isolines: if shows(ISOLINES) { pieces(mesh, all, watch)? } else { Vec::new() },
            tags,
            extraordinary: input.filter(|_| shows(EXTRAORDINARY)).map_or_else(Vec::new, dots),
            net,
        })
    }

    /// Returns the points of the control net; none if neither its edges nor its points are shown.
    pub(super) fn net_positions(&self) -> &[[f64; 3]] {
        &self.net.positions
    }

    /// Returns the strokes for the rasteriser, over a surface with these vertices and, in a drawing of lines, contours.
    pub(super) fn strokes<'b>(
        &'b self,
        surface: &'b [[f64; 3]],
        contours: &'b [[u32; 2]],
        options: &Options<'_>,
    ) -> Vec<Strokes<'b>> {
        let shows = |item| shading::shows(options, item);
        let unit = options.unit_px();
        let wide = unit * options.line_width();
        let ring = if options.background[3] == 255 { options.background } else { [255; 4] };
        let room = options.room(self.net.positions.len());
        let (thin, small) = (room.min(25.0) * 0.08, room.min(32.0) * 0.25);
        let line = |positions, segments, width_px: f32, color| Strokes {
            positions,
            segments,
            width_px,
            color,
            crowding: Crowding::Keep,
            hidden: 0.0,
        };
        let faint = |strokes| Strokes { hidden: FAINT_NET_OPACITY, ..strokes };
        let wire = options.ink(&WIRE_COLOR, WIRE);
        let mut strokes = Vec::new();
        strokes.push(Strokes { crowding: Crowding::Fade, ..line(surface, &self.wires, 1.3 * wide, wire) });
        // in a drawing of lines, contours are wider than isolines
        let fine = if shading::is_drawing(options.values) { 1.2 } else { 2.2 };
        strokes.push(line(surface, &self.isolines, fine * wide, wire));
        strokes.push(line(surface, contours, 3.2 * wide, wire));
        for ((_, color), lines) in TAG_LINES.iter().zip(&self.tags) {
            strokes.push(line(surface, lines, 3.4 * wide, *color));
        }
        strokes.push(line(surface, &self.extraordinary, 11.0 * unit, EXTRAORDINARY_RING));
        strokes.push(line(surface, &self.extraordinary, 8.0 * unit, EXTRAORDINARY_DOT));
        let net = &self.net;
        if shows("control") {
            let ink = options.ink(&CONTROL_COLOR, CONTROL_NET_INK);
            strokes.push(faint(line(&net.positions, &net.edges, thin * wide, ink)));
        }
        if shows("points") {
            strokes.push(line(&net.positions, &net.points, 1.31 * small * unit, ring));
            let ink = options.ink(&POINT_COLOR, CONTROL_POINT_INK);
            strokes.push(faint(line(&net.positions, &net.points, small * unit, ink)));
        }
        strokes.retain(|strokes| !strokes.segments.is_empty());
        strokes
    }
}

/// The control net: its points, its edges and, for discs, each point joined to itself.
#[derive(Default)]
struct ControlLines<'a> {
    positions: Cow<'a, [[f64; 3]]>,
    edges: Vec<[u32; 2]>,
    points: Vec<[u32; 2]>,
}

impl<'a> ControlLines<'a> {
    fn of(mesh: &'a dyn MeshSource, watch: &Watch) -> Result<Self, Stopped> {
        let positions = positions(mesh, watch)?;
        let n = u32::try_from(positions.len()).expect("indices of vertices have 32 bits");
        Ok(Self { positions, edges: edges(mesh, watch)?, points: (0..n).map(|i| [i, i]).collect() })
    }
}

/// Returns each edge of the shown faces once.
fn edges(mesh: &dyn MeshSource, watch: &Watch) -> Result<Vec<[u32; 2]>, Stopped> {
    let mut keys: Vec<[u32; 2]> = Vec::with_capacity(mesh.n_half_edges());
    each_face(mesh, watch, |face| keys.extend(edges_of(face)))?;
    keys.par_sort_unstable();
    keys.dedup();
    Ok(keys)
}

/// Returns the pieces of edges of the input that have a shown face beside them.
pub(super) fn pieces(
    mesh: &dyn MeshSource,
    edges: impl Iterator<Item = usize>,
    watch: &Watch,
) -> Result<Vec<[u32; 2]>, Stopped> {
    let mut pieces = Vec::new();
    let mut line = Vec::new();
    for (n, edge) in edges.enumerate() {
        if n % 4096 == 0 {
            watch.check()?;
        }
        if mesh.isoline(edge, &mut line) {
            pieces.extend(line.array_windows().copied());
        }
    }
    Ok(pieces)
}

/// Returns the edges of the input with this tag.
fn tagged(input: &Mesh, name: &str) -> Vec<usize> {
    let along = |direction| input.directions.as_ref().map_or_else(Vec::new, |lines| lines.edges(direction));
    let edges = match name {
        LATITUDE => along(Direction::Latitude),
        LONGITUDE => along(Direction::Longitude),
        _ => input.creases.iter().map(|&(edge, _)| edge).collect(),
    };
    edges.into_iter().map(|edge| edge as usize).collect()
}

/// Returns the extraordinary vertices of the input: inner ones whose valence is not 4, or not 6 if all faces are
/// triangles, and boundary vertices of valence greater than 3, or than 4.
fn extraordinary(input: &Mesh) -> impl Iterator<Item = u32> + '_ {
    let topology = &input.topology;
    let usual = if topology.first_other_than_triangle().is_none() { 6 } else { 4 };
    let is_unusual = move |&v: &usize| {
        let valence = topology.valence(v);
        if topology.boundary_edges(v).is_some() { valence > usual / 2 + 1 } else { valence != usual }
    };
    (0..topology.n_vertices()).filter(|&v| !topology.is_isolated(v)).filter(is_unusual).map(index)
}

/// Returns the edges whose two faces have different texture coordinates at an end.
fn seams(mesh: &dyn MeshSource, watch: &Watch) -> Result<Vec<[u32; 2]>, Stopped> {
    let Some(uvs) = mesh.uvs() else { return Ok(Vec::new()) };
    let mut sides: Vec<[u32; 4]> = Vec::with_capacity(mesh.n_half_edges());
    let (mut faces, mut places) = (FaceChunk::default(), FaceChunk::default());
    in_chunks(mesh.n_faces(), |range| {
        watch.check()?;
        mesh.faces(range.clone(), &mut faces);
        uvs.faces(range, &mut places);
        for (face, places) in faces.iter().zip(places.iter()) {
            for i in 0..face.len() {
                let j = (i + 1) % face.len();
                let [a, b] = if face[i] < face[j] { [i, j] } else { [j, i] };
                sides.push([face[a], face[b], places[a], places[b]]);
            }
        }
        Ok(())
    })?;
    sides.par_sort_unstable();
    let edges = sides.chunk_by(|a, b| a[..2] == b[..2]);
    let cut = edges.filter(|sides| sides.iter().any(|side| side[2..] != sides[0][2..]));
    Ok(cut.map(|sides| [sides[0][0], sides[0][1]]).collect())
}
