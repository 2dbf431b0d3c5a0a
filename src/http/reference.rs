//! The reference page: the OpenAPI document for people to read, as one page without scripts.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use quick_xml::escape::escape;
use serde_json::Value;
use sha2::{Digest, Sha256};

const REFERENCE_CSS: &str = include_str!("reference.css");

/// Returns the content security policy of the page: it may load nothing; its own style is allowed by its hash.
pub(super) fn policy() -> String {
    let style = STANDARD.encode(Sha256::digest(REFERENCE_CSS));
    format!(
        "default-src 'none'; style-src 'sha256-{style}'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
}

/// Returns the page that shows an OpenAPI document.
pub(super) fn page(document: &Value) -> String {
    let (mut nav, mut main) = (String::new(), String::new());
    let title = text_of(&document["info"], "title");
    let about = document["info"]["description"].as_str().unwrap_or_default();
    let about = format!("<h1>{title}</h1>{}", paragraphs(about));
    for tag in tags(document) {
        let _ = write!(nav, "<b>{0}</b>", escape(&tag));
        let _ = write!(main, "<h2>{0}</h2>", escape(&tag));
        for (path, verb, operation) in operations(document).filter(|(.., operation)| tag_of(operation) == tag) {
            let place = anchor(&format!("{verb}-{path}"));
            let (shown, verb) = (escape(path), verb.to_uppercase());
            let _ = write!(nav, "<a href=\"#{place}\"><span class=\"verb\">{verb}</span>{shown}</a>");
            let _ = write!(main, "<h3 id=\"{place}\"><span class=\"verb\">{verb}</span>{shown}</h3>");
            describe(&mut main, operation);
        }
    }
    nav.push_str("<b>schemas</b>");
    main.push_str("<h2>schemas</h2>");
    for (name, schema) in entries(&document["components"]["schemas"]) {
        let (place, name) = (anchor(&format!("schema-{name}")), escape(name));
        let _ = write!(nav, "<a href=\"#{place}\">{name}</a>");
        let _ = write!(main, "<h3 id=\"{place}\">{name}</h3>");
        describe_schema(&mut main, schema);
    }
    format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width\"><title>{title}: reference</title>\
         <style>{REFERENCE_CSS}</style><nav><a href=\"/\">{title}</a>\
         <a href=\"/openapi.json\">openapi.json</a>{nav}</nav><main>{about}{main}</main></html>\n"
    )
}

fn describe(page: &mut String, operation: &Value) {
    page.push_str(&paragraphs(operation["summary"].as_str().unwrap_or_default()));
    page.push_str(&paragraphs(operation["description"].as_str().unwrap_or_default()));
    let parameters = operation["parameters"].as_array().map_or(&[][..], Vec::as_slice);
    table(
        page,
        "Parameters",
        parameters.iter().map(|parameter| {
            let place = text_of(parameter, "in");
            let what = paragraphs(parameter["description"].as_str().unwrap_or_default());
            (format!("<code>{}</code> ({place}, {})", text_of(parameter, "name"), kind(&parameter["schema"])), what)
        }),
    );
    let bodies = entries(&operation["requestBody"]["content"]);
    table(page, "Body", bodies.map(|(media_type, body)| (code(media_type), kind(&body["schema"]))));
    table(
        page,
        "Answers",
        entries(&operation["responses"]).map(|(status, answer)| {
            let contents: Vec<String> = entries(&answer["content"])
                .filter(|(media_type, _)| *media_type != "application/problem+json")
                .map(|(media_type, content)| format!("{} {}", code(media_type), kind(&content["schema"])))
                .collect();
            let what = paragraphs(answer["description"].as_str().unwrap_or_default());
            (code(status), format!("{what}<p>{}</p>", contents.join(", ")))
        }),
    );
}

