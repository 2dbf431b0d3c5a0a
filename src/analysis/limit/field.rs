//! The masks of all vertices, or of what took their place in a net: regular ones by walks on a grid, the others by
//! their discs.

use std::collections::BTreeMap;
use std::sync::Arc;

use rayon::prelude::*;

use super::bounds::{CHUNK_VERTICES, DISCS_PER_CHUNK, FIRST_CHUNK, MAX_DISCS, VERTICES_A_ROW};
use super::disc::{Centre, Disc, Located, NEAREST, RingCount};
use super::error::Unlimited;
use super::grid::regular_mask;
use super::mask::{Finder, LimitMask, Masks};
use super::neighbourhoods::Neighbourhoods;
use super::on_net::CycleOnNet;
use super::regular::Regular;
use super::sector::Sectors;
use super::tangent::NoTangents;
use super::vertex_parameters::{CommonParameters, VertexParameters};
use crate::math::rows::{RowSource, Rows, RowsBy};
use crate::shape::topology::index;
use crate::watch::Watch;

/// The class of vertices around which the net is a grid of quads.
const REGULAR_CLASS: u32 = 0;
/// The class of vertices without faces.
const ISOLATED_CLASS: u32 = 1;

/// The masks of all vertices of a net.
#[derive(Debug)]
pub(super) struct VertexMasks<'a> {
    around: &'a dyn Neighbourhoods,
    rings: RingCount,
    classes: Vec<u32>,
    masks: Vec<Arc<LimitMask>>,
    /// The mask on a grid, in the order of [`grid`](super::grid::grid).
    regular: Option<LimitMask>,
}

/// The functional that a row of a field evaluates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Functional {
    /// The limit position.
    Position,
    /// One of the two tangents.
    Tangent(usize),
}

impl<'a> VertexMasks<'a> {
    /// Finds the masks of all vertices.
    pub(super) fn new(
        around: &'a dyn Neighbourhoods,
        on_net: &CycleOnNet<'_>,
        rings: RingCount,
        finder: &Finder<'_>,
        watch: &Watch,
    ) -> Result<Self, Unlimited> {
        let near = match on_net.regular {
            Regular::Quads => around.near_extraordinary(rings),
            Regular::Triangles => vec![true; around.n_points()],
        };
        let on_grid = near.iter().any(|near| !near);
        let plain = Masks::new(finder, CommonParameters::default());
        let grid = if on_grid { Some(regular_mask(rings, &plain, on_net.surroundings)?) } else { None };
        let sides = if on_net.regular == Regular::Quads { 4 } else { 3 };
        middles_settle(&around.middles(sides, rings, watch)?, &plain)?;
        let n = around.n_vertices();
        let is_regular = |v: &u32| matches!(around.centre(*v as usize), Some(Centre::Vertex(at)) if !near[at as usize]);
        let mut classes = vec![REGULAR_CLASS; n];
        let rest: Vec<u32> = (0..index(n)).filter(|v| !is_regular(v)).collect();
        let mut known: BTreeMap<(Disc, VertexParameters), u32> = BTreeMap::new();
        let mut left = rest.as_slice();
        let mut chunk = FIRST_CHUNK;
        while !left.is_empty() {
            watch.check().map_err(Unlimited::Stopped)?;
            let (now, later) = left.split_at(chunk.min(left.len()));
            left = later;
            let disc = |&v: &u32| {
                located(around, v, rings).map(|found| found.map(|(found, parameters)| (found.disc, parameters)))
            };
            let discs: Vec<Option<(Disc, VertexParameters)>> = now.par_iter().map(disc).collect::<Result<_, _>>()?;
            let size: usize = discs.iter().flatten().map(|(disc, _)| disc.n_vertices).sum();
            watch.advance(size as u64 / VERTICES_A_ROW + now.len() as u64);
            chunk = (CHUNK_VERTICES * now.len() / size.max(1)).clamp(1, DISCS_PER_CHUNK.min(2 * chunk));
            for (&v, disc) in now.iter().zip(discs) {
                let next = index(known.len()) + ISOLATED_CLASS + 1;
                classes[v as usize] = disc.map_or(ISOLATED_CLASS, |disc| *known.entry(disc).or_insert(next));
            }
            if known.len() > MAX_DISCS && known.keys().filter(|(_, parameters)| !parameters.agree()).count() > MAX_DISCS
            {
                return Err(Unlimited::Different);
            }
        }
        let mut discs: Vec<((Disc, VertexParameters), u32)> = known.into_iter().collect();
        discs.sort_unstable_by_key(|entry| entry.1);
        let mut common: BTreeMap<CommonParameters, Masks<'_>> = BTreeMap::new();
        common.insert(CommonParameters::default(), plain);
        for ((_, parameters), _) in discs.iter().filter(|((_, parameters), _)| parameters.agree()) {
            common.entry(parameters.first()).or_insert_with(|| Masks::new(finder, parameters.first()));
        }
        let find = |((disc, parameters), _): &((Disc, VertexParameters), u32)| {
            watch.check().map_err(Unlimited::Stopped)?;
            match common.get(&parameters.first()).filter(|_| parameters.agree()) {
                Some(masks) => masks.of(0, disc),
                None => finder.varying(disc, parameters).map(Arc::new),
            }
        };
        let masks = discs.par_iter().map(find).collect::<Result<_, _>>()?;
        Ok(Self { around, rings, classes, masks, regular: grid })
    }

