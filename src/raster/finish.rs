//! Finishes: non-realistic shading that helps to judge the shape of a surface.

#![expect(clippy::cast_possible_truncation, reason = "colours and directions need no more than the precision of f32")]

use super::camera::{Camera, Projection, unit};
use super::paint::stripes;
use super::pixmap::linear;
use super::shade::{Vec3f, dot};
use crate::math::functions::atan2;
use crate::math::vector::{cross, times};

/// The finish of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Finish {
    /// The colour, slightly darker where the surface turns away, so that it can be compared with a legend.
    Matt,
    /// The colour without shading.
    Bare,
    /// Clay of this colour in a studio that moves with the camera.
    Matcap,
    /// The components of the unit normal in model coordinates, from -1 to 1, as red, green and blue (sRGB).
    Normals,
    /// Stripes or lines that follow the normal.
    Stripes(Stripes),
}

/// Stripes or lines on a surface, in its colour and a dark one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stripes {
    /// The pattern that the stripes follow.
    pub pattern: StripePattern,
    /// The axis of the pattern in model coordinates, of any length but 0.
    pub axis: [f64; 3],
    /// The number of stripes.
    pub count: f32,
    /// Width of isophotes, pixels.
    pub width_px: f32,
}

/// The pattern of stripes, by the unit normal `n`, the unit viewing direction `d` and its reflection
/// `r = d - 2 (n . d) n`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StripePattern {
    /// `count` dark bands between the axis `a` and its opposite, equally high in `r . a`: dark where
    /// `count (1 + r . a) + 1 / 2`, rounded down, is odd. Both ends are in the middle of light bands.
    Zebra,
    /// The mirror images of `count` thin strips of light around half of the axis, which they are parallel to, far away:
    /// at equal steps of the angle of `r` around the axis, each a fifth of a step wide.
    ReflectionLines,
    /// Lines of equal `n . a`: 0 and the steps of `1 / count` on both sides of it, without the ends 1 and -1.
    Isophotes,
}

/// Share of a step that a reflection line takes.
/// Half of it leaves lines of a pixel on strongly bent parts of pictures of usual size; twice of it looks like a zebra.
const LINE_SHARE: f32 = 0.2;
/// Linear light of dark stripes.
const STRIPE_LIGHT: Vec3f = [0.012, 0.014, 0.02];

/// A finish as seen by a camera.
#[derive(Debug)]
pub(super) struct Finisher {
    finish: Finish,
    axes: [Vec3f; 3],
    frame: [Vec3f; 3],
    /// Direction of a ray: `forward + across * x + along * y` at pixel `(x, y)` from the centre.
    across: Vec3f,
    along: Vec3f,
    centre_px: [f32; 2],
}

impl Finisher {
    pub(super) fn new(finish: Finish, camera: &Camera) -> Self {
        let single = |v: [f64; 3]| v.map(|x| x as f32);
        let axis = if let Finish::Stripes(stripes) = finish { unit(stripes.axis) } else { None };
        let axis = axis.unwrap_or(camera.sky);
        // beside the axis, the angle is counted from the direction to the camera on
        let side = [camera.forward, camera.up].map(|v| {
            unit(cross(axis, v)).filter(|_| {
                let sine = cross(axis, v);
                sine.iter().map(|x| x * x).sum::<f64>() > 1e-6
            })
        });
        let side = side[0].or(side[1]).unwrap_or(camera.right);
        let spread = if camera.projection == Projection::Perspective { 1.0 / camera.focal_px } else { 0.0 };
        Self {
            finish,
            axes: [single(axis), single(side), single(cross(side, axis))],
            frame: [single(camera.right), single(camera.up), single(camera.forward)],
            across: single(times(spread, camera.right)),
            along: single(times(-spread, camera.up)),
            centre_px: [(0.5 * camera.size_px[0]) as f32, (0.5 * camera.size_px[1]) as f32],
        }
    }

