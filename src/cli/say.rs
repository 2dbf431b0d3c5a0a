//! Output of commands on standard output.

use std::io::{self, ErrorKind, Write};

use super::error::CliError;

/// Writes a text to standard output. A reader that closes the pipe early, such as `head`, is not an error.
pub(super) fn answer(text: &[u8]) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    match out.write_all(text).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(CliError::files(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}
