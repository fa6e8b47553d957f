//! Fuzzing of readers: any bytes are a particle file or a contact list.

use contactbench_ground::scene::Lattice;
use contactbench_io as io;
use contactbench_io::Given;
use contactbench_run::check::as_csv;

/// Returns the number that selects the reader `name` in [`fuzz_reader`].
pub fn reader(name: &str) -> Option<u8> {
    BESIDE
        .iter()
        .find(|(_, beside)| *beside == name)
        .map(|&(number, _)| number)
        .or_else(|| io::FORMATS.iter().position(|format| format.key == name).map(|k| k as u8))
}

const BESIDE: [(u8, &str); 2] = [(14, "gzip"), (15, "pairs")];

pub fn readers() -> impl Iterator<Item = String> {
    io::FORMATS
        .iter()
        .map(|format| format.key.to_string())
        .chain(BESIDE.map(|(_, name)| name.into()))
}

pub fn fuzz_reader_of(reader: u8, data: &[u8]) {
    let mut data = data.to_vec();
    if let Some(kind) = data.first_mut() {
        *kind = *kind & 0xf0 | reader & 15;
    }
    fuzz_reader(&data);
}

/// Reads the bytes as a particle file or contact list. The first byte chooses the format, the
/// second the options. Panics unless the result is a valid scene or an error of one line. A scene
/// must read back from its CSV, and its box must have a volume.
pub fn fuzz_reader(data: &[u8]) {
    let Some((&[kind, how], data)) = data.split_first_chunk() else { return };
    let frame = [
        io::FrameChoice::Only,
        io::FrameChoice::Last,
        io::FrameChoice::Number(1),
        io::FrameChoice::Number(0),
    ][usize::from(how >> 6)];
    let clear = |error: anyhow::Error| {
        let message = format!("{error:#}");
        assert!(
            message.chars().count() < 2000 && !message.contains(char::is_control),
            "not one clear line: {message:?}"
        );
    };
    let format = match usize::from(kind & 15) {
        15 => {
            let columns = [&[][..], &["i", "j"], &[], &["1", "2", "3", "4"]][usize::from(how) % 4];
            let one = io::pairs::lists_from(data, "bytes", columns, frame, |lists| lists.chosen());
            one.map_or_else(clear, drop);
            let all =
                io::pairs::lists_from(data, "bytes", columns, io::FrameChoice::All, |lists| {
                    lists.collect::<anyhow::Result<Vec<_>>>()
                });
            all.map_or_else(clear, drop);
            return;
        }
        k => io::FORMATS.get(k),
    };
    let options = io::Options {
        radius: [None, None, Some(0.5), Some(f64::NAN)][usize::from(how) % 4],
        dim: [None, None, Some(2), Some(3), None, Some(2), Some(3), Some(4)]
            [usize::from(how >> 2) % 8],
        ids: how & 32 != 0,
        frame,
        format,
        survey: kind & 16 != 0,
        columns: None,
        boundaries: io::Boundaries { open: kind & 32 != 0, ..io::Boundaries::AS_DECLARED },
        without: None,
        part: None,
    };
    let ending = ["", "csv", "xyz", "txt"][usize::from(kind >> 6)];
    let all = io::Options { frame: io::FrameChoice::All, ..options };
    let frames = io::frames_from(data, "bytes", ending, all, |frames| {
        frames.map(|frame| frame?.0.sort_by_id()).collect::<anyhow::Result<Vec<()>>>()
    });
    frames.map_or_else(clear, drop);
    let read = io::load_from(data, "bytes", ending, options)
        .and_then(|(particles, _)| particles.given("bytes", options.radius));
    let Given { scene, lattice, .. } = match read {
        Ok(given) => given,
        Err(error) => return clear(error),
    };
    let whole = |lattice: &Lattice| lattice.repeats() && (0..3).all(|k| lattice.height(k) > 0.0);
    assert!(lattice.as_ref().is_none_or(whole), "{lattice:?} is no box");
    // A file without particles cannot store the common radius.
    if !scene.is_empty() {
        let again =
            io::load_from(as_csv(&scene).as_bytes(), "again", "csv", io::Options::default());
        let again = again.and_then(|(particles, _)| particles.scene("again", None));
        assert!(again.as_ref().is_ok_and(|again| *again == scene), "{scene:?} became {again:?}");
    }
}
