//! `planish mcp`, as a client uses it.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

use base64::prelude::{BASE64_STANDARD, Engine};
use serde_json::{Value, json};

use super::planish;
use crate::http::jobs::{mesh, polygon, with};
use crate::http::server::Folder;

/// A client of the tools.
struct Client {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    calls: u64,
}

impl Client {
    /// Starts the program and performs the handshake.
    fn new(arguments: &[&str]) -> Self {
        let mut child = planish();
        child.arg("mcp").args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = child.spawn().unwrap();
        let (input, output) = (child.stdin.take().unwrap(), BufReader::new(child.stdout.take().unwrap()));
        let mut client = Self { child, input, output, calls: 0 };
        let hello = json!({ "protocolVersion": "2025-06-18", "capabilities": {},
            "clientInfo": { "name": "test", "version": "1" } });
        let said = client.ask("initialize", &hello);
        assert_eq!(said["result"]["serverInfo"]["name"], "planish", "{said}");
        assert!(said["result"]["instructions"].as_str().unwrap().contains("\"preset\": \"catmull-clark\""));
        client.send(&json!({ "jsonrpc": "2.0", "method": "notifications/initialized" }));
        client
    }

    fn send(&mut self, message: &Value) {
        writeln!(self.input, "{message}").unwrap();
        self.input.flush().unwrap();
    }

    fn ask(&mut self, method: &str, params: &Value) -> Value {
        self.calls += 1;
        let id = self.calls;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        loop {
            let mut line = String::new();
            assert!(self.output.read_line(&mut line).unwrap() > 0, "the program has ended");
            let said: Value = serde_json::from_str(&line).unwrap();
            if said["id"] == id {
                return said;
            }
        }
    }

    /// Returns the result of a tool, and whether it is a failure.
    fn call(&mut self, tool: &str, arguments: &Value) -> (Value, bool) {
        let said = self.ask("tools/call", &json!({ "name": tool, "arguments": arguments }));
        let result = &said["result"];
        assert!(result.is_object(), "{said}");
        (result["content"].clone(), result["isError"] == true)
    }

    /// Returns the only text of the result of a tool.
    fn text(&mut self, tool: &str, arguments: &Value) -> String {
        let (content, is_error) = self.call(tool, arguments);
        assert!(!is_error, "{content}");
        content[0]["text"].as_str().unwrap().to_owned()
    }

    /// Closes the input, after which the program exits by itself.
    fn leave(self) {
        let Self { mut child, input, .. } = self;
        drop(input);
        assert!(child.wait().unwrap().success());
    }
}

fn width(content: &Value) -> u32 {
    assert_eq!((&content["type"], &content["mimeType"]), (&json!("image"), &json!("image/png")), "{content}");
    let bytes = BASE64_STANDARD.decode(content["data"].as_str().unwrap()).unwrap();
    image::load_from_memory(&bytes).unwrap().width()
}

#[test]
fn a_client_lists_the_tools_and_calls_each() {
    let folder = Folder::new();
    let mut client = Client::new(&["--out", folder.path().to_str().unwrap()]);
    let said = client.ask("tools/list", &json!({}));
    let names: Vec<&str> =
        said["result"]["tools"].as_array().unwrap().iter().map(|tool| tool["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["render", "views", "validate", "estimate", "presets"]);
    assert!(client.text("presets", &json!({})).contains("catmull-clark"));
    let one: Value = serde_json::from_str(&client.text("presets", &json!({ "name": "four-point" }))).unwrap();
    assert_eq!(one["name"], "four-point");
    let mut wrong = mesh(1);
    wrong["input"]["mesh"]["faces"][2][1] = 77.into();
    let found: Value = serde_json::from_str(&client.text("validate", &json!({ "job": wrong }))).unwrap();
    assert_eq!((&found["valid"], &found["errors"][0]["pointer"]), (&json!(false), &json!("/input/mesh/faces/2/1")));
    let found: Value = serde_json::from_str(&client.text("estimate", &json!({ "job": mesh(3) }))).unwrap();
    assert_eq!(found["levels"][3]["faces"], 384);
    for job in [mesh(3), polygon(2)] {
        let (content, _) = client.call("render", &json!({ "job": job }));
        assert_eq!(width(&content[0]), 1024, "a job without outputs is drawn");
        let found: Value = serde_json::from_str(&client.text("estimate", &json!({ "job": job }))).unwrap();
        assert_eq!(found["outputs"][0]["format"], "png", "what it comes to is what it gives");
    }
    let mut job = with(mesh(2), "png");
    job["outputs"][0]["width"] = 80.into();
    let (content, _) = client.call("render", &json!({ "job": job }));
    assert_eq!(width(&content[0]), 80);
    assert!(client.text("render", &json!({ "job": with(polygon(2), "svg") })).starts_with("<svg"));
    let said = client.text("render", &json!({ "job": with(mesh(2), "glb") }));
    let path = said.split(" (").next().unwrap();
    assert!(std::fs::read(path).unwrap().starts_with(b"glTF"), "{said}");
    let (content, _) = client.call("views", &json!({ "job": mesh(2) }));
    assert_eq!(width(&content[0]), 900);
    client.leave();
}

#[test]
fn what_a_tool_cannot_do_is_a_failure_that_the_client_can_read() {
    let mut client = Client::new(&[]);
    let mut typo = mesh(1);
    typo["level"] = 2.into();
    for (tool, arguments, told) in [
        ("render", json!({ "job": typo }), "/level"),
        ("render", json!({}), "job"),
        ("render", json!({ "job": with(mesh(2), "glb") }), "--out"),
        ("render", json!({ "job": with(mesh(20), "png") }), "ask for at most"),
        ("views", json!({}), "job"),
        ("presets", json!({ "name": "nothing" }), "four-point"),
        ("presets", json!({ "preset": "four-point" }), "presets knows name"),
        ("presets", json!({ "name": 5 }), "no text"),
        ("estimate", json!({ "job": mesh(1), "level": 3 }), "estimate knows job"),
    ] {
        let (content, is_error) = client.call(tool, &arguments);
        assert!(is_error && content[0]["text"].as_str().unwrap().contains(told), "{tool}: {content}");
    }
    let unknown = client.ask("tools/call", &json!({ "name": "nothing", "arguments": {} }));
    assert!(unknown["error"]["message"].as_str().unwrap().contains("views"), "{unknown}");
    client.leave();
}
