//! Pictures against mathematics: areas, shared edges, clipping, and very many triangles.

use proptest::prelude::*;

use super::*;
use crate::math::vector::{cross, dot, minus};
use crate::watch::Watch;

const PLAIN_STYLE: RenderStyle =
    RenderStyle { background: [0; 4], is_fine: true, is_occluded: false, shadow: Ground::None };

/// The alpha of every pixel of a picture of triangles on a transparent background.
fn alpha(
    camera: &Camera,
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    look: RenderStyle,
    [width, height]: [u32; 2],
) -> Vec<u8> {
    let surface = TriangleAppearance::Lit([120, 160, 220, 255]);
    let model = Model { positions, triangles, normals: ShadingNormals::Planes, surface, strokes: &[] };
    let picture = render(&model, camera, look, [width, height], &Watch::new()).expect("nobody says stop");
    picture.bytes.as_chunks::<4>().0.iter().map(|pixel| pixel[3]).collect()
}

/// A camera that looks along -z at the square from 0 to 1, parallel rays.
fn above(size: u32) -> Camera {
    let view = View { projection: Projection::Orthographic, azimuth_rad: 0.0, elevation_rad: 0.0, ..View::default() };
    Camera::framing(&view, &[&[[0.0; 3], [1.0, 1.0, 0.0]]], size, size)
}

/// Where a point falls in the picture, on the lattice of 1/256 of a pixel on which triangles are drawn.
fn place(camera: &Camera, point: [f64; 3]) -> [f64; 2] {
    camera.place(point).expect("it is in the picture").map(|x| (x * 256.0 + 0.5).floor() / 256.0)
}

/// The area of a convex polygon within the pixel at `(x, y)`.
fn area_within(mut polygon: Vec<[f64; 2]>, [x, y]: [f64; 2]) -> f64 {
    let sides = [[1.0, 0.0, -x], [-1.0, 0.0, x + 1.0], [0.0, 1.0, -y], [0.0, -1.0, y + 1.0]];
    for [a, b, c] in sides {
        let inside = |p: [f64; 2]| a * p[0] + b * p[1] + c;
        let mut kept = Vec::new();
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            let (u, v) = (inside(p), inside(q));
            if u >= 0.0 {
                kept.push(p);
            }
            if (u >= 0.0) != (v >= 0.0) {
                let t = u / (u - v);
                kept.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
            }
        }
        polygon = kept;
    }
    let twice: f64 = (0..polygon.len())
        .map(|i| {
            let (p, q) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            p[0] * q[1] - q[0] * p[1]
        })
        .sum();
    0.5 * twice.abs()
}

/// The least height of a triangle.
fn height(polygon: &[[f64; 2]]) -> f64 {
    let [a, b, c] = [polygon[0], polygon[1], polygon[2]];
    let side = |p: [f64; 2], q: [f64; 2]| {
        let [x, y] = [q[0] - p[0], q[1] - p[1]];
        (x * x + y * y).sqrt()
    };
    let twice = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    twice.abs() / side(a, b).max(side(b, c)).max(side(c, a))
}

const CAMERA_SIDE: u32 = 70;