    /// Creates a field in which each vertex has its own mask; `None` for vertices without faces.
    pub(super) fn of_masks(
        around: &'a dyn Neighbourhoods,
        rings: RingCount,
        masks: Vec<Option<Arc<LimitMask>>>,
    ) -> Self {
        let mut n = ISOLATED_CLASS;
        let class = |mask: &Option<Arc<LimitMask>>| {
            n += u32::from(mask.is_some());
            if mask.is_some() { n } else { ISOLATED_CLASS }
        };
        let classes = masks.iter().map(class).collect();
        Self { around, rings, classes, masks: masks.into_iter().flatten().collect(), regular: None }
    }

    /// Returns why regular vertices have no tangents, if so: then the scheme has none.
    pub(super) fn no_regular_tangents(&self) -> Option<NoTangents> {
        self.regular.as_ref()?.tangents.iter().find_map(|tangents| tangents.as_ref().err().copied())
    }

    /// Returns why a vertex has no tangents in a sector, if so.
    pub(super) fn no_tangents(&self, v: usize, sector: usize) -> Option<NoTangents> {
        self.mask(v)?.tangents[sector].as_ref().err().copied()
    }

    /// Returns the mask of a vertex; `None` for a vertex without faces.
    fn mask(&self, v: usize) -> Option<&LimitMask> {
        match self.classes[v] {
            ISOLATED_CLASS => None,
            REGULAR_CLASS => self.regular.as_ref(),
            class => self.masks.get((class - ISOLATED_CLASS - 1) as usize).map(|mask| &**mask),
        }
    }

    /// Returns the sectors of all vertices: first sector 0 of each vertex, then the others, vertex after vertex.
    pub(super) fn sectors(&self) -> Vec<(u32, usize)> {
        let n = self.classes.len();
        let beside =
            |v: usize| (1..self.mask(v).map_or(1, |mask| mask.tangents.len())).map(move |sector| (index(v), sector));
        (0..n).map(|v| (index(v), 0)).chain((0..n).flat_map(beside)).collect()
    }

    /// Returns, for each face at a vertex, counter-clockwise, its next vertex and its sector.
    pub(super) fn sides(&self, v: usize) -> Vec<(u32, usize)> {
        let Some(found) = self.around.centre(v).and_then(|centre| self.around.disc(centre, NEAREST)) else {
            return Vec::new();
        };
        let sectors = Sectors::of(&found.disc);
        let faces = found.disc.central_faces().enumerate();
        faces.map(|(i, face)| (found.vertices[face[1] as usize], sectors.of_face(i))).collect()
    }

