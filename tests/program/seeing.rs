//! What people look at: drawings, traces, and what shells are told.

use std::path::Path;

use contactbench::contact::Arithmetic;
use contactbench::detect::{Options, table};
use contactbench::present::draw;
use contactbench::present::draw::{Highlighted, Look};
use contactbench::present::trace::{Algorithm, Trace, example, page, still, trace};
use contactbench::probe::Tally;
use contactbench::scene::spec::Spec;
use contactbench::scene::{AnyScene, Radii, Scene};
use contactbench::sink::normalise;

use crate::common::{file, program, run};

const ALL: [Algorithm; 4] =
    [Algorithm::Nbs, Algorithm::Sorting, Algorithm::Screening, Algorithm::BinaryTree];

fn scene(text: &str) -> AnyScene<'static> {
    Spec::parse(text).and_then(|spec| spec.make()).unwrap()
}

fn discs(centres: &[[f64; 2]], r: f64) -> AnyScene<'static> {
    Scene::new(
        centres.iter().copied().map(nalgebra::Point::from).collect::<Vec<_>>(),
        Radii::Uniform(r),
    )
    .unwrap()
    .into()
}

/// Counts and contacts of the counted build.
fn counted(name: &str, scene: &AnyScene<'_>) -> (Tally, Vec<[u32; 2]>) {
    let (mut tally, mut pairs) = (Tally::default(), Vec::new());
    let mut detector = table::find(name).unwrap().make(Options::default());
    detector.count(scene, Arithmetic::Exact.test(), &mut tally, &mut pairs).unwrap();
    (tally, pairs)
}

/// The trace is the counted build with another probe: the same operations, the same contacts in the
/// same order.
#[test]
fn a_trace_counts_and_finds_what_the_counted_build_does() {
    let scenes = [
        "packed:n=40",
        "loose:n=25,fraction=0.2",
        "clustered:n=30",
        "pack-a:n=36",
        "packed:n=1",
        "loose:n=30,size-ratio=3,offset=1e6",
    ];
    for algorithm in ALL {
        let book = example::example(algorithm).scene();
        let cases =
            scenes.iter().map(|text| (*text, Some(scene(text)))).chain([("the book's", None)]);
        for (name, given) in cases {
            let trace = trace(algorithm, given.as_ref())
                .unwrap_or_else(|error| panic!("{algorithm:?} {name}: {error:#}"));
            let (tally, pairs) = counted(algorithm.name(), given.as_ref().unwrap_or(&book));
            let last = trace.steps.last().unwrap();
            assert_eq!((last.tally, trace.tally), (tally, tally), "{algorithm:?} {name}");
            assert_eq!(trace.contacts, pairs, "{algorithm:?} {name}");
            assert_eq!(last.state.contacts, pairs, "{algorithm:?} {name}");
            // Counters never fall, and every step says something.
            for pair in trace.steps.array_windows::<2>() {
                assert!(pair[0].tally.iter().zip(pair[1].tally.iter()).all(|(a, b)| a.1 <= b.1));
            }
            assert!(
                trace.steps.iter().all(|step| step.words.ends_with('.')),
                "{algorithm:?} {name}"
            );
        }
    }
}

fn heads(trace: &Trace, step: usize, letter: char) -> Vec<i64> {
    let heads = trace.steps[step].state.heads_of(letter);
    let value = |list: i64| {
        usize::try_from(list)
            .ok()
            .and_then(|list| heads.get(list))
            .and_then(|head| head.first)
            .map_or(-1, |k| i64::from(k) + 1)
    };
    let shift = i64::from(trace.names.shift[usize::from(letter == 'B')]);
    (1..=10).map(|shown| value(shown - shift)).collect()
}

fn links(trace: &Trace, step: usize, letter: char) -> Vec<i64> {
    trace.steps[step]
        .state
        .links_of(letter)
        .iter()
        .map(|next| next.map_or(-1, |k| i64::from(k) + 1))
        .collect()
}

