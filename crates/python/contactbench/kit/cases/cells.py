"""Cases that vary the shape and the size of the cell."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..systems import PERIODIC, Random, System, inside, rotation, skewed, system
from .table import case


@case("left-handed cells")
def left_handed(rng: Random, c: float) -> Iterator[System]:
    """The volume is negative, and with it heights and numbers of cells (fairchem#2134)."""
    cell = skewed(rng, [3.3 * c, 4.2 * c, 2.7 * c], 0.4)
    yield inside(rng, 60, cell[[1, 0, 2]], c)
    yield inside(rng, 60, cell * np.array([[1], [1], [-1]]), c)
    yield inside(rng, 40, -cell, c)


@case("negative lengths")
def negative_lengths(rng: Random, c: float) -> Iterator[System]:
    """Vectors along negative axes: the diagonal is taken for lengths."""
    yield inside(rng, 60, [-3.3 * c, 3.1 * c, -4.2 * c], c)
    yield inside(rng, 60, [3.3 * c, 3.1 * c, -2.2 * c], c, (True, False, True))


@case("rotated cells")
def rotated(rng: Random, c: float) -> Iterator[System]:
    """No vector lies along an axis: only triangular cells are handled (vesin 0.5.8)."""
    for k in range(3):
        cell = skewed(rng, [3.3 * c, 2.4 * c, 3.9 * c], 0.3) @ rotation(rng)
        yield inside(rng, 60, cell, c, (True, True, k != 2))


@case("turned axes")
def turned_axes(rng: Random, c: float) -> Iterator[System]:
    """The vectors are permuted axes, so that the diagonal is zero."""
    yield inside(rng, 60, np.diag([3.3 * c, 2.4 * c, 4.5 * c])[[1, 2, 0]], c)
    yield inside(rng, 60, np.diag([3.3 * c, 2.4 * c, 4.5 * c])[[2, 1, 0]], c)


@case("skewed cells", quick=3)
def skewed_cells(rng: Random, c: float) -> Iterator[System]:
    """Heights are less than lengths, so more images are near (LAMMPS#3846)."""
    for shear in (0.5, 1.0, 2.5):
        yield inside(rng, 60, skewed(rng, [2.6 * c, 2.4 * c, 2.2 * c], shear), c)
        yield inside(rng, 50, skewed(rng, [3.6 * c, 3.4 * c, 4.2 * c], shear).T.copy(), c)


@case("hexagonal cells")
def hexagonal(rng: Random, c: float) -> Iterator[System]:
    """Angles of 60 and 120 degrees: the height is 0.87 of the length."""
    for cosine in (0.5, -0.5):
        a = 2.2 * c
        cell = [[a, 0, 0], [cosine * a, np.sqrt(0.75) * a, 0], [0, 0, 2.9 * c]]
        yield inside(rng, 50, cell, c)


@case("flat cells", quick=3)
def flat(rng: Random, c: float) -> Iterator[System]:
    """One height below the cutoff: images undercounted (kUPS#127: 56 of 64; sisl#1016)."""
    for axis in range(3):
        sides = np.full(3, 3.2 * c)
        sides[axis] = 0.45 * c
        yield inside(rng, 16, sides, c)
    yield inside(rng, 12, skewed(rng, [3.2 * c, 2.1 * c, 0.4 * c], 0.8), c)
    cell = np.array([[3.0, 0.0, 0.0], [2.8, 0.7, 0.0], [0.3, 0.4, 2.9]]) * c
    yield inside(rng, 14, cell, c, note="long vectors, small heights")


@case("needles")
def needles(rng: Random, c: float) -> Iterator[System]:
    """Two heights below the cutoff, the third far beyond."""
    yield inside(rng, 14, [0.6 * c, 0.5 * c, 9 * c], c)
    yield inside(rng, 10, skewed(rng, [7 * c, 0.6 * c, 0.5 * c], 0.3), c)


@case("cutoff beyond the cell", quick=3)
def small(rng: Random, c: float) -> Iterator[System]:
    """Many images of each pair: only the nearest, or the first shell, is listed."""
    for k, n in ((0.9, 6), (0.55, 3), (0.4, 2), (0.3, 1)):
        yield inside(rng, n, np.full(3, k * c), c)
    yield inside(rng, 4, skewed(rng, [0.7 * c, 0.8 * c, 0.6 * c], 0.6), c)
    s = inside(rng, 3, np.full(3, 0.6 * c), c)
    yield replace(s, positions=s.positions + [[1.2 * c, 0, 0], [0, -3 * c, 0], [0, 0, 0]])


@case("half the cell", quick=3)
def half(rng: Random, c: float) -> Iterator[System]:
    """Cutoff just above half the cell: two images of a pair are near, one is listed."""
    for k in (1.99, 1.9, 1.5, 2.01):
        yield inside(rng, 30, np.full(3, k * c), c)


def beside(k: int, c: float, towards: float) -> float:
    """Return a number next to k cutoffs; for k = 1 with room between own images and cutoff."""
    return c + np.sign(towards) * 1e-6 * c if k == 1 else float(np.nextafter(k * c, towards))


@case("heights at k cutoffs", quick=12)
def heights(rng: Random, c: float) -> Iterator[System]:
    """Heights of k cutoffs, less or more an ulp: the number of cells is rounded up."""
    for k in (1, 2, 3, 4):
        for step in (-np.inf, 0.0, np.inf):
            side = k * c if step == 0 else beside(k, c, step)
            yield inside(rng, 24 * k, np.full(3, side), c, note=f"{k} cutoffs")
    for k in (1, 2, 3, 4):
        for axis in range(3):
            sides = np.full(3, 3.4 * c)
            sides[axis] = beside(k, c, -np.inf)
            yield inside(rng, 40, sides, c, note=f"{k} cutoffs along axis {axis}")


@case("sweep of sizes", quick=9)
def sizes(rng: Random, c: float) -> Iterator[System]:
    """Pairs are listed twice if the box has two or three cells (GPUMD#1370: 2.5 (rc + 1))."""
    for side in (1.01, 1.5, 2.01, 2.4, 2.99, 3.01, 3.5, 4.01, 5.01, 1.25, 2.2, 2.6, 3.2, 6.01):
        yield inside(rng, 50, np.full(3, side * c), c, note=f"{side} cutoffs")


@case("unequal sizes")
def unequal(rng: Random, c: float) -> Iterator[System]:
    """Axes are mixed up in the index of a cell."""
    for sides in ((2.2, 4.4, 7.3), (8.1, 1.2, 3.3), (3.1, 9.2, 0.8)):
        yield inside(rng, 80, np.array(sides) * c, c, PERIODIC)


@case("one atom")
def one(rng: Random, c: float) -> Iterator[System]:
    """An atom is its own neighbour through images, and not otherwise."""
    yield system([[0.1 * c, 0.2 * c, 0.3 * c]], np.full(3, 0.8 * c), c)
    yield system([[-7 * c, 0, 0]], [3 * c, 4 * c, 5 * c], c)
    yield system([[0, 0, 0]], skewed(rng, [0.9 * c, 1.2 * c, 0.7 * c], 0.5), c)
    yield system([[c, c, c]], np.full(3, 0.5 * c), c, (False, False, False))
