//! Errors of TOML files in one sentence with line and column.

use anyhow::anyhow;

/// The parser's words in one line, and where in `text` they belong.
pub(super) fn located(text: &str, error: &toml::de::Error) -> anyhow::Error {
    // A list of what was expected follows on lines of its own.
    let words = error.message().split('\n').map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join("; ");
    let words = if words.contains(" untagged enum ") { WRONG_TYPE.into() } else { words };
    let Some(before) = error.span().and_then(|span| text.get(..span.start)) else { return anyhow!("{words}; {FORM}") };
    let (line, column) = (before.matches('\n').count() + 1, before.rsplit('\n').next().unwrap_or_default().chars().count() + 1);
    anyhow!("line {line}, column {column}: {words}; {FORM}")
}

/// In place of what the parser says of a field that takes one value or a list of them.
const WRONG_TYPE: &str = "the value is of the wrong type, or a list of values of different types";
const FORM: &str = "the files in experiments/ show the form";

#[cfg(test)]
mod tests {
    use super::super::experiment::Experiment;

    fn error(text: &str) -> String {
        let error = Experiment::parse(text, std::path::Path::new(".")).err().unwrap_or_else(|| panic!("accepted: {text}"));
        format!("{error:#}")
    }

    #[test]
    fn errors_are_one_line_with_a_place() {
        let head = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\ndetectors = []\n";
        for (tail, place, words) in [
            ("blocks = ", "line 6, column 10", ""),
            ("blocks = 3 4\n", "line 6, column 10", ""),
            ("[[scene]\nname = 1\n", "line 6,", ""),
            ("block = 3\nscene = []\n", "line 6, column 1", "unknown field `block`"),
            ("blocks = \"three\"\nscene = []\n", "line 6, column 10", "expected u32"),
            ("title = \"u\"\nscene = []\n", "line 6, column 1", "duplicate key"),
            ("[[scene]]\nname = \"packed\"\nn = [1, \"a\"]\n", "line 8, column 5", "of the wrong type"),
            ("", "", "missing field `scene`"),
            ("arithmetics = [\"exacd\"]\nscene = []\n", "line 6, column 16", "unknown variant"),
        ] {
            let error = error(&format!("{head}{tail}"));
            assert!(!error.contains('\n') && error.contains(place) && error.contains(words), "{tail:?}: {error}");
        }
    }
}