/// G5 of the book on the arrays that are shown (p103-110), and how many steps there are.
#[test]
fn the_books_ten_particles_are_shown_as_printed() {
    let trace = trace(Algorithm::Nbs, None).unwrap();
    assert_eq!(trace.steps.len(), 144);
    assert_eq!(heads(&trace, 10, 'B'), [-1, -1, -1, -1, 5, 9, 10, 2, -1, -1]);
    assert_eq!(links(&trace, 10, 'Y'), [-1, -1, -1, 1, -1, 3, 4, 6, 8, 7]);
    // The x-lists of row 7: before those of the row below are made, four pushes later.
    let row_7 = trace.steps.iter().position(|step| step.marks.written.contains(&('A', 1))).unwrap();
    let pushed = (row_7..)
        .find(|&step| trace.steps[step].marks.written.iter().any(|(letter, _)| *letter == 'a'))
        .unwrap()
        - 1;
    assert_eq!(heads(&trace, pushed, 'A'), [-1, -1, 7, 1, 4, -1, -1, -1, -1, -1]);
    assert_eq!(links(&trace, pushed, 'X'), [10, -1, -1, -1, -1, -1, -1, -1, -1, -1]);
    let last = trace.steps.len() - 1;
    for letter in ['A', 'a', 'B'] {
        assert_eq!(heads(&trace, last, letter), [-1; 10]);
        assert!(trace.steps[last].state.heads_of(letter).iter().all(|head| !head.old));
    }
}

/// While cells are checked, the list of every cell holds the particles of that cell, and those of
/// all cells are there.
#[test]
fn the_lists_that_are_shown_hold_the_particles_of_their_cells() {
    for (algorithm, link, letters) in
        [(Algorithm::Nbs, 'X', &['A', 'a'][..]), (Algorithm::Screening, 'E', &['C'])]
    {
        for given in [None, Some(scene("packed:n=40")), Some(scene("clustered:n=30"))] {
            let trace = trace(algorithm, given.as_ref()).unwrap();
            let (nx, mut seen) = (trace.cells.count[0], 0);
            for step in
                trace.steps.iter().filter(|step| trace.parts[step.part].ends_with("are checked"))
            {
                for &letter in letters {
                    for (list, head) in (0..).zip(step.state.heads_of(letter)) {
                        let cell = match letter {
                            'A' => [list, step.marks.row.unwrap()],
                            'a' => [list, step.marks.row.unwrap() - 1],
                            _ => [list % nx, list / nx],
                        };
                        let mut shown = step.state.chain(link, head.first);
                        shown.sort_unstable();
                        let there: Vec<u32> = (0..)
                            .zip(&trace.discs)
                            .filter(|(_, disc)| disc.cell == cell)
                            .map(|(k, _)| k)
                            .collect();
                        assert_eq!(shown, there, "{algorithm:?} {letter} {cell:?}: {}", step.words);
                        seen += there.len();
                    }
                }
            }
            assert!(seen > 0);
        }
    }
}

/// G2 (p90-91), G3 (p95-98) and the tree of the ten particles.
#[test]
fn the_other_examples_are_shown_as_printed() {
    let screening = trace(Algorithm::Screening, None).unwrap();
    assert_eq!(screening.steps.len(), 70);
    assert_eq!(links(&screening, 9, 'E'), [-1, 1, -1, 2, 3, -1, 5, -1, 7]);
    let (nx, c) = (screening.cells.count[0], screening.steps[9].state.heads_of('C'));
    let shown =
        |column: u32, row: u32| c[((row - 5) * nx + column - 1) as usize].first.map(|k| k + 1);
    assert_eq!(
        [shown(2, 7), shown(5, 6), shown(5, 7), shown(6, 6)],
        [Some(9), Some(6), Some(4), Some(8)]
    );
    assert_eq!(c.iter().filter(|head| head.first.is_some()).count(), 4);

    let sorting = trace(Algorithm::Sorting, None).unwrap();
    assert_eq!(sorting.steps.len(), 93);
    let last = &sorting.steps.last().unwrap().state;
    let keys = |axis: usize| {
        last.keys[axis]
            .iter()
            .map(|key| key.unwrap() + sorting.names.shift[axis])
            .collect::<Vec<_>>()
    };
    assert_eq!((keys(0), keys(1)), (vec![3, 4, 4, 4, 5, 5, 5, 6], vec![7, 5, 6, 7, 6, 7, 8, 6]));
    assert_eq!(last.particles.iter().map(|k| k + 1).collect::<Vec<_>>(), [7, 5, 3, 1, 6, 4, 2, 8]);
    let search = sorting
        .steps
        .iter()
        .find(|step| step.words.starts_with("Mask cell (5, 7): a binary search"))
        .unwrap();
    assert!(search.words.contains("particle 4 at place 6"), "{}", search.words);

    let tree = trace(Algorithm::BinaryTree, None).unwrap();
    assert_eq!(tree.steps.len(), 78);
    assert_eq!(links(&tree, 77, 'E'), [-1, -1, -1, -1, -1, -1, -1, -1, -1, 1]);
    let nodes = tree.tally.get(contactbench::probe::Op::NodeVisit);
    assert!(nodes > 10 * 8, "{nodes}");
}

