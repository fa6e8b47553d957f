use super::testing::*;
use super::variable::*;
use super::*;
use crate::cells::testing::Lab;

fn said(map: &Map) -> Vec<([usize; 2], String, Answer)> {
    let spots = map.panels.iter().flat_map(|panel| &panel.spots);
    spots.map(|spot| (spot.at, spot.front().join(" or "), spot.answer())).collect()
}

#[test]
fn every_place_has_the_answer_of_its_contest() {
    let found = made_up();
    let values = found.axes.each_ref().map(|axis| axis.values.join(" "));
    assert_eq!(values, ["100 1000", "0.1 0.6"]);
    assert_eq!(found.subjects, ["nbs", "sorting"]);
    assert_eq!(
        said(&found),
        [
            ([0, 0], "nbs".into(), Answer::Decided(2)),
            ([1, 0], "sorting".into(), Answer::Decided(1)),
            ([0, 1], "nbs or sorting".into(), Answer::Undecided),
            ([1, 1], String::new(), Answer::Nobody),
        ]
    );
    let [panel] = &*found.panels else { panic!("{found:?}") };
    assert_eq!((&*panel.title, panel.spots[3].outcome), ("packed, 2D", Outcome::Timeout));
    let factor = panel.spots[1].factor().unwrap();
    assert!((factor.median - 1.25).abs() < 1e-9 && factor.count == 15, "{factor:?}");
    // A measured property of the scenes gives the same map, by either name.
    for name in ["packing_fraction", "density"] {
        let measured = map(&lab(), "n", name, "").unwrap();
        assert_eq!((said(&measured), measured.panels.len()), (said(&found), 1), "{name}");
        assert_eq!(measured.axes[1].values, ["0.1", "0.6"]);
    }
    let error = map(&lab(), "n", "dinsity", "").unwrap_err().to_string();
    assert!(error.contains("did you mean density?"), "{error}");
    let error = map(&lab(), "n", "fraction", "n = 1000, fraction = 0.6").unwrap_err().to_string();
    assert!(error.contains("no detector has a time"), "{error}");
    // The noise includes twins that the filter leaves out: 1.25 exceeds it, 1.04 does not.
    let named = map(&lab(), "n", "fraction", "detector = ['nbs', 'sorting']").unwrap();
    assert_eq!(said(&named), said(&found));
}

#[test]
fn who_has_no_such_axis_takes_part_at_each_of_its_values() {
    let mut lab = Lab::new("e", "packed");
    lab.param("motion", "drift");
    for speed in [0.01, 0.1] {
        lab.param("speed", speed).detector("every-step(nbs)").time(&[300; 15]);
        for (skin, time) in [(0.1, 100), (0.2, if speed > 0.05 { 500 } else { 200 })] {
            lab.detector(&format!("verlet(nbs,rule=top-two,skin={skin})")).time(&[time; 15]);
            lab.detector(&format!("verlet(bvh,rule=top-two,skin={skin})")).time(&[2 * time; 15]);
        }
    }
    let found = map(&lab, "speed", "skin", "").unwrap();
    assert_eq!(found.subjects, ["every-step(nbs)", "verlet(nbs)"]);
    let fronts: Vec<String> = said(&found).into_iter().map(|it| it.1).collect();
    assert_eq!(fronts, ["verlet(nbs)", "verlet(nbs)", "verlet(nbs)", "every-step(nbs)"]);
    let spot = &found.panels[0].spots[3];
    let next = &spot.contest.as_ref().unwrap().others[0];
    assert_eq!(next.line.detector, "verlet(nbs,rule=top-two,skin=0.2)");
    let mut lab = Lab::new("e", "packed");
    for n in [100, 1000] {
        lab.n(n).threads(1).detector("nbs").time(&[150; 15]);
        lab.detector("cell-grid").time(&[200; 15]).threads(2).time(&[100; 15]);
    }
    let fronts: Vec<String> =
        said(&map(&lab, "n", "threads", "").unwrap()).into_iter().map(|it| it.1).collect();
    assert_eq!(fronts, ["nbs", "nbs", "cell-grid", "cell-grid"]);
}

#[test]
fn what_else_varies_makes_panels_until_there_are_too_many() {
    let mut lab = Lab::new("e", "packed");
    for k in 0..13 {
        for n in [100, 1000] {
            lab.n(n).param("fraction", 0.1).param("kind", format!("order-{k}")).detector("nbs");
            lab.time(&[100; 5]).detector("sorting").time(&[200; 5]);
            lab.seed(2).time(&[50; 5]).seed(1);
        }
        let found = map(&lab, "n", "fraction", "");
        // An axis with one value is not named.
        let title = if k == 0 { "packed, 2D" } else { "packed, 2D, kind = order-0" };
        if k < 12 {
            let found = found.unwrap();
            assert_eq!((found.panels.len(), &*found.panels[0].title), (k + 1, title));
            assert!(said(&found).iter().all(|it| it.1 == "nbs"));
        } else {
            let error = found.unwrap_err().to_string();
            let some = "13 panels, and at most 12 are drawn; they differ in kind (order-0, \
                        order-1, order-10, order-11, ...)";
            assert!(error.contains(some) && error.ends_with("--where kind=order-0"), "{error}");
        }
    }
    assert_eq!(map(&lab, "n", "fraction", "kind = 'order-3'").unwrap().panels.len(), 1);
}

#[test]
fn measured_numbers_near_each_other_share_a_place() {
    assert_eq!(classes(&[1.0, 1.05, 1.09, 1.2, 5.0]), [(1.0, 1.09), (1.2, 1.2), (5.0, 5.0)]);
    let many: Vec<f64> = (0..100).map(|k| 1.15_f64.powi(k)).collect();
    assert!((2..=MOST_VALUES).contains(&classes(&many).len()));
    assert_eq!(classes(&[0.0, 0.0, 1.0]).len(), 2);
    assert_eq!([shown((0.518, 0.561)), shown((6.02, 6.04))], ["0.52 to 0.56", "6"]);
}
