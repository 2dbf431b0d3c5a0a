//! The page `/play` for trying the service: files that are part of the program, served from a closed list.

use std::collections::HashMap;
use std::sync::{LazyLock, OnceLock};

use axum::body::Bytes;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Redirect, Response};

use super::address::etag;
use super::content::JSON;
use super::negotiate;
use super::problem::{self, Problem};
use super::segment::PathSegment;
use crate::fault::shortened;
use crate::job::key::{Key, content};
use crate::service::variant::{Coding, encoded};

/// The content security policy of the page: its own files and answers of the service. Pictures are shown from blob
/// URLs.
const SECURITY_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; \
                      img-src 'self' blob: data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const ICON: &str = "image/svg+xml";

/// The page itself, under the empty name, which no address below `/play/` has.
const PLAY_PAGE: (&str, &str, &str) = ("", HTML, include_str!("play/index.html"));

/// The files that the page loads: name below `/play/`, media type, text.
const FILES: &[(&str, &str, &str)] = &[
    ("icon.svg", ICON, include_str!("play/icon.svg")),
    ("play.css", CSS, include_str!("play/play.css")),
    ("main.js", SCRIPT, include_str!("play/main.js")),
    ("dom.js", SCRIPT, include_str!("play/dom.js")),
    ("state.js", SCRIPT, include_str!("play/state.js")),
    ("service.js", SCRIPT, include_str!("play/service.js")),
    ("refiner.js", SCRIPT, include_str!("play/refiner.js")),
    ("polygon.js", SCRIPT, include_str!("play/polygon.js")),
    ("pane.js", SCRIPT, include_str!("play/pane.js")),
    ("pieces.js", SCRIPT, include_str!("play/pieces.js")),
    ("curves.js", SCRIPT, include_str!("play/curves.js")),
    ("parameters.js", SCRIPT, include_str!("play/parameters.js")),
    ("scheme.js", SCRIPT, include_str!("play/scheme.js")),
    ("examples.js", SCRIPT, include_str!("play/examples.js")),
    ("analysis.js", SCRIPT, include_str!("play/analysis.js")),
    ("lines.js", SCRIPT, include_str!("play/lines.js")),
    ("given.js", SCRIPT, include_str!("play/given.js")),
    ("take.js", SCRIPT, include_str!("play/take.js")),
    ("help.js", SCRIPT, include_str!("play/help.js")),
    ("surfaces.js", SCRIPT, include_str!("play/surfaces.js")),
    ("viewer.js", SCRIPT, include_str!("play/viewer.js")),
    ("shaders.js", SCRIPT, include_str!("play/shaders.js")),
    ("buffers.js", SCRIPT, include_str!("play/buffers.js")),
    ("layers.js", SCRIPT, include_str!("play/layers.js")),
    ("model.js", SCRIPT, include_str!("play/model.js")),
    ("marks.js", SCRIPT, include_str!("play/marks.js")),
    ("part.js", SCRIPT, include_str!("play/part.js")),
    ("hard.js", SCRIPT, include_str!("play/hard.js")),
    ("hand.js", SCRIPT, include_str!("play/hand.js")),
    ("mesh.js", SCRIPT, include_str!("play/mesh.js")),
    ("space.js", SCRIPT, include_str!("play/space.js")),
    ("cage.js", SCRIPT, include_str!("play/cage.js")),
    ("told.js", SCRIPT, include_str!("play/told.js")),
    ("gltf.js", SCRIPT, include_str!("play/gltf.js")),
    ("meshopt.js", SCRIPT, include_str!("play/meshopt.js")),
    ("planish-view.js", SCRIPT, include_str!("play/planish-view.js")),
    ("stencils.js", SCRIPT, include_str!("../../api/clients/stencils.js")),
    ("animal.json", JSON, include_str!("../../api/examples/jobs/animal-isolines-png.json")),
    ("cube.json", JSON, include_str!("../../api/examples/jobs/cube-faces-png.json")),
    ("creases.json", JSON, include_str!("../../api/examples/jobs/cube-uneven-creases-png.json")),
    ("junction.json", JSON, include_str!("../../api/examples/jobs/t-junction-latitude-png.json")),
    ("vase.json", JSON, include_str!("../../api/examples/jobs/vase-latitude-png.json")),
    ("nut.json", JSON, include_str!("../../api/examples/jobs/drawing-nut-svg.json")),
    ("triangles.json", JSON, include_str!("../../api/examples/jobs/stellated-triangle-word-glb.json")),
    ("sheet.json", JSON, include_str!("../../api/examples/jobs/sheet-crease-png.json")),
];

/// A file with its key, and its bytes in each coding that was requested so far.
struct PlayFile {
    media_type: &'static str,
    bytes: Bytes,
    key: Key,
    coded: [OnceLock<Option<Bytes>>; Coding::ALL.len()],
}

impl PlayFile {
    fn of(&(_, media_type, text): &(&str, &'static str, &'static str)) -> Self {
        let bytes = Bytes::from_static(text.as_bytes());
        Self { media_type, key: content(&bytes), bytes, coded: Default::default() }
    }

    /// Returns the bytes in the coding that the client prefers, with that coding; uncompressed if compression does not
    /// pay.
    fn liked(&self, headers: &HeaderMap) -> (Option<Coding>, Bytes) {
        let coded = negotiate::coding(headers).and_then(|liked| {
            let place = Coding::ALL.iter().position(|coding| *coding == liked)?;
            let made = self.coded[place].get_or_init(|| encoded(liked, self.bytes.clone()).map(Bytes::from));
            made.clone().map(|bytes| (Some(liked), bytes))
        });
        coded.unwrap_or_else(|| (None, self.bytes.clone()))
    }

