//! The visibility of lines behind the surface of a tile.

use super::binned_model::BinnedModel;
use super::samples::Samples;
use super::triangle::{NOBODY, SAMPLES, slope};

/// Lines on a surface are lifted toward the viewer by this share of the radius of the scene.
/// Half of it lets lines sink into coarse triangles beside them; twice of it lets lines behind an edge show through
/// sooner.
const LINE_LIFT: f64 = 1e-3;
/// On steep surfaces lines are lifted by at most this share of the radius of the scene.
/// Half of it breaks lines on surfaces seen along their plane; twice of it lets lines behind a silhouette show through.
const STEEP_LIFT: f64 = 1e-2;

/// The samples of a tile, which hide the lines behind them.
pub(super) struct Veil<'a> {
    model: &'a BinnedModel<'a>,
    samples: &'a Samples,
    reach_px: f32,
    lift: [f32; 2],
    steep: [f32; 2],
    known: u32,
    slope: f32,
}

impl<'a> Veil<'a> {
    pub(super) fn new(model: &'a BinnedModel<'a>, samples: &'a Samples, half_px: f32) -> Self {
        let nearer = model.camera.nearer();
        #[expect(clippy::cast_possible_truncation, reason = "a lift needs no last digit")]
        let lifted = |share: f64| nearer.map(|c| (c * share * model.camera.radius) as f32);
        Self {
            model,
            samples,
            reach_px: half_px + 1.0,
            lift: lifted(LINE_LIFT),
            steep: lifted(STEEP_LIFT),
            known: NOBODY,
            slope: 0.0,
        }
    }

    /// Returns the share of a pixel, 0 to 1, in which a line of this depth is seen. The line is lifted a little, so
    /// that lines on a surface lie over it also where the surface is steep.
    pub(super) fn seen(&mut self, pixel: usize, depth: f32) -> f32 {
        let near = self.lift[0] + self.lift[1] * depth * depth;
        let most = self.steep[0] + self.steep[1] * depth * depth;
        let mut n = 0_u8;
        for s in 0..SAMPLES {
            let owner = self.samples.owner[pixel][s];
            let surface = self.samples.depth[pixel][s];
            if owner == NOBODY || depth + near >= surface {
                n += 1;
            } else if depth + most >= surface {
                if owner != self.known {
                    let [x, y] = slope(&self.model.corners(owner).map(|corner| *corner));
                    #[expect(clippy::cast_possible_truncation, reason = "a lift needs no last digit")]
                    let steepness = (x.abs() + y.abs()) as f32;
                    (self.known, self.slope) = (owner, steepness);
                }
                n += u8::from(depth + near + self.slope * self.reach_px >= surface);
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "four samples")]
        let all = SAMPLES as f32;
        f32::from(n) / all
    }
}
