//! Tests pages that play frames.

use serde_json::Value;

use super::browser::Browser;
use crate::common::Place;

const FLIGHT: &str = "loose:dim=2,n=200,fraction=0.5 --motion drift:speed=0.02 --frames 41 \
                      --tracker verlet(nbs,skin=0.1,rule=every-10)";

/// Runs a command; returns the page it wrote, the data in the page, and its output.
fn film(at: &Place, line: &str) -> (String, Value, String) {
    let said = at.good(&format!("draw {line} -o film.html")).stderr;
    let html = at.read("film.html");
    let data = html.split("<script type=\"application/json\" id=\"data\">").nth(1).unwrap();
    let data = serde_json::from_str(data.split("</script>").next().unwrap()).unwrap();
    (html, data, said)
}

fn numbers(text: &Value) -> Vec<u16> {
    let letter = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let text = text.as_str().unwrap().trim_end_matches('=');
    let bits = text.bytes().flat_map(|c| (0..6).rev().map(move |k| letter(c) >> k & 1));
    let bits: Vec<u8> = bits.collect();
    let byte = |bits: &[u8]| bits.iter().fold(0u8, |byte, bit| byte << 1 | bit);
    let bytes: Vec<u8> = bits.chunks_exact(8).map(byte).collect();
    bytes.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect()
}

fn count(value: &Value) -> usize {
    value.as_u64().unwrap() as usize
}

#[test]
fn a_film_has_its_frames_builds_and_missed_contacts() {
    let at = Place::new();
    let (html, data, said) = film(&at, FLIGHT);
    let track = at.json(&format!("track {FLIGHT}"));
    let frames = data["frames"].as_array().unwrap();
    assert_eq!((frames.len(), numbers(&data["radii"]).len()), (41, 200));
    let radii = numbers(&data["radii"]);
    let (mut contacts, mut missed, mut built) = (0, 0, Vec::new());
    for (k, frame) in frames.iter().enumerate() {
        let (circles, pairs) = (numbers(&frame[0]), numbers(&frame[1]));
        assert_eq!((circles.len(), pairs.len()), (2 * 200, 2 * count(&frame[3])), "frame {k}");
        assert_eq!(frame[2], frame[4], "all discs are there");
        // The gap of a pair is compared in this frame and in the frame of the last rebuild.
        let before = numbers(&frames[k / 10 * 10][0]);
        let gap = |circles: &[u16], pair: &[u16]| {
            let at = |place: u16, axis: usize| f64::from(circles[2 * usize::from(place) + axis]);
            let apart = |axis| at(pair[0], axis) - at(pair[1], axis);
            let reach = pair.iter().map(|&place| f64::from(radii[usize::from(place)]));
            apart(0).hypot(apart(1)) - reach.sum::<f64>()
        };
        let skin = 0.1 * 2.0 * f64::from(radii[0]);
        let reported = count(&frame[3]) - count(&frame[4]);
        for (place, pair) in pairs.chunks_exact(2).enumerate() {
            assert!(gap(&circles, pair) < 4.0, "frame {k}: {pair:?}");
            assert!(
                place < reported || gap(&before, pair) > skin - 4.0,
                "frame {k}: {pair:?} was listed"
            );
        }
        contacts += count(&frame[3]);
        missed += count(&frame[4]);
        built.extend((frame[5] == 1).then_some(k));
    }
    let tracker = &track["trackers"][0];
    assert_eq!(contacts, count(&track["contacts"]));
    assert_eq!((missed, built), (count(&tracker["missed"]), vec![0, 10, 20, 30, 40]));
    let first = count(&tracker["first_missed_frame"]);
    let words = format!("built in 5 of them and missed {missed} contacts since frame");
    assert!(missed > 10 && said.contains(&format!("{words} {first}.")), "{said}");
    // The timeline has a mark for each rebuild.
    assert!(html.contains("d=\"M0 0V10M10 0V10M20 0V10M30 0V10M40 0V10\""));
    // The first frame is visible without JavaScript.
    let discs = html.split("id=\"discs\" class=\"disc\" d=\"").nth(1).unwrap();
    assert_eq!(discs.split('"').next().unwrap().matches('M').count(), 200);
    assert!(html.contains("<noscript>") && html.len() < 5_000_000);
    for outside in ["http:", "https:", "src=", "href=", "url(", "@import", "fetch("] {
        assert!(!html.contains(outside), "{outside}");
    }
    assert!(!html.contains("{{"), "places were not filled");
}

