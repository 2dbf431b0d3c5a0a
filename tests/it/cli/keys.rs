//! `planish key` and `planish sign`.

use planish::config::keys::{Link, Token};

use super::{FILES, REFUSED, USAGE, planish, text};
use crate::http::jobs::{mesh, polygon, with};
use crate::http::keys::keyed;
use crate::http::server::{Folder, story, until};

fn key(folder: &Folder, arguments: &[&str]) -> (i32, String, String) {
    let output = planish().arg("key").args(arguments).arg("--data-dir").arg(folder.path()).output().unwrap();
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn keys_are_made_listed_and_revoked_and_only_their_hashes_are_kept() {
    let folder = Folder::new();
    let (code, _, told) = key(&folder, &["list"]);
    assert!(code == 0 && told.contains("there are no keys"), "{told}");
    let (code, made, told) = key(&folder, &["add", "--tenant", "acme", "--role", "read", "--expires-in", "90d"]);
    assert!(code == 0 && told.contains("shown this once"), "{told}");
    let token = Token::parse(made.trim()).unwrap();
    let (_, other, _) = key(&folder, &["add"]);
    assert_ne!(made, other, "secrets are random");
    let (_, list, _) = key(&folder, &["list"]);
    let line = list.lines().find(|line| line.starts_with(token.id())).unwrap();
    assert!(line.contains("acme") && line.contains("read") && line.contains("in 90 d"), "{list}");
    assert!(list.contains("shared") && list.contains("render") && list.contains("never"), "{list}");
    let kept = std::fs::read_to_string(folder.path().join("keys.toml")).unwrap();
    let secret = made.trim().rsplit_once(token.id()).unwrap().1;
    assert!(kept.contains(&token.hash()) && !kept.contains(secret), "{kept}");
    #[cfg(unix)]
    {
        let mode = std::os::unix::fs::MetadataExt::mode(&folder.path().join("keys.toml").metadata().unwrap());
        assert_eq!(mode & 0o007, 0, "others cannot read it");
    }
    assert_eq!(key(&folder, &["revoke", token.id()]).0, 0);
    let (code, _, told) = key(&folder, &["revoke", token.id()]);
    assert!(code == REFUSED && told.contains("there is no key"), "{told}");
    for name in ["Acme", "", "a b", "-a", &"a".repeat(33)] {
        let (code, _, told) = key(&folder, &["add", &format!("--tenant={name}")]);
        assert!(code == USAGE && told.contains("no name of a tenant"), "{name}: {told}");
    }
}

#[test]
fn many_commands_at_once_lose_no_key() {
    let folder = Folder::new();
    let adding: Vec<_> = (0..8)
        .map(|_| {
            planish()
                .args(["key", "add", "--data-dir"])
                .arg(folder.path())
                .stderr(std::process::Stdio::null())
                .stdout(std::process::Stdio::null())
                .spawn()
                .unwrap()
        })
        .collect();
    adding.into_iter().for_each(|mut adding| assert!(adding.wait().unwrap().success()));
    assert_eq!(key(&folder, &["list"]).1.lines().count(), 9);
}

#[test]
fn what_is_signed_on_the_command_line_opens_on_a_service_and_the_folder_stays_fit_for_one() {
    let (folder, jobs) = (Folder::new(), Folder::new());
    let (_, made, _) = key(&folder, &["add", "--tenant", "acme"]);
    let job = jobs.path().join("job.json");
    std::fs::write(&job, with(polygon(2), "svg").to_string()).unwrap();
    let sign = |arguments: &[&str]| {
        let output = planish().arg("sign").args(arguments).env("PLANISH_KEY", made.trim()).output().unwrap();
        (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
    };
    let name = job.to_str().unwrap();
    let (code, address, told) = sign(&[name, "--expires-in", "1h", "--url", "https://planish.example.org/"]);
    assert_eq!(code, 0, "{told}");
    let path = address.trim().strip_prefix("https://planish.example.org").unwrap().to_owned();
    assert!(path.strip_suffix(".svg").is_some(), "{path}");
    let id = "7fd9512d51873010739dc6b61ab050e2fa8041f4f0258865739ad5cfefd188f2";
    assert!(Link::parse(sign(&["--events", id]).1.trim()).unwrap().rest.starts_with("jobs/7fd9"));
    assert!(
        Link::parse(sign(&["--artifact", &format!("{id}.png")]).1.trim()).unwrap().rest.strip_suffix(".png").is_some()
    );
    for (arguments, code, says) in [
        (&["--events", "7"][..], USAGE, "no id"),
        (&["--artifact", &format!("{id}.exe")], USAGE, "no extension"),
        (&[], USAGE, "required"),
        (&[name, "--key", "secret"], USAGE, "the key is none"),
        (&[name, "--expires-in", "0s"], USAGE, "over at once; give a time"),
        (&["no-such-job.json"], FILES, "no-such-job.json: cannot be read"),
    ] {
        let (ended, _, told) = sign(arguments);
        assert!(ended == code && told.contains(says), "{arguments:?}: {told}");
    }
    std::fs::write(&job, mesh(1).to_string()).unwrap();
    let (ended, _, told) = sign(&[name]);
    assert!(ended == REFUSED && told.contains("--format"), "{told}");
    assert_eq!(sign(&[name, "--format", "glb"]).0, 0);
    let settings = planish::config::Settings { cache_bytes: 1 << 30, ..keyed(&folder) };
    story(settings, async |server| {
        server.get(&path).await.ok();
        let token = Token::parse(made.trim()).unwrap();
        assert_eq!(key(&folder, &["revoke", token.id()]).0, 0);
        until("the key is gone", || server.app.gate.n_keys() == 0).await;
        server.get(&path).await.problem(403, "bad-link");
    });
}
