//! docs/papers.md: the claims of the papers, compared with the answers in that document.

use std::path::Path;

use serde_json::Value;

use super::asked;

const HEAD: &str = "| Answer at | |";

#[test]
fn every_answer_on_the_page_about_the_papers_is_what_the_analysis_says() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/papers.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (made, questions) = answered(&page);
    assert!(questions > 50, "only {questions} questions were found");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, made).unwrap();
    } else {
        let differs = page.lines().zip(made.lines()).find(|(old, new)| old != new);
        assert_eq!(differs, None, "BLESS=1 writes answers anew");
    }
}

/// Returns the page with the answers to its questions, and the number of questions.
fn answered(page: &str) -> (String, usize) {
    let (mut made, mut answer, mut questions, mut in_table) = (Vec::new(), Value::Null, 0, false);
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        in_table = line == HEAD || in_table && line.starts_with('|');
        let pointer = line.strip_prefix("| `").and_then(|rest| rest.split_once('`')).filter(|_| in_table);
        made.push(match pointer {
            Some((pointer, _)) => format!("| `{pointer}` | {} |", said(&answer, pointer)),
            None => line.to_owned(),
        });
        if line == "```json" {
            let question = lines.next().unwrap();
            made.push(question.to_owned());
            answer = asked(&serde_json::from_str(question).unwrap());
            questions += 1;
        }
    }
    (made.join("\n") + "\n", questions)
}

/// Returns the value of an answer at a pointer, as short JSON.
fn said(answer: &Value, pointer: &str) -> String {
    let found = answer.pointer(pointer).unwrap_or_else(|| panic!("no {pointer} in {answer}"));
    short(found).to_string().replace("\":", "\": ").replace(',', ", ")
}

/// Rounds numbers to six decimals.
fn short(value: &Value) -> Value {
    match value {
        Value::Number(number) if number.is_f64() => {
            let x: f64 = format!("{:.6}", number.as_f64().unwrap()).parse().unwrap();
            Value::from(x + 0.0)
        }
        Value::Array(items) => items.iter().map(short).collect(),
        Value::Object(fields) => fields.iter().map(|(name, value)| (name.clone(), short(value))).collect(),
        other => other.clone(),
    }
}
