//! Light: what colour a surface has, given its normal and where the viewer is.
//!
//! Three lamps move with the camera (key from the upper left, a cooler fill from the right, a rim from behind), and the
//! hemisphere of the sky brightens what points up in the model. All light is linear; bytes are made at the very end.

#![expect(clippy::cast_possible_truncation, reason = "colours and directions need no more than the precision of f32")]

use super::camera::{Camera, Projection, unit};
use super::pixmap::linear;
use crate::math::vector::{Vector, plus, times};

pub(super) type Vec3f = [f32; 3];

#[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
#[inline(always)]
pub(super) fn dot(a: Vec3f, b: Vec3f) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The lamps of a picture, in model directions, and the surface they fall on.
#[derive(Debug)]
pub(super) struct Lamps {
    key: Vec3f,
    fill: Vec3f,
    rim: Vec3f,
    sky: Vec3f,
    /// Halfway between key lamp and viewer.
    gleam: Vec3f,
    forward: Vec3f,
    /// Direction of a ray: `forward + right * x + down * y` at pixel `(x, y)` from the centre.
    across: Vec3f,
    along: Vec3f,
    centre_px: [f32; 2],
    /// Linear light of a surface of one colour.
    pub(super) outside: Vec3f,
}

const KEY_DIRECTION: [f64; 3] = [-0.48, 0.62, 0.62];
const FILL_DIRECTION: [f64; 3] = [0.80, 0.05, 0.45];
const RIM_DIRECTION: [f64; 3] = [0.25, 0.65, -0.72];

const KEY_LIGHT: Vec3f = [0.93, 0.90, 0.855];
const FILL_LIGHT: Vec3f = [0.13, 0.15, 0.185];
const RIM_LIGHT: Vec3f = [0.30, 0.32, 0.36];
const SKY_LIGHT: Vec3f = [0.25, 0.275, 0.315];
const GROUND_LIGHT: Vec3f = [0.115, 0.105, 0.10];
/// How much brighter the surroundings are in metal than they light what is matt.
/// It is a choice of looks: half of it makes metal nearly black where no lamp is mirrored, twice of it makes it pale.
const METAL_BRIGHTNESS: f32 = 1.6;
/// Share of the light that mirrors at the surface, straight on.
/// It is a choice of looks: half of it is duller, twice of it brightens the spots of light.
const SURFACE_GLEAM: f32 = 0.36;

/// Returns the model direction of a direction given by its components to the right, up and towards the viewer.
fn turned(camera: &Camera, [x, y, z]: [f64; 3]) -> Vector {
    let v = plus(plus(times(x, camera.right), times(y, camera.up)), times(-z, camera.forward));
    unit(v).unwrap_or(camera.up)
}

impl Camera {
    /// Returns the direction of the brightest lamp, of length one, which moves with the camera.
    pub fn lamp(&self) -> Vector {
        turned(self, KEY_DIRECTION)
    }
}

impl Lamps {
    /// Creates the lamps for `camera`, falling on a surface of this sRGB colour.
    pub(super) fn new(camera: &Camera, [r, g, b, _]: [u8; 4]) -> Self {
        let single = |v: [f64; 3]| v.map(|x| x as f32);
        let turned = |lamp| turned(camera, lamp);
        let key = camera.lamp();
        let gleam = unit(plus(key, times(-1.0, camera.forward))).unwrap_or(key);
        let spread = if camera.projection == Projection::Perspective { 1.0 / camera.focal_px } else { 0.0 };
        Self {
            key: single(key),
            fill: single(turned(FILL_DIRECTION)),
            rim: single(turned(RIM_DIRECTION)),
            sky: single(camera.sky),
            gleam: single(gleam),
            forward: single(camera.forward),
            across: single(times(spread, camera.right)),
            along: single(times(-spread, camera.up)),
            centre_px: [(0.5 * camera.size_px[0]) as f32, (0.5 * camera.size_px[1]) as f32],
            outside: [linear(r), linear(g), linear(b)],
        }
    }

