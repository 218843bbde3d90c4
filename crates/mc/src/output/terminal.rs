//! The width of a terminal.

use std::io::IsTerminal as _;

/// The width of standard output in columns. None if it is not a terminal but, for instance, a pipe,
/// so that the input of programs does not depend on a window.
pub fn columns() -> Option<usize> {
    let out = std::io::stdout();
    let size = rustix::termios::tcgetwinsize(&out)
        .ok()
        .filter(|_| out.is_terminal())?;
    Some(usize::from(size.ws_col)).filter(|columns| *columns > 0)
}
