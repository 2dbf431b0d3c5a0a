//! The settings of a service, each with unit, default and range; read once at the start from flags, environment
//! variables, and a TOML file, in this order of precedence.

pub mod authority;
mod error;
mod file;
pub mod keys;
mod levels;
pub mod memory;
mod origins;
mod variables;
mod written;

use std::ffi::OsString;
use std::net::SocketAddr;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use crate::fault::nearest;
use crate::job::limits::Limits;

use written::{SettingValue, shown};

pub use error::ConfigError;
pub use levels::LogLevels;
pub use origins::CorsOrigins;
pub use written::seconds;

/// Maximum number of bytes in a setting, 1 PiB: beyond the memory and the disks of one machine, and so small that sums
/// of a thousand of them fit into 63 bits, the size of TOML integers.
const MAX_SETTING_BYTES: u64 = 1 << 50;
/// Minimum memory of a service, 256 MiB: its shares then still hold a small job each.
const LEAST_MEMORY_BYTES: u64 = 256 << 20;
/// Maximum of the setting for the length of request bodies, 1 GiB: bodies are held in memory, and a gibibyte of JSON is
/// read into several.
const MAX_BODY_BYTES: u64 = 1 << 30;
/// Maximum of the settings for jobs and connections: each connection has a file descriptor and its buffers, each job
/// its request, and 65,536 of them are more than two lanes or one address can serve.
const MAX_SETTING_WAITING: u64 = 1 << 16;
/// Maximum of the setting for requests per minute: 16,666 a second are more than one machine answers.
const MAX_SETTING_REQUESTS: u64 = 1_000_000;
/// Maximum of the setting for jobs of a batch: a response about a batch has the state of each job, some megabytes for
/// 10,000 jobs.
const MAX_BATCH_ITEMS: u64 = 10_000;
/// Maximum number of compute threads per lane: more than machines have cores, and two lanes of them still fit under the
/// usual limit on the threads of a process.
const MAX_THREADS: u64 = 1024;
/// Maximum duration in a setting, a day in seconds: longer waits are of no use to a service, and clocks can add a day
/// to any time without overflow.
const MAX_SETTING_SECONDS: u64 = 24 * 60 * 60;
/// Maximum of the settings for faces and vertices: indices are 32 bits wide.
const MAX_INDEXED: u64 = u32::MAX as u64;

/// One setting in the list of all settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// The name; flags and keys of the file have dashes in place of underscores.
    pub name: &'static str,
    /// The environment variable.
    pub variable: &'static str,
    /// The value, as a user would write it.
    pub value: String,
    /// The smallest and the largest value, if the setting is a number.
    pub range: Option<RangeInclusive<u64>>,
    /// The unit of the number.
    pub unit: &'static str,
    /// The meaning of the setting.
    pub doc: String,
}

impl Setting {
    /// Returns the value and the range in readable form.
    pub fn readable(&self) -> String {
        let amount = |n: u64| match (self.unit, shown(n, self.unit)) {
            ("bytes" | "", size) => size,
            ("bytes a second", size) => format!("{size} a second"),
            (unit, n) => format!("{n} {unit}"),
        };
        let value = self.value.parse().map_or_else(|_| self.value.trim_matches('"').to_owned(), amount);
        let range = self.range.as_ref();
        let range =
            range.map(|range| format!(", range: {} to {}", shown(*range.start(), self.unit), amount(*range.end())));
        value + &range.unwrap_or_default()
    }
}

