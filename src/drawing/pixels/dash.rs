//! Splits dashed lines into separate lines, where they are visible.

use tiny_skia::{Pixmap, Transform};

use crate::drawing::scene::{Point, PolylinePoints};

/// Returns left, top, right and bottom of the visible part of a group, in its pixels, with room for the line width.
pub(super) fn visible(pixmap: &Pixmap, transform: Transform, width_px: f32) -> [f32; 4] {
    #[expect(clippy::cast_precision_loss, reason = "pictures have some thousand pixels a side")]
    let [w, h] = [pixmap.width() as f32, pixmap.height() as f32];
    let [left, top] = [-transform.tx / transform.sx, -transform.ty / transform.sy];
    [left - width_px, top - width_px, left + w / transform.sx + width_px, top + h / transform.sy + width_px]
}

/// Returns the dashes of a line; `pattern` alternates lengths of dashes and gaps.
pub(super) fn dashes(run: &[Point], pattern: &[f32], seen: [f32; 4]) -> Vec<PolylinePoints> {
    let period: f64 = pattern.iter().copied().map(f64::from).sum();
    let mut found: Vec<PolylinePoints> = Vec::new();
    // position in the period, which continues around corners
    let mut phase = 0.0;
    for pair in run.windows(2) {
        let [a, b] = [pair[0].map(f64::from), pair[1].map(f64::from)];
        let step = [b[0] - a[0], b[1] - a[1]];
        let length = (step[0] * step[0] + step[1] * step[1]).sqrt();
        if length == 0.0 {
            continue;
        }
        if let Some([from, to]) = inside(a, step, seen) {
            let place = |s: f64| [a[0] + s / length * step[0], a[1] + s / length * step[1]];
            for [start, end] in on(phase + from * length, phase + to * length, pattern, period) {
                extend(&mut found, [place(start - phase), place(end - phase)]);
            }
        }
        phase = (phase + length) % period;
    }
    found
}

/// Returns the range of parameters for which the segment from `a` along `step` is inside the rectangle.
fn inside(a: [f64; 2], step: [f64; 2], [left, top, right, bottom]: [f32; 4]) -> Option<[f64; 2]> {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (k, low, high) in [(0, left, right), (1, top, bottom)] {
        let [low, high] = [f64::from(low) - a[k], f64::from(high) - a[k]];
        if step[k] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
        } else {
            let [near, far] =
                if step[k] > 0.0 { [low / step[k], high / step[k]] } else { [high / step[k], low / step[k]] };
            from = from.max(near);
            to = to.min(far);
        }
    }
    (from < to).then_some([from, to])
}

/// Returns the dashes between two lengths along a line.
fn on(from: f64, to: f64, pattern: &[f32], period: f64) -> Vec<[f64; 2]> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "as many as there is room for in a picture"
    )]
    let n_periods = ((to - from) / period) as usize + 2;
    let first = (from / period).floor();
    let mut found = Vec::new();
    for i in 0..n_periods {
        #[expect(clippy::cast_precision_loss, reason = "as many as there is room for in a picture")]
        let mut at = (first + i as f64) * period;
        for (k, length) in pattern.iter().enumerate() {
            let end = at + f64::from(*length);
            if k % 2 == 0 && end > from && at < to {
                found.push([at.max(from), end.min(to)]);
            }
            at = end;
        }
    }
    found
}

/// Adds a dash, or extends the last one if that ends at its start.
fn extend(found: &mut Vec<PolylinePoints>, [start, end]: [[f64; 2]; 2]) {
    #[expect(clippy::cast_possible_truncation, reason = "pixel coordinates need no more than the precision of f32")]
    let [start, end] = [start, end].map(|place| place.map(|x| x as f32));
    let joins = |run: &&mut PolylinePoints| {
        run.last().is_some_and(|last| {
            let (dx, dy) = (last[0] - start[0], last[1] - start[1]);
            dx * dx + dy * dy < 1e-4
        })
    };
    match found.last_mut().filter(joins) {
        Some(run) => run.push(end),
        None => found.push(vec![start, end]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_go_around_corners_and_are_made_where_they_are_seen() {
        let run = [[0.0, 0.0], [5.0, 0.0], [5.0, 100.0]];
        let found = dashes(&run, &[4.0, 2.0], [-1.0, -1.0, 10.0, 10.0]);
        assert_eq!(found, [vec![[0.0, 0.0], [4.0, 0.0]], vec![[5.0, 1.0], [5.0, 5.0]], vec![[5.0, 7.0], [5.0, 10.0]]]);
        let far = [[-1e30, 5.0], [1e30, 5.0]];
        assert!(dashes(&far, &[4.0, 2.0], [0.0, 0.0, 10.0, 10.0]).len() < 4);
    }
}
