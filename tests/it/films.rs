//! Moving pictures: each frame equals the picture of a job of its own.

use std::io::Cursor;

use image::codecs::png::PngDecoder;
use image::{AnimationDecoder, RgbaImage};
use planish::job::limits::Limits;
use planish::job::{RunError, run};
use planish::output::figure::FigureExtent;
use planish::output::film::shots;
use planish::output::scene::CoordinateSystem;
use planish::watch::Watch;
use serde_json::{Value, json};

use crate::support::{parsed, render};

fn bytes(job: &Value) -> Vec<u8> {
    render(job).unwrap_or_else(|faults| panic!("{faults:?} for {job}")).0
}

fn picture(job: &Value) -> RgbaImage {
    image::load_from_memory(&bytes(job)).expect("it is a picture").to_rgba8()
}

fn frames(bytes: &[u8]) -> Vec<RgbaImage> {
    let decoder = PngDecoder::new(Cursor::new(bytes)).expect("it is a PNG").apng().expect("it moves");
    decoder.into_frames().map(|frame| frame.expect("a frame").into_buffer()).collect()
}

fn places(job: &Value) -> Vec<String> {
    render(job).expect_err("the job is refused").into_iter().map(|fault| fault.pointer).collect()
}

fn tetrahedron(output: &Value) -> Value {
    json!({ "input": { "mesh": {
            "positions": [[1, 1, 1], [-1, 1, -1], [1, -1, -1], [-1, -1, 1]],
            "faces": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] } },
        "plan": { "preset": "push-back", "parameters": { "delta": 0.25 } }, "levels": 2, "outputs": [output] })
}

fn turntable(projection: &str) -> Value {
    let camera = json!({ "projection": projection, "elevation_deg": 10,
        "box": { "min": [-1, -1, -1], "max": [1, 1, 1] } });
    tetrahedron(&json!({ "format": "apng", "width": 64, "height": 48, "frames": 5, "camera": camera }))
}

#[test]
fn the_frames_of_a_turntable_are_the_pictures_from_their_places() {
    for projection in ["perspective", "orthographic"] {
        let job = turntable(projection);
        let found = frames(&bytes(&job));
        assert_eq!(found.len(), 5);
        let options = parsed(job.to_string().as_bytes()).expect("a job").outputs[0].options.clone();
        for (k, shot) in shots(&options, &FigureExtent::default(), CoordinateSystem::default()).iter().enumerate() {
            let seen = shot.group("camera").expect("a camera");
            let mut camera = job["outputs"][0]["camera"].clone();
            camera["azimuth_deg"] = json!(72.0 * f64::from(u8::try_from(k).expect("few frames")));
            camera["target"] = json!([0, 0, 0]);
            if projection == "perspective" {
                camera["eye"] = json!(seen.vector("eye").expect("an eye"));
            } else {
                camera["zoom"] = json!(seen.number("zoom").expect("a zoom"));
            }
            let still = json!({ "format": "png", "width": 64, "height": 48, "camera": camera });
            assert!(found[k] == picture(&tetrahedron(&still)), "{projection}, frame {k}");
        }
        assert!(found.windows(2).all(|pair| pair[0] != pair[1]), "it moves");
    }
}

#[test]
fn the_eye_goes_around_at_one_distance_and_sees_everything_all_the_way() {
    let options = parsed(turntable("perspective").to_string().as_bytes()).expect("a job").outputs[0].options.clone();
    let shots = shots(&options, &FigureExtent::default(), CoordinateSystem::default());
    let distances: Vec<f64> = shots
        .iter()
        .map(|shot| shot.group("camera").and_then(|camera| camera.vector("eye")).expect("an eye"))
        .map(|eye| eye.iter().map(|x| x * x).sum::<f64>().sqrt())
        .collect();
    assert!(distances.iter().all(|distance| (distance - distances[0]).abs() < 1e-12 * distance), "{distances:?}");
    for frame in frames(&bytes(&turntable("perspective"))) {
        let white = |x: u32, y: u32| frame.get_pixel(x, y).0 == [255; 4];
        assert!((0..64).all(|x| white(x, 0) && white(x, 47)) && (0..48).all(|y| white(0, y) && white(63, y)));
    }
}

#[test]
fn the_frames_of_a_sweep_are_the_pictures_of_their_plans_in_one_box() {
    let film = tetrahedron(&json!({ "format": "apng", "width": 64, "height": 48, "frames": 3,
        "sweep": { "pointer": "/plan/parameters/delta", "from": 0, "to": 1 } }));
    let found = frames(&bytes(&film));
    // the limits of delta 1 reach farthest
    let stats = |delta: f64| {
        let mut job = tetrahedron(&json!({ "format": "stats" }));
        job["plan"]["parameters"]["delta"] = json!(delta);
        serde_json::from_slice::<Value>(&bytes(&job)).expect("stats are JSON")
    };
    let box_of = |delta: f64, end: usize| -> Vec<f64> {
        let stats = stats(delta);
        let corner = &stats["bounding_box"][["min", "max"][end]];
        corner.as_array().unwrap_or_else(|| panic!("{stats}")).iter().map(|x| x.as_f64().expect("a number")).collect()
    };
    let joined = |end: usize, pick: fn(f64, f64) -> f64| -> Vec<f64> {
        let ends = [0.0, 0.5, 1.0].map(|delta| box_of(delta, end));
        (0..3).map(|k| pick(pick(ends[0][k], ends[1][k]), ends[2][k])).collect()
    };
    let camera = json!({ "box": { "min": joined(0, f64::min), "max": joined(1, f64::max) } });
    for (k, delta) in [0.0, 0.5, 1.0].into_iter().enumerate() {
        let mut still = tetrahedron(&json!({ "format": "png", "width": 64, "height": 48, "camera": camera }));
        still["plan"]["parameters"]["delta"] = json!(delta);
        assert!(found[k] == picture(&still), "frame {k}");
    }
}