    /// Describes a sector of a vertex in words.
    pub(super) fn describe(&self, v: usize) -> String {
        let by_sector = self.mask(v).is_some_and(|mask| mask.tangents.len() > 1);
        let found = self.around.centre(v).and_then(|centre| self.around.disc(centre, NEAREST));
        let place = found.map_or_else(|| "a boundary vertex".to_owned(), |found| found.disc.describe());
        format!("{}{place}", if by_sector { "one side of the sharp edges at " } else { "" })
    }

    /// Returns the vertices without faces that are not among the points.
    pub(super) fn left_out(&self) -> impl Iterator<Item = usize> {
        let n = if self.around.leaves_out() { self.n_vertices() } else { 0 };
        (0..n).filter(|&v| self.around.centre(v).is_none())
    }

    /// Returns the number of vertices.
    pub(super) fn n_vertices(&self) -> usize {
        self.classes.len()
    }

    /// Returns whether a vertex has no face.
    pub(super) fn is_isolated(&self, v: usize) -> bool {
        self.classes[v] == ISOLATED_CLASS
    }

    /// Returns the rows of some sectors of vertices for a functional.
    pub(super) fn rows(&self, sectors: &[(u32, usize)], functional: Functional) -> impl RowSource {
        RowsBy::new(sectors.len(), self.around.n_points(), move |i, out: &mut Rows| {
            self.row(sectors[i].0 as usize, sectors[i].1, functional, out);
        })
    }

    /// Adds the weights of a vertex for a functional in a sector.
    fn row(&self, v: usize, sector: usize, functional: Functional, out: &mut Rows) {
        match (self.around.centre(v), self.classes[v], &self.regular) {
            (None, ..) if self.around.leaves_out() => {}
            (None, ..) => out.add(index(v), if functional == Functional::Position { 1.0 } else { 0.0 }),
            (Some(Centre::Vertex(at)), REGULAR_CLASS, Some(mask)) => {
                self.around.add_on_grid(at, self.rings.support, weights(mask, functional, sector), out);
            }
            (Some(centre), class, _) => {
                // the support comes first in a disc, so that its outer rings are not needed
                let rings = RingCount { disc: self.rings.support, ..self.rings };
                let mask = &self.masks[(class - ISOLATED_CLASS - 1) as usize];
                let vertices = self.around.disc(centre, rings).map_or_else(Vec::new, |found| found.vertices);
                vertices.iter().zip(weights(mask, functional, sector)).for_each(|(&u, &w)| out.add(u, w));
            }
        }
    }
}

/// Returns the weights of a mask for a functional in a sector; none if there are no tangents.
fn weights(mask: &LimitMask, functional: Functional, sector: usize) -> &[f64] {
    match functional {
        Functional::Position => &mask.position,
        Functional::Tangent(i) => {
            mask.tangents.get(sector).and_then(|tangents| tangents.as_ref().ok()).map_or(&[], |t| &t[i])
        }
    }
}

/// Returns the disc around what took the place of a vertex, and its parameters; `None` for a vertex without faces.
///
/// # Errors
/// [`Unlimited::Size`] if the disc is too large.
pub(super) fn located(
    around: &dyn Neighbourhoods,
    v: u32,
    rings: RingCount,
) -> Result<Option<(Located, VertexParameters)>, Unlimited> {
    let Some(centre) = around.centre(v as usize) else { return Ok(None) };
    let found = around.disc(centre, rings).ok_or(Unlimited::Size)?;
    let parameters = around.parameters(&found.vertices);
    Ok(Some((found, parameters)))
}

/// Checks that points converge in the middles of faces that are not those of a regular net.
///
/// # Errors
/// [`Unlimited::Rough`] and [`Unlimited::Stopped`]; a middle that cannot be followed for another reason is accepted.
fn middles_settle(middles: &[Disc], masks: &Masks<'_>) -> Result<(), Unlimited> {
    for middle in middles {
        if let Err(error @ (Unlimited::Rough | Unlimited::Stopped(_))) = masks.of(0, middle) {
            return Err(error);
        }
    }
    Ok(())
}
