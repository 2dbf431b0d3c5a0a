//! Flags: those of jobs and formats are derived from their declarations, and are equivalent to a job.

use std::collections::BTreeSet;

use planish::output::FORMATS;
use serde_json::{Value, json};

use super::{FILES, REFUSED, USAGE, fails, fed, piped, run, saved, text};
use crate::http::jobs::{mesh, with};
use crate::http::server::Folder;
use crate::support::render;

/// Writes a cube as OBJ into a folder and returns its path.
fn cube(folder: &Folder) -> String {
    let path = folder.path().join("cube.obj");
    std::fs::write(&path, render(&with(json!({ "input": mesh(0)["input"] }), "obj")).unwrap().0).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn every_option_of_every_format_and_every_simple_field_of_a_job_is_a_flag() {
    let help = text(&run(&["render", "--help"]).stdout);
    let flags: BTreeSet<&str> = help.split_whitespace().filter(|word| word.starts_with("--")).collect();
    let has = |name: &str| flags.iter().any(|flag| flag.split(['=', '[']).next() == Some(name));
    for parameter in FORMATS.iter().flat_map(|format| format.facts().parameters) {
        assert!(has(&format!("--{}", parameter.name.replace('_', "-"))), "{}", parameter.name);
    }
    let document: Value = serde_json::from_str(&planish::http::document_text()).unwrap();
    let schemas = &document["components"]["schemas"];
    let kinds = schemas["InputRequest"]["oneOf"].as_array().unwrap();
    let of = |kind: &Value| kind["$ref"].as_str().unwrap().rsplit('/').next().unwrap().to_owned();
    let fields = kinds.iter().flat_map(|kind| schemas[of(kind)]["properties"].as_object().unwrap());
    for (name, field) in fields {
        let text = field.to_string();
        let is_simple =
            !["MeshRequest", "TextRequest", "Polygon", "array", "object"].iter().any(|part| text.contains(part));
        let is_option = FORMATS.iter().flat_map(|format| format.facts().parameters).any(|option| option.name == name);
        // only servers have uploads
        let is_flag = (is_simple && name != "blob") || is_option;
        assert_eq!(has(&format!("--{}", name.replace('_', "-"))), is_flag, "{name}");
    }
    assert!(["--preset", "--word", "--boundary", "--ends", "--seed"].into_iter().all(has));
    for name in ["--levels", "--tolerance", "--parameter", "--frame", "--input-format", "--quiet"] {
        assert!(has(name), "{name}");
    }
}

#[test]
fn flags_say_what_a_job_says_to_the_same_bytes() {
    let folder = Folder::new();
    let cube = cube(&folder);
    let same = |flags: &[&str], output: Value| {
        let format = output["format"].as_str().unwrap().to_owned();
        let made = run(&[&["render", &cube, "-o", "-", "--format", &format], flags].concat());
        assert!(made.status.success(), "{flags:?}: {}", text(&made.stderr));
        let mut job = mesh(1);
        job["outputs"] = json!([output]);
        assert_eq!(made.stdout, render(&job).unwrap().0, "{flags:?}");
    };
    let refined = ["--preset", "catmull-clark", "--levels", "1"];
    let with = |flags: &[&'static str]| [&refined[..], flags].concat();
    same(
        &with(&[
            "--width",
            "64",
            "--height=48",
            "--show",
            "surface,wireframe",
            "--camera",
            "azimuth-deg=10,zoom=1.5",
            "--camera",
            "eye=3,4,5",
            "--background",
            "transparent",
            "--shading",
            "flat",
        ]),
        json!({ "format": "png", "width": 64, "height": 48, "show": ["surface", "wireframe"],
            "camera": { "azimuth_deg": 10, "zoom": 1.5, "eye": [3, 4, 5] }, "background": "transparent",
            "shading": "flat" }),
    );
    same(
        &with(&["--sections", "point=0,0,0.1,normal=0,0,1", "--sections", "point=0,0.2,0,normal=0,1,0"]),
        json!({ "format": "json", "sections": [{ "point": [0, 0, 0.1], "normal": [0, 0, 1] },
            { "point": [0, 0.2, 0], "normal": [0, 1, 0] }] }),
    );
    same(&with(&["--ascii", "--precision", "f32"]), json!({ "format": "ply", "ascii": true, "precision": "f32" }));
    same(&with(&["--ids", "--positions", "limit"]), json!({ "format": "json", "ids": true, "positions": "limit" }));
    same(
        &with(&["--camera", "{\"zoom\": 2}", "--width", "32"]),
        json!({ "format": "png", "width": 32, "camera": { "zoom": 2 } }),
    );
}

#[test]
fn a_material_is_given_by_its_fields() {
    let folder = Folder::new();
    let cube = cube(&folder);
    let mut job = mesh(1);
    job["input"]["material"] = json!({ "color": [1, 0.5, 0], "roughness": 0.25, "alpha_mode": "mask" });
    job["outputs"] = json!([{ "format": "glb" }]);
    let flags = ["render", &cube, "-o", "-", "--format", "glb", "--preset", "catmull-clark", "--levels", "1"];
    for material in [
        &["--material", "color=1,0.5,0,roughness=0.25,alpha-mode=mask"][..],
        &["--material", "color=1,0.5,0", "--material", "roughness=0.25", "--material", "alpha_mode=mask"],
        &["--material", r#"{"color": [1, 0.5, 0], "roughness": 0.25, "alpha_mode": "mask"}"#],
    ] {
        let made = run(&[&flags, material].concat());
        assert!(made.status.success(), "{material:?}: {}", text(&made.stderr));
        assert_eq!(made.stdout, render(&job).unwrap().0, "{material:?}");
    }
    for (code, material, said) in [
        (USAGE, "red", "--material: write it as name=value,name=value with the names alpha_cutoff"),
        (USAGE, "color=red", "--material color: \"red\" is not a colour"),
        (REFUSED, "roughness=2", "--material roughness: 2 is not from 0 to 1"),
        (USAGE, "colour=#fff", "--material colour: unknown field \"colour\"; did you mean \"color\"?"),
    ] {
        fails(code, &run(&[&flags, &["--material", material][..]].concat()), &[said]);
    }
}

#[test]
fn schemes_are_given_by_flags() {
    let folder = Folder::new();
    let cube = cube(&folder);
    let same = |flags: &[&str], plan: Value, levels: Value| {
        let made = run(&[&["render", &cube, "-o", "-", "--format", "stats"], flags].concat());
        assert!(made.status.success(), "{flags:?}: {}", text(&made.stderr));
        let mut job = with(mesh(1), "stats");
        (job["plan"], job["levels"]) = (plan, levels);
        assert_eq!(made.stdout, render(&job).unwrap().0, "{flags:?}");
    };
    same(
        &["--word", "UUCP(UC)", "-p", "alpha=pi/5", "-p", "delta=0.5", "--levels", "2", "--boundary", "edge-only"],
        json!({ "word": "UUCP(UC)", "parameters": { "alpha": "pi/5", "delta": 0.5 }, "boundary": "edge-only" }),
        json!(2),
    );
    same(
        &["--preset", "push-back", "-p", "kernel=cos(alpha/2),1", "-p", "k=2", "--seed", "7", "--levels", "1"],
        json!({ "preset": "push-back", "parameters": { "kernel": ["cos(alpha/2)", 1], "k": 2 }, "seed": 7 }),
        json!(1),
    );
    same(
        &["--preset", "catmull-clark", "--tolerance", "0.05"],
        json!({ "preset": "catmull-clark" }),
        json!({ "tolerance": 0.05 }),
    );
}

#[test]
fn flags_take_the_place_of_what_a_job_says() {
    let folder = Folder::new();
    let mut job = mesh(3);
    job["outputs"] = json!([{ "format": "obj" }, { "format": "png", "width": 60, "height": 40 }]);
    let path = saved(&folder, &job);
    let made = run(&["render", &path, "-o", "-", "--format", "png", "--width", "80", "--levels", "1", "--unit", "mm"]);
    job["levels"] = json!(1);
    job["input"]["unit"] = json!("mm");
    job["outputs"] = json!([{ "format": "png", "width": 80, "height": 40 }]);
    assert_eq!(made.stdout, render(&job).unwrap().0, "{}", text(&made.stderr));
    let other = run(&["render", &path, "-o", "-", "--format", "obj", "--preset", "bilinear"]);
    job = mesh(3);
    job["plan"] = json!({ "preset": "bilinear" });
    assert_eq!(other.stdout, render(&with(job, "obj")).unwrap().0, "{}", text(&other.stderr));
}

#[test]
fn distances_are_measured_from_the_job_or_mesh_file_that_a_flag_names() {
    let folder = Folder::new();
    let cube = cube(&folder);
    let other = saved(&folder, &mesh(2));
    let measured = |flags: &[&str]| {
        let all = ["render", &cube, "-o", "-", "--format", "png", "--shading", "distance", "--width", "64"];
        run(&[&all[..], &["--height", "48"], flags].concat())
    };
    let mut job = json!({ "input": mesh(0)["input"] });
    job["outputs"] = json!([{ "format": "png", "width": 64, "height": 48, "shading": "distance" }]);
    job["distance_to"] = mesh(2);
    let made = measured(&["--distance-to", &other]);
    assert_eq!(made.stdout, render(&job).unwrap().0, "{}", text(&made.stderr));
    job["distance_to"] = json!({ "input": job["input"] });
    let made = measured(&["--distance-to", &cube]);
    assert_eq!(made.stdout, render(&job).unwrap().0, "{}", text(&made.stderr));
    let curve = json!({ "input": { "polygon": { "points": [[0, 0], [1, 0], [1, 1]] } } });
    fails(REFUSED, &measured(&["--distance-to", &saved(&folder, &curve)]), &["--distance-to: ", "give a mesh"]);
    let missing = folder.path().join("none.obj");
    fails(FILES, &measured(&["--distance-to", missing.to_str().unwrap()]), &["none.obj", "cannot be read"]);
}

#[test]
fn messages_speak_of_flags_where_flags_were_given_and_of_pointers_where_a_job_was() {
    let folder = Folder::new();
    let cube = cube(&folder);
    let job = saved(&folder, &mesh(1));
    let render = |input: &str, flags: &[&str]| run(&[&["render", input, "-o", "x.png"], flags].concat());
    for input in [&cube, &job] {
        fails(USAGE, &render(input, &["--width", "3"]), &["--width: 3 is not a whole number from 16 to 8192"]);
        fails(USAGE, &render(input, &["--shading", "flt"]), &["--shading: ", "did you mean \"flat\"?"]);
        fails(USAGE, &render(input, &["--camera", "zooom=2"]), &["--camera zooom: ", "did you mean \"zoom\"?"]);
        fails(USAGE, &render(input, &["--ids"]), &["--ids: unknown option \"ids\""]);
        fails(USAGE, &render(input, &["--wdth", "300"]), &["--wdth", "--width"]);
        fails(USAGE, &render(input, &["--preset", "catmul-clark"]), &["--preset: ", "did you mean \"catmull-clark\"?"]);
        fails(USAGE, &render(input, &["--preset", "butterfly", "-p", "v=1"]), &["--parameter v: ", "known here: w"]);
        fails(USAGE, &render(input, &["--word", "UX"]), &["--word: "]);
        fails(USAGE, &render(input, &["--orient", "repiar"]), &["--orient: ", "did you mean \"repair\"?"]);
        fails(
            USAGE,
            &render(input, &["--levels", "two"]),
            &["--levels: \"two\", expected a whole number of levels such as 3, a --tolerance in place of it"],
        );
        fails(USAGE, &render(input, &["--levels", "-1"]), &["--levels: \"-1.0\", expected a whole number"]);
        fails(USAGE, &render(input, &["--camera", "x"]), &["--camera: write it as name=value,", "names projection, "]);
        fails(
            USAGE,
            &render(input, &["--camera", "eye=1,2"]),
            &["--camera eye: 2 entries; expected three numbers like"],
        );
        fails(USAGE, &render(input, &["--max-faces", "many"]), &["--max-faces", "write it like 20000000"]);
        fails(USAGE, &render(input, &["--levels", "2", "--tolerance", "1"]), &["--levels", "--tolerance"]);
        fails(USAGE, &render(input, &["-p", "w"]), &["NAME=VALUE, for example w=0.05"]);
        let unfit = render(input, &["--preset", "loop", "--levels", "1"]);
        fails(REFUSED, &unfit, &[": --preset: face 0 has 4 vertices"]);
        fails(REFUSED, &render(input, &["--weld", "-1"]), &[": --weld: "]);
    }
    fails(REFUSED, &render(&cube, &["--preset", "bilinear"]), &[": --levels: ", "--tolerance"]);
    fails(REFUSED, &render(&cube, &["--levels", "2"]), &["2 levels of what? name a --preset or a --word"]);
    fails(REFUSED, &fed(&["render", "-", "-o", "-"], b"\n"), &["standard input: it is empty; give a job (JSON)"]);
    let marked = fed(&["render", "-", "-o", "-"], b"\xef\xbb\xbf{}");
    fails(REFUSED, &marked, &["standard input: it begins with a byte order mark, JSON is UTF-8 without one"]);
    fails(
        REFUSED,
        &fed(&["render", "-", "-o", "-"], b"\xff\xfe{\0}\0"),
        &["standard input: it is UTF-16, JSON is UTF-8"],
    );
    let mut wrong = mesh(1);
    wrong["outputs"] = json!([{ "format": "png", "width": 3 }]);
    let output = piped(&["render", "-", "-o", "-"], &wrong);
    fails(REFUSED, &output, &["standard input: /outputs/0/width: 3 is not a whole number"]);
    fails(USAGE, &run(&["render", &cube, "-o", "x.gbl"]), &["did you mean \"glb\"?"]);
    fails(USAGE, &run(&["render", &cube, "-o", "x", "--format", "pngg"]), &["--format: ", "did you mean \"png\"?"]);
    fails(USAGE, &run(&["prestes"]), &["'presets'"]);
}

#[test]
fn validation_says_what_the_service_says_of_jobs_and_of_files() {
    let folder = Folder::new();
    let cube = cube(&folder);
    let sound = with(mesh(2), "glb");
    let mut wrong = sound.clone();
    wrong["levels"] = json!(99);
    wrong["outputs"][0]["precision"] = json!("f32");
    let settings = crate::http::server::settings();
    let answers = crate::http::server::story(settings, async |server| {
        [server.post("/v1/validate", &sound).await.json(), server.post("/v1/validate", &wrong).await.json()]
    });
    for (job, answer) in [&sound, &wrong].into_iter().zip(answers) {
        let output = piped(&["validate", "-"], job);
        assert_eq!(serde_json::from_slice::<Value>(&output.stdout).unwrap(), answer);
        assert_eq!(output.status.code(), Some(if answer["valid"] == true { 0 } else { REFUSED }));
    }
    let job = saved(&folder, &wrong);
    let output = run(&["validate", &cube, &job, "--preset", "catmull-clark", "--levels", "99"]);
    assert_eq!(output.status.code(), Some(REFUSED), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    let lines: Vec<Value> = said.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((lines.len(), &lines[0]["input"]), (2, &json!(cube)));
    assert_eq!(lines[0]["errors"][0]["pointer"], "--levels", "{said}");
    assert_eq!(lines[0]["report"]["faces"], 6, "{said}");
    assert!(lines[1]["errors"].to_string().contains("/outputs/0/precision"), "{said}");
    let quiet = run(&["validate", &cube, "-q"]);
    assert!(quiet.status.success() && quiet.stdout.is_empty());
}

#[test]
fn formats_completions_and_manuals_are_made_of_the_commands() {
    let list = text(&run(&["formats"]).stdout);
    for format in FORMATS {
        assert!(list.lines().any(|line| line.starts_with(format.name())), "{}", format.name());
        let one = text(&run(&["formats", format.name()]).stdout);
        assert!(format.facts().parameters.iter().all(|option| one.contains(option.name)), "{one}");
    }
    assert!(list.contains("\noff "), "readers are listed: {list}");
    fails(USAGE, &run(&["formats", "gltff"]), &["did you mean \"gltf\"?", "planish formats"]);
    assert!(text(&run(&["operators"]).stdout).lines().any(|line| line.starts_with("U ")));
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = text(&run(&["completions", shell]).stdout);
        assert!(script.contains("tolerance") && script.contains("wireframe"), "{shell}");
    }
    fails(USAGE, &run(&["completions", "bsh"]), &["bash"]);
    assert!(text(&run(&["man"]).stdout).contains(".TH planish 1"));
    let page = text(&run(&["man", "render"]).stdout);
    assert!(page.contains("camera") && page.contains("Exit codes"), "{page}");
    fails(USAGE, &run(&["man", "rendr"]), &["did you mean \"render\"?"]);
}
