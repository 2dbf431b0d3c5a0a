//! When a model has a shadow, and what hollows look like.

use super::*;
use crate::kept::Kept;
use crate::watch::Watch;

const GROUNDED_STYLE: RenderStyle =
    RenderStyle { background: [255; 4], is_fine: true, is_occluded: true, shadow: Ground::Stood };
const PICTURE_SIZE: [u32; 2] = [160, 120];

fn picture(view: &View, positions: &[[f64; 3]], triangles: &[[u32; 3]], look: RenderStyle) -> Kept<u8> {
    let surface = TriangleAppearance::Lit([120, 160, 220, 255]);
    let model = Model { positions, triangles, normals: ShadingNormals::Planes, surface, strokes: &[] };
    let camera = Camera::framing(view, &[positions], PICTURE_SIZE[0], PICTURE_SIZE[1]);
    render(&model, &camera, look, PICTURE_SIZE, &Watch::new()).expect("nobody says stop").bytes
}

/// Whether the shadow of a model is seen: whether some pixel is darker with it than without.
fn has_shadow(view: &View, positions: &[[f64; 3]], triangles: &[[u32; 3]], shadow: Ground) -> bool {
    let without = picture(view, positions, triangles, RenderStyle { shadow: Ground::None, ..GROUNDED_STYLE });
    let with = picture(view, positions, triangles, RenderStyle { shadow, ..GROUNDED_STYLE });
    with.iter().zip(without.iter()).any(|(with, without)| without.saturating_sub(*with) > 10)
}

/// A box with these opposite corners.
fn block(low: [f64; 3], high: [f64; 3]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let corner = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 1 { high[k] } else { low[k] });
    let quads = [[0, 2, 3, 1], [0, 1, 5, 4], [0, 4, 6, 2], [7, 6, 4, 5], [7, 3, 2, 6], [7, 5, 1, 3]];
    ((0..8).map(corner).collect(), quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect())
}

/// Two square pyramids, one upside down: it touches the ground with a tip.
fn octahedron() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let positions = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].map(|[x, z]| [x, 0.0, z]);
    let tips = [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]];
    let triangles = (0..4).flat_map(|k| [[k, 4, (k + 1) % 4], [(k + 1) % 4, 5, k]]).collect();
    (positions.into_iter().chain(tips).collect(), triangles)
}

#[test]
fn what_stands_has_a_shadow_and_what_balances_or_lies_flat_has_none() {
    let view = View::default();
    let (positions, triangles) = block([0.0; 3], [1.0, 1.0, 1.0]);
    assert!(has_shadow(&view, &positions, &triangles, Ground::Stood));
    assert!(!has_shadow(&view, &positions, &triangles, Ground::None));
    let (positions, triangles) = octahedron();
    assert!(!has_shadow(&view, &positions, &triangles, Ground::Stood), "on its tip");
    assert!(has_shadow(&view, &positions, &triangles, Ground::Always));
    let (positions, triangles) = block([0.0; 3], [1.0, 0.01, 1.0]);
    assert!(!has_shadow(&view, &positions, &triangles, Ground::Stood), "a sheet");
    // an arm that reaches far beyond its foot
    let (mut positions, mut triangles) = block([0.0; 3], [0.2, 1.0, 0.2]);
    let (arm, faces) = block([0.2, 0.9, 0.0], [3.0, 1.1, 0.2]);
    triangles.extend(faces.iter().map(|face| face.map(|v| v + 8)));
    positions.extend(arm);
    assert!(!has_shadow(&view, &positions, &triangles, Ground::Stood), "it would fall");
}

#[test]
fn the_ground_is_seen_from_above_only_and_along_whatever_axis_is_up() {
    let (positions, triangles) = block([0.0; 3], [1.0, 1.0, 1.0]);
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let from = |elevation_rad, up| View { projection, elevation_rad, up, ..View::default() };
        for up in [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]] {
            assert!(has_shadow(&from(0.4, up), &positions, &triangles, Ground::Stood), "{projection:?} {up:?}");
            assert!(!has_shadow(&from(-0.4, up), &positions, &triangles, Ground::Always), "{projection:?} {up:?}");
        }
    }
}

/// A floor and a wall, and their mean brightness.
#[test]
fn hollows_are_darker_and_convex_models_keep_their_light() {
    let view = View { azimuth_rad: 0.7, elevation_rad: 0.5, ..View::default() };
    let mean = |positions: &[[f64; 3]], triangles: &[[u32; 3]], is_occluded| {
        let look = RenderStyle { is_occluded, shadow: Ground::None, ..GROUNDED_STYLE };
        let bytes = picture(&view, positions, triangles, look);
        bytes.iter().map(|&byte| f64::from(byte)).sum::<f64>() / f64::from(PICTURE_SIZE[0] * PICTURE_SIZE[1])
    };
    let (positions, triangles) = block([0.0; 3], [1.0, 1.0, 1.0]);
    let change = mean(&positions, &triangles, false) - mean(&positions, &triangles, true);
    assert!(change.abs() < 0.05, "a box is changed by {change}");
    let room = [
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [1.0, 0.0, 1.0],
        [0.0, 0.0, 1.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 1.0],
    ];
    let walls = [[0, 2, 1], [0, 3, 2], [0, 1, 5], [0, 5, 4], [0, 4, 6], [0, 6, 3]];
    let change = mean(&room, &walls, false) - mean(&room, &walls, true);
    assert!(change > 1.0, "the corner of a room is changed by {change}");
}

#[test]
fn lines_behind_a_surface_are_as_faint_as_they_are_asked_to_be() {
    let (positions, triangles) = block([0.0; 3], [1.0, 1.0, 1.0]);
    let view = View { azimuth_rad: 0.0, elevation_rad: 0.0, ..View::default() };
    let camera = Camera::framing(&view, &[&positions], PICTURE_SIZE[0], PICTURE_SIZE[1]);
    let line = [[0.0, 0.5, -1.0], [1.0, 0.5, -1.0]];
    let red = |hidden| {
        let strokes = Strokes {
            positions: &line,
            segments: &[[0, 1]],
            width_px: 9.0,
            color: [255, 0, 0, 255],
            crowding: Crowding::Keep,
            hidden,
        };
        let surface = TriangleAppearance::Lit([0, 0, 0, 255]);
        let normals = ShadingNormals::Planes;
        let model = Model { positions: &positions, triangles: &triangles, normals, surface, strokes: &[strokes] };
        let look = RenderStyle { is_occluded: false, shadow: Ground::None, ..GROUNDED_STYLE };
        let bytes = render(&model, &camera, look, PICTURE_SIZE, &Watch::new()).expect("nobody says stop").bytes;
        let [width, height] = PICTURE_SIZE.map(|side| side as usize);
        bytes[4 * (height / 2 * width + width / 2)]
    };
    let (none, faint, all) = (red(0.0), red(0.2), red(1.0));
    assert!(none + 40 < faint && faint + 40 < all && all == 255, "{none} {faint} {all}");
}
