//! Laws of the rasteriser.

use proptest::prelude::*;

use super::binned_model::BinnedModel;
use super::bins::{TILE, TileGrid};
use super::project::{BEHIND, RIGHT, Vertex, vertices};
use super::samples::Samples;
use super::triangle::{NOBODY, SAMPLES};
use super::*;
use crate::math::vector::{plus, times};
use crate::watch::{Stopped, Watch};

fn at(x: f64, y: f64) -> Vertex {
    #[expect(clippy::cast_possible_truncation, reason = "test places are small")]
    let steps = |u: f64| (u * 256.0) as i32;
    Vertex { x: steps(x), y: steps(y), depth: 0.5, sides: 0 }
}

fn covered(corners: [Vertex; 3]) -> Vec<bool> {
    let mut samples = Samples::new();
    samples.draw(corners.each_ref(), 7, [0, 0]);
    samples.settle([0, 0]);
    samples.owner.iter().flatten().map(|o| *o != NOBODY).collect()
}

/// A fan of triangles around a centre in the tile that covers all of it.
fn fan(centre: [f64; 2], n: u32) -> Vec<[Vertex; 3]> {
    let rim = |k: u32| {
        let angle = f64::from(k % n) / f64::from(n) * std::f64::consts::TAU;
        at(16.0 + 200.0 * crate::math::functions::cos(angle), 16.0 + 200.0 * crate::math::functions::sin(angle))
    };
    (0..n).map(|k| [at(centre[0], centre[1]), rim(k), rim(k + 1)]).collect()
}

#[test]
fn a_triangle_around_the_tile_covers_every_sample_and_its_mirror_image_does_too() {
    let triangle = [at(-300.0, -300.0), at(900.0, -200.0), at(-200.0, 900.0)];
    assert!(covered(triangle).iter().all(|&c| c));
    assert!(covered([triangle[0], triangle[2], triangle[1]]).iter().all(|&c| c));
}

#[test]
fn triangles_that_share_edges_leave_no_gap_and_hit_no_sample_twice() {
    let centres = [[16.0, 16.0], [10.375, 7.125], [0.875, 31.375], [5.3, 6.7], [12.625, 20.0]];
    for (centre, n) in centres.into_iter().flat_map(|c| [3, 4, 7, 64, 360].map(|n| (c, n))) {
        let mut hits = vec![0; TILE * TILE * SAMPLES];
        for triangle in fan(centre, n) {
            covered(triangle).iter().zip(&mut hits).for_each(|(&c, hit)| *hit += u32::from(c));
        }
        assert!(hits.iter().all(|&h| h == 1), "fan of {n} around {centre:?}");
    }
}

#[test]
fn the_order_of_drawing_does_not_matter_and_of_equal_depths_the_lower_number_is_seen() {
    let deep = |depth: f32, corners: [Vertex; 3]| corners.map(|corner| Vertex { depth, ..corner });
    let fans = [([16.0, 16.0], 7, 0.5), ([5.3, 6.7], 64, 0.5), ([10.375, 7.125], 4, 0.25)];
    let triangles: Vec<[Vertex; 3]> = fans
        .into_iter()
        .flat_map(|(centre, n, depth)| fan(centre, n).into_iter().map(move |t| deep(depth, t)))
        .collect();
    let drawn = |order: &mut dyn Iterator<Item = usize>| {
        let mut samples = Samples::new();
        let id = |i: usize| u32::try_from(i).expect("a few triangles");
        order.for_each(|i| samples.draw(triangles[i].each_ref(), id(i), [0, 0]));
        samples.settle([0, 0]);
        samples.owner
    };
    let forward = drawn(&mut (0..triangles.len()));
    assert!(forward.iter().flatten().all(|&owner| owner < 7), "the first fan covers all");
    assert_eq!(forward, drawn(&mut (0..triangles.len()).rev()));
}

