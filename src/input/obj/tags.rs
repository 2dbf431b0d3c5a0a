//! Tags of subdivision surfaces: `t name n/m/k`, then n whole numbers, m numbers and k words. Indices count from 0.

use std::collections::BTreeMap;

use crate::input::reader::ReadMesh;
use crate::input::text::{at_line, count, number, quoted};
use crate::scheme::tags::Boundary;

/// The parsed tags with their lines; they are checked at the end because the vertices that they name may follow later.
#[derive(Debug, Default)]
pub(super) struct ObjTags {
    creases: Vec<(usize, [u64; 2], f64)>,
    corners: Vec<(usize, u64, f64)>,
    holes: Vec<(usize, u64)>,
    boundary: Option<Boundary>,
}

/// The arguments of a tag.
struct Arguments {
    indices: Vec<u64>,
    numbers: Vec<f64>,
    n_words: usize,
}

impl Arguments {
    fn read<'a>(mut words: impl Iterator<Item = &'a str> + Clone) -> Result<Self, String> {
        let sizes = words.next().ok_or("a tag without the numbers of its arguments; write for example 2/1/0")?;
        let counts: Vec<u64> = sizes.split('/').map(count).collect::<Result<_, _>>()?;
        let &[n, m, k] = counts.as_slice() else {
            return Err(format!("{} are no numbers of arguments; write for example 2/1/0", quoted(sizes)));
        };
        let given = words.clone().count();
        let all = n.checked_add(m).and_then(|sum| sum.checked_add(k));
        if all != Some(given as u64) {
            return Err(format!("the tag has {given} arguments, {} says otherwise", quoted(sizes)));
        }
        // from here on no count exceeds the number of words
        let [n, m] = [n, m].map(|n| usize::try_from(n).unwrap_or(given));
        let (mut indices, mut numbers) = (Vec::with_capacity(n), Vec::with_capacity(m));
        for word in words.by_ref().take(n) {
            indices.push(count(word)?);
        }
        for word in words.by_ref().take(m) {
            numbers.push(number(word)?);
        }
        Ok(Self { indices, numbers, n_words: words.count() })
    }

    /// Returns the sharpness of each of `n` entries, from one common value or one value each.
    fn sharpness(&self, n: usize) -> Result<impl Iterator<Item = f64>, String> {
        let given = self.numbers.len();
        if n == 0 || !(given == 1 || given == n) {
            return Err(format!("the tag names {n} places and has {given} numbers; give one for all, or one for each"));
        }
        if let Some(wrong) = self.numbers.iter().find(|&&x| x < 0.0) {
            return Err(format!("{wrong} is no sharpness; 0 is smooth, 10 or more infinitely sharp"));
        }
        Ok((0..n).map(move |i| if given == 1 { self.numbers[0] } else { self.numbers[i] }))
    }
}

impl ObjTags {
    /// Adds a tag; tags that do not affect the shape are counted in `left_out`.
    pub(super) fn push<'a>(
        &mut self,
        line: usize,
        mut words: impl Iterator<Item = &'a str> + Clone,
        left_out: &mut BTreeMap<String, usize>,
    ) -> Result<(), String> {
        let name = words.next().ok_or("a tag without a name")?;
        let arguments = Arguments::read(words)?;
        match name {
            "crease" => {
                let (pairs, rest) = arguments.indices.as_chunks::<2>();
                if !rest.is_empty() {
                    return Err(format!("a crease of {} vertices; give pairs", arguments.indices.len()));
                }
                let sharpness = arguments.sharpness(pairs.len())?;
                self.creases.extend(pairs.iter().zip(sharpness).map(|(&edge, sharpness)| (line, edge, sharpness)));
            }
            "corner" => {
                let sharpness = arguments.sharpness(arguments.indices.len())?;
                let entries = arguments.indices.iter().zip(sharpness);
                self.corners.extend(entries.map(|(&vertex, sharpness)| (line, vertex, sharpness)));
            }
            "hole" => self.holes.extend(arguments.indices.iter().map(|&face| (line, face))),
            "interpolateboundary" => self.boundary = Some(boundary(&arguments)?),
            _ => *left_out.entry(format!("tags {}", quoted(name))).or_default() += 1,
        }
        Ok(())
    }

    /// Moves the tags into the mesh after checking that their vertices and faces exist.
    pub(super) fn finish(self, mesh: &mut ReadMesh) -> Result<(), String> {
        let vertices = mesh.positions.len() as u64;
        let faces = mesh.faces.len() as u64;
        let check = |line: usize, what: &str, i: u64, n: u64| {
            let beyond = || at_line(line, format!("there is no {what} {i}; the file has {n}, in tags counted from 0"));
            if i < n { Ok(()) } else { Err(beyond()) }
        };
        mesh.creases.reserve_exact(self.creases.len());
        for (line, edge, sharpness) in self.creases {
            edge.into_iter().try_for_each(|vertex| check(line, "vertex", vertex, vertices))?;
            mesh.creases.push((edge, sharpness));
        }
        mesh.corners.reserve_exact(self.corners.len());
        for (line, vertex, sharpness) in self.corners {
            check(line, "vertex", vertex, vertices)?;
            mesh.corners.push((vertex, sharpness));
        }
        mesh.holes.reserve_exact(self.holes.len());
        for (line, face) in self.holes {
            check(line, "face", face, faces)?;
            mesh.holes.push(face);
        }
        mesh.boundary = self.boundary;
        Ok(())
    }
}

/// Converts an `interpolateboundary` tag: 0 leaves out faces at the boundary, 1 is edges and corners, 2 edges only.
fn boundary(arguments: &Arguments) -> Result<Boundary, String> {
    match (arguments.indices.as_slice(), arguments.numbers.len() + arguments.n_words) {
        ([0], 0) => Ok(Boundary::None),
        ([1], 0) => Ok(Boundary::EdgeAndCorner),
        ([2], 0) => Ok(Boundary::EdgeOnly),
        _ => Err("interpolateboundary takes one of 0 (none), 1 (edge and corner), 2 (edge only)".to_owned()),
    }
}
