//! Options of pictures: quality, overlays beside the surface, and levels that follow the resolution.

use serde_json::{Value, json};

use planish::fault::Fault;

use crate::support::{nets, parsed, render};

/// Returns a job for a cube under Catmull-Clark as a picture of 200 x 150 pixels with these options.
fn cube(levels: &Value, options: &Value) -> Value {
    let mut mesh = nets::cube().to_json();
    mesh["creases"] = json!([{ "edge": [0, 1], "sharpness": 10 }]);
    let mut output = options.clone();
    for (name, value) in [("format", json!("png")), ("width", json!(200)), ("height", json!(150))] {
        if output[name].is_null() {
            output[name] = value;
        }
    }
    let plan = json!({ "preset": "catmull-clark" });
    json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels, "outputs": [output] })
}

/// Returns a job for the unrefined cube with latitude lines.
fn tagged(lines: &Value, options: &Value) -> Value {
    let mut job = cube(&json!(0), options);
    job.as_object_mut().expect("an object").remove("plan");
    job["input"]["mesh"]["latitude"] = lines.clone();
    job
}

/// Returns the faults of a job.
fn faults(job: &Value) -> Vec<Fault> {
    render(job).expect_err("it is refused")
}

fn png(options: &Value) -> Vec<u8> {
    render(&cube(&json!(2), options)).unwrap_or_else(|faults| panic!("{faults:?} for {options}")).0
}

/// Returns red, green and blue of all pixels.
fn pixels(png: &[u8]) -> Vec<[u8; 3]> {
    let picture = image::load_from_memory(png).expect("a picture").into_rgb8();
    picture.pixels().map(|pixel| pixel.0).collect()
}

#[test]
fn dots_an_inch_are_written_and_leave_the_pixels_alone() {
    let (without, with) = (png(&json!({})), png(&json!({ "dpi": 300 })));
    assert!(!without.windows(4).any(|name| name == b"pHYs"));
    let at = with.windows(4).position(|name| name == b"pHYs").expect("the chunk of dimensions");
    // 300 pixels per inch are 11,811 per metre
    let expected = [11_811_u32.to_be_bytes(), 11_811_u32.to_be_bytes()].concat();
    assert_eq!((&with[at + 4..at + 12], with[at + 12]), (&expected[..], 1));
    assert_eq!(pixels(&without), pixels(&with));
    let key = |options| parsed(cube(&json!(2), &options).to_string().as_bytes()).expect("a job").keys()[0];
    assert_ne!(key(json!({})), key(json!({ "dpi": 300 })));
}

#[test]
fn drafts_have_fewer_grey_values_and_no_shadow_unless_it_is_asked_for() {
    let grey = |options: Value| {
        let colors: std::collections::BTreeSet<[u8; 3]> = pixels(&png(&options)).into_iter().collect();
        colors.iter().filter(|[r, g, b]| r == g && g == b).count()
    };
    assert_eq!(grey(json!({ "quality": "draft" })), 1, "white alone");
    assert!(grey(json!({})) > 20, "a cube stands on its lowest face");
    assert!(grey(json!({ "quality": "draft", "grounding": "shadow" })) > 20);
    assert_eq!(grey(json!({ "grounding": "occlusion" })), 1);
    assert_eq!(grey(json!({ "grounding": "none" })), 1);
}

/// Counts the pixels of about this colour.
fn about(options: &Value, [r, g, b]: [u8; 3]) -> usize {
    let near = |pixel: &&[u8; 3]| pixel.iter().zip([r, g, b]).all(|(a, b)| a.abs_diff(b) < 40);
    pixels(&png(options)).iter().filter(near).count()
}

