//! A plan as a surface scheme: its regular rule, and the report on each valence.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use super::blocks::{FourierBlock, components, row};
use super::boundary::BoundaryReport;
use super::characteristic::{CharacteristicNet, RingProof, ring};
use super::local::{Applied, LocalRows, closed};
use super::regular::RegularMask;
use super::sectors::{LatticePoint, NetKind, PlaneNet, WEIGHT_ROUNDING};
use super::smoothness::RegularSmoothness;
use super::spectrum::{LocalEigenvalue, PointWeight, Spectrum};
use super::survey::{Extraordinary, on_boundary, survey};
use super::verdict::{Case, Criterion};
use crate::analysis::limit::Unlimited;
use crate::math::dense::dot;
use crate::scheme::operator::Children;
use crate::scheme::plan::Plan;
use crate::shape::tile::Tile;
use crate::shape::topology::Topology;
use crate::watch::{Stopped, Watch};

/// Maximum number of points of a reported characteristic net; enough for valence 12 with three rings. Half of it leaves
/// out the outer ring at large valences; twice of it makes answers about many valences twice as long.
const MAX_NET_POINTS: usize = 512;
/// Number of rings by which the ring of the characteristic map may move outwards until the regular rules apply on it.
/// Rules beside extraordinary vertices reach one ring farther at most. Half or twice of it decides alike.
const MORE_RINGS: i32 = 2;

/// A plan as a surface scheme.
#[derive(Debug)]
pub struct SurfaceStudy {
    applied: Applied,
    /// The rule of regular nets.
    pub regular: RegularMask,
    /// The bounds needed to prove characteristic maps regular, computed on first use.
    proof: OnceLock<Option<RingProof>>,
}

/// The report on one valence.
#[derive(Debug, Clone)]
pub struct ValenceReport {
    /// The valence of the vertex, or the number of corners of the face.
    pub valence: usize,
    /// The eigenvalues with their Fourier indices, the largest first.
    pub eigenvalues: Vec<LocalEigenvalue>,
    /// The ratio of the absolute value of the next eigenvalue to the subdominant one, the largest of Fourier index 1,
    /// if that is real and positive.
    pub ratio: Option<f64>,
    /// The weights of the limit position.
    pub limit_mask: Vec<PointWeight>,
    /// The weights of two tangents; `None` without a subdominant eigenvalue.
    pub tangent_masks: Option<[Vec<PointWeight>; 2]>,
    /// The net of the characteristic map: points and faces.
    pub net: Option<PlaneNet>,
    /// The least sine of the corner angles of the net.
    pub least_sine: Option<f64>,
    /// The criteria for C^1.
    pub criteria: Vec<Criterion>,
}

impl SurfaceStudy {
    /// Resolves a plan on meshes to its surface scheme.
    ///
    /// # Errors
    /// [`Unlimited`].
    pub fn of(plan: &Plan, watch: &Watch) -> Result<Self, Unlimited> {
        if plan.perturbation.is_some_and(|perturbation| perturbation.amplitude != 0.0) {
            return Err(Unlimited::Later("it is perturbed at random".into()));
        }
        let mut failed = Unlimited::NoUpsampling;
        for kind in kinds(plan) {
            match Applied::new(plan, kind, watch) {
                Ok(applied) => {
                    let regular = RegularMask::of(&applied, watch)?;
                    return Ok(Self { applied, regular, proof: OnceLock::new() });
                }
                Err(stopped @ Unlimited::Stopped(_)) => return Err(stopped),
                Err(error) => failed = error,
            }
        }
        Err(failed)
    }

    /// Returns the number of applications of the cycle after which directions are kept.
    pub fn applications(&self) -> u32 {
        self.applied.applications
    }

    /// Returns the extraordinary vertices inside a mesh, and the faces that are or become extraordinary, by valence.
    pub fn survey(&self, topology: &Topology) -> BTreeMap<usize, Extraordinary> {
        survey(self.applied.kind, topology)
    }