/// No address of anything else, no name that becomes markup, and all data readable.
#[test]
fn a_page_needs_nothing_else_and_holds_any_name() {
    let name = "</script><script>alert(1)</script>&\"'@@DATA@@.csv";
    for algorithm in ALL {
        let trace = trace(algorithm, None).unwrap();
        let html = page::html(&trace, name);
        assert!(html.len() < 5_000_000);
        for outside in
            ["http:", "https:", "src=", "href=", "url(", "@import", "fetch(", "alert(1)</script>"]
        {
            assert!(!html.contains(outside), "{algorithm:?}: {outside}");
        }
        assert_eq!(html.matches("@@").count(), 4, "places were not filled, or a name was");
        assert!(html.contains(
            "&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;&quot;&#39;@@DATA@@.csv"
        ));
        assert_eq!(html.matches("</script>").count(), 2);
        let data = html
            .split("<script type=\"application/json\" id=\"data\">")
            .nth(1)
            .unwrap()
            .split("</script>")
            .next()
            .unwrap();
        let data: serde_json::Value = serde_json::from_str(data).unwrap();
        assert_eq!(data["steps"].as_array().unwrap().len(), trace.steps.len());
        let svg = still::Stills::new(&trace, name).svg(trace.steps.len() - 1).unwrap();
        assert!(svg.contains("&lt;/script&gt;") && !svg.contains("<script"));
        contactbench::present::svg::png(&svg).unwrap();
    }
}

/// The page in a browser: it shows the step of its address, and keys, buttons and the bar step.
/// Without Chromium nothing is tested.
#[test]
fn a_page_steps_in_a_browser() {
    let script = r#"<script>
        const seen = [$("step").textContent];
        const press = (key) => { dispatchEvent(new KeyboardEvent("keydown", { key })); seen.push(at); };
        ["ArrowRight", " ", "PageDown", "ArrowLeft", "ArrowUp", "ArrowDown", "End", "ArrowRight", "Home", "ArrowLeft"].forEach(press);
        $("next").click(); seen.push(at);
        $("bar").value = 20; $("bar").dispatchEvent(new Event("input")); seen.push(at, location.hash);
        seen.push($("counts").textContent, $("words").textContent, $("contacts").getAttribute("d").split("M").length - 1, $("arrays").textContent.length > 100);
        document.documentElement.dataset.seen = JSON.stringify(seen);
    </script>"#;
    let folder = tempfile::tempdir().unwrap();
    let trace = trace(Algorithm::Screening, None).unwrap();
    let html = page::html(&trace, "in a browser").replace("</body>", &format!("{script}</body>"));
    let page = file(folder.path(), "page.html", html);
    let mut command = std::process::Command::new("chromium");
    command.args([
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--virtual-time-budget=3000",
        "--dump-dom",
    ]);
    command
        .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
        .arg(format!("file://{}#45", page.display()));
    let Ok(output) = command.output() else { return };
    let dom = String::from_utf8_lossy(&output.stdout).into_owned();
    let seen = dom
        .split("data-seen=\"")
        .nth(1)
        .unwrap_or_else(|| panic!("{dom}"))
        .split('"')
        .next()
        .unwrap()
        .replace("&quot;", "\"");
    let seen: serde_json::Value = serde_json::from_str(&seen).unwrap();
    let parts = |step: usize| trace.steps[step].part;
    let begins = |part: usize| trace.steps.iter().position(|step| step.part == part).unwrap();
    let here = begins(parts(47));
    let expected = [46, 47, 48, 47, here, begins(parts(here) + 1), 69, 69, 0, 0, 1, 20];
    assert_eq!(seen[0], "step 45 of 69");
    assert_eq!(seen.as_array().unwrap()[1..13], expected.map(serde_json::Value::from));
    assert_eq!(seen[13], "#20");
    let tests = trace.steps[20].tally.get(contactbench::probe::Op::ContactTest);
    assert!(seen[14].as_str().unwrap().ends_with(&format!("contact test {tests}")), "{}", seen[14]);
    assert_eq!(seen[15], trace.steps[20].words);
    assert_eq!(
        (seen[16].as_u64(), seen[17].as_bool()),
        (Some(trace.steps[20].state.contacts.len() as u64), Some(true))
    );
}

