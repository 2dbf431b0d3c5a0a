//! Merges vertices that coincide or lie close to each other.

use std::collections::HashMap;

use super::check::FaceList;
use super::topology::index;

/// Number of merged pairs that are kept for the report.
const REPORTED_PAIRS: usize = 5;

/// Smallest distance of a weld relative to the largest coordinate; below it, adjacent floating-point numbers may be
/// further apart. Half or twice of it is still some thousand times the distance of such numbers.
pub const LEAST_WELD: f64 = 1e-12;

/// The vertices that are kept, and the vertices that the others were merged into.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Welded {
    /// For each old vertex its new index.
    pub image: Vec<u32>,
    /// For each new vertex the old vertex whose position it has; ascending.
    pub kept: Vec<u32>,
    /// The first merged vertices, each with the vertex that it was merged into, by their old indices.
    pub pairs: Vec<[u32; 2]>,
}

impl Welded {
    /// Number of vertices that were merged into others.
    pub fn merged(&self) -> usize {
        self.image.len() - self.kept.len()
    }
}

/// Merges each vertex, in order, into the lowest kept vertex at most `distance` (model units, at least 0) away; a
/// vertex without such a neighbour is kept. The distance 0 merges equal positions.
///
/// Kept vertices are sorted into a grid of cells as wide as the distance, so that only the 27 cells around a vertex are
/// searched. As kept vertices are further apart than the distance, a cell holds few of them.
///
/// # Errors
/// A distance that is no number of at least 0, or too small for the largest coordinate.
pub fn weld(positions: &[[f64; 3]], distance: f64) -> Result<Welded, String> {
    let largest = positions.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    if !distance.is_finite() || distance < 0.0 {
        return Err(format!("{distance} is no distance; give a number of at least 0, where 0 merges equal positions"));
    }
    if distance > 0.0 && distance < LEAST_WELD * largest {
        let least = LEAST_WELD * largest;
        return Err(format!(
            "{distance:e} is too small for coordinates up to {largest:e}; give at least {least:e}, or 0 to merge equal \
             positions"
        ));
    }
    let mut welded = Welded { image: Vec::with_capacity(positions.len()), kept: Vec::new(), pairs: Vec::new() };
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for (v, place) in positions.iter().enumerate() {
        let cell = cell(*place, distance);
        let near = |new: &u32| is_near(positions[welded.kept[*new as usize] as usize], *place, distance);
        let around = neighbours(cell, distance).filter_map(|cell| cells.get(&cell)).flatten();
        if let Some(new) = around.copied().filter(|new| near(new)).min() {
            if welded.pairs.len() < REPORTED_PAIRS {
                welded.pairs.push([index(v), welded.kept[new as usize]]);
            }
            welded.image.push(new);
        } else {
            let new = index(welded.kept.len());
            cells.entry(cell).or_default().push(new);
            welded.kept.push(index(v));
            welded.image.push(new);
        }
    }
    Ok(welded)
}

/// Returns the cell of a position; with distance 0, each position is a cell of its own.
#[expect(clippy::cast_possible_truncation, reason = "the least distance keeps quotients below 2^40")]
fn cell(place: [f64; 3], distance: f64) -> [i64; 3] {
    place.map(|x| if distance > 0.0 { (x / distance).floor() as i64 } else { (x + 0.0).to_bits().cast_signed() })
}

fn neighbours(cell: [i64; 3], distance: f64) -> impl Iterator<Item = [i64; 3]> {
    let reach = move || if distance > 0.0 { -1..=1 } else { 0..=0 };
    let plane = move |x: i64| reach().flat_map(move |y| reach().map(move |z| [x, y, z]));
    reach().flat_map(plane).map(move |by| std::array::from_fn(|k| cell[k].saturating_add(by[k])))
}

/// Returns whether two positions of neighbouring cells are at most `distance` apart.
fn is_near(a: [f64; 3], b: [f64; 3], distance: f64) -> bool {
    // divides first so that squares of small numbers do not underflow; with distance 0 the cell is the position
    let part = |k: usize| if distance > 0.0 { (a[k] - b[k]) / distance } else { 0.0 };
    (0..3).map(|k| part(k) * part(k)).sum::<f64>() <= 1.0
}

/// Returns the corners of a face over merged vertices that remain when repeated neighbours are removed, ascending;
/// `None` if fewer than three distinct vertices remain.
///
/// # Errors
/// A vertex that the face visits twice, with others between, so that it is no longer one face.
fn collapse(face: &[u32]) -> Result<Option<Vec<usize>>, u32> {
    let mut places: Vec<usize> = Vec::with_capacity(face.len());
    for (j, &v) in face.iter().enumerate() {
        if places.last().is_none_or(|&last| face[last] != v) {
            places.push(j);
        }
    }
    while places.len() > 1 && face[places[0]] == face[places[places.len() - 1]] {
        places.pop();
    }
    if places.len() < 3 {
        return Ok(None);
    }
    let mut sorted: Vec<u32> = places.iter().map(|&j| face[j]).collect();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(pair[0]),
        None => Ok(Some(places)),
    }
}

/// The faces over merged vertices, with the old face of each, and the faces that collapsed.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct WeldedFaces {
    /// The remaining faces.
    pub faces: FaceList,
    /// The old index of each remaining face, ascending.
    pub kept: Vec<u32>,
    /// The old index of each remaining corner, ascending.
    pub corners: Vec<u32>,
    /// The old indices of the faces that collapsed.
    pub gone: Vec<u32>,
}

/// Rewrites faces for merged vertices. A face that already visits fewer than three vertices stays as it is.
///
/// # Errors
/// The old number of a pinched face and the old number of the vertex it meets twice.
pub fn weld_faces(faces: &FaceList, welded: &Welded) -> Result<WeldedFaces, (usize, u32)> {
    let mut result = WeldedFaces::default();
    let mut first_corner = 0;
    for f in 0..faces.len() {
        let face = faces.face(f);
        let image: Vec<u32> = face.iter().map(|&v| welded.image[v as usize]).collect();
        let all = || Ok(Some((0..face.len()).collect()));
        let places = if face.len() < 3 { all() } else { collapse(&image) };
        if let Some(places) = places.map_err(|vertex| (f, welded.kept[vertex as usize]))? {
            result.faces.push(places.iter().map(|&j| image[j]));
            result.kept.push(index(f));
            result.corners.extend(places.iter().map(|&j| index(first_corner + j)));
        } else {
            result.gone.push(index(f));
        }
        first_corner += face.len();
    }
    Ok(result)
}
