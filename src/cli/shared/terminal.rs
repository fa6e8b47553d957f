//! The terminal that a verb prints to.

/// Columns of the terminal; all there can be where the output goes to a file or another program.
pub fn width() -> usize {
    match rustix::termios::tcgetwinsize(std::io::stdout()) {
        Ok(size) if size.ws_col > 0 => size.ws_col.into(),
        _ => usize::MAX,
    }
}