#[test]
fn traces_refuse_what_they_cannot_show() {
    let far = discs(&[[0.0, 0.0], [500.0, 0.0]], 0.5);
    let crowd = discs(&[[0.0, 0.0]; 60], 0.5);
    for (scene, words) in [
        (scene("packed:dim=3,n=20"), "of spheres"),
        (scene("packed:n=61"), "61 particles; the steps of at most 60"),
        (scene("packed:n=0"), "no particles"),
        (far, "502 x 3 cells; at most 40"),
    ] {
        let error = trace(Algorithm::Nbs, Some(&scene)).unwrap_err();
        assert!(format!("{error:#}").contains(words), "{error:#}");
    }
    // Every pair is tested.
    for algorithm in ALL {
        let trace = trace(algorithm, Some(&crowd)).unwrap();
        assert_eq!(trace.contacts.len(), 1770);
        assert!(page::html(&trace, "crowd").len() < 5_000_000);
    }
}

#[test]
fn a_drawing_shows_scene_contacts_and_mistakes() {
    let scene = discs(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0000001, 0.0], [9.0, 9.0]], 0.5);
    let of = |pairs: &Highlighted, look: &Look| draw::svg(&scene, pairs, look).unwrap();
    let plain =
        of(&Highlighted::from_scene(&scene, 1 << 30).unwrap(), &Look::titled("a < b & \"c\""));
    assert_eq!(
        plain.matches("<circle").count(),
        5 + 3 + 2,
        "discs, tangent and nearly tangent marks, two of them in the legend"
    );
    assert!(
        plain.contains("contacts: 2")
            && plain.contains("exactly tangent: 2")
            && plain.contains("nearly tangent")
    );
    assert!(
        plain.contains("a &lt; b &amp; &quot;c&quot;")
            && !plain.contains("missed")
            && plain.contains(">4</text>")
    );
    let wrong = of(
        &Highlighted::compare(&scene, vec![[1, 2], [4, 0], [3, 3]], 1 << 30).unwrap(),
        &Look { labels: Some(false), grid: true, ..Look::default() },
    );
    assert!(
        wrong.contains("missed: touching, but not reported: 1")
            && wrong.contains("spurious: reported, but apart: 2")
    );
    assert!(!wrong.contains(">4</text>") && wrong.contains("cells of edge 1.0"));
}

/// In a crowd, and off the middle of a pack of spheres.
#[test]
fn the_worst_mistake_is_seen() {
    for (spec, place) in [("packed:n=5000", ""), ("packed:dim=3,n=1000", ", slice ")] {
        let scene = scene(spec);
        let all = Highlighted::from_scene(&scene, 1 << 30).unwrap().contacts;
        for k in [0, all.len() / 2, all.len() - 1] {
            let mut reported = all.clone();
            let [i, j] = reported.remove(k);
            let pairs = Highlighted::compare(&scene, reported, 1 << 30).unwrap();
            let svg = draw::svg(&scene, &pairs, &Look::titled("t")).unwrap();
            assert!(svg.contains("missed: touching, but not reported: 1<"), "{spec} {k}");
            let around = format!(", around {i} and {j}: the worst mistake");
            // Spheres of a slice are large enough to be seen as it is.
            assert!(svg.contains(place) && svg.contains(&around) == place.is_empty(), "{spec} {k}");
            let numbers = svg.contains(&format!(">{i}</text>"));
            assert!(numbers || !place.is_empty(), "{spec} {k}: few enough for numbers");
            on_the_sheet(&svg);
            let whole = Look { whole: true, ..Look::titled("t") };
            let svg = draw::svg(&scene, &pairs, &whole).unwrap();
            assert!(svg.contains("not reported: 1<") && !svg.contains("around"), "{spec} {k}");
        }
    }
}

#[test]
fn captions_are_whole() {
    let scene = discs(&[[0.0, 0.0], [0.0, 9.0]], 0.5);
    let words: Vec<String> = (0..60).map(|k| format!("word-{k}")).collect();
    let pairs = Highlighted::from_scene(&scene, 1 << 30).unwrap();
    let svg = draw::svg(&scene, &pairs, &Look::titled(words.join(" "))).unwrap();
    let texts = svg.split_once("</title>").unwrap().1;
    assert!(words.iter().all(|word| texts.contains(word.as_str())), "{texts}");
    on_the_sheet(&svg);
}

