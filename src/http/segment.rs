//! The extractor of the variable part of a path.

use axum::extract::{FromRequestParts, Path};
use axum::http::request::Parts;

use super::problem::{self, Problem};

/// The last variable segment of a path as text; if it is not UTF-8, the request is answered with 404.
#[derive(Debug)]
pub(super) struct PathSegment(pub(super) String);

impl<S: Send + Sync> FromRequestParts<S> for PathSegment {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let detail = "the address is no text in UTF-8; /openapi.json lists the pages that exist";
        let text = Path::<String>::from_request_parts(parts, state).await;
        text.map(|Path(text)| Self(text)).map_err(|_| Problem::new(problem::NOT_FOUND, detail))
    }
}