fn in_square() -> impl Strategy<Value = [f64; 3]> {
    (0.0..1.0, 0.0..1.0).prop_map(|(x, y)| [x, y, 0.0])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// In each pixel within a half, as tips between the four samples that look for edges are missed; on the mean far
    /// less.
    #[test]
    fn the_alpha_of_a_triangle_is_the_area_that_it_covers_of_each_pixel(corners in prop::array::uniform3(in_square())) {
        let camera = above(CAMERA_SIDE);
        let found = alpha(&camera, &corners, &[[0, 1, 2]], PLAIN_STYLE, [CAMERA_SIDE; 2]);
        let polygon = corners.map(|corner| place(&camera, corner)).to_vec();
        prop_assume!(height(&polygon) > 3.0, "slivers escape the four samples that look for edges");
        let (mut errors, mut edges) = (0.0, 0.0);
        for (i, &alpha) in (0_u32..).zip(&found) {
            let exact = area_within(polygon.clone(), [i % CAMERA_SIDE, i / CAMERA_SIDE].map(f64::from));
            let error = (f64::from(alpha) / 255.0 - exact).abs();
            prop_assert!(error < 0.5, "pixel {i}: {alpha} of 255 for an area of {exact}");
            if exact > 0.0 && exact < 1.0 {
                (errors, edges) = (errors + error, edges + 1.0);
            }
        }
        prop_assert!(errors <= 0.05 * edges + 1.0, "{errors} over {edges} pixels");
    }

    /// A square of many triangles, whose inner vertices stand anywhere: every pixel inside is covered once and fully.
    #[test]
    fn shared_edges_leave_no_gap_over_random_meshes(
        n in 1_u32..9,
        moves in prop::collection::vec((-0.45..0.45, -0.45..0.45, -0.4..0.4, any::<bool>()), 100),
        projected in any::<bool>(),
    ) {
        let at = |i: u32, j: u32| {
            let (dx, dy, z, _) = moves[(j * (n + 1) + i) as usize];
            let [left_right, above_below] = [i, j].map(|k| k.is_multiple_of(n));
            let (x, y) = (if left_right { 0.0 } else { dx }, if above_below { 0.0 } else { dy });
            let height = if left_right || above_below { 0.0 } else { z };
            [(f64::from(i) + x) / f64::from(n), (f64::from(j) + y) / f64::from(n), height]
        };
        let places = (0..=n).flat_map(|j| (0..=n).map(move |i| [i, j]));
        let positions: Vec<[f64; 3]> = places.map(|[i, j]| at(i, j)).collect();
        let cut = |i: u32, j: u32| {
            let a = j * (n + 1) + i;
            let [a, b, c, d] = [a, a + 1, a + n + 2, a + n + 1];
            if moves[a as usize].3 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
        };
        let squares = (0..n).flat_map(|j| (0..n).map(move |i| [i, j]));
        let triangles: Vec<[u32; 3]> = squares.flat_map(|[i, j]| cut(i, j)).collect();
        let camera = if projected {
            let (eye, target) = (Some([0.5, 0.5, 1.4]), Some([0.5, 0.5, 0.0]));
            let view = View { eye, target, fov_rad: 0.5, ..View::default() };
            Camera::framing(&view, &[&positions], CAMERA_SIDE, CAMERA_SIDE)
        } else {
            above(CAMERA_SIDE)
        };
        let found = alpha(&camera, &positions, &triangles, PLAIN_STYLE, [CAMERA_SIDE; 2]);
        // from close by the square fills the picture, and from above all but the margin
        let free = if projected { 0 } else { 6 };
        let inside = |i: u32| [i % CAMERA_SIDE, i / CAMERA_SIDE].iter().all(|&u| u >= free && u < CAMERA_SIDE - free);
        let gaps = (0_u32..).zip(&found).filter(|&(i, &alpha)| inside(i) && alpha != 255).count();
        prop_assert_eq!(gaps, 0);
    }

    /// A pixel whose four corners see a triangle sees nothing else, wherever its corners stand: beyond the picture,
    /// behind the camera, or both.
    #[test]
    fn what_reaches_behind_the_camera_is_cut_where_it_is_seen(
        corners in prop::array::uniform3(prop::array::uniform3(-30.0..30.0_f64)),
        fov_rad in 0.3..2.5,
    ) {
        let eye = [0.1, 0.2, 0.3];
        let view = View { eye: Some(eye), target: Some([4.0, 1.0, -7.0]), fov_rad, ..View::default() };
        let size = [61, 47];
        let camera = Camera::framing(&view, &[&corners], size[0], size[1]);
        let found = alpha(&camera, &corners, &[[0, 1, 2]], PLAIN_STYLE, size);
        let [a, b, c] = corners.map(|corner| minus(corner, eye));
        let sees = |x: f64, y: f64| {
            let (x, y) = ((x - 30.5) / camera.focal_px, (23.5 - y) / camera.focal_px);
            let ray: [f64; 3] =
                std::array::from_fn(|k| camera.forward[k] + x * camera.right[k] + y * camera.up[k]);
            let sides = [dot(ray, cross(a, b)), dot(ray, cross(b, c)), dot(ray, cross(c, a))];
            let volume = dot(a, cross(b, c));
            // beyond the near plane, and not just beside an edge
            sides.iter().all(|side| side * volume > 1e-3 * volume.abs())
                && volume.abs() / sides.iter().sum::<f64>().abs() > 2.0 * camera.near
        };
        let is_front = [a, b, c].iter().any(|&corner| dot(corner, camera.forward) > camera.near);
        for (i, &alpha) in (0_u32..).zip(&found) {
            let [x, y] = [i % size[0], i / size[0]].map(f64::from);
            prop_assert!(is_front || alpha == 0, "what stands behind the camera is seen at {x}, {y}");
            if [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].iter().all(|[u, v]| sees(x + u, y + v)) {
                prop_assert_eq!(alpha, 255, "pixel {}, {}", x, y);
            }
        }
    }

    #[test]
    fn triangles_without_area_are_not_seen(a in in_square(), b in in_square(), t in 0.0..1.0_f64) {
        let camera = above(CAMERA_SIDE);
        let flat = [a, b, [a[0], a[1], 1.0]];
        let triangles = [[0, 0, 1], [1, 1, 1], [0, 2, 0], [0, 2, 2], [0, 1, 0]];
        prop_assert!(alpha(&camera, &flat, &triangles, PLAIN_STYLE, [CAMERA_SIDE; 2]).iter().all(|&alpha| alpha == 0));
        // seen along its plane
        let upright = [a, b, [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), 1.0]];
        let thin = alpha(&camera, &upright, &[[0, 1, 2]], PLAIN_STYLE, [CAMERA_SIDE; 2]);
        prop_assert!(thin.iter().all(|&alpha| alpha < 64));
    }
}