/// All lines end on the sheet.
fn on_the_sheet(svg: &str) {
    let side = |name: &str| {
        svg.split(&format!(" {name}=\""))
            .nth(1)
            .unwrap()
            .split('"')
            .next()
            .unwrap()
            .parse::<f64>()
            .unwrap()
    };
    let (width, height) = (side("width"), side("height"));
    for path in svg
        .split(" d=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap())
        .filter(|path| !path.contains(['A', 'h', 'H']))
    {
        for point in path.split(['M', 'L']).skip(1) {
            let (x, y) = point.split_once(' ').unwrap();
            let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
            assert!(
                (0.0..=width).contains(&x) && (0.0..=height).contains(&y),
                "{x} {y} on {width} x {height}"
            );
        }
    }
}

/// N = 0 and 1, points, points in one place, huge and tiny numbers, offsets that leave few bits: a
/// picture, and nothing in it that is no number.
#[test]
fn every_scene_can_be_drawn() {
    let hard: Vec<AnyScene<'static>> = [
        (vec![], 1.0),
        (vec![[3.0, 4.0]], 0.0),
        (vec![[3.0, 4.0], [3.0, 4.0]], 0.0),
        (vec![[1e15, 1e15], [1e15 + 1.0, 1e15]], 0.5),
        (vec![[f64::MAX, f64::MAX], [-f64::MAX, -f64::MAX]], f64::MAX),
        (vec![[0.0, 0.0], [1e-310, 0.0]], 5e-311),
        (vec![[0.0, 0.0], [1e300, 1.0]], 1.0),
        ((0..1000).map(|k| [f64::from(k), 0.0]).collect(), 0.5),
    ]
    .into_iter()
    .map(|(centres, r): (Vec<[f64; 2]>, f64)| discs(&centres, r))
    .chain(["packed:dim=3,n=300", "loose:dim=3,n=1", "packed:n=5000"].map(scene))
    .collect();
    for scene in &hard {
        for grid in [false, true] {
            let svg = draw::svg(
                scene,
                &Highlighted::from_scene(scene, 1 << 30).unwrap(),
                &Look { grid, ..Look::titled("hard") },
            )
            .unwrap();
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "N = {}", scene.len());
            on_the_sheet(&svg);
            if !grid {
                contactbench::present::svg::png(&svg).unwrap();
            }
        }
    }
    let many = scene("loose:n=200001");
    let error =
        draw::svg(&many, &Highlighted::default(), &Look::default()).unwrap_err().to_string();
    assert!(error.contains("200001 particles are too many"), "{error}");
}

#[test]
fn the_verbs_write_what_they_say() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    file(at, "a<b>.csv", "x,y,r\n0,0,0.5\n1,0,0.5\n5,5,0.5\n");
    file(at, "pairs.csv", "i,j\n0,2\n");
    let ended = run(at, &["draw", "a<b>.csv", "--pairs", "pairs.csv"]);
    assert_eq!((ended.code, &*ended.stdout), (Some(0), ""), "{}", ended.stderr);
    assert!(
        ended.stderr.contains("N = 3, 2D, 1 contacts, 1 missed, 1 spurious, 0 repeated; scene.svg"),
        "{}",
        ended.stderr
    );
    assert!(std::fs::read_to_string(at.join("scene.svg")).unwrap().contains("a&lt;b&gt;.csv"));
    assert_eq!(
        run(at, &["draw", "packed:dim=3,n=100", "--slice", "y=1", "-o", "s.png"]).code,
        Some(0)
    );
    assert!(std::fs::read(at.join("s.png")).unwrap().starts_with(b"\x89PNG"));
    let ended = run(at, &["trace", "nbs", "a<b>.csv", "-o", "t"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let files = std::fs::read_dir(at.join("t")).unwrap().count();
    let page = std::fs::read_to_string(at.join("t/nbs.html")).unwrap();
    assert!(
        page.contains("a&lt;b&gt;.csv") && page.contains(&format!("max=\"{}\"", files - 2)),
        "{files} files"
    );
    for (arguments, words) in [
        (&["draw", "packed:n=9", "--slice", "z=0"][..], "scene is of discs; leave out --slice"),
        (
            &["draw", "packed:n=9", "-o", "a.jpg"],
            "a.jpg: the ending of a picture must be .svg or .png",
        ),
        (&["draw", "packed:dim=3,n=9", "--slice", "w=0"], "it must be x, y or z"),
        (&["draw", "none.csv"], "cannot read none.csv"),
        (&["draw"], "name a particle file, or a scene such as"),
        (
            &["draw", "packed:n=2", "--pairs", "pairs.csv"],
            "the pair 0,2: the scene has 2 particles",
        ),
        (
            &["draw", "packed:n=2", "-o", "nowhere/a.svg"],
            "cannot write nowhere/a.svg; choose another place",
        ),
        (
            &["draw", "packed:n=2", "--radius", "1"],
            "--radius, --dim, --frame, --columns and --format belong to files",
        ),
        (&["trace", "nbs", "packed:n=100"], "100 particles; the steps of at most 60"),
        (&["trace", "nbs", "-o", "a<b>.csv/t"], "cannot write to a<b>.csv/t"),
        (&["trace", "kd-tree"], "nbs"),
    ] {
        let ended = run(at, arguments);
        assert_eq!(ended.code, Some(2), "{arguments:?}: {}", ended.stderr);
        assert!(ended.stderr.contains(words), "{arguments:?}: {}", ended.stderr);
    }
}

const VERBS: [&str; 9] =
    ["run", "report", "list", "check", "detect", "draw", "trace", "completions", "runner"];

#[test]
fn shells_know_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let ended = run(folder.path(), &["completions", shell]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        for verb in VERBS {
            assert!(ended.stdout.contains(verb), "{shell}: {verb}");
        }
        assert!(ended.stdout.contains("slice"), "{shell}");
    }
}