#[test]
fn tags_are_shown_as_lines_and_dots_of_their_colours() {
    let (red, green, yellow) = ([190, 18, 60], [4, 120, 87], [250, 204, 21]);
    let view = json!({ "azimuth_deg": 180, "elevation_deg": -30 });
    for (item, color) in [("creases", red), ("extraordinary", yellow)] {
        let size = [800, 600];
        let shown = json!({ "show": ["surface", item], "camera": view, "line_width": 3, "width": size[0],
            "height": size[1] });
        assert!(about(&shown, color) > 10, "{item}");
        assert_eq!(about(&json!({ "camera": view }), color), 0, "{item}");
    }
    let lines = json!({ "show": ["surface", "latitude"], "camera": view, "line_width": 3 });
    let job = tagged(&json!([[0, 1]]), &lines);
    let shown = render(&job).unwrap_or_else(|faults| panic!("{faults:?}")).0;
    let is_green = |pixel: &&[u8; 3]| pixel.iter().zip(green).all(|(a, b)| a.abs_diff(b) < 40);
    assert!(pixels(&shown).iter().filter(is_green).count() > 10, "latitude");
    // no edge has such a tag
    let plain = png(&json!({ "camera": view }));
    assert_eq!(png(&json!({ "show": ["surface", "longitude"], "camera": view })), plain);
    assert_eq!(png(&json!({ "show": ["surface", "seams"], "camera": view })), plain);
}

#[test]
fn seams_are_where_texture_coordinates_are_cut() {
    let mut job = cube(&json!(2), &json!({ "show": ["surface", "seams"], "line_width": 3 }));
    let faces = job["input"]["mesh"]["faces"].clone();
    // one value per vertex, so that no edge is a seam
    job["input"]["mesh"]["uvs"] = json!({ "values": (0..8).map(|i| [i, i * i]).collect::<Vec<_>>(), "faces": faces });
    let whole = render(&job).expect("a picture").0;
    let faces: Vec<_> = (0..6).map(|f| [4 * f, 4 * f + 1, 4 * f + 2, 4 * f + 3]).collect();
    job["input"]["mesh"]["uvs"] = json!({ "values": (0..24).map(|i| [i, i * i]).collect::<Vec<_>>(), "faces": faces });
    let cut = render(&job).expect("a picture").0;
    let lime = |png: &[u8]| pixels(png).iter().filter(|[r, g, b]| *r < 180 && *g > 150 && *b < 100).count();
    assert_eq!(lime(&whole), 0);
    assert!(lime(&cut) > 100);
}

/// Latitude lines do not affect the plan, but they do affect the picture.
#[test]
fn pictures_of_other_latitude_lines_have_other_keys() {
    let key = |lines: Value, show: &str| {
        let job = tagged(&lines, &json!({ "show": ["surface", show] }));
        parsed(job.to_string().as_bytes()).expect("a job").keys()[0]
    };
    assert_ne!(key(json!([[0, 1]]), "latitude"), key(json!([]), "latitude"));
    assert_eq!(key(json!([[0, 1]]), "creases"), key(json!([]), "creases"));
}

#[test]
fn tags_are_refused_where_edges_of_the_input_do_not_stay() {
    let mut job = cube(&json!(2), &json!({ "show": ["surface", "extraordinary"] }));
    job["plan"]["preset"] = json!("doo-sabin");
    job["input"]["mesh"].as_object_mut().expect("an object").retain(|name, _| name == "positions" || name == "faces");
    assert!(faults(&job).iter().any(|fault| fault.detail.contains("extraordinary")));
}

#[test]
fn lines_take_their_width_and_colours_from_options() {
    let lime = [0, 255, 0];
    let shown = |width: f64| {
        about(&json!({ "show": ["surface", "control"], "control_color": "#00ff00", "line_width": width }), lime)
    };
    assert!(2 * shown(6.0) > 3 * shown(3.0) && shown(3.0) > 20, "{} and {}", shown(3.0), shown(6.0));
    assert!(about(&json!({ "show": ["wireframe"], "wire_color": "#00ff00", "line_width": 3 }), lime) > 20);
    assert!(about(&json!({ "show": ["points"], "point_color": "#00ff00", "width": 800, "height": 600 }), lime) > 20);
}