    /// Returns the boundary vertices of a mesh by their number of faces.
    pub fn on_boundary(&self, topology: &Topology) -> BTreeMap<usize, Extraordinary> {
        on_boundary(topology)
    }

    /// Returns the smoothness of limits of regular nets, as far as `nodes` matrix products prove it.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn smoothness(&self, nodes: u64, watch: &Watch) -> Result<RegularSmoothness, Stopped> {
        RegularSmoothness::of(&self.regular, nodes, watch)
    }

    /// Analyses boundary vertices with a given number of faces.
    ///
    /// # Errors
    /// [`Unlimited`].
    pub fn boundary(
        &self,
        faces: usize,
        smoothness: &RegularSmoothness,
        watch: &Watch,
    ) -> Result<BoundaryReport, Unlimited> {
        self.applied.boundary(faces, &self.regular, smoothness.is_c1(), watch)
    }

    /// Analyses a valence.
    ///
    /// # Errors
    /// [`Unlimited`].
    pub fn valence(
        &self,
        valence: usize,
        smoothness: &RegularSmoothness,
        watch: &Watch,
    ) -> Result<ValenceReport, Unlimited> {
        let kind = self.applied.kind;
        let (from, farthest) = ring(&self.regular);
        let local = |farthest: i32| {
            let local = self.applied.wide_enough(valence, farthest, watch)?.ok_or(Unlimited::Unsettled)?;
            let radius = closed(farthest, local.reach(kind), |radius| local.reach_of(kind, radius))?;
            Ok::<_, Unlimited>((radius, local))
        };
        let d = self.regular.arity;
        let mut ring = None;
        let mut found = local(farthest)?;
        for more in 0..=MORE_RINGS {
            if more > 0 {
                found = local(farthest + d * more)?;
            }
            if self.is_regular_beyond(valence, d * (from + more), &found.1) {
                let proof = || self.proof.get_or_init(|| RingProof::new(&self.regular)).as_ref();
                ring = if smoothness.proved_c >= 1 { proof().map(|proof| (proof, more)) } else { None };
                break;
            }
        }
        let (radius, local) = found;
        let spectrum = Spectrum::of(kind, valence, radius, &local, watch)?.ok_or(Unlimited::Unsettled)?;
        let vector = spectrum.subdominant().map(|value| (value, spectrum.blocks[1].matrix.eigenvector(value)));
        let net = vector.as_ref().and_then(|(value, vector)| net(&spectrum, &local, *value, vector));
        let least_sine = net.as_ref().map(|net| net.least_sine(kind, farthest));
        let case = Case { spectrum: &spectrum, regular: smoothness.is_c1(), ring, net: net.as_ref(), least_sine };
        let criteria = case.criteria(watch)?;
        let tangent_masks = vector.as_ref().map(|(value, right)| {
            let left = spectrum.blocks[1].matrix.transposed().eigenvector(*value);
            let scale = scale(&spectrum, right);
            let product = dot(&left, right);
            let left: Vec<f64> = left.iter().map(|l| l * scale / product).collect();
            spectrum.tangent_masks(&left)
        });
        Ok(ValenceReport {
            valence,
            ratio: spectrum.subdominant().map(|value| spectrum.next().0 / value),
            limit_mask: spectrum.limit_mask(),
            tangent_masks,
            net: net.map(|net| shown(kind, &net)),
            least_sine,
            eigenvalues: spectrum.sorted(),
            criteria,
        })
    }

    /// Returns whether all new points that influence cells from a radius on follow the rules of the regular net.
    fn is_regular_beyond(&self, n: usize, radius: i32, local: &LocalRows) -> bool {
        let (kind, d, mask) = (self.applied.kind, self.regular.arity, &self.regular.mask);
        let ends = RegularMask::ends(mask);
        let reach = ends.iter().map(|end| (end[1] + d - 2).div_euclid(d - 1)).max().unwrap_or(1) - 1;
        let n = i32::try_from(n).unwrap_or(i32::MAX);
        local.rows.iter().filter(|(p, _)| kind.radius(**p) >= radius - reach).all(|(p, row)| {
            let mut left: BTreeMap<Option<(usize, LatticePoint)>, f64> = BTreeMap::new();
            for &(place, weight) in row {
                *left.entry(place).or_insert(0.0) += weight;
            }
            for (k, a) in mask.iter().filter(|(k, _)| (0..2).all(|axis| (p[axis] - k[axis]) % d == 0)) {
                let old = [0, 1].map(|axis| (p[axis] - k[axis]) / d);
                let place = match kind.unfolded(old) {
                    Some((sector, point)) => Some((usize::try_from(sector.rem_euclid(n)).unwrap_or(0), point)),
                    None if kind.has_centre() && old == [0, 0] => None,
                    None => return false,
                };
                *left.entry(place).or_insert(0.0) -= a;
            }
            left.values().all(|x| x.abs() <= WEIGHT_ROUNDING)
        })
    }
}

