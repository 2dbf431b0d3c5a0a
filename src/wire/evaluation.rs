//! Requests for evaluations of the limit surface, and their answers.

use std::fmt;

use serde::de::{Deserializer, Error, IgnoredAny, SeqAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use serde_json::value::RawValue;
use utoipa::ToSchema;

use super::choice::choice;
use super::variants::{InputSchema, PlanSchema};
use super::whole;
use super::{fixed, schema};
use crate::fault::Fault;
use crate::job::{Evaluated, Quantity};
use crate::math::vector::Vector;
use crate::solid::evaluate::{Jet, Place};

/// What is asked of the limit surface of a mesh.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct EvaluationRequest {
    /// Version of this notation; 1 when left out.
    #[schema(minimum = 1, maximum = 1)]
    #[serde(default, deserialize_with = "whole::optional")]
    pub spec: Option<u64>,
    /// The mesh, as in a job.
    #[schema(value_type = InputSchema)]
    pub input: Box<RawValue>,
    /// The plan, as in a job: `catmull-clark`.
    #[schema(value_type = PlanSchema)]
    pub plan: Box<RawValue>,
    /// Places on input faces, at most a million: `[face, u, v]`, u and v from 0 to 1. On a quad corner 0 is at (0, 0),
    /// u runs towards corner 1 and v towards corner 3. Another face has a square for each of its corners, `[face, u, v,
    /// corner]` (0 when left out): the corner is at (0, 0), u runs to the middle of the edge to the next corner, v to
    /// that of the edge to the corner before, and the centre is at (1, 1).
    #[serde(default)]
    #[schema(schema_with = schema::places)]
    pub at: Vec<PlaceRequest>,
    /// Points, at most a million, whose closest places on the surface are looked for: `n x 3`, model units.
    #[serde(default, deserialize_with = "fixed::list")]
    #[schema(schema_with = schema::points_in_space)]
    pub closest: Vec<[f64; 3]>,
    /// What is answered of each place; `position` and `normal` when left out.
    #[serde(default)]
    #[schema(max_items = 16)]
    pub values: Option<Vec<ValueRequest>>,
}

choice! {
    /// What is answered of a place.
    pub enum ValueRequest means Quantity {
        /// The position: `positions`.
        Position = "position",
        /// The unit normal: `normals`.
        Normal = "normal",
        /// The derivatives along u and v: `du`, `dv`.
        Derivatives = "derivatives",
        /// The second derivatives: `duu`, `duv`, `dvv`.
        SecondDerivatives = "second_derivatives",
        /// The curvatures: `principal`, `mean`, `gaussian`.
        Curvatures = "curvatures",
    }
}

/// A place as clients write it: a face, u, v and optionally a corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceRequest([f64; 4]);

impl<'de> Deserialize<'de> for PlaceRequest {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(PlaceVisitor)
    }
}

struct PlaceVisitor;

impl<'de> Visitor<'de> for PlaceVisitor {
    type Value = PlaceRequest;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list [face, u, v] or [face, u, v, corner]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<PlaceRequest, A::Error> {
        let (mut found, mut n) = ([0.0; 4], 0);
        while n < 4 {
            let Some(number) = list.next_element()? else { break };
            found[n] = number;
            n += 1;
        }
        while list.next_element::<IgnoredAny>()?.is_some() {
            n += 1;
        }
        if (3..=4).contains(&n) { Ok(PlaceRequest(found)) } else { Err(A::Error::invalid_length(n, &self)) }
    }
}

impl PlaceRequest {
    /// Creates a place from face, u, v and corner.
    pub fn new(numbers: [f64; 4]) -> Self {
        Self(numbers)
    }

    /// Returns the place, or the index of the first invalid number with the reason.
    fn resolve(self) -> Result<Place, (usize, String)> {
        let Self([face, u, v, corner]) = self;
        let whole = |entry: usize, x: f64, what: &str| {
            let is_whole = x >= 0.0 && x <= f64::from(u32::MAX) && x.fract() == 0.0;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is whole and within range")]
            let found = x as u32;
            is_whole.then_some(found).ok_or_else(|| (entry, format!("{x} is no number of a {what}")))
        };
        Ok(Place { face: whole(0, face, "face")?, corner: whole(3, corner, "corner")?, uv: [u, v] })
    }
}

/// Converts a list of places.
///
/// # Errors
/// The first fault, with a pointer below the request.
pub fn places(written: &[PlaceRequest]) -> Result<Vec<Place>, Vec<Fault>> {
    let each = written.iter().enumerate();
    each.map(|(i, place)| {
        place.resolve().map_err(|(entry, detail)| vec![Fault::new(format!("/at/{i}/{entry}"), detail)])
    })
    .collect()
}

impl EvaluationRequest {
    /// Returns the JSON text of a job with the mesh and plan of the request.
    pub fn job(&self) -> String {
        let (input, plan) = (self.input.get(), self.plan.get());
        let spec = self.spec.map(|spec| format!("\"spec\":{spec},")).unwrap_or_default();
        format!("{{{spec}\"input\":{input},\"plan\":{plan},\"levels\":0,\"outputs\":[{{\"format\":\"stats\"}}]}}")
    }

    /// Returns the quantities to be evaluated at each place.
    ///
    /// # Errors
    /// A fault if the request names no place or no value.
    pub fn values(&self) -> Result<Vec<Quantity>, Vec<Fault>> {
        if self.at.is_empty() && self.closest.is_empty() {
            let detail = "there is no place; give some as [face, u, v], or points in \"closest\"";
            return Err(vec![Fault::new("/at", detail)]);
        }
        match &self.values {
            None => Ok(vec![Quantity::Position, Quantity::Normal]),
            Some(none) if none.is_empty() => Err(vec![Fault::new("/values", "nothing is asked for; name some values")]),
            Some(values) => Ok(values.iter().map(|&value| value.into()).collect()),
        }
    }
}