#[test]
fn curves_move_with_a_parameter_of_their_plan() {
    let job = |output: Value| {
        json!({ "input": { "polygon": { "points": [[0, 0], [1, 0], [1, 1], [0, 1]], "closed": true } },
            "plan": { "preset": "four-point" }, "levels": 4, "outputs": [output] })
    };
    let sweep = json!({ "pointer": "/plan/parameters/w", "from": 0, "to": 0.125 });
    let found =
        frames(&bytes(&job(json!({ "format": "apng", "width": 64, "height": 64, "frames": 4, "sweep": sweep }))));
    assert_eq!(found.len(), 4);
    assert!(found.windows(2).all(|pair| pair[0] != pair[1]), "it moves");
    assert_eq!(places(&job(json!({ "format": "apng" }))), ["/outputs/0/format"], "a plane curve has no other side");
    assert_eq!(places(&job(json!({ "format": "apng", "turntable": {} }))), ["/outputs/0/format"]);
}

#[test]
fn what_a_film_cannot_show_is_told_at_its_place() {
    let with = |output: Value| {
        let mut all = json!({ "format": "apng", "width": 64, "height": 48 });
        output.as_object().expect("options").iter().for_each(|(name, value)| all[name] = value.clone());
        places(&tetrahedron(&all))
    };
    let sweep = |pointer: &str, to: f64| json!({ "sweep": { "pointer": pointer, "from": 0, "to": to } });
    assert_eq!(with(sweep("/plan/parameters/nothing", 1.0)), ["/outputs/0/sweep"]);
    assert_eq!(with(sweep("/levels", 1.0)), ["/outputs/0/sweep/pointer"]);
    assert_eq!(with(sweep("/plan/parameters/k", 1.0)), ["/outputs/0/sweep"], "k is whole");
    assert_eq!(with(json!({ "frames": 1 })), ["/outputs/0/frames"]);
    assert_eq!(with(json!({ "frames": 240, "width": 4000, "height": 4000 })), ["/outputs/0/frames"]);
    assert_eq!(with(json!({ "camera": { "eye": [9, 9, 9] } })), ["/outputs/0/camera/eye"]);
    let mut tolerant =
        tetrahedron(&json!({ "format": "apng", "sweep": sweep("/plan/parameters/delta", 1.0)["sweep"] }));
    tolerant["levels"] = json!({ "tolerance": 0.01 });
    assert_eq!(places(&tolerant), ["/levels"]);
}

#[test]
fn a_film_of_other_plans_has_another_key() {
    let key = |to: f64, delta: f64| {
        let mut job = tetrahedron(&json!({ "format": "apng", "frames": 3,
            "sweep": { "pointer": "/plan/parameters/delta", "from": 0, "to": to } }));
        job["plan"]["parameters"]["delta"] = json!(delta);
        parsed(job.to_string().as_bytes()).expect("a job").keys()[0]
    };
    assert_ne!(key(1.0, 0.25), key(0.5, 0.25));
    assert_eq!(key(1.0, 0.25), key(1.0, 0.75), "the parameter that moves has no value besides");
}

#[test]
fn a_film_stops_between_frames_and_books_all_of_them() {
    let film = |frames: u32| {
        let job = tetrahedron(&json!({ "format": "apng", "width": 64, "height": 48, "frames": frames,
            "sweep": { "pointer": "/plan/parameters/delta", "from": 0, "to": 1 } }));
        Limits::default().admit(parsed(job.to_string().as_bytes()).expect("a job")).expect("it is admitted")
    };
    let (short, long) = (film(2), film(20));
    let work = |admitted: &planish::job::limits::Admitted| admitted.estimate().forecast.work;
    assert!(work(&long) > 8 * work(&short), "{} and {}", work(&long), work(&short));
    let watch = Watch::new();
    run(&long, &long.job().outputs[0].clone(), &mut Vec::new(), &watch).expect("it runs");
    let watch = Watch::new();
    let stopping = watch.clone();
    let mut out = Stopping(stopping);
    let ended = run(&long, &long.job().outputs[0].clone(), &mut out, &watch);
    assert!(matches!(ended, Err(RunError::Stopped(_))), "{ended:?}");
}

/// A client that disconnects when the first bytes arrive.
struct Stopping(Watch);

impl std::io::Write for Stopping {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.stop();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