#[test]
fn automatic_levels_make_faces_of_about_a_pixel_and_enter_the_key_as_a_number() {
    let auto = |options: &Value| parsed(cube(&json!("auto"), options).to_string().as_bytes()).expect("a job");
    // edges of the cube are between 64 and 128 pixels long
    let job = auto(&json!({}));
    assert_eq!((job.levels, job.reached.map(|reached| (reached.level, reached.bound))), (6, Some((6, None))));
    let same = parsed(cube(&json!(6), &json!({})).to_string().as_bytes()).expect("a job");
    assert_eq!(job.keys(), same.keys());
    assert_eq!(auto(&json!({ "width": 400, "height": 300 })).levels, 7);
    assert_eq!(auto(&json!({ "camera": { "zoom": 0.25 } })).levels, 4);
    // six faces become 6 x 4^9 = 1,572,864, which is below 2^21
    assert_eq!(auto(&json!({ "width": 8192, "height": 8192 })).levels, 9);
    let curve = json!({ "input": { "polygon": { "points": [[0, 0], [1, 0], [1, 1], [0, 1]], "closed": true } },
        "plan": { "preset": "chaikin" }, "levels": "auto",
        "outputs": [{ "format": "png", "width": 150, "height": 150 }] });
    assert_eq!(parsed(curve.to_string().as_bytes()).expect("a job").levels, 7, "sides of 132 pixels");
    // a drawing in lines takes 2^18 triangles; six faces become 12 x 4^7 = 196,608 of them
    assert_eq!(auto(&json!({ "format": "svg", "width": 2048, "height": 2048 })).levels, 7);
}

#[test]
fn automatic_levels_are_refused_without_pixels_and_without_smaller_faces() {
    let mut job = cube(&json!("auto"), &json!({}));
    job["outputs"] = json!([{ "format": "png" }, { "format": "obj", "name": "mesh" }]);
    let found = faults(&job);
    assert!(found.iter().any(|fault| fault.pointer == "/levels" && fault.detail.contains("obj")), "{found:?}");
    let mut job = cube(&json!("auto"), &json!({}));
    job["plan"] = json!({ "word": "C" });
    assert!(faults(&job).iter().any(|fault| fault.detail.contains("no smaller faces")));
    let job = cube(&json!("automatic"), &json!({}));
    assert!(faults(&job).iter().any(|fault| fault.pointer == "/levels" && fault.detail.contains("\"auto\"")));
}

#[test]
fn boxes_with_exchanged_corners_are_refused_at_the_first_coordinate() {
    let found = |format: &str, min: [f64; 3]| {
        let camera = json!({ "box": { "min": min, "max": [1, 1, 1] } });
        faults(&cube(&json!(1), &json!({ "format": format, "camera": camera })))
    };
    for format in ["png", "svg", "apng"] {
        let fault = &found(format, [0.0, 2.5, 3.0])[0];
        assert_eq!(fault.pointer, "/outputs/0/camera/box/min/1", "{format}: {fault:?}");
        assert!(fault.detail.contains("least y is 2.5, the greatest is 1"), "{fault:?}");
    }
    // a box without height is none that is exchanged
    png(&json!({ "camera": { "box": { "min": [-1, 1, -1], "max": [1, 1, 1] } } }));
}

#[test]
fn cameras_that_look_nowhere_are_refused_at_their_place() {
    for format in ["png", "svg", "apng"] {
        let found = |camera: Value| faults(&cube(&json!(1), &json!({ "format": format, "camera": camera })));
        let nowhere = found(json!({ "up": [0, 0, 0] }));
        assert_eq!(nowhere[0].pointer, "/outputs/0/camera/up", "{format}: {nowhere:?}");
    }
    let at_itself = |format: &str| {
        let camera = json!({ "eye": [1, 2, 3], "target": [1, 2, 3] });
        faults(&cube(&json!(1), &json!({ "format": format, "camera": camera })))
    };
    assert_eq!(at_itself("png")[0].pointer, "/outputs/0/camera/eye");
    assert_eq!(at_itself("svg")[0].pointer, "/outputs/0/camera/eye");
    // up along the view is no fault: it then takes another up
    png(&json!({ "camera": { "eye": [0, 9, 0], "target": [0, 0, 0], "up": [0, 1, 0] } }));
}