#[test]
fn pairs_of_pixels_are_covered_as_single_ones() {
    let ramp = |[a, b, c]: [Vertex; 3]| [a, Vertex { depth: 0.3, ..b }, Vertex { depth: 0.9, ..c }];
    let fans = [([16.0, 16.0], 7), ([5.3, 6.7], 64), ([30.2, 1.9], 360)];
    let [mut pairs, mut single] = [Samples::new(), Samples::new()];
    for (id, triangle) in (0..).zip(fans.into_iter().flat_map(|(centre, n)| fan(centre, n)).map(ramp)) {
        pairs.draw(triangle.each_ref(), id, [0, 0]);
        single.draw_where(triangle.each_ref(), id, [0, 0], |_| true);
    }
    pairs.settle([0, 0]);
    assert_eq!(pairs.owner, single.owner);
    let bits = |samples: &Samples| samples.depth.iter().flatten().map(|depth| depth.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&pairs), bits(&single));
}

/// A waved sheet of `n x n` squares.
fn sheet(n: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let step = 1.0 / f64::from(n);
    let wave = |x: f64, y: f64| 0.2 * crate::math::functions::sin(9.0 * x) * crate::math::functions::cos(7.0 * y);
    let point = |i: u32, j: u32| {
        let (x, y) = (f64::from(i) * step, f64::from(j) * step);
        [x, wave(x, y), y]
    };
    let positions = (0..=n).flat_map(|j| (0..=n).map(move |i| point(i, j))).collect();
    let quad = |i: u32, j: u32| {
        let a = j * (n + 1) + i;
        [[a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1]]
    };
    (positions, (0..n).flat_map(|j| (0..n).flat_map(move |i| quad(i, j))).collect())
}

const OCCLUDED_STYLE: RenderStyle =
    RenderStyle { background: [0; 4], is_fine: true, is_occluded: true, shadow: Ground::Stood };

fn picture(view: &View, positions: &[[f64; 3]], triangles: &[[u32; 3]], size: [u32; 2]) -> Pixmap {
    let segments: Vec<[u32; 2]> = triangles.iter().flat_map(|t| [[t[0], t[1]], [t[1], t[1]]]).collect();
    let strokes = [Strokes {
        positions,
        segments: &segments,
        width_px: 2.0,
        color: [9, 9, 9, 200],
        crowding: Crowding::Fade,
        hidden: 0.25,
    }];
    let surface = TriangleAppearance::Lit([200, 80, 40, 255]);
    let model = Model { positions, triangles, normals: ShadingNormals::Planes, surface, strokes: &strokes };
    let camera = Camera::framing(view, &[positions], size[0], size[1]);
    render(&model, &camera, OCCLUDED_STYLE, size, &Watch::new()).expect("nobody says stop")
}

#[test]
fn the_number_of_threads_does_not_change_a_byte() {
    let (positions, triangles) = sheet(120);
    let with = |n| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads can be started");
        pool.install(|| picture(&View::default(), &positions, &triangles, [200, 150]))
    };
    let one = with(1);
    assert!(one.bytes.chunks(4).filter(|p| p[3] == 255).count() > 3000);
    assert_eq!(one, with(2));
    assert_eq!(one, with(8));
}

#[test]
fn everything_framed_lies_inside_the_margin_and_reaches_it() {
    let (positions, _) = sheet(9);
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let camera = Camera::framing(&View { projection, ..View::default() }, &[&positions], 400, 300);
        let places: Vec<[f64; 2]> =
            positions.iter().filter_map(|&p| camera.segment(p, p)).map(|[place, _]| place).collect();
        assert_eq!(places.len(), positions.len());
        let margin = 0.06 * 300.0;
        let free = places.iter().map(|[x, y]| x.min(400.0 - x).min(*y).min(300.0 - y)).fold(f64::INFINITY, f64::min);
        assert!((free - margin).abs() < 1e-6, "{free} pixels are free, expected {margin}");
    }
}

