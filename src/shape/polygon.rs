//! Control polygons.

use super::attributes::Attributes;
use super::indices::{MAX_REPORTED, check_indices};
use crate::fault::{Fault, under};
use crate::math::vector::reduce;

/// Maximum number of coordinates of a point.
pub const MAX_DIMENSION: usize = 4;

/// A control polygon: `points` holds `n x dimension` coordinates in model units.
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    /// Coordinates, point after point.
    pub points: Vec<f64>,
    /// Number of coordinates per point, 1 to 4.
    pub dimension: usize,
    /// Whether the last point is joined to the first.
    pub closed: bool,
    /// Indices of corners, which keep their position; ascending.
    pub corners: Vec<u32>,
    /// Whether points are homogeneous: the last coordinate is a weight, and results are divided by it.
    pub rational: bool,
    /// Unit tangents, `n x dimension`, if they are given.
    pub tangents: Option<Vec<f64>>,
    /// Indices of points whose tangents stay fixed, ascending.
    pub pinned: Vec<u32>,
    /// Vertex parameters, if any.
    pub attributes: Option<Attributes>,
}

impl Polygon {
    /// Checks and builds a polygon from its points.
    ///
    /// # Errors
    /// Every fault, with a pointer below the polygon: too few points, unequal or unfit dimensions, coordinates that are
    /// not finite, corners out of range or named twice.
    pub fn new(points: &[Vec<f64>], closed: bool, corners: &[u64]) -> Result<Self, Vec<Fault>> {
        let mut faults = Vec::new();
        let least = if closed { 3 } else { 2 };
        if points.len() < least {
            let kind = if closed { "a closed" } else { "an open" };
            let detail = format!("{kind} polygon needs at least {least} points; this one has {}", points.len());
            faults.push(Fault::new("/points", detail));
        }
        let dimension = points.first().map_or(1, Vec::len);
        let wrong = points.iter().enumerate().filter_map(|(i, point)| check_point(i, point, dimension));
        faults.extend(wrong.take(MAX_REPORTED));
        let corners = check_indices("/corners", "point", corners, ("polygon", points.len()), &mut faults);
        if !faults.is_empty() {
            return Err(faults);
        }
        Ok(Self {
            points: points.iter().flatten().map(|x| x + 0.0).collect(),
            dimension,
            closed,
            corners,
            rational: false,
            tangents: None,
            pinned: Vec::new(),
            attributes: None,
        })
    }

    /// Returns the polygon with homogeneous points.
    ///
    /// # Errors
    /// When there is no coordinate besides the weight, or a weight is 0.
    pub fn rational(self) -> Result<Self, Vec<Fault>> {
        if self.dimension < 2 {
            let detail = "rational points have a weight as their last coordinate; give at least 2 coordinates";
            return Err(vec![Fault::new("/rational", detail)]);
        }
        let last = self.dimension - 1;
        let weightless = self.points.chunks_exact(self.dimension).position(|point| point[last] == 0.0);
        match weightless {
            Some(i) => Err(vec![Fault::new(format!("/points/{i}/{last}"), "a weight of 0 is a point at infinity")]),
            None => Ok(Self { rational: true, ..self }),
        }
    }

    /// Returns the polygon with vertex parameters.
    ///
    /// # Errors
    /// If a parameter does not have one number per point.
    pub fn carrying(self, attributes: Attributes) -> Result<Self, Vec<Fault>> {
        attributes.check(self.len()).map_err(|faults| under("/parameters", faults))?;
        Ok(Self { attributes: Some(attributes), ..self })
    }

    /// Returns the polygon with tangents, of any length but 0, and with the points whose tangents stay fixed.
    ///
    /// # Errors
    /// If there is not one tangent per point, if a tangent has no direction or the wrong dimension, or if a pinned
    /// point does not exist.
    pub fn steered(self, tangents: Option<&[Vec<f64>]>, pinned: &[u64]) -> Result<Self, Vec<Fault>> {
        let mut faults = Vec::new();
        let mut pinned = check_indices("/pinned", "point", pinned, ("polygon", self.len()), &mut faults);
        // at the ends of an open polygon, tangents stay fixed in any case
        pinned.retain(|&i| self.closed || i > 0 && i as usize + 1 < self.len());
        let tangents = tangents.map(|tangents| self.directions(tangents, &mut faults));
        if faults.is_empty() { Ok(Self { tangents, pinned, ..self }) } else { Err(faults) }
    }

    /// Scales one vector per point to length 1.
    fn directions(&self, tangents: &[Vec<f64>], faults: &mut Vec<Fault>) -> Vec<f64> {
        if tangents.len() != self.len() {
            let detail = format!("{} tangents for {} points; give one a point", tangents.len(), self.len());
            faults.push(Fault::new("/tangents", detail));
        }
        let mut directions = Vec::with_capacity(self.points.len());
        let most_faults = faults.len() + MAX_REPORTED;
        for (i, tangent) in tangents.iter().enumerate() {
            let place = format!("/tangents/{i}");
            if faults.len() == most_faults {
                break;
            }
            let mut direction: Vec<f64> = tangent.iter().map(|x| x + 0.0).collect();
            if tangent.len() != self.dimension {
                let detail =
                    format!("{} coordinates; points have {}, and so have tangents", tangent.len(), self.dimension);
                faults.push(Fault::new(place, detail));
            } else if let Some(j) = tangent.iter().position(|x| !x.is_finite()) {
                faults.push(Fault::new(format!("{place}/{j}"), format!("{} is not a finite number", tangent[j])));
            } else if let Some(length) = reduce(&mut direction) {
                directions.extend(direction.iter().map(|x| x / length + 0.0));
            } else {
                faults.push(Fault::new(place, "the vector 0 has no direction; give a tangent of any other length"));
            }
        }
        directions
    }

    /// Returns the number of coordinates of a point of the result.
    pub fn result_dimension(&self) -> usize {
        self.dimension - usize::from(self.rational)
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len() / self.dimension
    }

    /// Whether there are no points; never true for a checked polygon.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
}

fn check_point(i: usize, point: &[f64], dimension: usize) -> Option<Fault> {
    let place = || format!("/points/{i}");
    if point.is_empty() || point.len() > MAX_DIMENSION {
        return Some(Fault::new(place(), format!("{} coordinates; a point has 1 to {MAX_DIMENSION}", point.len())));
    }
    if point.len() != dimension {
        let detail = format!("{} coordinates where point 0 has {dimension}; give all points the same", point.len());
        return Some(Fault::new(place(), detail));
    }
    let j = point.iter().position(|x| !x.is_finite())?;
    Some(Fault::new(format!("{}/{j}", place()), format!("{} is not a finite number", point[j])))
}
