fn main() {
    use contactbench::{detect::*, scene::*, sink::*};
    use nalgebra::Point;
    let n: usize = std::env::args().filter_map(|a| a.parse().ok()).next().unwrap_or(1_000_000);
    // fcc
    let m = ((n as f64 / 4.0).cbrt().ceil()) as usize;
    let a = 2f64.sqrt() * 0.99;
    let mut pts = vec![];
    let mut s = 1u64;
    let mut rnd = || {
        s = s.wrapping_add(1);
        (splitmix64(s) >> 11) as f64 / (1u64 << 53) as f64
    };
    for z in 0..m {
        for y in 0..m {
            for x in 0..m {
                for o in [[0., 0., 0.], [0.5, 0.5, 0.], [0.5, 0., 0.5], [0., 0.5, 0.5]] {
                    if pts.len() < n {
                        pts.push(Point::from([
                            (x as f64 + o[0]) * a + 0.1 * (rnd() - 0.5),
                            (y as f64 + o[1]) * a + 0.1 * (rnd() - 0.5),
                            (z as f64 + o[2]) * a + 0.1 * (rnd() - 0.5),
                        ]))
                    }
                }
            }
        }
    }
    for i in (1..pts.len()).rev() {
        let j = (rnd() * (i + 1) as f64) as usize;
        pts.swap(i, j);
    }
    let scene = AnyScene::from(Scene::<f64, 3>::new(pts, Radii::Uniform(0.5)).unwrap());
    for name in ["screening", "nbs", "sorting", "binary-tree"] {
        let mut d = table::find(name).unwrap().make(Options::default());
        let mut v = vec![];
        for exact in [true, false] {
            let mut best = f64::MAX;
            for _ in 0..4 {
                v.clear();
                let t = std::time::Instant::now();
                d.list(&scene, exact, &mut v).unwrap();
                best = best.min(t.elapsed().as_nanos() as f64 / n as f64);
            }
            println!("{name} exact={exact} {best:.0} ns/particle {} {:?}", v.len(), Digest::of(&v).hex());
        }
    }
}
