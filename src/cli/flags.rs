//! The flags for the fields of a job, generated from the declarations of its input, its plan and the options of
//! formats, so that each is declared once.

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use clap::{Arg, ArgAction, ArgMatches, Command};
use serde_json::{Value, json};

use crate::math::parameter::{Parameter, ParameterKind};
use crate::scheme::parameters::WORD_PARAMETERS;
use crate::scheme::presets::PRESETS;
use crate::wire::catalogue::ParameterEntry;
use crate::wire::fields::{Field, FieldSection, FieldValues, OutputField, fields, output_fields};
use crate::wire::written::{number, separator, written};

/// The values of flags for fields of a job; they take precedence over the values in the job itself.
#[derive(Debug, Clone, Default)]
pub(crate) struct JobFlags {
    /// Values for the input, the plan and the levels: the flag, the JSON pointer into the job, the value.
    pub(super) fields: Vec<(String, String, Value)>,
    /// Values for options of the output.
    pub(super) options: Vec<(&'static str, Value)>,
}

impl clap::Args for JobFlags {
    fn augment_args(command: Command) -> Command {
        command.args(arguments())
    }

    fn augment_args_for_update(command: Command) -> Command {
        command.args(arguments())
    }
}

impl clap::FromArgMatches for JobFlags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let last = |id: &str| matches.get_many::<String>(id).and_then(|mut values| values.next_back().cloned());
        let all = |id: &str| Some(matches.get_many::<String>(id)?.map(String::as_str).collect::<Vec<_>>());
        let mut found = Self::default();
        for field in fields() {
            let part = if field.part == FieldSection::Input { "input" } else { "plan" };
            let text = match &field.takes {
                FieldValues::Object(_) => all(&dashed(&field.name)).map(|texts| texts.join(",")),
                _ => last(&dashed(&field.name)),
            };
            if let Some(text) = text {
                found.say(&dashed(&field.name), format!("/{part}/{}", field.name), field.value(&text));
            }
        }
        if let Some(text) = last("levels") {
            found.say("levels", "/levels".to_owned(), number(&text));
        }
        if let Some(text) = last("tolerance") {
            found.say("tolerance", "/levels".to_owned(), json!({ "tolerance": number(&text) }));
        }
        let parameters =
            matches.get_many::<String>("parameter").into_iter().flatten().filter_map(|p| p.split_once('='));
        let preset = last("preset");
        for (name, text) in parameters {
            let name = name.trim().replace('-', "_");
            let value = declared(preset.as_deref(), &name).map_or_else(|| number(text), |kind| written(kind, text));
            found.say(&format!("parameter {name}"), format!("/plan/parameters/{name}"), value);
        }
        for field in output_fields() {
            let texts = matches.get_many::<String>(&flag(field.name)).into_iter().flatten();
            let texts: Vec<&str> = texts.map(String::as_str).collect();
            if let Some(last) = texts.last() {
                let text = separator(field.kind()).map_or_else(|| (*last).to_owned(), |between| texts.join(between));
                found.options.push((field.name, field.value(&text)));
            }
        }
        Ok(found)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl JobFlags {
    fn say(&mut self, flag: &str, pointer: String, value: Value) {
        self.fields.push((format!("--{flag}"), pointer, value));
    }

    /// Writes the values for the input, the plan and the levels into a job; a preset or word given by a flag replaces
    /// the whole plan of the job.
    pub(super) fn onto(&self, job: &mut Value) {
        if self.fields.iter().any(|(_, pointer, _)| ["/plan/preset", "/plan/word"].contains(&pointer.as_str())) {
            job["plan"] = json!({});
        }
        for (_, pointer, value) in &self.fields {
            let place = pointer.split('/').skip(1).fold(&mut *job, |at, name| &mut at[name]);
            *place = value.clone();
        }
    }

    /// Returns the flag that sets the field at `pointer`, if any.
    pub(super) fn flag_of(&self, pointer: &str) -> Option<&str> {
        self.fields.iter().find(|(_, known, _)| known == pointer).map(|(flag, ..)| flag.as_str())
    }
}

/// Converts the name of a field to the form used in flags.
pub(super) fn dashed(name: &str) -> String {
    name.replace('_', "-")
}

/// Returns the kind of values of a parameter: as the preset declares it, else as words or other presets do.
fn declared(preset: Option<&str>, name: &str) -> Option<&'static ParameterKind> {
    let own = PRESETS.iter().filter(|known| Some(known.name) == preset).flat_map(|preset| preset.parameters);
    let others = PRESETS.iter().flat_map(|preset| preset.parameters);
    let mut all = own.chain(WORD_PARAMETERS).chain(others);
    all.find(|parameter| parameter.name == name).map(|parameter| &parameter.kind)
}

