//! Control polygons.

use super::attributes::Attributes;
use crate::fault::{Fault, under};

/// Most coordinates a point may have.
pub const MAX_DIMENSION: usize = 4;

/// A control polygon: `points` holds `n x dimension` coordinates in model units.
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    /// Coordinates, point after point.
    pub points: Vec<f64>,
    /// Coordinates a point, 1 to 4.
    pub dimension: usize,
    /// Whether the last point is joined to the first.
    pub closed: bool,
    /// Indices of points that keep their place, ascending.
    pub corners: Vec<u32>,
    /// Whether points are homogeneous: the last coordinate is a weight, by which the others are divided at the end.
    pub rational: bool,
    /// Parameters that points carry, if any.
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
        for (i, point) in points.iter().enumerate() {
            check_point(i, point, dimension, &mut faults);
        }
        let corners = check_corners(corners, points.len(), &mut faults);
        if !faults.is_empty() {
            return Err(faults);
        }
        Ok(Self {
            points: points.iter().flatten().map(|x| x + 0.0).collect(),
            dimension,
            closed,
            corners,
            rational: false,
            attributes: None,
        })
    }

    /// The polygon with homogeneous points.
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

    /// The polygon with parameters of its points.
    ///
    /// # Errors
    /// When there is not one number a point.
    pub fn carrying(self, attributes: Attributes) -> Result<Self, Vec<Fault>> {
        attributes.check(self.len()).map_err(|faults| under("/parameters", faults))?;
        Ok(Self { attributes: Some(attributes), ..self })
    }

    /// Coordinates of a point of the result.
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

fn check_point(i: usize, point: &[f64], dimension: usize, faults: &mut Vec<Fault>) {
    let place = format!("/points/{i}");
    if point.is_empty() || point.len() > MAX_DIMENSION {
        faults.push(Fault::new(place, format!("{} coordinates; a point has 1 to {MAX_DIMENSION}", point.len())));
    } else if point.len() != dimension {
        let detail = format!("{} coordinates where point 0 has {dimension}; give all points the same", point.len());
        faults.push(Fault::new(place, detail));
    } else if let Some(j) = point.iter().position(|x| !x.is_finite()) {
        faults.push(Fault::new(format!("{place}/{j}"), format!("{} is not a finite number", point[j])));
    }
}

/// Corner indices in ascending order.
fn check_corners(corners: &[u64], n: usize, faults: &mut Vec<Fault>) -> Vec<u32> {
    let mut found = Vec::with_capacity(corners.len());
    for (i, &corner) in corners.iter().enumerate() {
        match u32::try_from(corner) {
            Ok(index) if (index as usize) < n => found.push(index),
            _ => {
                let detail = format!("there is no point {corner}; the polygon has {n}, counted from 0");
                faults.push(Fault::new(format!("/corners/{i}"), detail));
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}