/// Returns the kinds of nets on which a plan may be regular, the most likely first.
fn kinds(plan: &Plan) -> Vec<NetKind> {
    let children = || plan.word.cycle.iter().map(|letter| letter.facts().children);
    let duals = children().filter(|children| *children == Children::Dual).count();
    // which of the two kinds of quads fits also depends on the order of U and D
    let quads = if duals % 2 == 1 || children().any(|children| children == Children::Faces) {
        [NetKind::Dual, NetKind::Quads]
    } else {
        [NetKind::Quads, NetKind::Dual]
    };
    if plan.tile() == Tile::Triangle { vec![NetKind::Triangles] } else { [&quads[..], &[NetKind::Triangles]].concat() }
}

/// Returns the value of the first point of a sector, by which the eigenvector is divided to place this point at 1.
fn scale(spectrum: &Spectrum, vector: &[f64]) -> f64 {
    FourierBlock::values(&spectrum.blocks[1].components, vector).first().map_or(1.0, |(_, u)| u[0])
}

/// Returns the net of an eigenvector, as far as the rows reach, scaled to place its first point at 1.
fn net(spectrum: &Spectrum, local: &LocalRows, value: f64, vector: &[f64]) -> Option<CharacteristicNet> {
    let (kind, n) = (spectrum.kind, spectrum.n);
    let scale = scale(spectrum, vector);
    if scale == 0.0 {
        return None;
    }
    let known = &spectrum.blocks[1].components;
    let farthest = local.rows.keys().map(|&p| kind.radius(p)).max()?;
    let all = components(kind, farthest, 1);
    let entry = |component: &super::blocks::Component| {
        let weights = row(kind, n, 1, local, *component, known)?;
        Some(dot(&weights, vector) / (value * scale))
    };
    let extended: Vec<f64> = all.iter().map(entry).collect::<Option<_>>()?;
    Some(CharacteristicNet { n, values: FourierBlock::values(&all, &extended).into_iter().collect() })
}

/// Returns the points and faces of a net, in as many rings as a report has.
fn shown(kind: NetKind, net: &CharacteristicNet) -> (Vec<[f64; 2]>, Vec<Vec<usize>>) {
    let farthest = net.values.keys().map(|&p| kind.radius(p)).max().unwrap_or(0);
    let fits = |radius: &i32| kind.points(*radius).len() * net.n < MAX_NET_POINTS;
    let radius = (1..=farthest).rev().find(fits).unwrap_or(1).min(farthest);
    let star = super::star::Star::new(kind, net.n, radius);
    let place = |place: &Option<(usize, LatticePoint)>| match place {
        None => [0.0; 2],
        Some((sector, point)) => {
            let sector = i32::try_from(*sector).unwrap_or(0);
            net.place(kind, sector, *point).unwrap_or([0.0; 2])
        }
    };
    let topology = &star.net.mesh.base;
    let face = |f: usize| topology.face(f).iter().map(|&v| v as usize).collect();
    (star.places.iter().map(place).collect(), (0..topology.n_faces()).map(face).collect())
}
