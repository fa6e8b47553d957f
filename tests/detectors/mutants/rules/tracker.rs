//! A tracker that is small, plain and right, and can be made wrong in one way at a time.

use contactbench::contact::exact::compare;

use super::{Frame, Rule, Way};

/// The reference.
pub struct Tracker<const D: usize> {
    way: Way,
    rule: Rule,
    /// In diameters.
    skin: f64,
    list: Option<List<D>>,
}

struct List<const D: usize> {
    pairs: Vec<[usize; 2]>,
    /// Half of the skin.
    half: f64,
    radii: Vec<f64>,
    then: Vec<[f64; D]>,
    last: Vec<[f64; D]>,
    summed: f64,
    /// In the frame before.
    was_due: bool,
}

/// The sum of two numbers as computed, and what the true one has beyond it (Møller, Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

fn up(a: f64, b: f64) -> f64 {
    let (sum, rest) = two_sum(a, b);
    if rest > 0.0 { sum.next_up() } else { sum }
}

fn down(a: f64, b: f64) -> f64 {
    let (sum, rest) = two_sum(a, b);
    if rest < 0.0 { sum.next_down() } else { sum }
}

fn root<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>().sqrt()
}

/// The least double that is no less than the distance.
fn least<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let most = (0..D).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max);
    if most == 0.0 {
        return 0.0;
    }
    let part = |k: usize| (a[k] - b[k]) / most;
    let mut way = most * (0..D).map(|k| part(k) * part(k)).sum::<f64>().sqrt();
    while compare(a, b, way, 0.0).is_gt() {
        way = way.next_up();
    }
    while compare(a, b, way.next_down(), 0.0).is_le() {
        way = way.next_down();
    }
    way
}

impl<const D: usize> Tracker<D> {
    pub fn new(way: Way, rule: Rule, skin: f64) -> Tracker<D> {
        Tracker { way, rule, skin, list: None }
    }

    pub fn step(&mut self, frame: &Frame<D>) -> Vec<[u32; 2]> {
        let due = self.is_due(frame);
        let build = match &mut self.list {
            Some(list) if self.way == Way::OneStepLate => std::mem::replace(&mut list.was_due, due),
            _ => due,
        };
        if build {
            self.build(frame);
        }
        let (n, pairs) = (frame.centres.len(), self.list.iter().flat_map(|list| &list.pairs));
        let touch = |&&[i, j]: &&[usize; 2]| {
            let [p, q] = [i, j].map(|k| &frame.centres[k]);
            compare(p, q, frame.radii[i], frame.radii[j]).is_le()
        };
        let there = pairs.filter(|pair| pair.iter().all(|&k| k < n));
        there.filter(touch).map(|pair| pair.map(|k| k as u32)).collect()
    }

    fn is_due(&mut self, frame: &Frame<D>) -> bool {
        let Some(list) = &mut self.list else { return true };
        let (way, rule) = (self.way, self.rule);
        let grown = list.radii.iter().zip(&frame.radii).any(|(before, now)| before != now);
        if way != Way::NumberKept && list.then.len() != frame.centres.len()
            || way != Way::RadiiKept && grown
        {
            return true;
        }
        let bound = |a: &[f64; D], b: &[f64; D]| match way {
            Way::AlongX => least(&[a[0]], &[b[0]]),
            Way::LargestAxis => (0..D).map(|k| least(&[a[k]], &[b[k]])).fold(0.0, f64::max),
            Way::Nearest => root(a, b),
            Way::PartOfItself => root(a, b) * (1.0 + 1e-15),
            _ => least(a, b),
        };
        let sum = |a: f64, b: f64| match way {
            Way::SumNearest => a + b,
            Way::SumDown => down(a, b),
            _ => up(a, b),
        };
        let top_two = |then: &[[f64; D]]| {
            let looked_at = then.len() - usize::from(way == Way::LastForgotten);
            let ways = frame.centres.iter().zip(then).take(looked_at).map(|(a, b)| bound(a, b));
            let mut ways: Vec<f64> = ways.collect();
            ways.sort_by(|a, b| b.total_cmp(a));
            if way == Way::Mean && !ways.is_empty() {
                let mean = ways.iter().sum::<f64>() / ways.len() as f64;
                ways.fill(mean);
            }
            [0, 1].map(|k| ways.get(k).copied().unwrap_or(0.0))
        };
        let step = top_two(&list.last);
        list.last.clone_from(&frame.centres);
        list.summed = match way {
            Way::SinceLastFrame => step[0],
            _ => sum(list.summed, step[0]),
        };
        let [first, second] = match way {
            Way::SinceLastFrame => step,
            _ => top_two(&list.then),
        };
        let gone = match rule {
            Rule::TopTwo if way == Way::SecondForgotten => first,
            Rule::TopTwo => sum(first, second),
            Rule::HalfSkin => 2.0 * first,
            Rule::Summed => 2.0 * list.summed,
        };
        let skin = 2.0 * list.half;
        match way {
            Way::HalfCounted => 0.5 * gone > skin,
            Way::AtLimit => gone >= skin,
            Way::RestsWhereBuilt => gone > skin && first > 0.0,
            _ => gone > skin,
        }
    }

    fn build(&mut self, frame: &Frame<D>) {
        let way = self.way;
        let largest = frame.radii.iter().copied().fold(0.0, f64::max);
        let half = largest * self.skin;
        let larger = |r: f64| {
            let margin = match way {
                Way::OwnSkin => r * self.skin,
                Way::Thicker => 2.0 * half,
                _ => half,
            };
            match way {
                Way::RadiusNearest => r + margin,
                Way::RadiusDown => down(r, margin),
                _ => up(r, margin),
            }
        };
        let n = frame.centres.len();
        let mut pairs = Vec::new();
        for (i, j) in (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))) {
            let [p, q] = [i, j].map(|k| &frame.centres[k]);
            let [r, s] = [i, j].map(|k| frame.radii[k]);
            let apart = match way {
                Way::OneSkin => compare(p, q, larger(r), s),
                _ => compare(p, q, larger(r), larger(s)),
            };
            if apart.is_lt() || apart.is_eq() && way != Way::Strict {
                pairs.push([i, j]);
            }
        }
        let before = self.list.take();
        let (mut then, mut summed) = (frame.centres.clone(), 0.0);
        match (way, before) {
            (Way::SinceFirstList, Some(list)) if list.then.len() == n => then = list.then,
            (Way::PairsKept, Some(list)) => pairs = list.pairs,
            (Way::SumGoesOn, Some(list)) => summed = list.summed,
            _ => {}
        }
        let (radii, last) = (frame.radii.clone(), frame.centres.clone());
        self.list = Some(List { pairs, half, radii, then, last, summed, was_due: false });
    }
}
