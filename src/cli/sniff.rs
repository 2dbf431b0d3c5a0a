//! Detection of the kind of an input from its first bytes, for names that do not determine it.

use crate::input;
use crate::wire::read::mark_remedy;

/// Returns the name of the reader, `json` for the JSON of a mesh, or `job`.
///
/// # Errors
/// A sentence, when the bytes are of no known kind.
pub(super) fn sniffed(bytes: &[u8]) -> Result<&'static str, String> {
    if bytes.trim_ascii_start().starts_with(b"{") {
        return Ok(of_json(bytes));
    }
    if bytes.trim_ascii().is_empty() {
        return Err("it is empty; give a job (JSON) or a mesh file".to_owned());
    }
    let reader = input::of_bytes(bytes).map(|reader| reader.name);
    reader.ok_or_else(|| {
        let what = match (input::foreign(bytes), mark_remedy(bytes)) {
            (Some(what), _) => format!("it is {what}; "),
            (None, Some(mark)) => format!("{mark}; "),
            _ if input::is_text(bytes) => "it is plain text; ".to_owned(),
            _ => String::new(),
        };
        format!(
            "{what}it is no job (JSON), and no mesh file that is known by its first bytes; name its kind with \
             --input-format"
        )
    })
}

/// Returns the kind of an input that is a JSON object.
fn of_json(bytes: &[u8]) -> &'static str {
    #[derive(serde::Deserialize)]
    struct JsonFields {
        positions: Option<serde::de::IgnoredAny>,
        asset: Option<serde::de::IgnoredAny>,
    }
    match serde_json::from_slice::<JsonFields>(bytes) {
        Ok(JsonFields { positions: Some(_), .. }) => "json",
        Ok(JsonFields { asset: Some(_), .. }) => "gltf",
        _ => "job",
    }
}