/// The grey values along an edge that is crossed slowly.
fn grey_values(look: RenderStyle) -> usize {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.03, 0.0], [0.0, 1.0, 0.0]];
    let mut found = alpha(&above(700), &positions, &[[0, 1, 2]], look, [700; 2]);
    found.sort_unstable();
    found.dedup();
    found.len()
}

#[test]
fn edges_have_seventeen_grey_values_and_in_drafts_five() {
    assert_eq!(grey_values(PLAIN_STYLE), 17);
    assert_eq!(grey_values(RenderStyle { is_fine: false, ..PLAIN_STYLE }), 5);
}

/// A flat square of very many triangles of less than a pixel has the outline of two triangles.
#[test]
fn a_million_tiny_triangles_cover_what_two_do() {
    // unoptimised code takes a second for a tenth of it
    let n: u32 = if cfg!(debug_assertions) { 224 } else { 708 };
    let point = |i: u32, j: u32| [f64::from(i) / f64::from(n), f64::from(j) / f64::from(n), 0.0];
    let positions: Vec<[f64; 3]> = (0..=n).flat_map(|j| (0..=n).map(move |i| point(i, j))).collect();
    let quad = |i: u32, j: u32| {
        let a = j * (n + 1) + i;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    };
    let triangles: Vec<[u32; 3]> = (0..n).flat_map(|j| (0..n).flat_map(move |i| quad(i, j))).collect();
    let camera = above(CAMERA_SIDE);
    let many = alpha(&camera, &positions, &triangles, PLAIN_STYLE, [CAMERA_SIDE; 2]);
    let two = alpha(
        &camera,
        &[point(0, 0), point(n, 0), point(n, n), point(0, n)],
        &[[0, 1, 2], [0, 2, 3]],
        PLAIN_STYLE,
        [CAMERA_SIDE; 2],
    );
    assert_eq!(many, two);
}
