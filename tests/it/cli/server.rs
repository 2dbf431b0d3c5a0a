//! `planish render --server`.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpListener;
use std::process::Output;
use std::thread::{self, JoinHandle};

use serde_json::{Value, json};

use super::{FILES, LIMIT, OTHER, REFUSED, USAGE, fails, planish, run, saved, text};
use crate::http::jobs::{mesh, polygon, with};
use crate::http::server::{Folder, Server, settings, story};

/// Runs the program with `--server` while a server answers it.
async fn beside(server: &Server, arguments: &[&str]) -> Output {
    let mut command = planish();
    command.args(arguments).args(["--server", &server.url("")]);
    tokio::task::spawn_blocking(move || command.output().unwrap()).await.unwrap()
}

#[test]
fn jobs_and_mesh_files_have_the_bytes_that_they_have_here() {
    let folder = Folder::new();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(path("cube.json"), with(mesh(2), "ply").to_string()).unwrap();
    fs::write(path("square.json"), polygon(3).to_string()).unwrap();
    fs::write(path("tetra.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n").unwrap();
    let inputs = [path("cube.json"), path("square.json"), path("tetra.obj")];
    let mut arguments: Vec<&str> = vec!["render"];
    arguments.extend(inputs.iter().map(String::as_str));
    arguments.extend(["--format", "obj"]);
    let (there, here) = (path("there/{stem}.obj"), path("here/{stem}.obj"));
    story(settings(), async |server| {
        let made = beside(server, &[&arguments[..], &["-o", &there]].concat()).await;
        assert!(made.status.success(), "{}", text(&made.stderr));
        assert!(text(&made.stderr).contains("3 of 3 inputs rendered"), "{}", text(&made.stderr));
    });
    assert!(run(&[&arguments[..], &["-o", &here]].concat()).status.success());
    for stem in ["cube", "square", "tetra"] {
        let [there, here] = ["there", "here"].map(|folder| fs::read(path(&format!("{folder}/{stem}.obj"))).unwrap());
        assert_eq!(there, here, "{stem}");
    }
}

#[test]
fn failures_end_with_the_codes_that_they_have_here() {
    let folder = Folder::new();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let mut typo = with(mesh(1), "ply");
    typo["plan"]["preset"] = "catmul-clark".into();
    fs::write(path("typo.json"), typo.to_string()).unwrap();
    fs::write(path("large.json"), with(mesh(30), "ply").to_string()).unwrap();
    fs::write(path("good.json"), with(mesh(1), "ply").to_string()).unwrap();
    story(settings(), async |server| {
        let out = path("out.ply");
        let refused = beside(server, &["render", &path("typo.json"), "-o", &out]).await;
        fails(REFUSED, &refused, &["typo.json", "/plan/preset", "catmull-clark"]);
        let large = beside(server, &["render", &path("large.json"), "-o", &out]).await;
        fails(LIMIT, &large, &["large.json", "ask for at most"]);
        let inputs = ["typo.json", "large.json", "good.json"].map(path);
        let all: Vec<&str> = inputs.iter().map(String::as_str).collect();
        let several = beside(server, &[&["render"], &all[..], &["-o", &path("{stem}.ply")]].concat()).await;
        fails(OTHER, &several, &["1 of 3 inputs", "1 refused", "1 beyond a limit"]);
        assert!(fs::metadata(path("good.ply")).is_ok() && fs::metadata(path("typo.ply")).is_err());
    });
}

/// Starts a service that gives these answers, one per connection, and returns the heads of the requests.
fn scripted(answers: Vec<String>) -> (String, JoinHandle<Vec<String>>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}", listener.local_addr().unwrap());
    let serve = move || {
        let mut heads = Vec::new();
        for answer in answers {
            let mut stream = BufReader::new(listener.accept().unwrap().0);
            let (mut head, mut length) = (String::new(), 0);
            loop {
                let mut line = String::new();
                stream.read_line(&mut line).unwrap();
                if let Some(n) = line.to_ascii_lowercase().strip_prefix("content-length:") {
                    length = n.trim().parse().unwrap();
                }
                if line.trim().is_empty() {
                    break;
                }
                head += &line;
            }
            stream.read_exact(&mut vec![0; length]).unwrap();
            stream.get_mut().write_all(answer.as_bytes()).unwrap();
            heads.push(head);
        }
        heads
    };
    (url, thread::spawn(serve))
}