/// Pages cut spheres by a plane, and play frames of files; safe trackers miss nothing.
#[test]
fn films_are_of_slices_and_files_too() {
    let at = Place::new();
    let spheres = "packed:dim=3,n=300 --motion vortex --frames 12 --slice z=2";
    let (html, data, said) = film(&at, spheres);
    for words in ["300 spheres, slice z = 2", "12 frames.", "missed no contact", "skin=auto"] {
        assert!(said.contains(words), "{said}");
    }
    assert!(data["slice"] == true && data["radii"].is_null() && html.contains("slice z = 2"));
    for frame in data["frames"].as_array().unwrap() {
        let circles = numbers(&frame[0]).len() / 3;
        assert!((10..300).contains(&circles) && count(&frame[3]) > 300, "{circles}");
        let most = numbers(&frame[1]).into_iter().max().map_or(0, usize::from);
        assert!(most < circles, "{most} of {circles}");
    }
    let head = "Properties=species:S:1:pos:R:2:radius:R:1";
    let frame = |x: f64| format!("2\n{head}\nA 0 0 0.5\nA {x} 0 0.5\n");
    at.file("<b>&.xyz", [1.5, 1.25, 1.0].map(frame).concat());
    let (html, data, _) = film(&at, "'<b>&.xyz'");
    let frames = data["frames"].as_array().unwrap().iter();
    assert_eq!(frames.map(|frame| count(&frame[3])).collect::<Vec<_>>(), [0, 0, 1]);
    assert!(html.contains("<title>&lt;b&gt;&amp;.xyz</title>") && !html.contains("<b>&"));
    let said = film(&at, "'<b>&.xyz' --frames 2").2;
    assert!(said.contains("2 frames.") && said.contains("(--frames)"), "{said}");
    // Two frames of a file whose radii differ.
    let frame = |r: f64| format!("2\n{head}\nA 0 0 {r}\nA 2 0 0.5\n");
    at.file("grow.xyz", [0.5, 1.5].map(frame).concat());
    let (_, data, _) = film(&at, "grow.xyz");
    let radii = |frame: usize| numbers(&data["frames"][frame][0])[2];
    assert!(radii(1) > 2 * radii(0) && count(&data["frames"][1][3]) == 1, "{data}");
}

/// The error about too large a page suggests a number of frames that nearly fills the limit.
#[test]
fn a_film_has_at_most_5_mb() {
    let at = Place::new();
    let line = "draw packed:n=3000 --motion rest --frames 1000 -o f.html";
    let said = at.ends(2, line, &["5 MB"]).stderr;
    assert!(!at.path("f.html").exists());
    let frames = said.split("take --frames ").nth(1).unwrap().split(',').next().unwrap();
    let size = film(&at, &format!("packed:n=3000 --motion rest --frames {frames}")).0.len();
    assert!((4_000_000..5_000_000).contains(&size), "{size}");
}

/// In a browser the page plays, steps and marks without errors in the console.
#[test]
fn a_film_plays_in_a_browser() {
    let Some(browser) = Browser::open(1200, 900) else { return };
    let at = Place::new();
    let (_, data, _) = film(&at, FLIGHT);
    browser.show(&at.path("film.html"));
    let text = |id: &str| browser.text(&format!("#{id}"));
    assert_eq!(text("step"), "frame 0 of 40");
    let paths = |id: &str| {
        let code = format!("return document.getElementById('{id}').getAttribute('d')");
        browser.get::<String>(&code).matches('M').count()
    };
    let worst = (0..41).max_by_key(|&k: &usize| count(&data["frames"][k][4])).unwrap();
    browser.run(&format!("show({worst})"));
    let frame = &data["frames"][worst];
    assert_eq!((paths("discs"), paths("missed")), (200, count(&frame[4])));
    assert_eq!(paths("contacts"), count(&frame[3]) - count(&frame[4]));
    assert!(text("words").contains(&format!("{} missed", frame[4])), "{}", text("words"));
    // The keys go to the last frame, the rebuild before it, one frame back, and the next miss.
    let first = (0..41).find(|&k| count(&data["frames"][k][4]) > 0).unwrap();
    for (key, step) in [
        ("End", 40),
        ("ArrowUp", 30),
        ("ArrowLeft", 29),
        ("ArrowDown", 30),
        ("Home", 0),
        ("m", first),
    ] {
        browser.run(&format!("dispatchEvent(new KeyboardEvent('keydown', {{ key: '{key}' }}))"));
        assert_eq!(text("step"), format!("frame {step} of 40"), "{key}");
    }
    browser.run("show(30)");
    browser.click("#play");
    let begun = std::time::Instant::now();
    while text("step") != "frame 40 of 40" && begun.elapsed().as_secs() < 20 {
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    assert_eq!((text("step"), text("play")), ("frame 40 of 40".into(), "Play".into()));
    assert!(browser.log().is_empty(), "{:?}", browser.log());
}