fn arguments() -> Vec<Arg> {
    let (input, plan): (Vec<Field>, Vec<Field>) =
        fields().into_iter().partition(|field| field.part == FieldSection::Input);
    let levels = Arg::new("levels").long("levels").value_name("N").help("How often the scheme is applied");
    let tolerance = Arg::new("tolerance")
        .long("tolerance")
        .value_name("DISTANCE")
        .conflicts_with("levels")
        .help("In place of --levels: the first level that is so close to the limit, in model units");
    let parameter = Arg::new("parameter")
        .short('p')
        .long("parameter")
        .value_name("NAME=VALUE")
        .action(ArgAction::Append)
        .value_parser(|text: &str| match text.split_once('=') {
            Some((name, _)) if !name.trim().is_empty() => Ok(text.to_owned()),
            _ => Err("write it as NAME=VALUE, for example w=0.05 or alpha=pi/6"),
        })
        .help("A parameter of the preset or of the word, for example w=0.05; can be given several times");
    let scheme = plan.iter().map(of_field).chain([levels, tolerance, parameter]);
    let scheme = scheme.map(|arg| arg.help_heading("Scheme").allow_hyphen_values(true));
    let input = input.iter().map(|field| of_field(field).help_heading("Input").allow_hyphen_values(true));
    let output = output_fields();
    let output = output.iter().map(|field| of_option(field).help_heading("Options of the output"));
    input.chain(scheme).chain(output).collect()
}

fn of_field(field: &Field) -> Arg {
    let doc = field.doc.replace("/v1/presets", "planish presets").replace("/v1/operators", "planish operators");
    let arg = Arg::new(dashed(&field.name)).long(dashed(&field.name)).help(doc.trim_end_matches('.').to_owned());
    match &field.takes {
        FieldValues::Flag => switch(arg),
        FieldValues::Text(choices) if field.name == "preset" && choices.is_empty() => arg
            .value_name("NAME")
            .value_parser(Hint(PRESETS.iter().map(|preset| preset.name.to_owned()).collect()))
            .hide_possible_values(true),
        FieldValues::Text(choices) => arg.value_name(field.name.to_uppercase()).value_parser(Hint(choices.clone())),
        FieldValues::Number | FieldValues::Scalar => arg.value_name("NUMBER"),
        FieldValues::Numbers => arg.value_name("NUMBER,..."),
        FieldValues::Object(fields) => {
            let way = names_of(fields.iter().map(|field| field.name.as_str()));
            arg.value_name("NAME=VALUE,...").action(ArgAction::Append).help(format!("{doc} Written {way}"))
        }
    }
}

/// Options of formats whose names belong to other flags: the target distance to the limit, and the limit of faces of
/// this run.
const OPTIONS_OF_OTHER_FLAGS: &[&str] = &["tolerance", "max-faces"];

/// Returns the flag for an option of formats.
pub(super) fn flag(name: &str) -> String {
    let name = dashed(name);
    if OPTIONS_OF_OTHER_FLAGS.contains(&name.as_str()) { format!("output-{name}") } else { name }
}

