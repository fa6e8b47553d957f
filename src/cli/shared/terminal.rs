//! The terminal that a verb prints to.

/// Columns of the terminal; all there can be where the output goes to a file or another program.
pub fn width() -> usize {
    #[cfg(unix)]
    if let Ok(size) = rustix::termios::tcgetwinsize(std::io::stdout())
        && size.ws_col > 0
    {
        return size.ws_col.into();
    }
    usize::MAX
}
