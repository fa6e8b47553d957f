//! Reads a runner's standard output, at most one line ahead, and the end of its standard error. So
//! neither can fill the memory.

use std::io::{BufRead, BufReader, Read};
use std::process::{ChildStderr, ChildStdout};
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

pub(super) type Line = Result<String, String>;

/// Maximum length of a line, in bytes.
const LONGEST_LINE: u64 = 1 << 20;
const SHOWN: usize = 320;
/// Maximum size of the kept end of standard error, in bytes; it has the reason for a crash.
const KEPT: usize = 1 << 16;

/// Returns the lines of a runner. One line is read ahead; a runner that writes more must wait.
pub(super) fn lines(output: Option<ChildStdout>) -> Receiver<Line> {
    let (sender, lines) = sync_channel(1);
    std::thread::spawn(move || {
        let mut output = BufReader::new(output?);
        loop {
            let mut bytes = Vec::new();
            let read = output.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut bytes).ok()?;
            let line = if read == 0 { return None } else { line(bytes) };
            // Reading stops at an invalid line, because the start of the next one is unknown.
            let last = line.is_err();
            if sender.send(line).is_err() || last {
                return Some(());
            }
        }
    });
    lines
}

fn line(bytes: Vec<u8>) -> Line {
    if bytes.len() as u64 == LONGEST_LINE && !bytes.ends_with(b"\n") {
        return Err(format!("it is longer than 1 MiB: {}", shown(&bytes)));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to() + 1;
        format!("byte {at} is not UTF-8: {}", shown(error.as_bytes()))
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
