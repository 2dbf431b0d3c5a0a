//! `planish evaluate`.

use serde_json::{Value, json};

use super::{REFUSED, USAGE, fails, run, saved, text};
use crate::http::jobs::{cube, mesh};
use crate::http::server::{Folder, settings, story};

#[test]
fn values_are_those_of_the_service() {
    let folder = Folder::new();
    let job = saved(&folder, &mesh(3));
    let names = "position,normal,curvatures";
    let output =
        run(&["evaluate", &job, "--at", "1,0.5,0.25", "--at", "2,0,0", "--closest", "-4,0,0.5", "--values", names]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let asked = json!({ "input": cube(), "plan": { "preset": "catmull-clark" }, "at": [[1, 0.5, 0.25], [2, 0, 0]],
        "closest": [[-4, 0, 0.5]], "values": ["position", "normal", "curvatures"] });
    let answered = story(settings(), async |server| server.post("/v1/evaluate", &asked).await.ok().json());
    assert_eq!(found, answered);
    let questions = folder.path().join("questions.json");
    let whole = json!({ "at": asked["at"], "closest": asked["closest"], "values": asked["values"] });
    std::fs::write(&questions, whole.to_string()).unwrap();
    let again = run(&["evaluate", &job, "--questions", questions.to_str().unwrap()]);
    assert_eq!(text(&again.stdout), text(&output.stdout));
}

#[test]
fn what_has_no_values_is_refused_by_its_flag() {
    let folder = Folder::new();
    let job = saved(&folder, &mesh(3));
    fails(REFUSED, &run(&["evaluate", &job, "--at", "9,0,0"]), &["--at 0 0", "the mesh has 6"]);
    fails(REFUSED, &run(&["evaluate", &job]), &["--at", "no place"]);
    fails(REFUSED, &run(&["evaluate", &job, "--at", "0,0,0", "--values", "colour"]), &["--values 0", "colour"]);
    fails(REFUSED, &run(&["evaluate", &job, "--at", "0,0,0", "--preset", "doo-sabin"]), &["--preset", "Catmull-Clark"]);
    fails(USAGE, &run(&["evaluate", &job, "--at", "here"]), &["--at", "here"]);
}
