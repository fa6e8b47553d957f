//! Records the origin of rows: the program of each process, by the SHA-256 of its file, and the
//! load of the machine.

use std::collections::HashMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use anyhow::Context;

use crate::run::runner::client::Client;
use crate::run::subject::Subject;
use contactbench_record::record::folder::copies::{sha256, sha256_of};
use contactbench_record::record::folder::ledger::{Entry, Executed, Process, Span, Writer};
use contactbench_record::record::role::Role;

pub struct Origins {
    ledger: Writer,
    /// SHA-256 of files. A file is read again only if its path, size, time or inode changes.
    known: HashMap<Stamp, Option<String>>,
}

type Stamp = (PathBuf, u64, Option<SystemTime>, u64);

impl Origins {
    pub fn append(folder: &Path) -> io::Result<Origins> {
        Ok(Origins { ledger: Writer::append(folder)?, known: HashMap::new() })
    }

    pub fn process(
        &mut self,
        subject: &Subject,
        client: &Client,
    ) -> anyhow::Result<Option<String>> {
        let [program, arguments @ ..] = &*subject.start.command else { return Ok(None) };
        let mut files = vec![self.executed(running(client.process(), program))];
        // A runner's command may name a script after its interpreter.
        let named = arguments.iter().map(PathBuf::from).filter(|_| subject.role == Role::Runner);
        for path in named.filter(|path| path.is_file()) {
            let name = name(&path);
            files.push(self.executed((name, path)));
        }
        let hello = &client.hello;
        let (version, build) = (hello.version.clone(), hello.build.clone());
        let mut process = Process { id: String::new(), files, version, build };
        process.id = sha256(&serde_json::to_vec(&process)?)[..8].into();
        let id = process.id.clone();
        self.write(&Entry::Process(process))?;
        Ok(Some(id))
    }

    pub fn span(&mut self, span: Span) -> anyhow::Result<()> {
        self.write(&Entry::Span(span))
    }

    fn write(&mut self, entry: &Entry) -> anyhow::Result<()> {
        self.ledger.write(entry).context("cannot write where the rows come from")
    }

    fn executed(&mut self, (name, path): (String, PathBuf)) -> Executed {
        // On Linux, the path is `/proc/PID/exe`, which differs between processes.
        let place = if path.starts_with("/proc") { PathBuf::from(&name) } else { path.clone() };
        let stamp = std::fs::metadata(&path).map(|it| {
            #[cfg(unix)]
            let number = std::os::unix::fs::MetadataExt::ino(&it);
            #[cfg(not(unix))]
            let number = 0;
            (place, it.len(), it.modified().ok(), number)
        });
        let sha256 = stamp.ok().and_then(|stamp| {
            self.known.entry(stamp).or_insert_with(|| fingerprint(&path).ok()).clone()
        });
        Executed { name, sha256 }
    }
}

/// Returns name and path of a process's program. On Linux, this is the program that it has become
/// by `exec`, even if the file was replaced since.
fn running(process: u32, program: &str) -> (String, PathBuf) {
    let link = PathBuf::from(format!("/proc/{process}/exe"));
    if let Ok(target) = std::fs::read_link(&link) {
        let name = name(&target);
        return (name.strip_suffix(" (deleted)").unwrap_or(&name).to_string(), link);
    }
    let path = Path::new(program);
    let found = || {
        let folders = std::env::var_os("PATH")?;
        std::env::split_paths(&folders).map(|folder| folder.join(program)).find(|it| it.is_file())
    };
    let place = if path.components().count() > 1 { None } else { found() };
    (name(path), place.unwrap_or_else(|| path.to_path_buf()))
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

pub fn fingerprint(path: &Path) -> io::Result<String> {
    sha256_of(File::open(path)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_the_fingerprint_that_sha256sum_prints_until_it_changes() {
        let folder = tempfile::tempdir().unwrap();
        let mut origins = Origins::append(folder.path()).unwrap();
        let path = folder.path().join("a.py");
        let mut sum = |text: &str| {
            std::fs::write(&path, text).unwrap();
            origins.executed((name(&path), path.clone())).sha256.unwrap()
        };
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!([sum("abc"), sum("abc")], [abc; 2]);
        assert_ne!(sum("abcd"), abc);
        let gone = folder.path().join("gone");
        assert_eq!(origins.executed((name(&gone), gone)).sha256, None);
    }

    #[test]
    fn the_program_of_a_process_is_found() {
        let (name, path) = running(std::process::id(), "other");
        assert!(path.is_file(), "{name} {}", path.display());
        let (name, path) = running(u32::MAX, "sh");
        assert!(name == "sh" && path.is_file(), "{}", path.display());
        let missing = ("nothing-like-it".to_string(), PathBuf::from("./nothing-like-it"));
        assert_eq!(running(u32::MAX, "./nothing-like-it"), missing);
    }
}
