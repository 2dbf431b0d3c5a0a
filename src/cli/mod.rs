//! The command line: the same jobs as over HTTP, by the same path, to the same bytes.

mod analyse;
mod error;
mod estimate;
mod folder;
mod health;
mod job;
mod log;
mod presets;
mod render;
mod serve;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::config::{Given, Setting, Settings};

/// Refines control polygons and control meshes by subdivision.
#[derive(Debug, Parser)]
#[command(name = "planish", version, about, max_term_width = 110)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Serve jobs over HTTP.
    ///
    /// Every setting is a flag, an environment variable and a key of the TOML file; the flag wins over the variable,
    /// the variable over the file. GET /v1/limits tells those of a running service.
    Serve {
        /// Settings file (TOML); its keys are the names of the flags.
        #[arg(long, env = "PLANISH_CONFIG")]
        config: Option<PathBuf>,
        #[command(flatten)]
        given: Box<Given>,
    },
    /// Render a job, or a mesh file, to a file; the format follows the extension.
    Render {
        /// The job, a JSON file (- reads it from standard input), or a mesh: obj, ply, stl, off, gltf, glb, json.
        job: PathBuf,
        /// The file to write; - writes to standard output.
        #[arg(short, long)]
        output: PathBuf,
        /// Format, where the extension does not tell.
        #[arg(long)]
        format: Option<String>,
        /// Most faces of a mesh at any level.
        #[arg(long)]
        max_faces: Option<u64>,
        #[command(flatten)]
        options: job::MeshOptions,
    },
    /// Tell what a job, or a mesh file, would come to, without running it.
    Estimate {
        /// The job, a JSON file (- reads it from standard input), or a mesh: obj, ply, stl, off, gltf, glb, json.
        job: PathBuf,
        #[command(flatten)]
        options: job::MeshOptions,
    },
    /// Tell what can be said of a plan: masks, smoothness with its proofs, limit and tangent weights.
    Analyse {
        #[command(flatten)]
        question: Box<analyse::Question>,
    },
    /// List the presets, or one with its parameters.
    Presets {
        /// Name of a preset.
        name: Option<String>,
    },
    /// Ask a running service whether it is ready; for health checks.
    Health {
        /// Address of the service.
        #[arg(long, default_value = "http://127.0.0.1:8080")]
        url: String,
    },
}

impl Cli {
    /// The command line of this process; its help tells the default of every setting.
    pub fn from_command_line() -> Self {
        let defaults = Settings::default().list();
        let with_defaults = |serve: clap::Command| {
            defaults.iter().fold(serve, |serve, Setting { name, value, range, unit, doc }| {
                let value = value.trim_matches('"');
                let blank = if unit.is_empty() { "" } else { " " };
                let range = range.as_ref().map(|range| format!(", range: {} to {}", range.start(), range.end()));
                let help = format!("{doc} [default: {value}{blank}{unit}{}]", range.unwrap_or_default());
                serve.mut_arg(name, |arg| arg.help(help))
            })
        };
        let command = Self::command().mut_subcommand("serve", with_defaults);
        Self::from_arg_matches(&command.get_matches()).unwrap_or_else(|error| error.exit())
    }
}

/// Runs a command.
pub fn run(cli: Cli) -> ExitCode {
    let done = match cli.command {
        Command::Serve { config, given } => serve::serve(*given, config.as_deref()),
        Command::Render { job, output, format, max_faces, options } => {
            render::render(&job, &options, &output, format.as_deref(), max_faces)
        }
        Command::Estimate { job, options } => estimate::estimate(&job, &options),
        Command::Analyse { question } => analyse::analyse(&question),
        Command::Presets { name } => presets::presets(name.as_deref()),
        Command::Health { url } => health::health(&url),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("planish: {error}");
            ExitCode::FAILURE
        }
    }
}