    /// Returns the linear light of a surface of this colour at a place in a tile, in pixels; the first pixel of the
    /// tile is at `corner`. `normal` gives the normal at a place, of any length, and 1 if the inside is seen, else 0.
    pub(super) fn color(
        &self,
        color: Vec3f,
        normal: impl Fn([f32; 2]) -> [f32; 4],
        place: [f32; 2],
        corner: [f32; 2],
    ) -> Vec3f {
        let towards = 1.0 - 2.0 * normal(place)[3];
        let at = |place: [f32; 2]| {
            let [x, y] = [corner[0] + place[0] - self.centre_px[0], corner[1] + place[1] - self.centre_px[1]];
            let ray = std::array::from_fn(|k| self.frame[2][k] + self.across[k] * x + self.along[k] * y);
            let [x, y, z, _] = normal(place);
            (normalized([x, y, z]).map(|c| towards * c), normalized(ray))
        };
        let (n, ray) = at(place);
        match self.finish {
            Finish::Bare => color,
            Finish::Matt => color.map(|c| c * self.shade(n, ray)),
            Finish::Matcap => self.clay(color, n, ray),
            Finish::Normals => n.map(|c| linear_of(0.5 + 0.5 * towards * c)),
            Finish::Stripes(stripes) => {
                let here = self.measure(&stripes, n, ray);
                let period = if stripes.pattern == StripePattern::ReflectionLines { 2.0 * stripes.count } else { 0.0 };
                let slope = [[1.0, 0.0], [0.0, 1.0]].map(|[x, y]| {
                    let (n, ray) = at([place[0] + x, place[1] + y]);
                    let step = self.measure(&stripes, n, ray) - here;
                    if period > 0.0 { step - period * (step / period + 0.5).floor() } else { step }
                });
                let wide = (slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
                let dark = stripes.darkness(here, if wide < 1e6 { wide } else { 1e6 });
                let shade = self.shade(n, ray);
                std::array::from_fn(|k| shade * (color[k] + (STRIPE_LIGHT[k] - color[k]) * dark))
            }
        }
    }

    /// Returns the value that a pattern follows, in steps of the pattern.
    fn measure(&self, stripes: &Stripes, n: Vec3f, ray: Vec3f) -> f32 {
        if stripes.pattern == StripePattern::Isophotes {
            return stripes.count * dot(n, self.axes[0]);
        }
        let twice = 2.0 * dot(n, ray);
        let mirrored: Vec3f = std::array::from_fn(|k| ray[k] - twice * n[k]);
        if stripes.pattern == StripePattern::Zebra {
            return stripes.count * (1.0 + dot(mirrored, self.axes[0])) + 0.5;
        }
        let [x, y] = [dot(mirrored, self.axes[1]), dot(mirrored, self.axes[2])].map(f64::from);
        stripes.count * (atan2(x, y) / std::f64::consts::PI) as f32
    }

    /// Returns the brightness of a matt surface, 0 to 1: greatest where it faces the viewer, with a little light from
    /// the upper left.
    fn shade(&self, n: Vec3f, ray: Vec3f) -> f32 {
        let facing = positive(-dot(n, ray));
        let above =
            0.5 + 0.5 * (0.62 * dot(n, self.frame[1]) - 0.48 * dot(n, self.frame[0]) - 0.62 * dot(n, self.frame[2]));
        0.42 + 0.33 * facing + 0.25 * positive(above).min(1.0)
    }

    /// Returns the linear light of clay under a broad light from the upper left, a cool one from the lower right, and a
    /// soft spot.
    fn clay(&self, color: Vec3f, n: Vec3f, ray: Vec3f) -> Vec3f {
        let [x, y, z] = [dot(n, self.frame[0]), dot(n, self.frame[1]), positive(-dot(n, ray))];
        let key = positive(0.5 + 0.5 * (-0.46 * x + 0.62 * y + 0.63 * z));
        let fill = positive(0.78 * x - 0.52 * y + 0.30 * z);
        let away = 1.0 - z.min(1.0);
        let rim = away * away * away;
        let spot = positive(-0.34 * x + 0.48 * y + 0.81 * z);
        let spot = spot * spot * spot * spot;
        let spot = spot * spot * spot;
        let warm = [1.06, 0.99, 0.93];
        let cool = [0.16, 0.20, 0.29];
        std::array::from_fn(|k| {
            let diffuse = 0.15 + 1.12 * key * key * warm[k] + fill * cool[k];
            let matt = color[k] * diffuse * (1.0 - 0.45 * rim);
            matt + (0.22 * spot + 0.10 * rim * fill) * positive(1.0 - matt)
        })
    }
}

/// Least growth of the number of an isophote over a pixel. A surface on which it grows less counts as a plane, since
/// normals in f32 make some 1e-6 of it by rounding. Half of it is closer to that; twice of it widens lines that are
/// more than 5,000 pixels apart.
const LEAST_ISOPHOTE_GROWTH: f32 = 1e-4;

impl Stripes {
    /// Returns the dark fraction, 0 to 1, of a pixel at `at` over which the pattern grows by `wide`.
    fn darkness(&self, at: f32, wide: f32) -> f32 {
        match self.pattern {
            StripePattern::Zebra => 0.5 - 0.5 * stripes(at, wide),
            StripePattern::ReflectionLines => {
                // the integral from 0 of 1 on lines, which lie about whole numbers
                let integral = |t: f32| {
                    let from = t + 0.5 * LINE_SHARE;
                    LINE_SHARE * from.floor() + (from - from.floor()).min(LINE_SHARE)
                };
                if wide > 1e-3 {
                    ((integral(at + 0.5 * wide) - integral(at - 0.5 * wide)) / wide).clamp(0.0, 1.0)
                } else {
                    let from = at + 0.5 * LINE_SHARE;
                    if from - from.floor() < LINE_SHARE { 1.0 } else { 0.0 }
                }
            }
            StripePattern::Isophotes => {
                let last = self.count - 1.0;
                let off = (at - (at + 0.5).floor().clamp(-last, last)).abs();
                let off_px = off / wide.max(LEAST_ISOPHOTE_GROWTH);
                let line = (0.5 * self.width_px + 0.5 - off_px).clamp(0.0, 1.0);
                // where steps are narrower than two lines, what is dark of them on average
                let crowded = (2.0 * self.width_px * wide - 0.5).clamp(0.0, 1.0);
                line + ((self.width_px * wide).min(0.5) - line) * crowded
            }
        }
    }
}

/// Returns a vector scaled to length one; zero if it has no direction.
fn normalized(v: Vec3f) -> Vec3f {
    let largest = v[0].abs().max(v[1].abs()).max(v[2].abs());
    if !(largest > 0.0 && largest < f32::INFINITY) {
        return [0.0; 3];
    }
    let v = v.map(|x| x / largest);
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

fn positive(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
}

/// Returns the linear light of an sRGB component from 0 to 1, rounded to a byte.
#[expect(clippy::cast_sign_loss, reason = "the number is from 0 to 255")]
fn linear_of(x: f32) -> f32 {
    linear((x.clamp(0.0, 1.0) * 255.0 + 0.5) as u8)
}
