//! `contactbench new-detector`: writes a working detector, and adds it to the table of detectors.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};

use crate::cli::shared::terminal;
use contactbench_detectors::table;

/// The detector that is written; tests compile and check it.
const TEMPLATE: &str = include_str!("template.rs");
const NAME: &str = "new-detector";
const TYPE: &str = "NewDetector";

const FOLDER: &str = "crates/detectors/src";

/// Maximum number of letters in a name, so that tables stay readable.
const LONGEST: usize = 32;

#[derive(clap::Args)]
pub struct NewDetector {
    /// Name in small letters, digits and '-', as in quad-tree
    name: String,
    /// Root of the checkout
    #[arg(long = "in", value_name = "FOLDER", default_value = ".")]
    root: PathBuf,
}

struct Names {
    /// Name in the table, as in `quad-tree`.
    name: String,
    /// Name of the module, as in `quad_tree`.
    module: String,
    /// Name of the type, as in `QuadTree`.
    kind: String,
}

/// What happens to a file, its path, and its new text.
type Change = (&'static str, PathBuf, String);

/// Writes the module of a new detector and its entries. Nothing is written unless all can be made.
pub fn new_detector(options: &NewDetector) -> anyhow::Result<()> {
    let names = names(&options.name)?;
    let mut out = terminal::out();
    // The module comes first. Without its entries it would stop a second try.
    let changes = changes(&options.root, &names)?;
    for (what, path, text) in &changes {
        if let Err(error) = terminal::save(path, text.as_bytes(), "--in") {
            let _ = std::fs::remove_file(&changes[0].1);
            return Err(error);
        }
        writeln!(out, "{what} {}", path.display())?;
    }
    let check = format!("cargo run -- check --detector {}", names.name);
    writeln!(out, "It sorts along x and works. Change it, then run:")?;
    for (command, meaning) in [
        (&*check, "is it right? In seconds"),
        ("cargo run --release -- recommend packed:n=100000", "how fast is it?"),
        ("cargo test", "all tests include it"),
    ] {
        writeln!(out, "  {command:<48} {meaning}")?;
    }
    Ok(())
}

fn names(given: &str) -> anyhow::Result<Names> {
    let name = given.replace('_', "-");
    let piece = |piece: &str| {
        !piece.is_empty() && piece.bytes().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
    };
    ensure!(
        name.split('-').all(piece) && name.starts_with(|c: char| c.is_ascii_lowercase()),
        "'{given}' cannot name a detector; begin with a small letter, and use small letters, \
         digits and single '-', as in quad-tree"
    );
    ensure!(name.len() <= LONGEST, "'{given}' has {} letters; use at most {LONGEST}", name.len());
    let module = name.replace('-', "_");
    ensure!(
        !RESERVED.split(' ').any(|word| word == name),
        "'{given}' is a word of Rust; choose another name"
    );
    ensure!(
        table::find(&name).is_none(),
        "the detector '{name}' exists already; choose another name"
    );
    let kind: String =
        name.split('-').map(|piece| piece[..1].to_uppercase() + &piece[1..]).collect();
    Ok(Names { name, module, kind })
}

/// Words that cannot name a module, or whose type the code of a detector uses.
const RESERVED: &str = "as async await box break const continue crate detector do dyn else \
    enum extern false fn for if impl in let loop match mod move mut option options particles \
    probe pub refusal ref return self sink static struct use vec";

fn changes(root: &Path, names: &Names) -> anyhow::Result<[Change; 3]> {
    let folder = root.join(FOLDER);
    let (modules, lines) = (folder.join("lib.rs"), folder.join("table/mod.rs"));
    for path in [&modules, &lines] {
        ensure!(
            path.is_file(),
            "{} is not a checkout of contactbench: there is no {}; give the checkout with --in",
            root.display(),
            path.strip_prefix(root).unwrap_or(path).display()
        );
    }
    let read = |path: &Path| {
        std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
    };
    let (module_text, table_text) = (read(&modules)?, read(&lines)?);
    let file = folder.join(format!("{}.rs", names.module));
    let taken = module_text.lines().any(|line| module(line) == Some(&names.module));
    ensure!(
        !taken && !file.exists() && !folder.join(&names.module).exists(),
        "the module {} exists already in {FOLDER}; choose another name",
        names.module
    );
    let quoted = format!("\"{}\"", names.name);
    ensure!(
        !table_text.contains(&quoted),
        "{} has a line {quoted} already; choose another name",
        lines.display()
    );
    let by_hand = |path: &Path, lines: &str| {
        lines.lines().for_each(terminal::say);
        let path = path.display();
        format!("{path} has an unexpected form; add the lines above to it, and the file by hand")
    };
    let module_line = format!("pub mod {};", names.module);
    let with_module = with_module(&module_text, &names.module)
        .with_context(|| by_hand(&modules, &module_line))?;
    let with_line =
        with_line(&table_text, &entry(names)).with_context(|| by_hand(&lines, &entry(names)))?;
    let detector = TEMPLATE.replace(NAME, &names.name).replace(TYPE, &names.kind);
    Ok([
        ("wrote  ", file, detector),
        ("changed", modules, with_module),
        ("changed", lines, with_line),
    ])
}

/// Returns NAME of a line `pub mod NAME;`.
fn module(line: &str) -> Option<&str> {
    line.strip_prefix("pub mod ")?.strip_suffix(';')
}

/// Inserts `pub mod` for the module into the text, in alphabetical order.
fn with_module(text: &str, name: &str) -> Option<String> {
    let (line, mut lines) = (format!("pub mod {name};"), Vec::from_iter(text.lines()));
    let last = lines.iter().rposition(|line| module(line).is_some())?;
    let next = lines.iter().position(|line| module(line).is_some_and(|other| other > name));
    lines.insert(next.unwrap_or(last + 1), &line);
    Some(lines.join("\n") + "\n")
}

/// Inserts the entry into the table, before the controls or else at the end.
fn with_line(text: &str, entry: &str) -> Option<String> {
    let begin = text.find("pub static TABLE: &[Entry] = &[\n")?;
    let end = begin + text[begin..].find("\n];\n")? + 1;
    let controls =
        text[begin..end].find("    Entry {\n        name: \"nothing\",\n").map(|at| begin + at);
    let at = controls.unwrap_or(end);
    Some(format!("{}{entry}{}", &text[..at], &text[at..]))
}

fn entry(Names { name, module, kind }: &Names) -> String {
    let kind = format!("super::{module}::{kind}");
    let mut constructor = format!("        constructor: Both::<{kind}, {kind}>::boxed,\n");
    // rustfmt would break a line of more than 100 columns.
    if constructor.len() > 101 {
        constructor = format!(
            "        constructor: Both::<\n            {kind},\n            {kind},\n        \
             >::boxed,\n"
        );
    }
    format!(
        "    Entry {{\n        name: \"{name}\",\n        group: Group::Modern,\n        summary: \
         \"new; its entry in the table describes it\",\n        cost: \"not stated\",\n        \
         memory: \"not stated\",\n        limits: \"the \
         memory limit\",\n{constructor}        ..PLAIN\n    }},\n"
    )
}
