//! What a file may not say, and where the error is.

use std::path::Path;

use crate::experiment::Experiment;

fn error(text: &str) -> String {
    let error =
        Experiment::parse(text, Path::new(".")).err().unwrap_or_else(|| panic!("accepted: {text}"));
    format!("{error:#}")
}

const HEAD: &str =
    "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\ndetectors = [\"nbs\"]\n";

fn refused(tail: &str, place: &str, words: &str) {
    let error = error(&format!("{HEAD}{tail}"));
    assert!(
        !error.contains('\n') && error.starts_with(place) && error.contains(words),
        "{tail:?}: {error}"
    );
}

#[test]
fn errors_are_one_line_with_a_place() {
    for (tail, place, words) in [
        ("blocks = ", "line 6, column 10", ""),
        ("blocks = 3 4\n", "line 6, column 10", ""),
        ("[[scene]\nname = 1\n", "line 6,", ""),
        ("block = 3\nscene = []\n", "line 6, column 1", "unknown field `block`"),
        ("blocks = \"three\"\nscene = []\n", "line 6, column 10", "expected u32"),
        ("title = \"u\"\nscene = []\n", "line 6, column 1", "duplicate key"),
        ("", "", "scene is missing: give a [[scene]]"),
        ("arithmetics = [\"exacd\"]\nscene = []\n", "line 6, column 16", "unknown variant"),
        ("threads = 0\nscene = []\n", "line 6, column 1", "threads = 0"),
        ("scene = 3\n", "line 6, column 9", "expected a sequence"),
        ("scene = [3]\n", "line 6, column 10", "expected struct SceneSweep"),
    ] {
        refused(tail, place, words);
    }
    refused("scene = []\nratios-to = \"sorting\"\n", "line 7, column 1", "must be one of");
    let text = HEAD.replace("\"nbs\"", "\"nsb\"") + "scene = []\n";
    assert!(error(&text).starts_with("line 5, column 1: there is no detector 'nsb'"));
}

#[test]
fn scenes_are_refused_with_their_line() {
    for (scene, place, words) in [
        ("n = [1, \"a\"]", "line 8, column 9", "invalid type: string \"a\", expected u64"),
        ("n = \"a\"", "line 8, column 5", "expected u64"),
        ("n = -1", "line 8, column 5", "expected u64"),
        ("n = 1979-05-27", "line 8, column 5", "expected a value or a list of values"),
        ("n = 5\norder = \"up\"", "line 9, column 9", "unknown variant `up`"),
        ("n = 5\nquick.n = \"x\"", "line 9, column 11", "expected u64"),
        ("n = 5\nquick = 3", "line 9, column 9", "expected struct Quick"),
        ("n = 5\nspcing = 1", "line 6: packed: there is no parameter 'spcing'", "size-ratio"),
        ("n = 5\nquick.jitter = -1", "line 6: packed: jitter is -1", "at least 0"),
        ("n = 5\nparams = 5", "line 6: packed: there is no parameter 'params'", ""),
        ("", "line 6: scene packed: n is missing", ""),
        ("n = [5, 5]", "line 6: scene packed stands there twice", ""),
    ] {
        refused(&format!("[[scene]]\nname = \"packed\"\n{scene}\n"), place, words);
    }
    refused("[[scene]]\nn = 5\n", "line 6: there is no scene ''", "");
}

#[test]
fn a_claim_takes_the_keys_of_its_kind() {
    for (claim, place, words) in [
        (
            "kind = \"at-most\"\nvalue = \"n\"\nto = \"1\"\nwithin = 0.1",
            "line 12, column 1",
            "a claim of kind at-most has no key 'within'; it takes value, \
             to, and like every claim name, kind, where, source",
        ),
        (
            "kind = \"constant\"\nvalue = \"n\"\nwithn = 1",
            "line 11, column 1",
            "has no key 'withn'; did you mean within?",
        ),
        ("kind = \"faster\"\nvalue = \"n\"", "line 10, column 1", "it takes than, and"),
        (
            "kind = \"constnt\"",
            "line 9, column 8",
            "no such kind of claim; the kinds are: constant, equal, at-most, model, faster",
        ),
        ("value = \"n\"", "line 7, column 1", "the claim has no kind; the kinds are: constant,"),
        ("kind = \"equal\"\nvalue = \"n\"", "line 9, column 8", "missing field `to`"),
        (
            "kind = \"equal\"\nvalue = \"n\"\nto = \"n / / 2\"",
            "line 11, column 6",
            "cannot read the expression 'n / / 2': at column 5,",
        ),
        (
            "kind = \"constant\"\nvalue = \"n\"\nwithin = -0.5",
            "line 11, column 10",
            "within is -0.5; it must be a finite number of at least 0",
        ),
        ("kind = \"constant\"\nvalue = \"n\"\nwithin = nan", "line 11, column 10", "finite"),
        (
            "kind = \"model\"\nvalue = \"n\"\nmodel = \"N^3\"",
            "line 11, column 9",
            "unknown model 'N^3'; the models are: N, N log N, N^2",
        ),
        (
            "kind = \"model\"\nvalue = \"time_ns\"\nmodel = \"N\"",
            "line 10, column 9",
            "fitted to counts or bytes",
        ),
    ] {
        refused(&format!("scene = []\n[[claim]]\nname = \"c\"\n{claim}\n"), place, words);
    }
}

#[test]
fn a_figure_takes_the_keys_of_its_kind() {
    const LINES: &str = "x = \"s\"\nx-label = \"s\"\ny = \"n\"\ny-label = \"n\"\n";
    for (figure, place, words) in [
        (
            "kind = \"speed-error\"\nx = \"n\"",
            "line 11, column 1",
            "a figure of kind speed-error has no key 'x'",
        ),
        (
            &format!("{LINES}against = \"given\""),
            "line 14, column 1",
            "a figure of kind lines has no key 'against'",
        ),
        ("kind = \"speed-error\"\nagainst = \"all\"", "line 11, column 11", "unknown variant"),
        ("kind = \"pie\"", "line 10, column 8", "the kinds are: lines, speed-error"),
        ("x = \"n\"", "line 7, column 1", "missing field `x-label`"),
        (&format!("{LINES}caches = true"), "line 7, column 1", "the figure f has caches = true"),
        (&format!("{LINES}slopes = true"), "line 7, column 1", "the figure f has slopes = true"),
        (&LINES.replace("\"n\"", "\"n +\""), "line 12, column 5", "at column 4"),
    ] {
        let head = "scene = []\n[[figure]]\nname = \"f\"\ntitle = \"F\"\n";
        refused(&format!("{head}{figure}\n"), place, words);
    }
}
