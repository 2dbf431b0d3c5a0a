//! Faults in terms of the command line: with flags in place of JSON pointers.

use super::error::CliError;
use super::flags::{JobFlags, dashed, flag, way_of};
use crate::fault::Fault;
use crate::job::limits::Refusal;
use crate::wire::read::ReadError;

/// Translates faults of a job to the command line.
#[derive(Debug, Clone, Copy)]
pub(super) struct FaultTranslator<'a> {
    /// The flags that were given.
    pub(super) flags: &'a JobFlags,
    /// Whether the input is a mesh file, so that everything else comes from flags.
    pub(super) is_file: bool,
    /// The flag that determines the format, if any.
    pub(super) format: Option<&'static str>,
}

impl FaultTranslator<'_> {
    /// Converts faults of an input to an error.
    pub(super) fn refused(&self, faults: Vec<Fault>) -> CliError {
        CliError::faults(faults.into_iter().map(|fault| self.with_flags(fault)))
    }

    /// Converts the error of reading a job to an error of the command line.
    pub(super) fn unread(&self, error: ReadError) -> CliError {
        match error {
            ReadError::NotJson(detail) => CliError::refused(detail.replacen("the body is not", "it is not", 1)),
            ReadError::Unfit(faults) => self.refused(faults),
        }
    }

    /// Converts the refusal of a job to an error of the command line.
    pub(super) fn not_admitted(&self, refusal: Refusal) -> CliError {
        match refusal {
            Refusal::Impossible(faults) => self.refused(faults),
            Refusal::TooLarge { detail, .. } => {
                let remedy = if detail.contains(" faces") { "; --max-faces allows more" } else { "" };
                CliError::too_large(detail.replace("this server allows", "the limit is") + remedy)
            }
            Refusal::Stopped => CliError::other("the forecast of the job was stopped"),
        }
    }

    /// Replaces the JSON pointers in a fault by flags.
    pub(super) fn with_flags(&self, fault: Fault) -> Fault {
        let Fault { pointer, mut detail, other } = fault;
        if let Some(at) = other {
            let end = detail[at..].find([' ', ',', ';', ')']).map_or(detail.len(), |length| at + length);
            if let Some(flag) = self.flag(&detail[at..end]) {
                detail.replace_range(at..end, &flag);
            }
        }
        if (detail.starts_with("expected an object, got") || detail.ends_with("expected an object"))
            && let Some(way) = way_of(&pointer)
        {
            detail = format!("write it {way}");
        }
        match self.flag(&pointer) {
            Some(flag) => Fault::new(flag, in_flags(&detail)),
            None => Fault::new(pointer, detail),
        }
    }

    /// Returns the flag for a JSON pointer into a job; `None` if no flag sets that field.
    fn flag(&self, pointer: &str) -> Option<String> {
        let mut parts = pointer.split('/').skip(1);
        let (part, name) = (parts.next().unwrap_or_default(), parts.next());
        match (part, name) {
            ("input", Some("text")) if self.is_file => {
                Some(if parts.next() == Some("format") { "--input-format".to_owned() } else { String::new() })
            }
            ("input", None) if self.is_file => Some(String::new()),
            ("distance_to", _) if self.is_file => Some("--distance-to".to_owned()),
            ("levels", _) => match self.flags.flag_of("/levels") {
                Some(flag) => Some(flag.to_owned()),
                None => self.is_file.then(|| "--levels".to_owned()),
            },
            ("plan", None) => {
                let named = ["/plan/word", "/plan/preset"].iter().find_map(|place| self.flags.flag_of(place));
                named.map(str::to_owned).or_else(|| self.is_file.then(|| "--preset".to_owned()))
            }
            ("plan", Some("parameters")) => {
                let name = parts.next()?;
                let flag = self.flags.flag_of(&format!("/plan/parameters/{name}")).map(str::to_owned);
                flag.or_else(|| self.is_file.then(|| format!("--parameter {name}")))
            }
            ("input" | "plan", Some(name)) => {
                let flag = self.flags.flag_of(&format!("/{part}/{name}")).map(str::to_owned);
                let flag = flag.or_else(|| self.is_file.then(|| format!("--{}", dashed(name))))?;
                Some(parts.next().map_or(flag.clone(), |inner| format!("{flag} {inner}")))
            }
            ("outputs", index) => {
                index.map_or_else(|| self.format.map(str::to_owned), |_| self.option(parts.next(), parts.next()))
            }
            _ => None,
        }
    }

    /// Returns the flag for an output, or for an option of it.
    fn option(&self, name: Option<&str>, inner: Option<&str>) -> Option<String> {
        match name {
            None | Some("format") => self.format.map(str::to_owned),
            Some(name) if self.format.is_some() || self.flags.options.iter().any(|(known, _)| *known == name) => {
                let inner = inner.map_or_else(String::new, |inner| format!(" {inner}"));
                Some(format!("--{}{inner}", flag(name)))
            }
            Some(_) => None,
        }
    }
}

/// Rewrites a message about a JSON value as a message about a flag, which has no JSON type.
fn in_flags(detail: &str) -> String {
    let kinds = ["invalid type: string ", "invalid value: string ", "invalid type: number "];
    let detail = kinds.iter().find_map(|kind| detail.strip_prefix(kind)).unwrap_or(detail);
    flagged(detail)
        .replace("{\"tolerance\": t}", "a --tolerance")
        .replace("an object with a \"tolerance\"", "a --tolerance in place of it")
        .replace("a whole number of levels,", "a whole number of levels such as 3,")
        .replace("give a \"plan\"", "name a --preset or a --word")
        .replace("expected three numbers", "expected three numbers like 0,0,1")
}

/// JSON fields of the input in remedies of messages, and the corresponding flags.
const REMEDIES: [(&str, &str); 4] = [
    ("\"non_manifold\": \"split\"", "--non-manifold split"),
    ("\"orient\": \"repair\"", "--orient repair"),
    ("\"weld\": 0", "--weld 0"),
    ("\"weld\": false", "--weld false"),
];

/// Replaces JSON fields of the input in a message by flags.
pub(super) fn flagged(text: &str) -> String {
    REMEDIES.iter().fold(text.to_owned(), |text, (field, flag)| text.replace(field, flag))
}
