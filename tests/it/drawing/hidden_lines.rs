//! Visible lines of meshes, compared with known results for simple bodies and with the rasteriser.

use planish::job::limits::{Limits, Refusal};
use planish::math::functions::sqrt;
use planish::raster::{
    Camera, Crowding, Ground, Model, ProjectedPoint, RenderStyle, ShadingNormals, Sight, Strokes, TriangleAppearance,
    View, render as paint,
};
use planish::watch::Watch;
use serde_json::{Value, json};

use crate::support::nets::{self, Net};
use crate::support::{parsed, render};

/// Returns the SVG of an output of a mesh.
pub(super) fn drawn(input: &Value, level: u32, output: &Value) -> String {
    let mut job = json!({ "input": input, "outputs": [output] });
    job["outputs"][0]["format"] = json!("svg");
    if level > 0 {
        job["plan"] = json!({ "preset": "catmull-clark" });
        job["levels"] = json!(level);
    }
    let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    String::from_utf8(bytes).expect("SVG is text")
}

pub(super) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    sqrt(x * x + y * y)
}

/// Returns the total length of the lines of a class in pixels.
fn length(svg: &str, class: &str) -> f64 {
    let step = |pair: &[[f64; 2]]| distance(pair[0], pair[1]);
    lines(svg, class).iter().map(|line| line.windows(2).map(step).sum::<f64>()).sum()
}

/// Returns the lines of a class.
pub(super) fn lines(svg: &str, class: &str) -> Vec<Vec<[f64; 2]>> {
    let Some((_, rest)) = svg.split_once(&format!("class=\"{class}\"")) else { return Vec::new() };
    let (group, _) = rest.split_once("</g>").expect("the group ends");
    let paths = group.split("d=\"M").skip(1).map(|path| path.split('"').next().expect("a path"));
    let places = |path: &str| -> Vec<[f64; 2]> {
        let numbers: Vec<f64> =
            path.replace('L', " ").split(' ').map(|number| number.parse().expect("a number")).collect();
        numbers.as_chunks::<2>().0.to_vec()
    };
    paths.map(places).collect()
}

/// Returns a cube with edges of equal length.
fn straight_cube() -> Net {
    let positions = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
    Net { positions, faces: nets::cube().faces }
}

fn orthographic() -> Value {
    json!({ "projection": "orthographic", "azimuth_deg": 45, "elevation_deg": 35.264_389_682_754_654 })
}

/// Seen along its diagonal, a cube is a hexagon with three edges inside, and hides three more; all have the same
/// length.
#[test]
#[expect(clippy::float_cmp, reason = "no line is as long as exactly 0")]
fn a_cube_along_its_diagonal_shows_nine_of_its_edges() {
    let show = ["silhouettes", "creases", "isolines", "hidden"];
    let svg = drawn(&straight_cube().input(), 0, &json!({ "show": show, "camera": orthographic() }));
    let [outline, inner, hidden] = ["silhouettes", "creases", "hidden"].map(|class| length(&svg, class));
    let edge = outline / 6.0;
    assert!(edge > 100.0, "{svg}");
    assert!((inner - 3.0 * edge).abs() < 0.1 && (hidden - 3.0 * edge).abs() < 0.5, "{outline} {inner} {hidden}");
    assert_eq!(length(&svg, "isolines"), 0.0, "each line is drawn once");
}

/// A smoothed cube is convex apart from its triangles: its outline surrounds it, and hardly any of it is hidden.
#[test]
#[expect(clippy::float_cmp, reason = "no line is as long as exactly 0")]
fn the_outline_of_a_convex_body_is_seen() {
    let svg = drawn(&nets::cube().input(), 4, &json!({ "show": ["silhouettes", "hidden"] }));
    let [outline, hidden] = ["silhouettes", "hidden"].map(|class| length(&svg, class));
    assert!(outline > 1500.0 && hidden < 0.02 * outline, "{outline} seen, {hidden} hidden");
    assert_eq!(length(&svg, "creases") + length(&svg, "boundary"), 0.0);
}

