//! Very different radii.
//!
//! ```text
//!    .-------.  . . .
//!   /         \. . .      the largest body sets the cell: a cell holds all the dust;
//!   \         /. . .      a smaller cell needs a wider mask, or loses the giant's contacts
//!    '-------'  . . .
//! ```

use crate::scene::hard::build::*;
use crate::scene::hard::tangent::of_length;
use crate::scene::hard::{Case, Expect, Group};

const SIZES: Case = Case::in_group(Group::Sizes);

pub const CASES: &[Case] = &[
    Case {
        name: "giant-first-in-dust",
        reason: "one body 2^14 times larger than the others, and first: cells of its size are one \
                 crowd, cells of the dust's do not reach",
        source: "rapier#153",
        expect: Expect::Contacts([400, 343]),
        make: |dim| {
            let mut bodies = dust(dim);
            bodies.insert(0, ([0.1; 3], 1.0));
            each(dim, &bodies)
        },
        ..SIZES
    },
    Case {
        name: "giant-last-in-dust",
        reason: "as giant-first-in-dust, and last: lists that were sized by the bodies before it, \
                 loops that stop at N - 1",
        source: "rapier#153",
        expect: Expect::Contacts([400, 343]),
        make: |dim| {
            let mut bodies = dust(dim);
            bodies.push(([0.1; 3], 1.0));
            each(dim, &bodies)
        },
        ..SIZES
    },
    Case {
        name: "giant-and-far-dust",
        reason: "dust exactly in touch with a giant 10^4 times larger, all around: no centre is \
                 nearer than 10^4 cells of the dust's size",
        source: "rapier#153",
        expect: Expect::Contacts([36, 102]),
        make: |dim| {
            let (length, scale) = by_dim(dim, [(65, two_to(5)), (9, two_to(8))]);
            let r = 0.125;
            let giant = ([0.0; 3], f64::from(length) * scale - r);
            let near = of_length(dim, length).into_iter().map(|v| (v.map(|x| x * scale), r));
            // A second crown, at least one unit farther out: not in touch.
            let far = near
                .clone()
                .map(|(v, r)| (v.map(|x| if x == 0.0 { x } else { x + x.signum() }), r));
            each(dim, &near.chain(far).chain([giant]).collect::<Vec<_>>())
        },
        ..SIZES
    },
    Case {
        name: "point-beside-a-giant",
        reason: "radius 0 inside, exactly on, and one last bit outside a large body: a cell as \
                 large as the *mean* reach, or a test of both radii, fails",
        expect: Expect::Contacts([2 * 3, 3 * 3]),
        make: |dim| {
            let r: f64 = 1024.0;
            let points = [0.5 * r, r, r.next_up(), -r, (-r).next_down()];
            let around = lines(dim, &points, 0.0).into_iter().map(|place| (place, 0.0));
            each(dim, &around.chain([([0.0; 3], r)]).collect::<Vec<_>>())
        },
        ..SIZES
    },
    Case {
        name: "giants-across-dust",
        reason: "two giants exactly in touch, and 300 specks that make the mean radius small: \
                 only a filter that looks as far as the largest diameter finds the contact",
        expect: Expect::Contacts([1, 1]),
        make: |dim| {
            let mut bodies: Vec<(Place, f64)> =
                vec![([-300.0, 0.0, 0.0], 500.0), ([300.0, 800.0, 0.0], 500.0)];
            // Below both giants, apart from them.
            bodies.extend(
                (0..300).map(|k| ([f64::from(k % 20), f64::from(k / 20) - 700.0, 0.0], 0.25)),
            );
            each(dim, &bodies)
        },
        ..SIZES
    },
    Case {
        name: "every-size-in-a-chain",
        reason: "a chain of bodies exactly in touch, each half as large as the one before it: \
                 every ratio up to 2^13 occurs",
        expect: Expect::Contacts([13, 13]),
        make: |dim| {
            // Centres at 2 - 3·2^-k from radii 2^-k: the distances are 1.5·2^-k = 2^-k + 2^-(k+1).
            let bodies = (0..14).map(|k| ([2.0 - 3.0 * two_to(-k), 0.0, 0.0], two_to(-k)));
            each(dim, &bodies.collect::<Vec<_>>())
        },
        ..SIZES
    },
    Case {
        name: "two-scales",
        reason: "two touching lattices, one 64 times finer, side by side: the coarse one makes \
                 the fine one a crowd",
        expect: Expect::Contacts([2 * lattice_contacts(2, 12, 1), 2 * lattice_contacts(3, 6, 1)]),
        make: |dim| {
            let coarse = lattice(dim, by_dim(dim, [12, 6]), |k| 64.0 * k)
                .into_iter()
                .map(|place| (place, 32.0));
            let fine = lattice(dim, by_dim(dim, [12, 6]), |k| k - 100.0)
                .into_iter()
                .map(|place| (place, 0.5));
            each(dim, &coarse.chain(fine).collect::<Vec<_>>())
        },
        ..SIZES
    },
    Case {
        name: "one-inside-the-other",
        reason: "40 concentric bodies from 2^-20 to 2^19: surfaces do not meet, but bodies are \
                 solid and touch",
        expect: Expect::Contacts([pairs(40), pairs(40)]),
        make: |dim| {
            each(dim, &(-20..20).map(|k| ([0.5, -3.0, 7.0], two_to(k))).collect::<Vec<_>>())
        },
        ..SIZES
    },
    Case {
        name: "uniform-radii-one-by-one",
        reason: "a radius per body, all equal: what is computed once for one radius must not \
                 differ from what is computed for each",
        expect: of_lattice([12, 6], 1),
        make: |dim| {
            each(
                dim,
                &lattice(dim, by_dim(dim, [12, 6]), |k| k - 3.0)
                    .into_iter()
                    .map(|place| (place, 0.5))
                    .collect::<Vec<_>>(),
            )
        },
        ..SIZES
    },
];

/// 400 or 343 bodies of radius 2^-14 within about 1/2 of the origin, all apart.
fn dust(dim: u32) -> Vec<(Place, f64)> {
    lattice(dim, by_dim(dim, [20, 7]), |k| by_dim(dim, [0.03125, 0.0625]) * k - 0.2)
        .into_iter()
        .map(|place| (place, two_to(-14)))
        .collect()
}
