//! Draws a mesh in lines, without the parts that its faces hide.

mod chain;
mod edges;
mod hatching;
mod parts;

use rayon::prelude::*;

use super::options::Options;
use crate::drawing::{Cap, Color, Drawing, DrawingItem, Stroke};
use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::counts::Counts;
use crate::output::error::FormatError;
use crate::output::hard_edges;
use crate::output::positions::Positions;
use crate::output::scene::{MeshSource, Scene};
use crate::output::size::Size;
use crate::raster::{ProjectedPoint, Sight};
use crate::watch::Watch;

use chain::{LineSegment, chains};
use edges::{CLASSES, Class, DrawnEdge, SceneEdges};
use hatching::HatchedSurface;
use parts::{LineIntervals, rest, tidied};

/// All items that a drawing of a mesh can show.
pub(crate) const MESH_ITEMS: &[&str] =
    &["silhouettes", "boundary", "creases", "isolines", "wireframe", "hidden", HATCHING];
const HATCHING: &str = "hatching";
/// The items that a drawing shows by default.
const DEFAULT_LINE_ITEMS: &[&str] = &["silhouettes", "boundary", "creases", "isolines"];

/// Maximum number of triangles of a mesh. Twice of it takes four times as long if triangles lie behind each other, and
/// 100 MB more; half of it refuses meshes that are still drawn in seconds.
pub const MAX_LINE_TRIANGLES: u128 = 1 << 18;
/// Maximum number of tested pairs of a line and a triangle, 5 ns each: ten seconds of one core. Meshes of
/// [`MAX_LINE_TRIANGLES`] that are not a heap of sheets need a hundredth of it. Half of it refuses heaps after five
/// seconds; twice of it after twenty.
const MAX_TESTED_PAIRS: usize = 1 << 31;
/// Bytes of memory per triangle: its corners, their places and order (60), its sides (48), its cells (40), and its
/// share of lines and their pieces (150).
const HIDDEN_TRIANGLE_BYTES: u128 = 300;
/// Work per triangle in rows of a table, 100 ns each: finding lines and the triangles that hide them. Half or twice of
/// it predicts half or twice the time.
const TRIANGLE_ROWS: u128 = 30;
/// Maximum number of pieces per line on average; usual meshes have less than one visible piece per line. Half of it
/// refuses meshes that hide more than 4,096 parts of lines; twice of it books twice as many bytes.
const MAX_PIECES_A_LINE: usize = 2;

const OUTLINE_INK: Color = [15, 23, 42, 255];
const THIN_INK: Color = [71, 85, 105, 255];
const HIDDEN_INK: Color = [148, 163, 184, 255];

/// Refuses meshes of too many triangles.
pub(crate) fn fits(counts: &Counts) -> Result<(), Fault> {
    let n = counts.triangles();
    if n <= MAX_LINE_TRIANGLES {
        return Ok(());
    }
    let detail = format!(
        "the mesh has {n} triangles, a drawing in lines takes at most {MAX_LINE_TRIANGLES}; ask for fewer levels, or \
         for \"png\""
    );
    Err(Fault::new("/format", detail))
}

/// Returns the memory for finding hidden parts, bytes.
pub(crate) fn memory(counts: &Counts, options: &Values) -> u128 {
    let lines = counts.triangles().saturating_mul(HIDDEN_TRIANGLE_BYTES);
    if !options.has("show", HATCHING) {
        return lines;
    }
    let vertices = counts.vertices.saturating_add(hard_edges::split_vertices(counts, options));
    lines.saturating_add(hatching::memory(counts.triangles(), vertices))
}

/// Returns the work of finding hidden parts, in rows of a table.
pub(crate) fn work(counts: &Counts) -> u128 {
    counts.triangles().saturating_mul(TRIANGLE_ROWS)
}

/// Returns the maximum number of bytes: three lines a triangle in [`MAX_PIECES_A_LINE`] pieces, 51 bytes each and
/// counted as 64, and the strokes of hatching.
pub(crate) fn size(counts: &Counts, options: &Values) -> Size {
    let pieces = counts.triangles().saturating_mul(3 * MAX_PIECES_A_LINE as u128);
    let strokes = if options.has("show", HATCHING) { hatching::STROKES_BYTES } else { 0 };
    Size::AtMost(pieces.saturating_mul(64).saturating_add(strokes).saturating_add(16 << 10))
}