/// What was found.
#[derive(Debug, Serialize, ToSchema)]
pub struct EvaluationAnswer {
    /// The values at the places of `at`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at: Option<SurfaceValuesAnswer>,
    /// The places closest to the points of `closest`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closest: Option<ClosestAnswer>,
}

/// The places of the surface closest to points, each a list with an entry a point in the order of the request.
#[derive(Debug, Serialize, ToSchema)]
pub struct ClosestAnswer {
    /// The places, as `at` has them: of faces and corners that share one, the lowest.
    #[schema(value_type = Vec<Vec<f64>>)]
    pub at: Vec<WrittenPlace>,
    /// Their positions, model units.
    #[schema(value_type = Vec<Vec<f64>>)]
    pub positions: Vec<Vector>,
    /// How far the points are from them, model units.
    pub distances: Vec<f64>,
    /// For how many points the search ended before all other places were ruled out: they are as far from much of the
    /// surface as from the place that was found, such as the middle of a ball. Of the others no place is nearer, by
    /// more than 1e-9 of the size of the surface.
    pub uncertain: usize,
}

/// A place for an answer, serialized with the corner only if it is not 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrittenPlace(Place);

impl Serialize for WrittenPlace {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Place { face, corner, uv: [u, v] } = self.0;
        if corner == 0 { (face, u, v).serialize(serializer) } else { (face, u, v, corner).serialize(serializer) }
    }
}

/// Values at places, each a list with an entry a place in the order of the request; those that were not asked for are
/// left out. Entries are null where the surface has no such value: derivatives and curvatures at vertices around which
/// it is not bicubic, normals where there is no tangent plane.
#[derive(Debug, Default, Serialize, ToSchema)]
pub struct SurfaceValuesAnswer {
    /// Positions, model units.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<Vec<f64>>>)]
    pub positions: Option<Vec<Vector>>,
    /// Unit normals, to the side from which the face is seen counter-clockwise.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<Option<Vec<f64>>>>)]
    pub normals: Option<Vec<Option<Vector>>>,
    /// Derivatives along u, model units.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<Option<Vec<f64>>>>)]
    pub du: Option<Vec<Option<Vector>>>,
    /// Derivatives along v, model units.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<Option<Vec<f64>>>>)]
    pub dv: Option<Vec<Option<Vector>>>,
    /// Second derivatives along u, model units.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<Option<Vec<f64>>>>)]
    pub duu: Option<Vec<Option<Vector>>>,
    /// Derivatives along u and v, model units.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<Option<Vec<f64>>>>)]
    pub duv: Option<Vec<Option<Vector>>>,
    /// Second derivatives along v, model units.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<Option<Vec<f64>>>>)]
    pub dvv: Option<Vec<Option<Vector>>>,
    /// Principal curvatures, the larger first, 1 / model units: positive where the surface bends away from its normal,
    /// as a sphere does whose normals point outwards.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Vec<Option<Vec<f64>>>>)]
    pub principal: Option<Vec<Option<[f64; 2]>>>,
    /// Their means.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean: Option<Vec<Option<f64>>>,
    /// Their products.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gaussian: Option<Vec<Option<f64>>>,
}

impl EvaluationAnswer {
    /// Creates the answer with the requested quantities.
    pub fn new(found: &Evaluated, values: &[Quantity]) -> Self {
        let at = (!found.at.is_empty()).then(|| SurfaceValuesAnswer::new(&found.at, values));
        let closest = (!found.closest.is_empty()).then(|| ClosestAnswer {
            at: found.closest.iter().map(|closest| WrittenPlace(closest.place)).collect(),
            positions: found.closest.iter().map(|closest| plain(closest.at)).collect(),
            distances: found.closest.iter().map(|closest| closest.distance).collect(),
            uncertain: found.closest.iter().filter(|closest| !closest.is_certain).count(),
        });
        Self { at, closest }
    }
}

impl SurfaceValuesAnswer {
    fn new(jets: &[Jet], values: &[Quantity]) -> Self {
        let vectors = |value: fn(&Jet) -> Option<Vector>| Some(jets.iter().map(|jet| value(jet).map(plain)).collect());
        let mut answer = Self::default();
        for quantity in values {
            match quantity {
                Quantity::Position => answer.positions = Some(jets.iter().map(|jet| plain(jet.at)).collect()),
                Quantity::Normal => answer.normals = vectors(|jet| jet.normal),
                Quantity::Derivatives => {
                    answer.du = vectors(|jet| jet.first.map(|[du, _]| du));
                    answer.dv = vectors(|jet| jet.first.map(|[_, dv]| dv));
                }
                Quantity::SecondDerivatives => {
                    answer.duu = vectors(|jet| jet.second.map(|[duu, _, _]| duu));
                    answer.duv = vectors(|jet| jet.second.map(|[_, duv, _]| duv));
                    answer.dvv = vectors(|jet| jet.second.map(|[_, _, dvv]| dvv));
                }
                Quantity::Curvatures => {
                    let principal: Vec<_> = jets.iter().map(|jet| jet.principal.map(plain)).collect();
                    let each = |value: fn([f64; 2]) -> f64| principal.iter().map(|both| both.map(value)).collect();
                    answer.mean = Some(each(|[k, l]| 0.5 * (k + l)));
                    answer.gaussian = Some(each(|[k, l]| k * l));
                    answer.principal = Some(principal);
                }
            }
        }
        answer
    }
}

/// Replaces -0 by 0.
fn plain<const N: usize>(numbers: [f64; N]) -> [f64; N] {
    numbers.map(|x| x + 0.0)
}
