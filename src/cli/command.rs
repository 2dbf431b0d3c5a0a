//! The commands and their flags.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use clap_complete::Shell;

use super::analyse::Question;
use super::compare::CompareOptions;
use super::error::{CODES, CliError};
use super::estimate::EstimateOptions;
use super::evaluate::EvaluateOptions;
use super::figures::FigureOptions;
use super::key::KeyOptions;
use super::mcp::McpOptions;
use super::render::RenderOptions;
use super::reproduce::ReproduceOptions;
use super::sign::SignOptions;
use super::validate::ValidateOptions;
use super::{catalogue, health, serve, shell};
use crate::config::{PartialSettings, Setting, Settings};

/// Refines control polygons and control meshes by subdivision.
#[derive(Debug, Parser)]
#[command(name = "planish", version, about, max_term_width = 110, after_help = CODES)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Serve jobs over HTTP.
    ///
    /// Every setting is a flag, an environment variable and a key of the TOML file; the flag wins over the variable,
    /// the variable over the file. Sizes are written as 64MiB or 500kB, times as 30s or 5min. GET /v1/limits tells
    /// those of a running service.
    Serve {
        /// Settings file (TOML); its keys are the names of the flags.
        #[arg(long, env = "PLANISH_CONFIG")]
        config: Option<PathBuf>,
        #[command(flatten)]
        given: Box<PartialSettings>,
    },
    /// Render jobs, or mesh files, to files; the format follows the extension.
    ///
    /// Inputs are rendered one after another, each with all threads; one that fails does not stop the others. Flags
    /// say what a job says, and take the place of what it says itself. Lists are written with commas (`--show
    /// surface,wireframe`), objects as names with values (`--camera azimuth-deg=40,zoom=2`).
    #[command(after_help = CODES)]
    Render(Box<RenderOptions>),
    /// Render a folder of jobs to pictures, or tell which of them have changed.
    ///
    /// The jobs are rendered in parallel. Beside the pictures stands manifest.json with their keys and hashes: what has
    /// the key that it had is not made again. For figures in a repository: `planish figures DIR -o OUT --check` ends
    /// with 1 where a picture is not what it was, and writes a report with before, after and difference.
    #[command(after_help = CODES)]
    Figures(Box<FigureOptions>),
    /// Render files again that say of which job they are, and tell whether the bytes are the same; ends with 0 where
    /// they are, and with 1 where they are not.
    ///
    /// Files say so that were rendered with the option `describe` (`--describe`): png, apng, svg, obj, ply, glb, gltf.
    #[command(after_help = CODES)]
    Reproduce(Box<ReproduceOptions>),
    /// Compare two pictures, or two shapes, and tell what differs as JSON; ends with 0 where they are the same within
    /// what is allowed, and with 1 where they are not.
    ///
    /// Pictures are compared pixel by pixel: files as they are seen, without pixels that smooth an edge (as pixelmatch
    /// does), those that jobs make by equality. Shapes are compared by the Hausdorff distance both ways, and by what
    /// changes of box, area, volume and shape hash.
    #[command(after_help = CODES)]
    Compare(Box<CompareOptions>),
    /// Tell what a job, or a mesh file, would come to, without running it.
    #[command(after_help = CODES)]
    Estimate(Box<EstimateOptions>),
    /// Tell what the Catmull-Clark limit surface of a mesh is like at places on its faces, and which of its places are
    /// closest to points, as JSON.
    #[command(after_help = CODES)]
    Evaluate(Box<EvaluateOptions>),
    /// Tell what is wrong with jobs, or mesh files, and what their meshes are like, as JSON; ends with 3 where
    /// something is wrong.
    #[command(after_help = CODES)]
    Validate(Box<ValidateOptions>),
    /// Tell what can be said of a plan: masks, smoothness with its proofs, limit and tangent weights.
    #[command(after_help = CODES)]
    Analyse(Box<Question>),
    /// List the presets, or one with its parameters.
    Presets {
        /// Name of a preset.
        name: Option<String>,
    },
    /// List the operators of words, or one with its parameters.
    Operators {
        /// Letter of an operator.
        letter: Option<String>,
    },
    /// List the formats that are written and the kinds of files that are read, or one format with its options.
    Formats {
        /// Name of a format.
        name: Option<String>,
    },
    /// Add, list and revoke the keys that a service lets in; a running service takes changes up within a second or two.
    Key(Box<KeyOptions>),
    /// Sign an address that opens a render, a result or the events of a job without a key, until its time is over.
    Sign(Box<SignOptions>),
    /// Serve a language model's client, by the Model Context Protocol over standard input and output: the tools render,
    /// views, validate, estimate and presets.
    Mcp(McpOptions),
    /// Ask a running service whether it is ready; for health checks.
    Health {
        /// Address of the service.
        #[arg(long, default_value = "http://127.0.0.1:8080")]
        url: String,
    },
    /// Print what a shell needs to complete commands and flags.
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Print the manual page of planish, or of one command.
    Man {
        /// Name of a command.
        command: Option<String>,
    },
}

impl Cli {
    /// Parses the command line of this process; exits with a message if it is wrong.
    pub fn from_command_line() -> Self {
        Self::from_arg_matches(&whole().get_matches()).unwrap_or_else(|error| error.exit())
    }
}

/// Builds the command line, whose help shows the default of every setting.
fn whole() -> clap::Command {
    let defaults = Settings::default().list();
    let with_defaults = |serve: clap::Command| {
        defaults.iter().fold(serve, |serve, setting| {
            let Setting { name, variable, doc, .. } = setting;
            let help = format!("{doc} [env: {variable}] [default: {}]", setting.readable());
            serve.mut_arg(name, |arg| arg.help(help).long_help(None))
        })
    };
    Cli::command().mut_subcommand("serve", with_defaults)
}

/// Runs a command and returns its exit code.
pub fn run(cli: Cli) -> ExitCode {
    let done = match cli.command {
        Command::Serve { config, given } => serve::serve(*given, config.as_deref()),
        Command::Render(options) => options.render(),
        Command::Figures(options) => options.run(),
        Command::Reproduce(options) => options.reproduce(),
        Command::Compare(options) => options.compare(),
        Command::Estimate(options) => options.estimate(),
        Command::Evaluate(options) => options.evaluate(),
        Command::Validate(options) => options.validate(),
        Command::Analyse(question) => question.analyse(),
        Command::Presets { name } => catalogue::list_presets(name.as_deref()),
        Command::Operators { letter } => catalogue::list_operators(letter.as_deref()),
        Command::Formats { name } => catalogue::list_formats(name.as_deref()),
        Command::Key(options) => options.run(),
        Command::Sign(options) => options.sign(),
        Command::Mcp(options) => options.serve(),
        Command::Health { url } => health::health(&url),
        Command::Completions { shell } => shell::completions(shell, whole()),
        Command::Man { command } => shell::man(command.as_deref(), whole()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error @ CliError { kind, .. }) => {
            if !error.details.is_empty() {
                eprintln!("planish: {error}");
            }
            ExitCode::from(kind as u8)
        }
    }
}
