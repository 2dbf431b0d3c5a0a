//! Traces in and out, the reference page, and the metrics of the example dashboard.

use std::collections::BTreeSet;
use std::path::Path;

use super::jobs::{polygon, with};
use super::server::{settings, story};

#[test]
fn a_trace_goes_on_in_the_answer_and_names_the_refusal() {
    story(settings(), async |server| {
        let (id, parent) = ("4bf92f3577b34da6a3ce929d0e0e4736", "00f067aa0ba902b7");
        let named = format!("00-{id}-{parent}-01");
        let traced = [("traceparent", named.as_str())];
        // the second answer bypasses the router, the third is a refusal
        for job in [with(polygon(1), "svg"), with(polygon(1), "svg"), with(polygon(1), "svg")] {
            let answer = server.post_with("/v1/render", &job, &traced).await.ok();
            let told = answer.header("traceparent");
            assert!(told.starts_with(&format!("00-{id}-")) && told.ends_with("-01"), "{told}");
            assert!(told.len() == 55 && !told.contains(parent), "the part of the trace is a new one: {told}");
        }
        let refused = server.post_with("/v1/render", &with(polygon(1), "nothing"), &traced).await;
        assert_eq!(refused.problem(422, "invalid-job")["trace_id"], id);
        for wrong in ["00-0-0-00", "", "garbage", &named.to_uppercase()] {
            let answer = server.get_with("/v1/jobs/0", &[("traceparent", wrong)]).await;
            assert_eq!(answer.header("traceparent"), "", "{wrong}");
            let trace_id = answer.problem(404, "not-found")["trace_id"].as_str().unwrap().to_owned();
            assert!(trace_id.len() == 32 && trace_id != id, "{trace_id}");
        }
        assert_eq!(server.get("/livez").await.header("traceparent"), "", "who names no trace gets none");
    });
}

#[test]
fn the_reference_shows_every_operation_and_schema_and_loads_nothing() {
    story(settings(), async |server| {
        let page = server.get("/docs").await.ok();
        let policy = page.header("content-security-policy");
        assert!(policy.starts_with("default-src 'none'; style-src 'sha256-"), "{policy}");
        let text = page.text();
        let document = server.get("/openapi.json").await.ok().json();
        for (path, verbs) in document["paths"].as_object().unwrap() {
            for verb in verbs.as_object().unwrap().keys().filter(|verb| *verb != "head") {
                let heading = format!("<span class=\"verb\">{}</span>{path}</h3>", verb.to_uppercase());
                assert!(text.contains(&heading), "{heading}");
            }
        }
        for name in document["components"]["schemas"].as_object().unwrap().keys() {
            assert!(text.contains(&format!("<h3 id=\"schema-{name}\">{name}</h3>")), "{name}");
        }
        let places: BTreeSet<&str> = text.split(" id=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
        for link in text.split("href=\"#").skip(1).map(|rest| rest.split('"').next().unwrap()) {
            assert!(places.contains(link), "#{link} leads nowhere");
        }
        for loads in ["<script", "src=", "@import", "url(", "http://", "style=\""] {
            assert!(!text.contains(loads), "{loads}");
        }
    });
}

#[test]
fn the_dashboard_and_the_alerts_watch_metrics_that_exist() {
    story(settings(), async |server| {
        server.render(&with(polygon(1), "svg")).await.ok();
        super::server::until("the canary has sung", || server.app.canary.last_success().is_some()).await;
        let page = server.get("/metrics").await.ok().text();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docker");
        let mut watched = BTreeSet::new();
        for file in ["dashboard.json", "alerts.yaml"] {
            let text = std::fs::read_to_string(folder.join(file)).unwrap();
            let is_of_name = |c: char| c.is_ascii_lowercase() || c == '_';
            let names = text.match_indices("planish_").map(|(at, _)| &text[at..]);
            watched.extend(names.map(|name| name[..name.find(|c| !is_of_name(c)).unwrap()].to_owned()));
        }
        assert!(watched.len() > 12, "{watched:?}");
        for name in watched {
            let known = ["", "_bucket"]
                .iter()
                .any(|end| page.contains(&format!("# TYPE {} ", name.strip_suffix(end).unwrap_or(&name))));
            assert!(known, "there is no metric {name}");
        }
        let dashboard = std::fs::read(folder.join("dashboard.json")).unwrap();
        let dashboard: serde_json::Value = serde_json::from_slice(&dashboard).unwrap();
        assert!(dashboard["panels"].as_array().unwrap().len() > 10);
        let alerts = std::fs::read_to_string(folder.join("alerts.yaml")).unwrap();
        let mut asked: Vec<&str> = alerts.lines().filter_map(|line| line.trim().strip_prefix("expr: ")).collect();
        let panels = dashboard["panels"].as_array().unwrap();
        let targets = panels.iter().flat_map(|panel| panel["targets"].as_array().unwrap());
        asked.extend(targets.map(|target| target["expr"].as_str().unwrap()));
        assert!(asked.len() > 20, "{asked:?}");
        asked.iter().for_each(|asked| labels_exist(asked, &page));
    });
}

/// Checks that every label by which a query selects or sums belongs to one of its metrics.
fn labels_exist(query: &str, page: &str) {
    let mut known = BTreeSet::from(["instance", "job"]);
    let words: BTreeSet<&str> = query.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').collect();
    for line in page.lines().filter(|line| words.iter().any(|word| line.starts_with(&format!("{word}{{")))) {
        let labels = line.split(['{', '}']).nth(1).unwrap().split("\",");
        known.extend(labels.map(|label| label.split('=').next().unwrap()));
    }
    let lists = |open: &str, close: char| -> Vec<String> {
        let parts = query.split(open).skip(1);
        parts.map(|rest| rest.split(close).next().unwrap().to_owned()).collect()
    };
    for list in lists("by (", ')').into_iter().chain(lists("{", '}')) {
        for label in list.split(',').map(|label| label.split(['=', '!']).next().unwrap().trim()) {
            assert!(known.contains(label), "no metric of `{query}` has a label {label}, only {known:?}");
        }
    }
}