fn describe_schema(page: &mut String, schema: &Value) {
    page.push_str(&paragraphs(schema["description"].as_str().unwrap_or_default()));
    let alternatives = ["oneOf", "anyOf", "allOf"].into_iter().find_map(|word| schema[word].as_array());
    match alternatives {
        Some(kinds) => {
            let kinds: Vec<String> = kinds.iter().map(kind).collect();
            let _ = write!(page, "<p>{}</p>", kinds.join(", or "));
        }
        None if schema["properties"].is_null() => {
            let _ = write!(page, "<p>{}</p>", kind(schema));
        }
        None => {}
    }
    table(
        page,
        "Fields",
        entries(&schema["properties"]).map(|(name, field)| {
            let what = paragraphs(field["description"].as_str().unwrap_or_default());
            (format!("{} {}", code(name), kind(field)), what)
        }),
    );
}

fn table(page: &mut String, title: &str, rows: impl Iterator<Item = (String, String)>) {
    let rows: Vec<String> = rows.map(|(name, what)| format!("<tr><td>{name}</td><td>{what}</td></tr>")).collect();
    let rows = rows.concat();
    if !rows.is_empty() {
        let _ = write!(page, "<h4>{title}</h4><table>{rows}</table>");
    }
}

/// Describes the type of a schema in a few words, as HTML.
fn kind(schema: &Value) -> String {
    if let Some(name) = schema["$ref"].as_str().and_then(|place| place.rsplit('/').next()) {
        return format!("<a href=\"#{}\">{}</a>", anchor(&format!("schema-{name}")), escape(name));
    }
    if let Some(kinds) = ["oneOf", "anyOf", "allOf"].into_iter().find_map(|word| schema[word].as_array()) {
        return kinds.iter().map(kind).collect::<Vec<_>>().join(" or ");
    }
    if let Some(values) = schema["enum"].as_array() {
        return values.iter().map(|value| code(&value.to_string())).collect::<Vec<_>>().join(" ");
    }
    let of_type = match &schema["type"] {
        Value::String(name) => name.clone(),
        Value::Array(names) => names.iter().filter_map(Value::as_str).collect::<Vec<_>>().join(" or "),
        _ => "anything".to_owned(),
    };
    match &schema["items"] {
        Value::Null => of_type,
        items => format!("{of_type} of {}", kind(items)),
    }
}

fn entries(object: &Value) -> impl Iterator<Item = (&String, &Value)> {
    object.as_object().into_iter().flatten()
}

/// Returns all operations except HEAD, which answers like GET without the bytes.
fn operations(document: &Value) -> impl Iterator<Item = (&String, &String, &Value)> {
    let all = entries(&document["paths"]);
    let all = all.flat_map(|(path, verbs)| entries(verbs).map(move |(verb, of)| (path, verb, of)));
    all.filter(|(_, verb, _)| *verb != "head")
}

fn tag_of(operation: &Value) -> String {
    operation["tags"][0].as_str().unwrap_or("other").to_owned()
}

/// Returns the tags in the order of the document, then others in the order of their first operation.
fn tags(document: &Value) -> Vec<String> {
    let named = document["tags"].as_array().into_iter().flatten();
    let mut tags: Vec<String> = named.filter_map(|tag| tag["name"].as_str().map(str::to_owned)).collect();
    for tag in operations(document).map(|(.., operation)| tag_of(operation)) {
        if !tags.contains(&tag) {
            tags.push(tag);
        }
    }
    tags
}

fn text_of(value: &Value, field: &str) -> String {
    escape(value[field].as_str().unwrap_or_default()).into_owned()
}

fn code(text: &str) -> String {
    format!("<code>{}</code>", escape(text))
}

fn anchor(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect()
}

/// Renders Markdown as HTML; only paragraphs, backticks and fences are supported.
fn paragraphs(text: &str) -> String {
    let mut html = String::new();
    for (at, block) in text.split("```").enumerate() {
        if at % 2 == 1 {
            let body = block.split_once('\n').map_or(block, |(_, body)| body);
            let _ = write!(html, "<pre><code>{}</code></pre>", escape(body.trim_end()));
            continue;
        }
        for paragraph in block.split("\n\n").map(str::trim).filter(|paragraph| !paragraph.is_empty()) {
            let marked: String = escape(paragraph)
                .split('`')
                .enumerate()
                .map(|(at, part)| if at % 2 == 1 { format!("<code>{part}</code>") } else { part.to_owned() })
                .collect();
            let _ = write!(html, "<p>{marked}</p>");
        }
    }
    html
}
