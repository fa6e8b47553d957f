//! `ro-crate-metadata.json`: describes a result folder to archives, as a Process Run Crate 0.5
//! (<https://w3id.org/ro/wfrun/process/0.5>), from the provenance of the run.

use std::collections::BTreeSet;
use std::path::Path;

use contactbench_record::record::folder::copies::sha256;
use serde_json::{Value, json};

pub const FILE: &str = "ro-crate-metadata.json";

const PROFILE: &str = "https://w3id.org/ro/wfrun/process/0.5";
const LICENCES: [(&str, &str); 2] = [
    ("https://spdx.org/licenses/MIT.html", "MIT License"),
    ("https://spdx.org/licenses/Apache-2.0.html", "Apache License 2.0"),
];

/// Finds the files in a folder and its folders, as paths below it, without hidden ones.
fn find(folder: &Path, below: &Path, found: &mut BTreeSet<String>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder.join(below))? {
        let entry = entry?;
        let (kind, path) = (entry.file_type()?, below.join(entry.file_name()));
        let hidden = entry.file_name().to_string_lossy().starts_with('.');
        if kind.is_dir() && !hidden {
            find(folder, &path, found)?;
        } else if kind.is_file() && !hidden {
            found.insert(path.to_string_lossy().replace('\\', "/"));
        }
    }
    Ok(())
}

fn kind(path: &str) -> &'static str {
    match path.rsplit('.').next().unwrap_or_default() {
        "csv" => "text/csv",
        "gz" => "application/gzip",
        "html" => "text/html",
        "json" => "application/json",
        "jsonl" => "application/jsonl",
        "md" => "text/markdown",
        "svg" => "image/svg+xml",
        _ => "text/plain",
    }
}

/// Encodes a path as a part of an address.
fn id(path: &str) -> String {
    let plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"/-._~".contains(byte);
    let encoded = |byte: u8| match plain(&byte) {
        true => char::from(byte).to_string(),
        false => format!("%{byte:02X}"),
    };
    path.bytes().map(encoded).collect()
}

/// Returns the text of the file for a folder with this title, question and provenance.
///
/// # Errors
/// A file or folder that cannot be read.
pub fn text(
    folder: &Path,
    title: &str,
    question: &str,
    provenance: &Value,
) -> std::io::Result<String> {
    let field = |name: &str| provenance.get(name).and_then(Value::as_str).unwrap_or_default();
    // The date is written as 2026-11-27T09-31-08.
    let (day, time) = field("date_utc").split_once('T').unwrap_or((field("date_utc"), "00-00-00"));
    let mut files = BTreeSet::new();
    find(folder, Path::new(""), &mut files)?;
    files.remove(FILE);
    let (inputs, results): (Vec<&String>, Vec<&String>) =
        files.iter().partition(|path| path.starts_with("experiments/"));
    let ids = |paths: &[&String]| -> Vec<Value> {
        paths.iter().map(|path| json!({"@id": id(path)})).collect()
    };
    let mut graph = vec![
        json!({"@id": FILE, "@type": "CreativeWork", "about": {"@id": "./"},
            "conformsTo": {"@id": "https://w3id.org/ro/crate/1.1"}}),
        json!({"@id": "./", "@type": "Dataset", "name": title, "description": question,
            "datePublished": day, "license": LICENCES.map(|(id, _)| json!({"@id": id})),
            "conformsTo": {"@id": PROFILE}, "mentions": {"@id": "#run"},
            "hasPart": ids(&Vec::from_iter(&files))}),
        json!({"@id": PROFILE, "@type": "CreativeWork", "name": "Process Run Crate",
            "version": "0.5"}),
        json!({"@id": "#authors", "@type": "Organization", "name": "The contactbench founders"}),
        json!({"@id": "#program", "@type": "SoftwareApplication", "name": "contactbench",
            "version": format!("{} ({})", field("contactbench"), field("revision")),
            "operatingSystem": field("os"), "processorRequirements": field("cpu"),
            "author": {"@id": "#authors"}}),
        json!({"@id": "#run", "@type": "CreateAction", "name": field("command"),
            "description": question, "instrument": {"@id": "#program"},
            "startTime": format!("{day}T{}+00:00", time.replace('-', ":")),
            "object": ids(&inputs), "result": ids(&results)}),
    ];
    graph.extend(
        LICENCES.map(|(id, name)| json!({"@id": id, "@type": "CreativeWork", "name": name})),
    );
    for path in &files {
        let bytes = std::fs::read(folder.join(path))?;
        graph.push(json!({"@id": id(path), "@type": "File", "name": path,
            "encodingFormat": kind(path), "contentSize": bytes.len().to_string(),
            "sha256": sha256(&bytes)}));
    }
    let context =
        ["https://w3id.org/ro/crate/1.1/context", "https://w3id.org/ro/terms/workflow-run/context"];
    let all = json!({"@context": context, "@graph": graph});
    Ok(serde_json::to_string_pretty(&all)? + "\n")
}
