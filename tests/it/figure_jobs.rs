//! Figures: pictures of jobs in a grid, composed of the pictures that the jobs give alone.

use image::RgbaImage;
use planish::job::limits::{Limits, Refusal};
use serde_json::{Value, json};

use crate::support::{parsed, render};

fn cube() -> Value {
    json!({ "mesh": {
        "positions": [
            [-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1],
        ],
        "faces": [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
    } })
}

/// Returns a job of a mesh with a picture of these proportions.
fn solid(levels: u32, size: [u32; 2]) -> Value {
    json!({ "input": cube(), "plan": { "preset": "catmull-clark" }, "levels": levels,
        "outputs": [{ "format": "png", "width": size[0], "height": size[1] }] })
}

/// Returns a job of a curve with a picture of these proportions.
fn curve(scale: f64, size: [u32; 2]) -> Value {
    json!({ "input": { "polygon": { "points": [[0, 0], [scale, 0], [scale, scale], [0, scale]], "closed": true } },
        "plan": { "preset": "chaikin" }, "levels": 4,
        "outputs": [{ "format": "png", "width": size[0], "height": size[1] }] })
}

fn panels(jobs: &[Value]) -> Value {
    jobs.iter().map(|job| json!({ "job": job })).collect()
}

fn figure(columns: u32, jobs: &[Value], width: u32) -> Value {
    let outputs = json!([{ "format": "png", "width": width }]);
    json!({ "figure": { "columns": columns, "panels": panels(jobs) }, "outputs": outputs })
}

fn picture(job: &Value) -> RgbaImage {
    let (bytes, _) = render(job).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    image::load_from_memory(&bytes).expect("it is a picture").to_rgba8()
}

fn part(of: &RgbaImage, [x, y]: [u32; 2], [width, height]: [u32; 2]) -> RgbaImage {
    image::imageops::crop_imm(of, x, y, width, height).to_image()
}

/// Returns the pointers of all faults of a job.
fn places(job: &Value) -> Vec<String> {
    render(job).expect_err("the job is refused").into_iter().map(|fault| fault.pointer).collect()
}

#[test]
fn a_figure_of_one_panel_is_the_picture_of_its_job() {
    for job in [solid(2, [160, 120]), curve(1.0, [160, 120])] {
        assert_eq!(picture(&figure(1, std::slice::from_ref(&job), 160)), picture(&job));
    }
}

#[test]
fn the_key_of_a_panel_is_that_of_the_equal_job() {
    let text = serde_json::to_vec(&figure(1, &[solid(2, [200, 100])], 300)).expect("a value can be written");
    let job = parsed(&text).expect("it is a job");
    let alone = parsed(&serde_json::to_vec(&solid(2, [300, 150])).expect("a value can be written")).expect("a job");
    assert_eq!(job.panels()[0].keys(), alone.keys());
    assert_ne!(job.keys(), alone.keys());
}

#[test]
fn what_changes_a_figure_changes_its_key() {
    let key = |job: &Value| parsed(&serde_json::to_vec(job).expect("written")).expect("a job").keys()[0];
    let jobs = [solid(1, [100, 100]), solid(2, [100, 100])];
    let plain = figure(2, &jobs, 400);
    let mut scaled = plain.clone();
    scaled["figure"]["shared"] = json!({ "scale": true });
    let mut spanned = plain.clone();
    spanned["figure"]["panels"][1]["span"] = json!([1, 2]);
    let mut stacked = plain.clone();
    stacked["figure"]["panels"][1]["overlay"] = json!(true);
    let mut grey = plain.clone();
    grey["outputs"][0]["background"] = json!("#cccccc");
    let turned = figure(2, &[jobs[1].clone(), jobs[0].clone()], 400);
    let others = [figure(1, &jobs, 400), figure(2, &jobs, 401), scaled, spanned, stacked, grey, turned];
    for other in &others {
        assert_ne!(key(&plain), key(other), "{other}");
    }
    let mut named = plain.clone();
    named["outputs"][0]["name"] = json!("other");
    assert_eq!(key(&plain), key(&named));
}

#[test]
fn panels_that_lie_on_each_other_are_framed_alike_and_all_seen() {
    let (small, large) = (curve(1.0, [120, 120]), curve(2.0, [120, 120]));
    let mut both = figure(1, &[large.clone(), small.clone()], 120);
    both["figure"]["panels"][1]["overlay"] = json!(true);
    let boxed = |job: &Value, background: &str| {
        let mut job = job.clone();
        job["outputs"][0]["camera"] = json!({ "box": { "min": [0, 0, 0], "max": [2, 2, 0] } });
        job["outputs"][0]["background"] = json!(background);
        picture(&job)
    };
    let (below, above) = (boxed(&large, "#ffffff"), boxed(&small, "transparent"));
    let seen = picture(&both);
    for (x, y, pixel) in seen.enumerate_pixels() {
        match above.get_pixel(x, y).0[3] {
            0 => assert_eq!(pixel, below.get_pixel(x, y), "at {x}, {y} nothing lies above"),
            255 => assert_eq!(pixel, above.get_pixel(x, y), "at {x}, {y} nothing shows through"),
            _ => {}
        }
    }
    assert_ne!(seen, below);
    // the second panel takes no cell, so that a third one is beside the first
    let mut three = figure(2, &[large.clone(), small.clone(), large], 242);
    three["figure"]["panels"][1]["overlay"] = json!(true);
    assert_eq!(picture(&three).height(), 120);
}

#[test]
fn a_panel_that_lies_on_another_has_no_place_of_its_own() {
    let jobs = [curve(1.0, [120, 120]), curve(2.0, [120, 120])];
    let mut wrong = figure(2, &jobs, 242);
    wrong["figure"]["panels"][0]["overlay"] = json!(true);
    assert_eq!(places(&wrong), ["/figure/panels/0/overlay"]);
    let mut wrong = figure(2, &jobs, 242);
    wrong["figure"]["panels"][1] = json!({ "job": jobs[1], "overlay": true, "span": [1, 1], "caption": "b" });
    assert_eq!(places(&wrong), ["/figure/panels/1/span", "/figure/panels/1/caption"]);
}

#[test]
fn panels_stand_row_by_row_and_where_they_span_nothing_else_stands() {
    let job = |levels| solid(levels, [100, 80]);
    let mut wide = figure(3, &[job(0), job(1), job(2), job(3)], 300);
    wide["figure"]["panels"][1]["span"] = json!([2, 1]);
    wide["figure"]["panels"][2]["span"] = json!([1, 2]);
    let whole = picture(&wide);
    let sized = |levels, size: [u32; 2]| picture(&solid(levels, size));
    // three columns of 98 pixels with gaps of 3 pixels; a picture of two columns is 199 wide and 159 high
    assert_eq!(part(&whole, [101, 0], [199, 159]), sized(1, [199, 159]));
    assert_eq!(part(&whole, [0, 40], [98, 78]), sized(0, [98, 78]), "in the middle of its row");
    assert_eq!(part(&whole, [101, 162], [98, 78]), sized(3, [98, 78]));
    assert_eq!(part(&whole, [0, 162], [98, whole.height() - 162]), sized(2, [98, whole.height() - 162]));
}

#[test]
fn panels_of_one_scale_are_framed_by_the_box_around_all() {
    let jobs = [curve(1.0, [120, 120]), curve(2.0, [120, 120])];
    let mut one_scale = figure(2, &jobs, 242);
    one_scale["figure"]["shared"] = json!({ "scale": true });
    let whole = picture(&one_scale);
    let boxed = |mut job: Value| {
        job["outputs"][0]["camera"] = json!({ "box": { "min": [0, 0, 0], "max": [2, 2, 0] } });
        picture(&job)
    };
    assert_eq!(part(&whole, [0, 0], [120, 120]), boxed(jobs[0].clone()));
    assert_eq!(part(&whole, [122, 0], [120, 120]), boxed(jobs[1].clone()));
    assert_ne!(part(&whole, [0, 0], [120, 120]), picture(&jobs[0]));
    assert_eq!(part(&whole, [122, 0], [120, 120]), picture(&jobs[1]), "the largest is framed as ever");
}

#[test]
fn panels_of_one_scale_keep_it_beside_a_legend() {
    let [plain, mut curved] = [solid(1, [400, 300]), solid(1, [400, 300])];
    let look = json!({ "shading": "gaussian-curvature", "color_map": "viridis", "quality": "draft" });
    curved["outputs"][0].as_object_mut().expect("an output").extend(look.as_object().expect("options").clone());
    let mut one_scale = figure(2, &[plain, curved], 808);
    one_scale["figure"]["panels"][0]["job"]["outputs"][0]["quality"] = json!("draft");
    one_scale["figure"]["shared"] = json!({ "scale": true });
    let whole = picture(&one_scale);
    let covered = |left: u32| -> Vec<bool> {
        part(&whole, [left, 0], [320, 300]).pixels().map(|pixel| pixel.0 != [255; 4]).collect()
    };
    assert!(covered(0).contains(&true));
    assert!(covered(0) == covered(408), "both surfaces cover the same pixels");
    let strip = part(&whole, [330, 0], [70, 300]);
    assert!(strip.pixels().all(|pixel| pixel.0 == [255; 4]), "what is left free has the background");
}

#[test]
fn a_shared_camera_takes_the_place_of_those_of_the_panels() {
    let mut shared = figure(1, &[solid(1, [90, 60])], 90);
    shared["figure"]["shared"] = json!({ "camera": { "azimuth_deg": 80, "elevation_deg": 5 } });
    let mut alone = solid(1, [90, 60]);
    alone["outputs"][0]["camera"] = json!({ "azimuth_deg": 80, "elevation_deg": 5 });
    assert_eq!(picture(&shared), picture(&alone));
}

#[test]
fn everything_wrong_with_a_figure_is_told_at_its_place() {
    let mut job = figure(2, &[solid(1, [90, 60]), solid(1, [90, 60]), solid(1, [90, 60])], 200);
    job["figure"]["panels"][0]["job"]["levels"] = json!(99);
    job["figure"]["panels"][1]["job"]["outputs"][0]["colour"] = json!("#fff");
    assert_eq!(places(&job), ["/figure/panels/1/job/outputs/0/colour"], "the layout first");
    job["figure"]["panels"][1]["job"]["outputs"][0] = json!({ "format": "png", "show": [] });
    job["figure"]["panels"][2]["job"]["input"] = json!({ "mesh": { "positions": [], "faces": [[0, 1]] } });
    let found = places(&job);
    assert_eq!(found[..2], ["/figure/panels/0/job/levels", "/figure/panels/1/job/outputs/0/show"]);
    assert!(found[2].starts_with("/figure/panels/2/job/input/mesh/"), "{found:?}");
}

#[test]
fn a_figure_refuses_what_it_does_not_take() {
    let plain = figure(2, &[solid(1, [90, 60])], 200);
    let with = |pointer: &str, value: Value| {
        let mut job = plain.clone();
        let (outer, name) = pointer.rsplit_once('/').expect("a pointer");
        job.pointer_mut(outer).expect("a place")[name] = value;
        places(&job)
    };
    assert_eq!(with("/input", cube()), ["/input"]);
    assert_eq!(with("/levels", json!(2)), ["/levels"]);
    assert_eq!(with("/spec", json!(2)), ["/spec"]);
    assert_eq!(with("/figure/columns", json!(13)), ["/figure/columns"]);
    assert_eq!(with("/figure/panels", json!([])), ["/figure/panels"]);
    assert_eq!(with("/figure/shared", json!({ "camera": { "zoom": 0 } })), ["/figure/shared/camera/zoom"]);
    assert_eq!(with("/outputs", json!([{ "format": "glb" }])), ["/outputs/0/format"]);
    assert_eq!(with("/outputs/0/height", json!(100)), ["/outputs/0/height"]);
    let panel = "/figure/panels/0";
    assert_eq!(with(&format!("{panel}/span"), json!([3, 1])), ["/figure/panels/0/span"]);
    assert_eq!(with(&format!("{panel}/job/figure"), json!({ "panels": [] })), ["/figure/panels/0/job/figure"]);
    assert_eq!(with(&format!("{panel}/job/levels"), json!({ "tolerance": 0.01 })), ["/figure/panels/0/job/levels"]);
    let obj = json!([{ "format": "obj" }]);
    assert_eq!(with(&format!("{panel}/job/outputs"), obj), ["/figure/panels/0/job/outputs/0/format"]);
    let two = json!([{ "format": "png" }, { "format": "png", "name": "other" }]);
    assert_eq!(with(&format!("{panel}/job/outputs"), two), ["/figure/panels/0/job/outputs"]);
}

#[test]
fn a_job_needs_an_input_or_a_figure() {
    assert_eq!(places(&json!({ "outputs": [{ "format": "png" }] })), ["/input"]);
}

#[test]
fn figures_too_large_are_refused() {
    let high = figure(1, &vec![solid(0, [100, 800]); 3], 4000);
    assert_eq!(places(&high), ["/outputs/0/width"]);
    let narrow = figure(12, &vec![solid(0, [100, 100]); 12], 120);
    assert_eq!(places(&narrow), ["/outputs/0/width"]);
}

#[test]
fn what_is_too_large_of_a_panel_is_told_at_the_panel_and_all_are_booked_together() {
    let job = |jobs: &[Value]| {
        let text = serde_json::to_vec(&figure(2, jobs, 200)).expect("a value can be written");
        parsed(&text).expect("it is a job")
    };
    let limits = Limits { max_faces: 100, ..Limits::default() };
    let Err(Refusal::TooLarge { faults, detail }) = limits.admit(job(&[solid(1, [90, 60]), solid(4, [90, 60])])) else {
        panic!("panel 1 is too large")
    };
    assert_eq!(faults[0].pointer, "/figure/panels/1/job/levels");
    assert!(detail.contains("panel 1") && detail.contains("at most 2 levels"), "{detail}");
    let bytes = |jobs: &[Value]| Limits::default().estimate(&job(jobs)).expect("an estimate").memory_bytes;
    let one = bytes(&[solid(7, [90, 60])]);
    assert!(bytes(&vec![solid(7, [90, 60]); 8]) > 7 * one, "the sum of eight panels is booked");
    let limits = Limits { max_job_bytes: u64::try_from(3 * one).expect("a number of bytes"), ..Limits::default() };
    let Err(Refusal::TooLarge { faults, .. }) = limits.admit(job(&vec![solid(7, [90, 60]); 8])) else {
        panic!("eight panels are too large")
    };
    assert_eq!(faults[0].pointer, "/figure/panels");
}

#[test]
fn captions_stand_below_their_panels_and_the_title_above_all() {
    let plain = figure(2, &[solid(1, [100, 80]), solid(2, [100, 80])], 402);
    let mut told = plain.clone();
    told["figure"]["title"] = json!("Cubes");
    told["figure"]["letters"] = json!(true);
    told["figure"]["panels"][1]["caption"] =
        json!("\\delta = 1/4, and many more words than there is room for in one line");
    let (plain, told) = (picture(&plain), picture(&told));
    assert!(told.height() > plain.height() + 60, "{} and {}", told.height(), plain.height());
    let top = (0..told.height()).find(|y| part(&told, [0, *y], [402, plain.height()]) == plain);
    let top = top.expect("the panels are as they were");
    let is_written = |at: [u32; 2], size: [u32; 2]| part(&told, at, size).pixels().any(|pixel| pixel.0[0] < 128);
    assert!(is_written([100, 0], [202, top]), "the title");
    let below = top + plain.height();
    assert!(is_written([80, below], [40, told.height() - below]), "the letter (a)");
    assert!(is_written([202, told.height() - 20], [200, 20]), "the last line of the second caption");
    assert!(!is_written([0, told.height() - 20], [198, 20]), "the first has one line");
}

#[test]
fn in_svg_and_pdf_curves_are_lines_and_meshes_are_pixels() {
    let mut job = figure(2, &[curve(1.0, [100, 80]), solid(1, [100, 80])], 402);
    job["figure"]["title"] = json!("A curve and a cube");
    job["outputs"][0]["format"] = json!("svg");
    let svg = String::from_utf8(render(&job).expect("a figure").0).expect("SVG is text");
    assert_eq!(svg.matches("data:image/png;base64,").count(), 1, "one picture in pixels");
    assert!(svg.contains("class=\"curve\"") && svg.contains("A curve and a cube"), "{svg:.400}");
    job["outputs"][0]["format"] = json!("pdf");
    assert!(render(&job).expect("a figure").0.starts_with(b"%PDF-"));
    let text = serde_json::to_vec(&job).expect("a value can be written");
    let admitted = Limits::default().admit(parsed(&text).expect("a job")).expect("it is admitted");
    let bound = admitted.estimate().outputs[0].1.bytes();
    assert!(u128::try_from(svg.len()).expect("a length") <= bound, "{} bytes of {bound}", svg.len());
}

#[test]
fn what_cannot_be_written_is_told_at_its_place() {
    let plain = figure(1, &[solid(1, [90, 60])], 200);
    let mut job = plain.clone();
    job["figure"]["title"] = json!("\\nonsense");
    job["figure"]["panels"][0]["caption"] = json!("x_{");
    assert_eq!(places(&job), ["/figure/title", "/figure/panels/0/caption"]);
    let mut job = plain;
    job["figure"]["title"] = json!("x".repeat(1001));
    assert_eq!(places(&job), ["/figure/title"]);
}
