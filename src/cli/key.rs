//! `planish key`: the keys of clients that a service accepts.

use std::fmt::Write;
use std::path::PathBuf;
use std::time::SystemTime;

use clap::Subcommand;

use super::error::CliError;
use super::say::answer;
use crate::config::keys::{KeyEntry, KeyFile, KeyFileError, KeyRole, SHARED, Token, tenant_fault};
use crate::config::{PartialSettings, Settings, seconds};

/// What to do with the keys of which service.
#[derive(Debug, clap::Args)]
pub(crate) struct KeyOptions {
    #[command(subcommand)]
    command: KeyCommand,
    /// The data directory of the service; as for `planish serve` when left out.
    #[arg(long, global = true)]
    data_dir: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
enum KeyCommand {
    /// Make a key and print it, once: only its hash is kept.
    ///
    /// A tenant may have several keys, so that a new one can be handed out before the old one is revoked.
    Add {
        /// Whose results, jobs and uploads it opens; keys of `shared` share them with each other.
        #[arg(long, default_value = SHARED)]
        tenant: String,
        /// What it allows; each role also allows what those before it do.
        #[arg(long, value_enum, default_value = "render")]
        role: KeyRole,
        /// When it ends, from now on, like 90d; never when left out.
        #[arg(long, value_name = "TIME", value_parser = lifetime)]
        expires_in: Option<u64>,
        /// Most requests for work a minute, in place of the setting.
        #[arg(long)]
        requests_per_minute: Option<u64>,
        /// Most requests for work that are answered at once, in place of the setting.
        #[arg(long)]
        in_flight: Option<u64>,
    },
    /// List the keys: id, tenant, role, when each was made and when it ends.
    List,
    /// Take a key back: it and the addresses that it signed open nothing any more.
    Revoke {
        /// The id of the key, the twelve digits after `planish_`.
        id: String,
    },
}

impl KeyOptions {
    /// Runs the subcommand.
    pub(super) fn run(self) -> Result<(), CliError> {
        let from_variables = PartialSettings::of_variables(std::env::vars_os()).map_err(CliError::usage)?;
        let given = PartialSettings { data_dir: self.data_dir, ..PartialSettings::default() }.or(from_variables);
        let settings = Settings::read(given, None).map_err(CliError::usage)?;
        let file = KeyFile::of(&settings.data_dir);
        match self.command {
            KeyCommand::Add { tenant, role, expires_in, requests_per_minute, in_flight } => {
                if let Some(fault) = tenant_fault(&tenant) {
                    return Err(CliError::usage(fault));
                }
                let token = Token::new(random).map_err(CliError::other)?;
                let created = now_s();
                let entry = KeyEntry {
                    id: token.id().to_owned(),
                    tenant,
                    role,
                    hash: token.hash(),
                    link: token.link_secret(),
                    created,
                    expires: expires_in.map(|time| created.saturating_add(time).min(LAST_S)),
                    requests_per_minute,
                    in_flight,
                };
                add(&file, &token, entry)
            }
            KeyCommand::List => list(&file),
            KeyCommand::Revoke { id } => {
                file.change(|keys| revoke(keys, &id)).map_err(failed)?;
                eprintln!("planish: {id} is revoked; running services refuse it within two seconds");
                Ok(())
            }
        }
    }
}

/// The latest time that a TOML file can hold.
const LAST_S: u64 = i64::MAX as u64;

fn add(file: &KeyFile, token: &Token, entry: KeyEntry) -> Result<(), CliError> {
    let (tenant, role) = (entry.tenant.clone(), entry.role.name());
    file.change(|keys| {
        keys.push(entry);
        Ok(())
    })
    .map_err(failed)?;
    eprintln!(
        "planish: a key of {tenant} with the role {role}, kept in {}; it is shown this once:",
        file.path().display()
    );
    answer(format!("{}\n", token.expose()).as_bytes())
}

fn revoke(keys: &mut Vec<KeyEntry>, id: &str) -> Result<(), KeyFileError> {
    let before = keys.len();
    keys.retain(|key| key.id != id);
    if keys.len() == before {
        let id = crate::fault::shortened(id);
        let detail = format!("there is no key \"{id}\"; `planish key list` tells the ids of those that exist");
        return Err(KeyFileError::Refused(detail));
    }
    Ok(())
}

fn list(file: &KeyFile) -> Result<(), CliError> {
    let Some(keys) = file.read().map_err(failed)? else {
        eprintln!("planish: there are no keys in {}; `planish key add` makes one", file.path().display());
        return Ok(());
    };
    let now_s = now_s();
    let mut text = format!("{:<14}{:<34}{:<8}{:<14}{}\n", "ID", "TENANT", "ROLE", "AGE", "ENDS");
    for key in keys {
        let age = days(now_s.saturating_sub(key.created));
        let ends = match key.expires {
            None => "never".to_owned(),
            Some(_) if key.has_expired(now_s) => "has ended".to_owned(),
            // Rounded up to whole minutes, so that a key just made for 90 d shows 90 d.
            Some(end) => format!("in {}", days((end - now_s).next_multiple_of(60))),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:<14}{:<34}{:<8}{age:<14}{ends}", key.id, key.tenant, key.role.name());
    }
    answer(text.as_bytes())
}

/// Formats a duration in the largest suitable unit.
fn days(time_s: u64) -> String {
    match time_s {
        0..120 => format!("{time_s} s"),
        120..7200 => format!("{} min", time_s / 60),
        7200..172_800 => format!("{} h", time_s / 3600),
        _ => format!("{} d", time_s / 86_400),
    }
}

fn failed(error: KeyFileError) -> CliError {
    match error {
        KeyFileError::Refused(detail) => CliError::refused(detail),
        other => CliError::files(other),
    }
}

/// Reads how long something is valid, in seconds.
///
/// # Errors
/// A text that is no time, and the time 0, in which nothing could be opened.
pub(super) fn lifetime(text: &str) -> Result<u64, String> {
    match seconds(text)? {
        0 => Err("0 seconds are over at once; give a time like 1h or 90d".to_owned()),
        time => Ok(time),
    }
}

/// Returns the current time in seconds since 1970.
pub(super) fn now_s() -> u64 {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_secs()
}

fn random(bytes: &mut [u8]) -> Result<(), String> {
    getrandom::fill(bytes).map_err(|error| format!("the system has no random numbers: {error}"))
}