/// Draws the visible lines of a mesh: its outline (edges between a triangle that shows its outside and one that shows
/// its inside), its boundary, its creases, the edges of the input and of its faces, each line once and under the first
/// of these names. `hidden` adds dashes where outline, boundary or creases are hidden, `hatching` adds strokes where
/// the surface turns away from the light.
pub(crate) fn drawing(
    scene: &Scene<'_>,
    mesh: &dyn MeshSource,
    options: &Options<'_>,
    watch: &Watch,
) -> Result<Drawing, FormatError> {
    let shows = |item: &str| options.shows(item, DEFAULT_LINE_ITEMS);
    let positions = Positions::of_mesh(mesh).held(watch)?;
    let camera = options.camera(&[positions.rows()], options.size_beside(0));
    let seen: Option<Vec<ProjectedPoint>> = positions.rows().par_iter().map(|point| camera.seen(*point)).collect();
    let seen = seen.ok_or_else(|| {
        FormatError::Unfit("parts of the mesh are not before the camera; move its eye away, or ask for \"png\"".into())
    })?;
    let found = SceneEdges::of(scene, mesh, (positions.rows(), &seen), options.values, watch)?;
    let edges: Vec<&DrawnEdge> = found.all.iter().filter(|edge| edge.drawn_as(shows).is_some()).collect();
    let sight = Sight::new(&seen, &found.triangles);
    let pairs = edges.par_iter().map(|edge| sight.n_candidates(edge.ends.map(|v| seen[v as usize]))).sum::<usize>();
    if pairs > MAX_TESTED_PAIRS {
        let detail =
            "too many faces lie behind each other to find what each hides; ask for fewer levels, or for \"png\"";
        return Err(FormatError::Unfit(detail.into()));
    }
    let parts = |edge: &&DrawnEdge| {
        watch.check()?;
        let ends = edge.ends.map(|v| seen[v as usize]);
        let hidden = sight.hidden(ends, |triangle| edge.beside.contains(&triangle));
        Ok(tidied(&hidden, ends))
    };
    let hidden: Vec<LineIntervals> =
        edges.par_iter().with_min_len(256).map(parts).collect::<Result<_, FormatError>>()?;
    let n_pieces: usize = hidden.iter().map(|parts| parts.len() + 1).sum();
    if n_pieces > MAX_PIECES_A_LINE * edges.len() + 4096 {
        let detail = "what the faces hide cuts lines into too many pieces; ask for fewer levels, or for \"png\"";
        return Err(FormatError::Unfit(detail.into()));
    }
    let artist = EdgePainter { options, seen: &seen, edges: &edges, hidden: &hidden };
    let mut items = Vec::new();
    if options.shows(HATCHING, &[]) {
        let ground = HatchedSurface::of(scene, mesh, &found.hard, &camera, watch)?;
        let runs = ground.strokes(&sight, options.size, options.unit_px(), MAX_TESTED_PAIRS - pairs, watch)?;
        let stroke = options.stroke(0.7, options.color(THIN_INK));
        items.extend((!runs.is_empty()).then(|| DrawingItem::lines(HATCHING, runs, stroke).titled(HATCHING)));
    }
    if options.shows("hidden", &[]) {
        items.push(artist.dashes());
    }
    for class in CLASSES.into_iter().rev() {
        items.extend(artist.lines(class));
    }
    Ok(Drawing { size: options.size, background: options.background, title: "Subdivision surface".to_owned(), items })
}

struct EdgePainter<'a> {
    options: &'a Options<'a>,
    seen: &'a [ProjectedPoint],
    edges: &'a [&'a DrawnEdge],
    /// The hidden parts of each edge.
    hidden: &'a [LineIntervals],
}

impl EdgePainter<'_> {
    /// Returns the visible parts of the lines of a class.
    fn lines(&self, class: Class) -> Option<DrawingItem> {
        let name = class.name();
        let (width, color) = match class {
            Class::Silhouette | Class::Boundary => (2.4, OUTLINE_INK),
            Class::Crease => (1.9, OUTLINE_INK),
            Class::Isoline => (1.0, THIN_INK),
            Class::Wireframe => (0.6, THIN_INK),
        };
        let lines = self.edges.iter().zip(self.hidden).filter(|(edge, _)| self.class(edge) == Some(class));
        let pieces: Vec<_> = lines.flat_map(|(edge, hidden)| self.pieces(edge, rest(hidden))).collect();
        let stroke = self.options.stroke(width, self.options.color(color));
        let runs = chains(&pieces);
        (!runs.is_empty()).then(|| DrawingItem::lines(name, runs, stroke).titled(name))
    }

    /// Returns the hidden parts of all lines but isolines and wireframe, as dashes.
    fn dashes(&self) -> DrawingItem {
        let lines = self.edges.iter().zip(self.hidden);
        let thick = lines.filter(|(edge, _)| !matches!(self.class(edge), Some(Class::Isoline | Class::Wireframe)));
        let pieces: Vec<_> = thick.flat_map(|(edge, hidden)| self.pieces(edge, hidden.clone())).collect();
        let solid = self.options.stroke(1.0, HIDDEN_INK);
        let unit = solid.width_px;
        let stroke = Stroke { dash: vec![4.0 * unit, 3.0 * unit], cap: Cap::Butt, ..solid };
        DrawingItem::lines("hidden", chains(&pieces), stroke).titled("hidden lines")
    }

    fn class(&self, edge: &DrawnEdge) -> Option<Class> {
        edge.drawn_as(|item| self.options.shows(item, DEFAULT_LINE_ITEMS))
    }

    fn pieces(&self, edge: &DrawnEdge, parts: LineIntervals) -> impl Iterator<Item = LineSegment> + use<> {
        let [a, b] = edge.ends.map(|v| self.seen[v as usize]);
        let ends = edge.ends;
        #[expect(clippy::cast_possible_truncation, reason = "pixel coordinates need no more than the precision of f32")]
        let place = move |t: f64| [0, 1].map(|k| (a[k] + t * (b[k] - a[k])) as f32);
        parts.into_iter().map(move |[from, to]| LineSegment {
            places: [place(from), place(to)],
            vertices: [(from <= 0.0).then_some(ends[0]), (to >= 1.0).then_some(ends[1])],
        })
    }
}