/// Pipes and files get no colours, and with NO_COLOR nobody does.
#[test]
fn colours_are_for_terminals() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["--help"][..],
        &["detect", "--help"],
        &["dtect"],
        &["detect", "none.csv"],
        &["list", "detectors"],
    ] {
        for no_color in [None, Some("1")] {
            let mut command = program(folder.path(), arguments);
            command.env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE");
            if let Some(value) = no_color {
                command.env("NO_COLOR", value);
            }
            let output = command.output().unwrap();
            let escapes = |bytes: &[u8]| bytes.contains(&0x1b);
            assert!(!escapes(&output.stdout) && !escapes(&output.stderr), "{arguments:?}");
        }
    }
}

/// On a terminal, which `script` of util-linux makes, help has styles, and with NO_COLOR it has
/// none. Without `script` nothing is tested.
#[test]
fn no_color_is_honoured_on_terminals() {
    let folder = tempfile::tempdir().unwrap();
    let on_terminal = |no_color: Option<&str>| {
        let mut command = std::process::Command::new("script");
        command
            .args(["-qec", &format!("{} dtect", crate::common::PROGRAM), "/dev/null"])
            .env("TERM", "xterm-256color");
        command
            .env_remove("NO_COLOR")
            .env_remove("CLICOLOR")
            .env_remove("CI")
            .current_dir(folder.path())
            .stdin(std::process::Stdio::null());
        if let Some(value) = no_color {
            command.env("NO_COLOR", value);
        }
        command.output().ok().map(|output| output.stdout)
    };
    let (Some(plain), Some(styled)) = (on_terminal(Some("1")), on_terminal(None)) else { return };
    assert!(String::from_utf8_lossy(&plain).contains("dtect"), "script ran the program");
    assert!(!plain.contains(&0x1b), "{}", String::from_utf8_lossy(&plain));
    assert!(
        styled.contains(&0x1b),
        "this test must be able to see a style: {}",
        String::from_utf8_lossy(&styled)
    );
}

/// The citation is of this version.
#[test]
fn the_citation_is_of_this_version() {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("CITATION.cff"))
        .unwrap();
    let value = |key: &str| {
        text.lines()
            .find_map(|line| line.strip_prefix(&format!("{key}: ")))
            .map(|value| value.trim_matches('"'))
    };
    assert_eq!(value("cff-version"), Some("1.2.0"));
    assert_eq!(value("version"), Some(env!("CARGO_PKG_VERSION")));
    assert_eq!(value("title"), Some("contactbench"));
    assert!(["message", "type", "abstract"].into_iter().all(|key| value(key).is_some()));
    assert!(text.contains("authors:\n  - name: \"The contactbench founders\"\n"));
}

/// `draw` finds contacts as every detector does.
#[test]
fn drawn_contacts_are_the_contacts() {
    for text in ["packed:n=500", "loose:dim=3,n=300", "clustered:n=200"] {
        let scene = scene(text);
        let (_, mut pairs) = counted("direct", &scene);
        normalise(&mut pairs);
        assert_eq!(draw::find(&scene, 1 << 30).unwrap(), pairs, "{text}");
    }
}
