//! `planish presets`: the schemes by name.

use super::error::CliError;
use crate::wire::catalogue::{ParameterEntry, PresetEntry, presets as all};

/// Prints all presets, or one.
#[expect(clippy::print_stdout, reason = "the answer of a command goes to standard output")]
pub(super) fn presets(name: Option<&str>) -> Result<(), CliError> {
    let presets = all();
    let Some(name) = name else {
        presets
            .iter()
            .for_each(|preset| println!("{:16} {:18} {}", preset.name, preset.refines.join(", "), brief(preset)));
        return Ok(());
    };
    let found = presets.into_iter().find(|preset| preset.name == name);
    let preset =
        found.ok_or_else(|| CliError::new(format!("there is no preset {name}; `planish presets` lists them")))?;
    println!("{} ({})\n{}\nSource: {}", preset.name, preset.refines.join(", "), preset.doc, preset.source);
    preset.parameters.iter().for_each(|parameter| println!("  {}", line(parameter)));
    Ok(())
}

/// The first sentence.
fn brief(preset: &PresetEntry) -> &str {
    preset.doc.split([':', ';', '.']).next().unwrap_or(preset.doc)
}

fn line(parameter: &ParameterEntry) -> String {
    let default = if parameter.required { "required".to_owned() } else { format!("default {}", parameter.default) };
    format!("{:14} {} ({default}). {}", parameter.name, parameter.expects, parameter.doc)
}