#[test]
fn what_cannot_be_drawn_in_lines_is_told() {
    let refused = |output: Value, levels: u32| {
        let plan = json!({ "preset": "catmull-clark" });
        let job = json!({ "input": nets::cube().input(), "plan": plan, "levels": levels, "outputs": [output] });
        let fault = render(&job).expect_err("it is refused").remove(0);
        (fault.pointer, fault.detail)
    };
    let plan = json!({ "preset": "catmull-clark" });
    let job = json!({ "input": nets::cube().input(), "plan": plan, "levels": 8, "outputs": [{ "format": "svg" }] });
    let job = parsed(job.to_string().as_bytes()).expect("it is a job");
    let Err(Refusal::Impossible(faults) | Refusal::TooLarge { faults, .. }) = Limits::default().estimate(&job) else {
        panic!("it is refused");
    };
    assert_eq!(faults[0].pointer, "/outputs/0/format");
    let detail = &faults[0].detail;
    assert!(detail.contains("786432 triangles") && detail.contains("262144"), "{detail}");
    let (place, _) = refused(json!({ "format": "pdf", "show": ["comb"] }), 1);
    assert_eq!(place, "/outputs/0/show");
    let (_, detail) = refused(json!({ "format": "svg", "camera": { "eye": [0.5, 0.4, 0.5] } }), 1);
    assert!(detail.contains("before the camera"), "{detail}");
}

/// Pseudorandom numbers between 0 and 1, the same in every run.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let share = (self.0 >> 11) as f64 / (1_u64 << 53) as f64;
        share
    }

    fn point(&mut self, size: f64) -> [f64; 3] {
        [0; 3].map(|_| size * (self.next() - 0.5))
    }
}

/// In the middle of visible parts, the rasteriser draws the line, and in the middle of hidden parts it does not, if
/// these middles are more than two pixels from the deciding edge.
#[test]
fn what_is_hidden_is_what_the_depth_buffer_hides() {
    let size = [400, 300];
    let (mut n_seen, mut n_hidden) = (0, 0);
    for seed in 0..60 {
        let mut chance = Chance(seed);
        let mut positions = Vec::new();
        for _ in 0..12 {
            let centre = chance.point(2.0);
            positions.extend([0; 3].map(|_| chance.point(1.6)).map(|p| [0, 1, 2].map(|k| centre[k] + p[k])));
        }
        let triangles: Vec<[u32; 3]> = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let ends = [chance.point(3.0), chance.point(3.0)];
        positions.extend(ends);
        let camera = Camera::framing(&View::default(), &[&positions], size[0], size[1]);
        let seen: Vec<ProjectedPoint> = positions.iter().map(|p| camera.seen(*p).expect("before the camera")).collect();
        let line = [seen[36], seen[37]];
        let sight = Sight::new(&seen, &triangles);
        let hidden = sight.hidden(line, |_| false);
        // the rasteriser draws lines slightly nearer than they are
        let nearer = sight.hidden(line.map(|[x, y, nearness]| [x, y, 1.02 * nearness]), |_| false);
        let strokes = Strokes {
            positions: &positions,
            segments: &[[36, 37]],
            width_px: 3.0,
            color: [255, 0, 0, 255],
            crowding: Crowding::Keep,
            hidden: 0.0,
        };
        let model = Model {
            positions: &positions,
            triangles: &triangles,
            normals: ShadingNormals::Planes,
            surface: TriangleAppearance::Unseen,
            strokes: &[strokes],
        };
        let look = RenderStyle { background: [255; 4], is_fine: false, is_occluded: false, shadow: Ground::None };
        let picture = paint(&model, &camera, look, size, &Watch::new()).expect("it is painted");
        let length = distance([line[0][0], line[0][1]], [line[1][0], line[1][1]]);
        let marked = |t: f64| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the line lies in the picture")]
            let [x, y] = [0, 1].map(|k| (line[0][k] + t * (line[1][k] - line[0][k])) as usize);
            let at = 4 * (y * size[0] as usize + x);
            picture.bytes[at + 1] < 128
        };
        let mut from = 0.0;
        for part in hidden.iter().copied().chain([[1.0, 1.0]]) {
            if (part[0] - from) * length > 6.0 {
                n_seen += 1;
                assert!(marked(0.5 * (from + part[0])), "scene {seed}: {hidden:?}, seen from {from}");
            }
            let middle = 0.5 * (part[0] + part[1]);
            let far = nearer.iter().any(|[from, to]| (*from..=*to).contains(&middle));
            if (part[1] - part[0]) * length > 6.0 && far {
                n_hidden += 1;
                assert!(!marked(middle), "scene {seed}: {hidden:?}, {part:?}");
            }
            from = part[1];
        }
    }
    assert!(n_seen > 20 && n_hidden > 20, "{n_seen} seen parts and {n_hidden} hidden ones");
}
