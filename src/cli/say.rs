//! Answers of commands on standard output.

use std::io::{self, ErrorKind, Write};

use super::error::CliError;

/// Writes an answer to standard output. A reader that has seen enough, such as `head`, is no failure.
pub(super) fn answer(text: &[u8]) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    match out.write_all(text).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(CliError::files(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}
