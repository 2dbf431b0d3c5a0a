//! Transforms of prims: their operations in the order of `xformOpOrder`.

use super::tree::Prim;
use crate::input::text::quoted;
use crate::input::transform::{AFFINE, Transform};
use crate::math::functions::{cos, sin};
use crate::math::vector::{cross, dot, times};

/// Returns the transform of a prim, composed with the transform of its parent.
///
/// # Errors
/// An operation is unknown, has the wrong number of values, or cannot be inverted.
pub(super) fn of(prim: &Prim<'_>, outer: &Transform) -> Result<Transform, String> {
    let order = prim.value("xformOpOrder").map_or(&[][..], |order| &order.words);
    let mut all = *outer;
    for &name in order {
        if name == "!resetXformStack!" {
            all = Transform::IDENTITY;
            continue;
        }
        let (name, is_inverse) = name.strip_prefix("!invert!").map_or((name, false), |name| (name, true));
        let numbers = prim.numbers(name);
        let step = operation(name, numbers).and_then(|step| if is_inverse { inverse(&step) } else { Some(step) });
        let step = step.ok_or_else(|| {
            format!("the operation {} of its transform with {} numbers is not known", quoted(name), numbers.len())
        })?;
        all = all.after(&step);
    }
    Ok(all)
}

/// Returns the transform of an operation by its name, such as `xformOp:rotateXYZ:pivot`. Angles are in degrees,
/// quaternions begin with their real part, and matrices act on row vectors.
fn operation(name: &str, numbers: &[f64]) -> Option<Transform> {
    if numbers.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let kind = name.strip_prefix("xformOp:")?.split(':').next()?;
    match (kind, numbers) {
        ("translate", &[x, y, z]) => Some(moved([x, y, z])),
        ("translateX", &[x]) => Some(moved([x, 0.0, 0.0])),
        ("translateY", &[y]) => Some(moved([0.0, y, 0.0])),
        ("translateZ", &[z]) => Some(moved([0.0, 0.0, z])),
        ("scale", &[x, y, z]) => Some(scaled([x, y, z])),
        ("scaleX", &[x]) => Some(scaled([x, 1.0, 1.0])),
        ("scaleY", &[y]) => Some(scaled([1.0, y, 1.0])),
        ("scaleZ", &[z]) => Some(scaled([1.0, 1.0, z])),
        ("orient", &[w, x, y, z]) => Transform::rotation([x, y, z, w]),
        ("transform", numbers) => {
            let rows: &[f64; 16] = numbers.try_into().ok()?;
            let row = |i: usize| [rows[4 * i], rows[4 * i + 1], rows[4 * i + 2]];
            let is_affine = [rows[3], rows[7], rows[11], rows[15] - 1.0].iter().all(|x| x.abs() <= AFFINE);
            is_affine.then(|| Transform([row(0), row(1), row(2), row(3)]))
        }
        (kind, angles) => {
            let axes = kind.strip_prefix("rotate")?;
            let axis = |letter: u8| [b'X', b'Y', b'Z'].iter().position(|&known| known == letter);
            match (axes.as_bytes(), angles) {
                (&[letter], &[angle]) => Some(rotated(axis(letter)?, angle)),
                (&[first, second, third], angles) if angles.len() == 3 => {
                    let turn = |letter: u8| axis(letter).map(|axis| rotated(axis, angles[axis]));
                    let is_all = first != second && second != third && third != first;
                    let turned = turn(third)?.after(&turn(second)?).after(&turn(first)?);
                    is_all.then_some(turned)
                }
                _ => None,
            }
        }
    }
}

fn moved(by: [f64; 3]) -> Transform {
    let [x, y, z, _] = Transform::IDENTITY.0;
    Transform([x, y, z, by])
}

fn scaled([x, y, z]: [f64; 3]) -> Transform {
    Transform([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z], [0.0; 3]])
}

/// Returns the rotation around an axis, counter-clockwise if the axis points at the viewer; quarter turns are exact.
fn rotated(axis: usize, degrees: f64) -> Transform {
    let turn = degrees.rem_euclid(360.0);
    let quarters = [270.0, 180.0, 90.0].iter().position(|&least| turn >= least).map_or(0, |i| 3 - i);
    let rest = turn.rem_euclid(90.0).to_radians();
    let [c, s] = [cos(rest), sin(rest)];
    let [cos, sin] = [[c, s], [-s, c], [-c, -s], [s, -c]][quarters];
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut columns = Transform::IDENTITY.0;
    (columns[i][i], columns[i][j]) = (cos, sin);
    (columns[j][i], columns[j][j]) = (-sin, cos);
    Transform(columns)
}

/// Returns the inverse; `None` if the map is singular.
fn inverse(of: &Transform) -> Option<Transform> {
    let [a, b, c, t] = of.0;
    let rows = [cross(b, c), cross(c, a), cross(a, b)];
    let volume = dot(a, rows[0]);
    let rows = rows.map(|row| times(1.0 / volume, row));
    let columns = [0, 1, 2].map(|j| rows.map(|row| row[j]));
    let all = Transform([columns[0], columns[1], columns[2], rows.map(|row| 0.0 - dot(row, t))]);
    all.0.as_flattened().iter().all(|x| x.is_finite()).then_some(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::functions::sqrt;

    /// Returns the bits of a point, ignoring the sign of zeros.
    fn bits(point: [f64; 3]) -> [u64; 3] {
        point.map(|x| (x + 0.0).to_bits())
    }

    #[test]
    fn operations_apply_the_last_one_first_and_quarters_are_exact() {
        let step = |name: &str, numbers: &[f64]| operation(name, numbers).expect(name);
        let turned = step("xformOp:rotateZ", &[90.0]);
        assert_eq!(bits(turned.point([1.0, 0.0, 0.0])), bits([0.0, 1.0, 0.0]));
        let both = step("xformOp:translate", &[1.0, 2.0, 3.0]).after(&turned);
        assert_eq!(bits(both.point([1.0, 0.0, 0.0])), bits([1.0, 3.0, 3.0]));
        // around x first, then y, then z
        let all = step("xformOp:rotateXYZ", &[90.0, 0.0, 90.0]);
        assert_eq!(bits(all.point([0.0, 0.0, 1.0])), bits(turned.point([0.0, -1.0, 0.0])));
        let half = sqrt(0.5);
        let found = step("xformOp:orient", &[half, 0.0, 0.0, half]).point([1.0, 0.0, 0.0]);
        assert!((found[0].abs() < 1e-15) && (found[1] - 1.0).abs() < 1e-15, "{found:?}");
    }

    #[test]
    fn inverses_undo() {
        let step = |name: &str, numbers: &[f64]| operation(name, numbers).expect(name);
        let there = step("xformOp:translate:pivot", &[1.0, -2.0, 3.0])
            .after(&step("xformOp:rotateX", &[30.0]).after(&step("xformOp:scale", &[2.0, 3.0, -4.0])));
        let back = inverse(&there).expect("it is not flat").point(there.point([0.5, 0.25, -7.0]));
        assert!(back.iter().zip([0.5, 0.25, -7.0]).all(|(a, b)| (a - b).abs() < 1e-14), "{back:?}");
        assert_eq!(inverse(&scaled([1.0, 0.0, 1.0])), None);
        assert_eq!(operation("xformOp:rotateXXY", &[1.0, 2.0, 3.0]), None);
        assert_eq!(operation("xformOp:scale", &[1.0]), None);
    }
}