// Each entry is `name: type = default, in range, "VARIABLE", "unit";`, and only numbers have a range.
macro_rules! settings {
    (@range) => { None };
    (@range $range:expr) => { Some($range) };
    ($(
        $(#[doc = $doc:literal])+
        $name:ident: $type:ty = $default:expr, $(in $range:expr,)? $env:literal, $unit:literal;
    )*) => {
        /// Settings as far as they were given in one place: flags, environment, or the file.
        #[derive(Debug, Clone, Default, PartialEq, clap::Args)]
        pub struct PartialSettings {
            $(
                $(#[doc = $doc])+
                #[arg(long, allow_negative_numbers = true)]
                #[arg(value_parser = |text: &str| <$type as SettingValue>::read(text, $unit))]
                pub $name: Option<$type>,
            )*
        }

        impl PartialSettings {
            /// The names of the settings.
            const NAMES: &[&'static str] = &[$(stringify!($name)),*];
            /// The environment variables of the settings, in the same order.
            const VARIABLES: &[&'static str] = &[$($env),*];

            /// Returns these settings, completed by `other` where they have no value.
            #[must_use]
            pub fn or(self, other: Self) -> Self {
                Self { $($name: self.$name.or(other.$name),)* }
            }

            /// Sets the setting with this name to the value read from `text`.
            fn set(&mut self, name: &str, text: &str) -> Result<(), String> {
                $(if name == stringify!($name) {
                    self.$name = Some(<$type as SettingValue>::read(text, $unit)?);
                })*
                Ok(())
            }
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
            /// Returns the given settings, completed by the defaults.
            fn of(given: PartialSettings) -> Self {
                let default = Self::default();
                Self { $($name: given.$name.unwrap_or(default.$name),)* }
            }

            /// Returns every setting with its value, range and meaning.
            pub fn list(&self) -> Vec<Setting> {
                vec![$(Setting {
                    name: stringify!($name),
                    variable: $env,
                    value: format!("{:?}", self.$name),
                    range: settings!(@range $($range)?),
                    unit: $unit,
                    doc: concat!($($doc),+).trim().to_owned(),
                },)*]
            }

            /// Checks every number against its range.
            fn checked(self) -> Result<Self, ConfigError> {
                $($(in_range(stringify!($name), self.$name, $range, $env, $unit)?;)?)*
                Ok(self)
            }
        }
    };
}

settings! {
    /// Address to listen on.
    listen: SocketAddr = SocketAddr::from(([127, 0, 0, 1], 8080)), "PLANISH_LISTEN", "";
    /// Web pages that may ask, by their origins: `none`, `loopback`, `*`, or a list like `https://example.org`.
    cors_origins: CorsOrigins = CorsOrigins::Usual, "PLANISH_CORS_ORIGINS", "";
    /// Answer everybody on an address that is not loopback, though there are no keys.
    without_keys: bool = false, "PLANISH_WITHOUT_KEYS", "";
    /// Folder for the cache; by the platform's convention when left out.
    data_dir: PathBuf = default_data_dir(), "PLANISH_DATA_DIR", "";
    /// Compute threads a lane; 0 means one a core.
    threads: usize = 0, in 0..=MAX_THREADS, "PLANISH_THREADS", "threads";
    /// Most faces of a mesh at any level.
    max_faces: u64 = Limits::default().max_faces, in 1..=MAX_INDEXED, "PLANISH_MAX_FACES", "faces";
    /// Most points of all polygons, or vertices of a mesh, at any level.
    max_vertices: u64 = Limits::default().max_vertices, in 1..=MAX_INDEXED, "PLANISH_MAX_VERTICES", "vertices";
    /// Most bytes of one result.
    max_output_bytes: u64 = Limits::default().max_output_bytes, in 1..=MAX_SETTING_BYTES,
        "PLANISH_MAX_OUTPUT_BYTES", "bytes";
    /// Most memory one job may need.
    max_job_bytes: u64 = Limits::default().max_job_bytes, in 1..=MAX_SETTING_BYTES, "PLANISH_MAX_JOB_BYTES", "bytes";
    /// Memory of everything that is held for requests: bodies, computations, answers, caches. Who finds none left waits
    /// or is answered 503. Where it is not given, less is taken where the machine or its control group has less.
    max_memory_bytes: u64 = 12 << 30, in LEAST_MEMORY_BYTES..=MAX_SETTING_BYTES, "PLANISH_MAX_MEMORY_BYTES", "bytes";
    /// Most bytes of a request body, as it comes and inflated.
    max_body_bytes: u64 = 32 << 20, in 1..=MAX_BODY_BYTES, "PLANISH_MAX_BODY_BYTES", "bytes";
    /// Most jobs waiting in each of the two lanes; more are answered 503.
    max_queue: usize = 256, in 1..=MAX_SETTING_WAITING, "PLANISH_MAX_QUEUE", "jobs";
    /// Most jobs of one peer address that wait at once, joined ones included, and most that go on without their
    /// request; more are answered 503.
    max_queue_per_peer: usize = 64, in 1..=MAX_SETTING_WAITING, "PLANISH_MAX_QUEUE_PER_PEER", "jobs";
    /// Most requests for work that one key, or one address where there are no keys, may send in a minute; as many may
    /// come at once. More are answered 429. 0 sets no bound.
    requests_per_minute: u64 = 0, in 0..=MAX_SETTING_REQUESTS, "PLANISH_REQUESTS_PER_MINUTE", "requests";
    /// Most requests for work of one key, or one address where there are no keys, that are answered at once; more are
    /// answered 429. 0 sets no bound.
    requests_in_flight: u64 = 0, in 0..=MAX_SETTING_WAITING, "PLANISH_REQUESTS_IN_FLIGHT", "requests";
    /// Most jobs of one batch.
    max_batch_items: u64 = 1000, in 1..=MAX_BATCH_ITEMS, "PLANISH_MAX_BATCH_ITEMS", "jobs";
    /// Most connections open at once; a further one takes the place of the one that has been idle or slow for longest.
    max_connections: usize = 1024, in 1..=MAX_SETTING_WAITING, "PLANISH_MAX_CONNECTIONS", "connections";
    /// Most connections of one peer address open at once; the same holds for a further one.
    max_connections_per_peer: usize = 512, in 1..=MAX_SETTING_WAITING,
        "PLANISH_MAX_CONNECTIONS_PER_PEER", "connections";
    /// Memory for cached results, at most a quarter of max-memory-bytes; 0 turns the memory cache off.
    memory_cache_bytes: u64 = 512 << 20, in 0..=MAX_SETTING_BYTES, "PLANISH_MEMORY_CACHE_BYTES", "bytes";
    /// Disk space for cached results; 0 keeps nothing on disk.
    cache_bytes: u64 = 8 << 30, in 0..=MAX_SETTING_BYTES, "PLANISH_CACHE_BYTES", "bytes";
    /// Disk space for files that clients send to /v1/blobs; those that no job needs leave for others.
    uploads_bytes: u64 = 2 << 30, in 1..=MAX_SETTING_BYTES, "PLANISH_UPLOADS_BYTES", "bytes";
    /// Where results and uploads are kept: `folder`, in data-dir, or `s3`, in a bucket that servers share. Credentials
    /// for the bucket are read from the variables `AWS_ACCESS_KEY_ID`, `AWS_SECRET_ACCESS_KEY` and
    /// `AWS_SESSION_TOKEN`, or are those of the machine.
    cache_store: String = "folder".to_owned(), "PLANISH_CACHE_STORE", "";
    /// Bucket for `s3`.
    s3_bucket: String = String::new(), "PLANISH_S3_BUCKET", "";
    /// What the names of all objects in the bucket begin with.
    s3_prefix: String = "planish".to_owned(), "PLANISH_S3_PREFIX", "";
    /// Address of the store, as `https://s3.example.org`; that of AWS for the region when left out.
    s3_endpoint: String = String::new(), "PLANISH_S3_ENDPOINT", "";
    /// Region of the bucket; `us-east-1` when left out here and in `AWS_REGION`.
    s3_region: String = String::new(), "PLANISH_S3_REGION", "";
    /// Results that are larger are sent while they are made and not kept, unless the request asks for it.
    keep_at_most_bytes: u64 = 64 << 20, in 0..=MAX_SETTING_BYTES, "PLANISH_KEEP_AT_MOST_BYTES", "bytes";
    /// How long a job is known after it is done, has failed or was cancelled; its results may leave the cache before.
    job_ttl_s: u64 = 86_400, in 1..=MAX_SETTING_SECONDS, "PLANISH_JOB_TTL_S", "seconds";
    /// Longest time one computation may run.
    run_timeout_s: u64 = 300, in 1..=MAX_SETTING_SECONDS, "PLANISH_RUN_TIMEOUT_S", "seconds";
    /// Longest time a client may take for its request headers, or stay silent between requests.
    header_timeout_s: u64 = 10, in 1..=MAX_SETTING_SECONDS, "PLANISH_HEADER_TIMEOUT_S", "seconds";
    /// Longest silence within a request body, and how long a body or the reading of an answer may be slow at first.
    body_timeout_s: u64 = 15, in 1..=MAX_SETTING_SECONDS, "PLANISH_BODY_TIMEOUT_S", "seconds";
    /// Least rate at which a body has to arrive and an answer has to be read, averaged over all but its first
    /// body-timeout-s.
    least_rate_bytes_s: u64 = 16 << 10, in 1..=MAX_SETTING_BYTES, "PLANISH_LEAST_RATE_BYTES_S", "bytes a second";
    /// Time for running requests and jobs to end after the signal to stop.
    shutdown_timeout_s: u64 = 20, in 0..=MAX_SETTING_SECONDS, "PLANISH_SHUTDOWN_TIMEOUT_S", "seconds";
    /// How much is logged: `off`, `error`, `warn`, `info`, `debug` or `trace`, of parts of the program as in
    /// `warn,planish=debug`.
    log: LogLevels = LogLevels::default(), "PLANISH_LOG", "";
    /// Write logs as JSON lines.
    log_json: bool = false, "PLANISH_LOG_JSON", "";
}

fn in_range(
    name: &'static str,
    value: impl TryInto<u64>,
    range: RangeInclusive<u64>,
    variable: &'static str,
    unit: &'static str,
) -> Result<(), ConfigError> {
    let value = value.try_into().unwrap_or(u64::MAX);
    if range.contains(&value) {
        return Ok(());
    }
    Err(ConfigError::OutOfRange { name, value, range, unit, variable })
}

impl PartialSettings {
    /// Reads the settings from environment variables.
    ///
    /// # Errors
    /// [`ConfigError`] for a variable `PLANISH_...` that is not a setting, or for an invalid value.
    pub fn of_variables(variables: impl Iterator<Item = (OsString, OsString)>) -> Result<Self, ConfigError> {
        let mut given = Self::default();
        for (at, text) in variables::settings(variables, Self::VARIABLES)? {
            let wrong = |detail| ConfigError::Wrong { place: format!("the variable {}", Self::VARIABLES[at]), detail };
            given.set(Self::NAMES[at], &text).map_err(wrong)?;
        }
        Ok(given)
    }

    /// Reads the settings from a TOML file.
    fn of_file(path: &Path) -> Result<Self, ConfigError> {
        let mut given = Self::default();
        for (key, text) in file::read(path)? {
            let place = format!("the key {key} of the settings file {}", path.display());
            let keys: Vec<String> = Self::NAMES.iter().map(|name| name.replace('_', "-")).collect();
            let Some(at) = keys.iter().position(|known| *known == key) else {
                let near = nearest(&key, keys.iter().map(String::as_str)).map(str::to_owned);
                return Err(ConfigError::Unknown { place, near });
            };
            given.set(Self::NAMES[at], &text).map_err(|detail| ConfigError::Wrong { place, detail })?;
        }
        Ok(given)
    }
}

impl Settings {
    /// Returns the settings from flags and environment (`given`), completed by a TOML file and the defaults.
    ///
    /// # Errors
    /// [`ConfigError`].
    pub fn read(given: PartialSettings, file: Option<&Path>) -> Result<Self, ConfigError> {
        Self::read_within(given, file, None)
    }

    /// As [`Settings::read`], for a process with `available` bytes of memory, which bound the memory budget if no
    /// setting does.
    ///
    /// # Errors
    /// [`ConfigError`].
    pub fn read_within(
        given: PartialSettings,
        file: Option<&Path>,
        available: Option<u64>,
    ) -> Result<Self, ConfigError> {
        let from_file = file.map(PartialSettings::of_file).transpose()?.unwrap_or_default();
        let mut given = given.or(from_file);
        let usual = Self::default().max_memory_bytes;
        given.max_memory_bytes.get_or_insert_with(|| memory::budget(usual, LEAST_MEMORY_BYTES, available));
        Self::of(given).checked()
    }

    /// Returns the limits on one job.
    pub fn limits(&self) -> Limits {
        Limits {
            max_faces: self.max_faces.min(MAX_INDEXED),
            max_vertices: self.max_vertices.min(MAX_INDEXED),
            max_output_bytes: self.max_output_bytes,
            max_job_bytes: self.max_job_bytes,
            ..Limits::default()
        }
    }

    /// Returns the number of compute threads per lane.
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