    /// Returns the linear light that reaches the viewer from the point `place` of the picture. The normal need not have
    /// length one; it points to the outside of the surface, whose colour is `outside` in linear light; `back` is 1
    /// where the inside is seen and otherwise 0, `spread` is the width of its highlights, and `metal` says from 0 to 1
    /// whether it mirrors its surroundings in its colour, which counts where there is `METAL` at all.
    #[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
    #[inline(always)]
    pub(super) fn light<const METAL: bool>(
        &self,
        normal: Vec3f,
        outside: Vec3f,
        place: [f32; 2],
        [back, metal, spread]: [f32; 3],
    ) -> Vec3f {
        let grey = 0.2126 * outside[0] + 0.7152 * outside[1] + 0.0722 * outside[2];
        let inside = outside.map(|c| 0.45 * c + 0.3 * grey);
        let (x, y) = (place[0] - self.centre_px[0], place[1] - self.centre_px[1]);
        let ray: Vec3f = std::array::from_fn(|k| self.forward[k] + self.across[k] * x + self.along[k] * y);
        let scale = (1.0 - 2.0 * back) / dot(normal, normal).sqrt();
        let n = [normal[0] * scale, normal[1] * scale, normal[2] * scale];
        let facing = positive(-dot(n, ray) / dot(ray, ray).sqrt());
        let away = positive(1.0 - facing);
        let edge = away * away * away;
        let key = positive(dot(n, self.key));
        let fill = positive(0.75 * dot(n, self.fill) + 0.25);
        let rim = positive(dot(n, self.rim)) + 0.25 * edge;
        let sky = 0.5 * dot(n, self.sky) + 0.5;
        // wide highlights are fainter, as the light is the same; those that nobody asked for have both factors 1
        let wider = USUAL_SPREAD / spread;
        let peak = if SURFACE_GLEAM * wider < 1.0 { SURFACE_GLEAM * wider } else { 1.0 };
        let rim_gleam = if wider < 1.0 { wider.sqrt() } else { 1.0 };
        let gleam = peak * polished(positive(dot(n, self.gleam)), spread) + 0.10 * edge * sky * rim_gleam;
        let length = dot(ray, ray).sqrt();
        let mirrored: Vec3f = std::array::from_fn(|k| ray[k] / length + 2.0 * facing * n[k]);
        let above = positive(0.5 * dot(mirrored, self.sky) + 0.5);
        let lamp = positive(dot(mirrored, self.key));
        // rough metal mirrors all around its normal
        let rough = positive((spread - USUAL_SPREAD) * (1.0 / (1.0 - USUAL_SPREAD)));
        std::array::from_fn(|k| {
            let ambient = GROUND_LIGHT[k] + (SKY_LIGHT[k] - GROUND_LIGHT[k]) * sky;
            let diffuse = KEY_LIGHT[k] * key + FILL_LIGHT[k] * fill + RIM_LIGHT[k] * rim + ambient;
            let colour = outside[k] + (inside[k] - outside[k]) * back;
            let matt = shoulder(colour * diffuse);
            let plain = matt + gleam * (1.0 - matt);
            if !METAL {
                return plain;
            }
            let around = GROUND_LIGHT[k] + (SKY_LIGHT[k] - GROUND_LIGHT[k]) * (above + rough * (sky - above));
            let mirrored = lamp * lamp;
            let bare =
                shoulder(colour * (METAL_BRIGHTNESS * around + KEY_LIGHT[k] * (mirrored + rough * (key - mirrored))));
            let bare = bare + colour * gleam * (1.0 - bare);
            if metal > 0.0 { plain + metal * (bare - plain) } else { plain }
        })
    }
}

/// Returns `x`, or 0 when it is negative or not a number.
#[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
#[inline(always)]
pub(super) fn positive(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
}

/// Returns the share that is mirrored, 1 where `x` is 1: the lobe of B. Walter et al., EGSR 2007, 195-206, which falls
/// so slowly beside its middle that no rim is seen around a highlight.
#[inline]
fn polished(x: f32, spread: f32) -> f32 {
    let share = spread / (1.0 - (1.0 - spread) * x * x);
    share * share
}

/// The width of the highlights of what says nothing of its roughness, as [`spread`] has it: that of a roughness of
/// 0.47. Half of it makes highlights smaller by a third and shows a rim, twice of it veils the whole model.
pub(super) const USUAL_SPREAD: f32 = 0.05;

/// The least width of highlights, that of a roughness of 0.18: half of it is seen in a pixel here and there where a
/// surface is curved, twice of it makes what is polished look like plastic.
const LEAST_SPREAD: f32 = 1e-3;

/// Returns the width of the highlights of a surface of this roughness, 0 to 1: the fourth power of the roughness, as in
/// glTF 2.0, appendix B.3.
pub(super) fn spread(roughness: Option<f32>) -> f32 {
    let square = |x: f32| x * x;
    roughness.map_or(USUAL_SPREAD, |roughness| square(square(roughness)).clamp(LEAST_SPREAD, 1.0))
}

/// Bends bright light softly below 1, so that highlights keep their shape.
#[inline]
fn shoulder(light: f32) -> f32 {
    // from here on light is bent: at half of it greys become pale, close to 1 highlights lose their shape
    const LIGHT_KNEE: f32 = 0.75;
    let over = positive(light - LIGHT_KNEE);
    light - over + over / (1.0 + over / (1.0 - LIGHT_KNEE))
}