fn answer(status: &str, headers: &str, body: &str) -> String {
    format!("HTTP/1.1 {status}\r\n{headers}content-length: {}\r\nconnection: close\r\n\r\n{body}", body.len())
}

fn problem(status: &str, headers: &str, detail: &str) -> String {
    answer(status, headers, &json!({ "type": "/docs/problems/any", "detail": detail }).to_string())
}

#[test]
fn a_busy_service_is_asked_again_and_a_long_job_is_followed() {
    let (folder, place) = (Folder::new(), "location: /v1/jobs/7\r\n");
    let job = saved(&folder, &with(mesh(1), "obj"));
    let (url, service) = scripted(vec![
        problem("503 Service Unavailable", "retry-after: 0\r\n", "busy"),
        problem("429 Too Many Requests", "retry-after: 1\r\n", "quota"),
        answer("202 Accepted", place, "{}"),
        answer("200 OK", "retry-after: 0\r\n", &json!({ "state": "running" }).to_string()),
        answer("200 OK", "", &json!({ "state": "done", "outputs": [{ "href": "/v1/artifacts/8.obj" }] }).to_string()),
        answer("200 OK", "", "v 0 0 0\n"),
    ]);
    let made = run(&["render", &job, "-o", "-", "--server", &url, "--key", "planish_k_s"]);
    assert_eq!((made.status.code(), text(&made.stdout).as_str()), (Some(0), "v 0 0 0\n"), "{}", text(&made.stderr));
    let heads = service.join().unwrap();
    let lines: Vec<&str> = heads.iter().map(|head| head.lines().next().unwrap()).collect();
    let (post, look) = ("POST /v1/render HTTP/1.1", "GET /v1/jobs/7 HTTP/1.1");
    assert_eq!(lines, [post, post, post, look, look, "GET /v1/artifacts/8.obj HTTP/1.1"]);
    assert!(heads.iter().all(|head| head.contains("Bearer planish_k_s")), "{heads:?}");
    assert!(heads[0].contains("wait="), "{}", heads[0]);
}

#[test]
fn patience_ends_and_keys_and_addresses_are_told_to_be_wrong() {
    let folder = Folder::new();
    let job = saved(&folder, &with(mesh(1), "obj"));
    let (url, service) =
        scripted(vec![problem("503 Service Unavailable", "retry-after: 30\r\n", "all lanes are full")]);
    let args = |url: &str| ["render", &job, "-o", "-", "--patience", "2", "--server", url].map(str::to_owned);
    let call = |url: &str| planish().args(args(url)).output().unwrap();
    fails(FILES, &call(&url), &["all lanes are full", "2 s"]);
    service.join().unwrap();
    let (url, service) = scripted(vec![problem("401 Unauthorized", "", "the key is unknown")]);
    fails(USAGE, &call(&url), &["--key", "the key is unknown"]);
    service.join().unwrap();
    // nothing listens there any more
    fails(FILES, &call(&url), &["no answer"]);
    fails(USAGE, &call("ftp://127.0.0.1"), &["--server"]);
    fails(USAGE, &call("http://"), &["--server"]);
    let value: Value = serde_json::from_str(&fs::read_to_string(&job).unwrap()).unwrap();
    assert_eq!(value["levels"], 1, "the job is left alone");
}

#[test]
fn answers_that_no_planish_gives_are_no_results() {
    let folder = Folder::new();
    let job = saved(&folder, &with(mesh(1), "obj"));
    let out = folder.path().join("out.obj");
    let call = |url: &str| run(&["render", &job, "-o", out.to_str().unwrap(), "--patience", "2", "--server", url]);
    let place = "location: /v1/jobs/7\r\n";
    let (nowhere, elsewhere) = ("", "location: http://elsewhere.example/v1/jobs/7\r\n");
    for headers in [nowhere, elsewhere] {
        let (url, service) = scripted(vec![answer("202 Accepted", headers, "{\"state\":\"queued\"}")]);
        fails(FILES, &call(&url), &[&url, "as no planish does", "202", "Location"]);
        service.join().unwrap();
    }
    let (url, service) = scripted(vec![answer("202 Accepted", place, "{}"), answer("200 OK", "", "{}")]);
    fails(FILES, &call(&url), &[&url, "as no planish does", "no state"]);
    service.join().unwrap();
    assert!(!out.exists(), "what is no result is not written");
}

