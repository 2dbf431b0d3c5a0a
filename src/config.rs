//! Every setting: unit, default, bound; read once at start from flags, environment, and a TOML file, in this order.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use crate::job::limits::Limits;

macro_rules! settings {
    ($($(#[doc = $doc:literal])+ $name:ident: $type:ty = $default:expr, $env:literal, $unit:literal;)*) => {
        /// Settings as far as they were given in one place: flags and environment, or the file.
        #[derive(Debug, Clone, Default, PartialEq, clap::Args, serde::Deserialize)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        pub struct Given {
            $($(#[doc = $doc])+ #[arg(long, env = $env)] pub $name: Option<$type>,)*
        }

        /// The settings of a service.
        #[derive(Debug, Clone, PartialEq)]
        pub struct Settings {
            $($(#[doc = $doc])+ pub $name: $type,)*
        }

        impl Default for Settings {
            fn default() -> Self {
                Self { $($name: $default,)* }
            }
        }

        impl Settings {
            /// What was given first wins; what was given nowhere has its default.
            fn merged(first: Given, second: Given) -> Self {
                let default = Self::default();
                Self { $($name: first.$name.or(second.$name).unwrap_or(default.$name),)* }
            }

            /// Name, value, unit and meaning of every setting.
            pub fn list(&self) -> Vec<(&'static str, String, &'static str, String)> {
                vec![$((stringify!($name), format!("{:?}", self.$name), $unit, concat!($($doc),+).trim().to_owned()),)*]
            }
        }
    };
}

settings! {
    /// Address to listen on.
    listen: SocketAddr = SocketAddr::from(([127, 0, 0, 1], 8080)), "PLANISH_LISTEN", "";
    /// Folder for the cache; by the platform's convention when left out.
    data_dir: PathBuf = default_data_dir(), "PLANISH_DATA_DIR", "";
    /// Compute threads a lane; 0 means one a core.
    threads: usize = 0, "PLANISH_THREADS", "threads";
    /// Most faces of a mesh at any level.
    max_faces: u64 = Limits::default().max_faces, "PLANISH_MAX_FACES", "faces";
    /// Most points of all polygons, or vertices of a mesh, at any level.
    max_vertices: u64 = Limits::default().max_vertices, "PLANISH_MAX_VERTICES", "vertices";
    /// Most bytes of one result.
    max_output_bytes: u64 = Limits::default().max_output_bytes, "PLANISH_MAX_OUTPUT_BYTES", "bytes";
    /// Most memory one job may need.
    max_job_bytes: u64 = Limits::default().max_job_bytes, "PLANISH_MAX_JOB_BYTES", "bytes";
    /// Memory of all jobs that run at once; others wait.
    max_memory_bytes: u64 = 12 << 30, "PLANISH_MAX_MEMORY_BYTES", "bytes";
    /// Most bytes of a request body.
    max_body_bytes: u64 = 4 << 20, "PLANISH_MAX_BODY_BYTES", "bytes";
    /// Most jobs waiting in each of the two lanes; more are answered 503.
    max_queue: usize = 256, "PLANISH_MAX_QUEUE", "jobs";
    /// Most connections open at once; more wait to be accepted.
    max_connections: usize = 1024, "PLANISH_MAX_CONNECTIONS", "connections";
    /// Memory for cached results; 0 turns the memory cache off.
    memory_cache_bytes: u64 = 512 << 20, "PLANISH_MEMORY_CACHE_BYTES", "bytes";
    /// Disk space for cached results; 0 keeps nothing on disk.
    cache_bytes: u64 = 8 << 30, "PLANISH_CACHE_BYTES", "bytes";
    /// Longest time one computation may run.
    run_timeout_s: u64 = 300, "PLANISH_RUN_TIMEOUT_S", "seconds";
    /// Longest time a client may take for its request headers, or stay silent between requests.
    header_timeout_s: u64 = 10, "PLANISH_HEADER_TIMEOUT_S", "seconds";
    /// Longest silence within a request body, and within the reading of an answer.
    body_timeout_s: u64 = 15, "PLANISH_BODY_TIMEOUT_S", "seconds";
    /// Time for running requests and jobs to end after the signal to stop.
    shutdown_timeout_s: u64 = 20, "PLANISH_SHUTDOWN_TIMEOUT_S", "seconds";
    /// Write logs as JSON lines.
    log_json: bool = false, "PLANISH_LOG_JSON", "";
}

/// Why there are no settings.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The file could not be read.
    #[error("the settings file {path}: {error}", path = .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// The file is not what it should be.
    #[error("the settings file {path}: {error}", path = .path.display())]
    Unfit {
        /// The file.
        path: PathBuf,
        /// Where and why.
        error: Box<toml::de::Error>,
    },
    /// A value that no service can work with.
    #[error("{name} is {value}; {remedy}")]
    OutOfRange {
        /// The setting.
        name: &'static str,
        /// Its value.
        value: u64,
        /// What would be right.
        remedy: &'static str,
    },
}

impl Settings {
    /// The settings from flags and environment (`given`) and, below them, a TOML file.
    ///
    /// # Errors
    /// [`ConfigError`].
    pub fn read(given: Given, file: Option<&Path>) -> Result<Self, ConfigError> {
        let from_file = match file {
            None => Given::default(),
            Some(path) => {
                let text = std::fs::read_to_string(path)
                    .map_err(|error| ConfigError::Unreadable { path: path.to_owned(), error })?;
                toml::from_str(&text)
                    .map_err(|error| ConfigError::Unfit { path: path.to_owned(), error: Box::new(error) })?
            }
        };
        Self::merged(given, from_file).checked()
    }

    fn checked(self) -> Result<Self, ConfigError> {
        let at_least_one = [
            ("max_body_bytes", self.max_body_bytes),
            ("max_connections", self.max_connections as u64),
            ("max_queue", self.max_queue as u64),
            ("run_timeout_s", self.run_timeout_s),
            ("header_timeout_s", self.header_timeout_s),
            ("body_timeout_s", self.body_timeout_s),
        ];
        if let Some(&(name, value)) = at_least_one.iter().find(|(_, value)| *value == 0) {
            return Err(ConfigError::OutOfRange { name, value, remedy: "give at least 1" });
        }
        if self.threads > 1024 {
            let (name, value) = ("threads", self.threads as u64);
            return Err(ConfigError::OutOfRange { name, value, remedy: "give at most 1024, or 0 for one a core" });
        }
        Ok(self)
    }

    /// The bounds on one job.
    pub fn limits(&self) -> Limits {
        // indices are 32 bits wide, and a net has up to four corners a vertex
        let indexed = u64::from(u32::MAX) / 5;
        Limits {
            max_faces: self.max_faces.min(indexed),
            max_vertices: self.max_vertices.min(indexed),
            max_output_bytes: self.max_output_bytes,
            max_job_bytes: self.max_job_bytes,
        }
    }

    /// Compute threads a lane.
    pub fn compute_threads(&self) -> usize {
        match self.threads {
            0 => std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            n => n,
        }
    }
}

fn default_data_dir() -> PathBuf {
    directories::ProjectDirs::from("", "", "planish").map_or_else(PathBuf::new, |dirs| dirs.cache_dir().to_owned())
}
