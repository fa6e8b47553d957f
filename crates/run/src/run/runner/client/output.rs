//! Reads a runner's standard output, at most one line ahead, and the end of its standard error. So
//! neither can fill the memory.

use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::process::{ChildStderr, ChildStdout};
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

pub(super) type Line = Result<String, String>;

/// Maximum length of a line, in bytes.
const LONGEST_LINE: usize = 1 << 20;
const SHOWN: usize = 320;
/// Maximum size of the kept end of standard error, in bytes; it has the reason for a crash.
const KEPT: usize = 1 << 16;

/// The beginning of a line whose end has not arrived.
pub(super) type Begun = Arc<Mutex<Vec<u8>>>;

/// Returns the lines of a runner. One line is read ahead; a runner that writes more must wait.
pub(super) fn lines(output: Option<ChildStdout>) -> (Receiver<Line>, Begun) {
    let (sender, lines) = sync_channel(1);
    let begun = Begun::default();
    let seen = begun.clone();
    std::thread::spawn(move || {
        let Some(output) = output else { return };
        let mut output = BufReader::new(output);
        loop {
            let bytes = next(&mut output, &seen);
            if bytes.is_empty() {
                return;
            }
            let line = line(bytes);
            // Reading stops at an invalid line, because the start of the next one is unknown.
            let last = line.is_err();
            if sender.send(line).is_err() || last {
                return;
            }
        }
    });
    (lines, begun)
}

/// Reads up to the end of a line, at most [`LONGEST_LINE`] bytes; nothing at the output's end.
fn next(output: &mut impl BufRead, begun: &Mutex<Vec<u8>>) -> Vec<u8> {
    let mut bytes = Vec::new();
    while bytes.len() < LONGEST_LINE && !bytes.ends_with(b"\n") {
        let part = match output.fill_buf() {
            Ok([]) => break,
            Ok(part) => part,
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(_) => return Vec::new(),
        };
        let end = part.iter().position(|&byte| byte == b'\n').map_or(part.len(), |at| at + 1);
        let read = end.min(LONGEST_LINE - bytes.len());
        bytes.extend_from_slice(&part[..read]);
        output.consume(read);
        let mut begun = begun.lock().unwrap_or_else(PoisonError::into_inner);
        begun.clear();
        if !bytes.ends_with(b"\n") {
            begun.extend_from_slice(&bytes[..bytes.len().min(SHOWN)]);
        }
    }
    bytes
}

fn line(bytes: Vec<u8>) -> Line {
    if bytes.len() == LONGEST_LINE && !bytes.ends_with(b"\n") {
        return Err(format!("it is longer than 1 MiB): {}", shown(&bytes)));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to() + 1;
        format!("byte {at} is not UTF-8): {}", shown(error.as_bytes()))
    })
}

pub(super) fn shown(line: &[u8]) -> String {
    let text = String::from_utf8_lossy(&line[..line.len().min(SHOWN)]);
    text.trim_end().chars().take(80).collect()
}

pub(super) fn errors(output: Option<ChildStderr>) -> Arc<Mutex<String>> {
    let errors = Arc::new(Mutex::new(String::new()));
    let kept = errors.clone();
    std::thread::spawn(move || {
        let Some(mut output) = output else { return };
        let mut buffer = [0; 1024];
        while let Ok(read @ 1..) = output.read(&mut buffer) {
            let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
            kept.push_str(&String::from_utf8_lossy(&buffer[..read]));
            let surplus = kept.floor_char_boundary(kept.len().saturating_sub(KEPT));
            kept.drain(..surplus);
        }
    });
    errors
}