#[test]
fn the_upload_the_job_and_its_states_have_one_patience_together() {
    let folder = Folder::new();
    let job = saved(&folder, &with(mesh(1), "obj"));
    let file = folder.path().join("triangle.obj");
    fs::write(&file, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let busy = || problem("503 Service Unavailable", "retry-after: 1\r\n", "all lanes are full");
    let running = || answer("200 OK", "retry-after: 1\r\n", &json!({ "state": "running" }).to_string());
    let accepted = answer("202 Accepted", "location: /v1/jobs/7\r\n", "{}");
    // The service is gone after its last answer. A client that began to count anew with the job, or with its states,
    // would ask once more and find nobody; one on a slow machine gives up earlier.
    let call = |input: &str, answers: Vec<String>| {
        let (url, _service) = scripted(answers);
        let made = run(&["render", input, "-o", "-", "--format", "obj", "--patience", "2", "--server", &url]);
        fails(FILES, &made, &["2 s"]);
        assert!(!text(&made.stderr).contains("no answer"), "{}", text(&made.stderr));
    };
    call(file.to_str().unwrap(), vec![busy(), answer("200 OK", "", &json!({ "id": "7" }).to_string()), busy()]);
    call(&job, vec![busy(), accepted, running(), running()]);
}

/// Starts a service that answers one request over TLS, and returns its certificate.
fn sealed(answer: String) -> (String, u16, JoinHandle<()>) {
    let made = rcgen::generate_simple_self_signed(vec!["localhost".to_owned()]).unwrap();
    let key = rustls::pki_types::PrivatePkcs8KeyDer::from(made.signing_key.serialize_der());
    let ring = std::sync::Arc::new(rustls::crypto::ring::default_provider());
    let versions = rustls::ServerConfig::builder_with_provider(ring).with_safe_default_protocol_versions().unwrap();
    let tls = versions.with_no_client_auth().with_single_cert(vec![made.cert.der().clone()], key.into()).unwrap();
    let tls = std::sync::Arc::new(tls);
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let serve = move || {
        let (socket, _) = listener.accept().unwrap();
        let connection = rustls::ServerConnection::new(tls).unwrap();
        let mut stream = BufReader::new(rustls::StreamOwned::new(connection, socket));
        let mut length = 0;
        loop {
            let mut line = String::new();
            // a client that does not trust the certificate disconnects
            if stream.read_line(&mut line).unwrap_or(0) == 0 {
                return;
            }
            let line = line.trim_end().to_ascii_lowercase();
            if line.is_empty() {
                break;
            }
            length = line.strip_prefix("content-length: ").map_or(length, |text| text.parse().unwrap());
        }
        stream.read_exact(&mut vec![0; length]).unwrap();
        stream.get_mut().write_all(answer.as_bytes()).unwrap();
        stream.get_mut().conn.send_close_notify();
        stream.get_mut().flush().unwrap();
    };
    (made.cert.pem(), port, thread::spawn(serve))
}

#[test]
fn a_service_is_asked_over_tls_where_its_certificate_is_trusted() {
    let folder = Folder::new();
    let job = saved(&folder, &with(mesh(1), "obj"));
    let file = folder.path().join("trusted.pem");
    let call = |port: u16| {
        let url = format!("https://localhost:{port}");
        let arguments = ["render", &job, "-o", "-", "--patience", "2", "--server", &url];
        planish().args(arguments).env("SSL_CERT_FILE", &file).output().unwrap()
    };
    let answer = "HTTP/1.1 200 OK\r\ncontent-length: 4\r\nconnection: close\r\n\r\nv 1\n";
    let (certificate, port, service) = sealed(answer.to_owned());
    fs::write(&file, certificate).unwrap();
    let made = call(port);
    assert_eq!((made.status.success(), &*text(&made.stdout)), (true, "v 1\n"), "{}", text(&made.stderr));
    service.join().unwrap();
    // another certificate is not trusted for this service
    let (_, port, service) = sealed(answer.to_owned());
    fails(FILES, &call(port), &["is asked again", "certificate"]);
    drop(service);
}
