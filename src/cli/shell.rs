//! `planish completions` and `planish man`: shell completions and manual pages, generated from the command line.

use clap::Command;
use clap_complete::Shell;

use super::error::CliError;
use super::say::answer;
use crate::fault::{did_you_mean, shortened};

/// Prints the completions for a shell.
pub(super) fn completions(shell: Shell, mut command: Command) -> Result<(), CliError> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut command, "planish", &mut text);
    answer(&text)
}

/// Prints the manual page of planish, or of one of its commands.
pub(super) fn man(name: Option<&str>, mut command: Command) -> Result<(), CliError> {
    command.build();
    let page = match name {
        None => command,
        Some(name) => {
            let found = command.get_subcommands().find(|known| known.get_name() == name).cloned();
            found.ok_or_else(|| {
                let near = did_you_mean(name, command.get_subcommands().map(Command::get_name));
                let name = shortened(name);
                CliError::usage(format!("there is no command \"{name}\"; {near}`planish help` lists them"))
            })?
        }
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(page).render(&mut text).map_err(CliError::other)?;
    answer(&text)
}