fn of_option(field: &OutputField) -> Arg {
    let name = flag(field.name);
    let arg =
        Arg::new(name.clone()).long(name).help(option_help(field)).hide_short_help(true).allow_hyphen_values(true);
    let hint = |names: &[&str]| Hint(names.iter().map(|name| (*name).to_owned()).collect());
    let arg = if separator(field.kind()).is_some() { arg.action(ArgAction::Append) } else { arg };
    match field.kind() {
        ParameterKind::Flag => switch(arg).allow_hyphen_values(false),
        ParameterKind::Choice(names) | ParameterKind::Choices(names) => {
            arg.value_name(field.name.to_uppercase()).value_parser(hint(names)).hide_possible_values(true)
        }
        ParameterKind::Group(_) => arg.value_name("NAME=VALUE,..."),
        ParameterKind::Groups { .. } => arg.value_name("NAME=VALUE,...;..."),
        ParameterKind::Vector | ParameterKind::Direction => arg.value_name("X,Y,Z"),
        ParameterKind::Number { .. } | ParameterKind::Integer { .. } => arg.value_name("NUMBER"),
        _ => arg.value_name(field.name.to_uppercase()),
    }
}

/// Makes a flag whose value is `true` if it is given without a value.
fn switch(arg: Arg) -> Arg {
    arg.num_args(0..=1)
        .require_equals(true)
        .default_missing_value("true")
        .value_name("true|false")
        .hide_possible_values(true)
}

/// Formats the help of an option: its meaning, and the values that each format with this option accepts.
fn option_help(field: &OutputField) -> String {
    let mut ways: Vec<(Vec<&str>, String)> = Vec::new();
    for &(format, parameter) in &field.declared {
        let way = way(parameter);
        match ways.iter_mut().find(|(_, known)| *known == way) {
            Some((formats, _)) => formats.push(format),
            None => ways.push((vec![format], way)),
        }
    }
    let ways: Vec<String> = ways.iter().map(|(formats, way)| format!("[{}: {way}]", formats.join(", "))).collect();
    format!("{} {}", field.declared[0].1.doc, ways.join(" "))
}

fn way(parameter: &Parameter) -> String {
    let entry = ParameterEntry::new(parameter);
    let blank = if entry.unit.is_empty() { "" } else { ", " };
    let expects = match parameter.kind {
        ParameterKind::Choice(names) => names.join(", "),
        ParameterKind::Choices(names) => format!("some of {}, with commas between", names.join(",")),
        ParameterKind::Group(fields) => objects(fields),
        ParameterKind::Groups { fields, .. } => format!("{}; semicolons between several", objects(fields)),
        ParameterKind::Color => "a colour like #fff or #ff8800, or transparent".to_owned(),
        ParameterKind::Vector | ParameterKind::Direction => "three numbers like 0,0,1".to_owned(),
        _ => entry.expects,
    };
    let default = match &entry.default {
        Value::Null | Value::Object(_) => String::new(),
        Value::String(text) => format!("; default {text}"),
        other => format!("; default {other}"),
    };
    format!("{expects}{blank}{}{default}", entry.unit)
}

/// Describes how an object or a list of objects at `pointer` is written in a flag; `None` if the field is neither.
pub(super) fn way_of(pointer: &str) -> Option<String> {
    if let Some(name) = pointer.strip_prefix("/input/") {
        let field = fields().into_iter().find(|field| field.part == FieldSection::Input && field.name == name)?;
        let FieldValues::Object(inner) = field.takes else { return None };
        return Some(names_of(inner.iter().map(|field| field.name.as_str())));
    }
    let name = pointer.strip_prefix("/outputs/0/")?.split('/').next()?;
    match output_fields().iter().find(|field| field.name == name)?.kind() {
        ParameterKind::Group(fields) | ParameterKind::Groups { fields, .. } => Some(objects(fields)),
        _ => None,
    }
}

fn objects(fields: &[Parameter]) -> String {
    names_of(fields.iter().map(|field| field.name))
}

fn names_of<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    format!("as name=value,name=value with the names {}", names.join(", "))
}

/// Texts that shell completion offers; the given value itself is checked together with the job.
#[derive(Debug, Clone)]
struct Hint(Vec<String>);

impl TypedValueParser for Hint {
    type Value = String;

    fn parse_ref(
        &self,
        command: &Command,
        arg: Option<&Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<Self::Value, clap::Error> {
        StringValueParser::new().parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        if self.0.is_empty() { None } else { Some(Box::new(self.0.iter().map(PossibleValue::new))) }
    }
}