#[test]
fn strange_shapes_and_cameras_give_a_picture() {
    let triangles = [[0, 1, 2], [0, 0, 1], [2, 1, 0]];
    let shapes: Vec<[[f64; 3]; 3]> = [0.0, 1.0, 1e-6, 1e6, 1e-200, 1e200, f64::MAX, f64::NAN, f64::INFINITY]
        .into_iter()
        .flat_map(|s| {
            let flat = [[s, 0.0, 0.0], [-s, 0.0, 0.0], [0.0, s, 0.0]];
            [flat, [[s, s, s]; 3], [[s, 0.0, 0.0], [1e6 + s, 0.0, 0.0], [1e6, 1e-6, 1e6]]]
        })
        .collect();
    let vectors = [[0.0; 3], [0.0, 1.0, 0.0], [1e-6, 0.0, 0.0], [1e300, -1e300, 0.0], [f64::NAN; 3]];
    let mut views = Vec::new();
    for projection in [Projection::Perspective, Projection::Orthographic] {
        for (zoom, fov_rad) in [(1.0, 0.5), (1e3, 3.2)] {
            for v in vectors {
                let plain = View { projection, fov_rad, zoom, ..View::default() };
                views.extend([
                    plain,
                    View { eye: Some(v), ..plain },
                    View { target: Some(v), up: v, ..plain },
                    View { eye: Some(v), target: Some(v), up: v, ..plain },
                ]);
            }
        }
    }
    for shape in &shapes {
        for view in &views {
            assert_eq!(picture(view, shape, &triangles, [33, 16]).bytes.len(), 33 * 16 * 4);
        }
    }
    assert!(picture(&View::default(), &[], &[], [17, 16]).bytes.iter().all(|&b| b == 0));
}

#[test]
fn a_camera_inside_a_box_sees_walls_in_every_pixel() {
    let positions: Vec<[f64; 3]> = (0..8_u32).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
    let quads = [[0, 2, 3, 1], [0, 1, 5, 4], [0, 4, 6, 2], [7, 6, 4, 5], [7, 3, 2, 6], [7, 5, 1, 3]];
    let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    for target in [[0.9, 0.3, 0.6], [0.0, 0.0, 0.0], [0.5, 0.9999, 0.5], [-3.0, 0.5, 7.0]] {
        let view = View { eye: Some([0.5, 0.01, 0.4]), target: Some(target), fov_rad: 2.0, ..View::default() };
        let seen = picture(&view, &positions, &triangles, [90, 64]);
        assert!(seen.bytes.chunks(4).all(|p| p[3] == 255), "toward {target:?}");
    }
}

#[test]
fn a_stopped_watch_ends_the_picture() {
    let (positions, triangles) = sheet(3);
    let watch = Watch::new();
    watch.stop();
    let surface = TriangleAppearance::Lit([200, 80, 40, 255]);
    let model =
        Model { positions: &positions, triangles: &triangles, normals: ShadingNormals::Planes, surface, strokes: &[] };
    let camera = Camera::framing(&View::default(), &[&positions], 64, 64);
    assert_eq!(render(&model, &camera, OCCLUDED_STYLE, [64, 64], &watch), Err(Stopped));
}

/// Draws a triangle into the tile at `origin`, and checks that it has the samples inside of it and no others; whose
/// those on its edges are is not said.
fn sampled(corners: [Vertex; 3], origin: [i32; 2]) -> Samples {
    let mut samples = Samples::new();
    samples.draw(corners.each_ref(), 7, origin);
    samples.settle(origin);
    let left = |a: Vertex, b: Vertex, [px, py]: [i64; 2]| {
        let [ax, ay, bx, by] = [a.x, a.y, b.x, b.y].map(i64::from);
        (bx - ax) * (py - ay) - (by - ay) * (px - ax)
    };
    let tile = i64::try_from(TILE).expect("a tile is some dozen pixels wide");
    for (i, owners) in (0_i64..).zip(&samples.owner) {
        let (column, row) = (i64::from(origin[0]) + i % tile, i64::from(origin[1]) + i / tile);
        for (owner, place) in owners.iter().zip(super::triangle::SAMPLE_PLACES) {
            let p = [256 * column + 32 * i64::from(place[0]), 256 * row + 32 * i64::from(place[1])];
            let sides = [0, 1, 2].map(|k| left(corners[k], corners[(k + 1) % 3], p));
            if sides.iter().all(|&side| side > 0) || sides.iter().all(|&side| side < 0) {
                assert_eq!(*owner, 7, "sample at {p:?} of {corners:?}");
            } else if sides.iter().any(|&side| side > 0) && sides.iter().any(|&side| side < 0) {
                assert_eq!(*owner, NOBODY, "sample at {p:?} of {corners:?}");
            }
        }
    }
    samples
}