    fn answer(&self, headers: &HeaderMap) -> Response {
        let fixed = [
            (header::CONTENT_TYPE, HeaderValue::from_static(self.media_type)),
            // revalidated at each use, so that a page never mixes files of two releases
            (header::CACHE_CONTROL, HeaderValue::from_static("no-cache")),
            (header::VARY, HeaderValue::from_static("accept-encoding")),
            (header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(SECURITY_POLICY)),
            // pages of other origins load the element by its address; these files contain nothing private
            (header::ACCESS_CONTROL_ALLOW_ORIGIN, HeaderValue::from_static("*")),
            (HeaderName::from_static("cross-origin-resource-policy"), HeaderValue::from_static("cross-origin")),
        ];
        if let Some(tag) = negotiate::has_already(headers, &self.key) {
            return (StatusCode::NOT_MODIFIED, fixed, [(header::ETAG, tag)]).into_response();
        }
        let (coding, bytes) = self.liked(headers);
        let mut response = (fixed, [(header::ETAG, etag(&self.key, coding))], bytes).into_response();
        if let Some(coding) = coding {
            response.headers_mut().insert(header::CONTENT_ENCODING, HeaderValue::from_static(coding.name()));
        }
        response
    }
}

static PLAY_FILES: LazyLock<HashMap<&str, PlayFile>> =
    LazyLock::new(|| FILES.iter().chain([&PLAY_PAGE]).map(|file| (file.0, PlayFile::of(file))).collect());

/// The page for trying the service: control points and vertices to drag, schemes to choose, results to take along.
#[utoipa::path(
    get, path = "/play", tag = "operations",
    responses((status = 200, description = "A page", body = String, content_type = "text/html",
        example = "<!doctype html>"))
)]
pub(super) async fn page(headers: HeaderMap) -> Response {
    PLAY_FILES[PLAY_PAGE.0].answer(&headers)
}

/// A file that the page loads. `planish-view.js` is an element that pages of other origins may load, too.
#[utoipa::path(
    get, path = "/play/{file}", tag = "operations",
    params(("file" = String, Path, description = "Name of the file", example = "planish-view.js")),
    responses((status = 200, description = "The file", body = String, content_type = "text/javascript"))
)]
pub(super) async fn file(PathSegment(name): PathSegment, headers: HeaderMap) -> Result<Response, Problem> {
    let missing = || Problem::new(problem::NOT_FOUND, format!("the page has no file \"{}\"", shortened(&name)));
    let file = PLAY_FILES.get(name.as_str()).filter(|_| !name.is_empty()).ok_or_else(missing)?;
    Ok(file.answer(&headers))
}

/// Redirects people from `/` to the page; this is no operation of the interface.
pub(super) async fn index() -> Redirect {
    Redirect::temporary("/play")
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{FILES, HTML, JSON, PLAY_PAGE, SCRIPT};

    /// Returns the quoted names that follow these words.
    fn named<'a>(text: &'a str, words: &[&str]) -> Vec<&'a str> {
        let after = |word: &&str| text.match_indices(*word).map(|(at, word)| &text[at + word.len()..]).collect();
        let places: Vec<&str> = words.iter().flat_map::<Vec<&str>, _>(after).collect();
        places.into_iter().filter_map(|place| place.split(['"', '`']).next()).collect()
    }

    #[test]
    fn what_the_page_loads_is_in_the_list() {
        let known: Vec<&str> = FILES.iter().map(|file| file.0).collect();
        let mut n = 0;
        for (file, media_type, text) in FILES.iter().chain([&PLAY_PAGE]) {
            let loaded = match *media_type {
                SCRIPT => named(text, &["from \"./", "import(\"./", "file: \""]),
                HTML => named(text, &["href=\"/play/", "src=\"/play/"]),
                _ => Vec::new(),
            };
            n += loaded.len();
            let missing: Vec<&&str> = loaded.iter().filter(|name| !known.contains(name)).collect();
            assert!(missing.is_empty(), "{file} loads {missing:?}");
        }
        assert!(n > 60, "only {n} names were read");
    }

    #[test]
    fn what_lies_in_the_folder_is_served() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/http/play");
        for entry in std::fs::read_dir(folder).expect("the folder is there") {
            let name = entry.expect("an entry").file_name().to_string_lossy().into_owned();
            let served = name == "index.html" || FILES.iter().any(|(known, ..)| *known == name);
            assert!(served, "{name} is not in the list");
        }
    }

    #[test]
    fn the_files_are_short_and_load_nothing_from_elsewhere() {
        for (name, media_type, text) in FILES.iter().chain([&PLAY_PAGE]).filter(|file| file.1 != JSON) {
            assert!(text.lines().count() <= 400, "{name} has {} lines", text.lines().count());
            for (at, line) in text.lines().enumerate() {
                assert!(line.chars().count() <= 120, "{name}:{}: {} columns", at + 1, line.chars().count());
                let is_told = line.trim_start().starts_with("//") || line.contains("http://www.w3.org/2000/svg");
                assert!(is_told || !line.contains("://"), "{name}:{}: an address elsewhere: {line}", at + 1);
                let inline = *media_type == HTML && (line.contains(" style=") || line.contains(" onclick="));
                assert!(!inline, "{name}:{}: the policy allows nothing inline", at + 1);
            }
        }
    }
}