proptest! {
    #[test]
    fn triangles_have_the_samples_inside_of_them_in_every_tile_and_at_its_borders(
        tile in prop::array::uniform2(0..256_i32),
        centre in prop::array::uniform2(-4.0..36.0_f64),
        corners in prop::array::uniform3(prop::array::uniform2(-1.0..1.0_f64)),
        size in prop::sample::select(vec![0.4, 1.0, 3.0, 8.0, 40.0, 3000.0]),
    ) {
        let origin = tile.map(|i| 32 * i);
        let [left, top] = origin.map(f64::from);
        let far = |u: f64| u.clamp(-2047.0, 10_239.0);
        let corner = |[x, y]: [f64; 2]| at(far(left + centre[0] + size * x), far(top + centre[1] + size * y));
        sampled(corners.map(corner), origin);
    }
}

/// Rows of pixels are cut to what slivers may cover: every sample inside is found, and few pixels are looked at.
#[test]
fn slivers_cover_the_samples_inside_them_and_look_at_few_pixels_beside() {
    for k in 0..64_u32 {
        let angle = f64::from(k) / 64.0 * std::f64::consts::TAU + 0.01;
        let (x, y) = (crate::math::functions::cos(angle), crate::math::functions::sin(angle));
        let end = |side: f64| at(16.3 + 300.0 * x - side * y, 15.9 + 300.0 * y + side * x);
        let corners = [at(16.3 - 300.0 * x, 15.9 - 300.0 * y), end(2.0), end(-2.0)];
        let mut samples = sampled(corners, [0, 0]);
        let all = (TILE * TILE) as u64;
        assert!(samples.done().pixels < all / 2, "sliver {k}");
    }
}

/// Beyond the picture, the last tiles have pixels too, whose edges mark those at the border.
#[test]
fn pieces_that_lie_beside_the_picture_are_drawn_into_its_last_tiles() {
    let camera = Camera::framing(&View::default(), &[&[[0.0; 3], [1.0; 3]]], 70, 70);
    let seen = |right: f64, up: f64, forward: f64| {
        let aside = plus(times(right, camera.right), times(up, camera.up));
        plus(camera.eye, plus(aside, times(forward, camera.forward)))
    };
    let on_picture = |[x, y]: [f64; 2]| seen((x - 35.0) / camera.focal_px, (35.0 - y) / camera.focal_px, 1.0);
    let positions = [on_picture([74.0, 20.0]), on_picture([80.0, 50.0]), seen(1.0, 0.0, -0.5)];
    let surface = TriangleAppearance::Lit([200; 4]);
    let normals = ShadingNormals::Planes;
    let model = Model { positions: &positions, triangles: &[[0, 1, 2]], normals, surface, strokes: &[] };
    let grid = TileGrid::of(70, 70);
    let binned = BinnedModel::new(&model, &camera, grid, &Watch::new()).expect("nobody says stop");
    let seen = vertices(&camera, &positions);
    assert!(seen[..2].iter().all(|vertex| vertex.sides == RIGHT));
    assert_eq!(seen[2].sides, BEHIND);
    let touched: Vec<usize> = (0..9).filter(|&tile| binned.touches(tile)).collect();
    assert!(touched.contains(&2), "the last tile of the first row, of {touched:?}");
}
