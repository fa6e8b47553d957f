"""Cases with open axes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np

from ..systems import OPEN, Random, System, inside, rotation, skewed
from .table import case

SLABS = [(True, True, False), (True, False, True), (False, True, True)]
WIRES = [(True, False, False), (False, True, False), (False, False, True)]


@case("slabs", quick=3)
def slabs(rng: Random, c: float) -> Iterator[System]:
    """One open axis: treated as periodic, or atoms beyond the cell are wrapped or lost."""
    for pbc in SLABS:
        s = inside(rng, 60, [3.2 * c, 2.7 * c, 3.6 * c], c, pbc)
        beyond = rng.uniform(-2 * c, 2 * c, (60, 3)) * ~np.array(pbc)
        yield replace(s, positions=s.positions + beyond)
    for pbc in SLABS:
        yield inside(rng, 30, skewed(rng, [1.4 * c, 1.2 * c, 1.7 * c], 0.5), c, pbc)


@case("wires", quick=3)
def wires(rng: Random, c: float) -> Iterator[System]:
    """Two open axes."""
    for pbc in WIRES:
        s = inside(rng, 40, [2.2 * c, 2.7 * c, 1.6 * c], c, pbc)
        beyond = rng.uniform(-2 * c, 2 * c, (40, 3)) * ~np.array(pbc)
        yield replace(s, positions=s.positions + beyond)
    for pbc in WIRES:
        yield inside(rng, 10, np.full(3, 0.6 * c), c, pbc)


@case("skewed slabs", quick=3)
def skewed_slabs(rng: Random, c: float) -> Iterator[System]:
    """Vectors of open axes that are not orthogonal to the rest (vesin 0.5.7)."""
    for pbc in (*SLABS, *WIRES):
        cell = skewed(rng, [2.3 * c, 2.8 * c, 2.5 * c], 1.2) @ rotation(rng)
        s = inside(rng, 40, cell, c, pbc)
        moves = rng.integers(-1, 2, (40, 3)) * 1.0 * np.array(pbc)
        yield replace(s, positions=s.positions + moves @ cell)


@case("short open axes")
def short_open(rng: Random, c: float) -> Iterator[System]:
    """The vector of an open axis is shorter than the cutoff, and atoms lie far beyond it."""
    for pbc, sides in ((SLABS[0], [3 * c, 3 * c, 0.2 * c]), (WIRES[1], [0.1 * c, 3 * c, 0.3 * c])):
        s = inside(rng, 50, [3 * c, 3 * c, 3 * c], c, pbc)
        yield replace(s, cell=np.diag(np.array(sides)))


@case("zero vectors of open axes", quick=3)
def zero_vectors(rng: Random, c: float) -> Iterator[System]:
    """Cells of molecules and slabs hold zeros, which make the cell singular."""
    for pbc in (OPEN, SLABS[0], SLABS[1], WIRES[2], WIRES[0]):
        s = inside(rng, 40, [2.4 * c, 3.1 * c, 2.2 * c], c, pbc)
        yield replace(s, cell=s.cell * np.array(pbc)[:, None], optional=True)


@case("no periodic axis", quick=3)
def open_space(rng: Random, c: float) -> Iterator[System]:
    """The cell has no meaning, and atoms lie anywhere."""
    for side, n in ((3.3, 70), (1.2, 20), (6.0, 120)):
        s = inside(rng, n, np.full(3, side * c), c, OPEN)
        yield replace(s, positions=s.positions - rng.uniform(0, 4 * c, 3))
    s = inside(rng, 50, np.full(3, 3 * c), c, OPEN)
    yield replace(
        s, cell=np.diag([0.5 * c, 0.5 * c, 0.5 * c]), note="a cell smaller than the atoms"
    )
    yield inside(rng, 50, skewed(rng, [3 * c, 2 * c, 3 * c], 1.5), c, OPEN)


@case("a line and a plane")
def flat_places(rng: Random, c: float) -> Iterator[System]:
    """All atoms in a plane or on a line: the bounding box has no volume."""
    for scale in ([1, 1, 0], [0, 0, 1], [0, 1, 0]):
        s = inside(rng, 40, np.full(3, 5 * c), c, OPEN)
        yield replace(s, positions=s.positions * np.array(scale) + c)


@case("every choice of axes", quick=1)
def every(rng: Random, c: float) -> Iterator[System]:
    """The flags of `pbc` are applied to the wrong axes."""
    for a, b, d in product((True, False), repeat=3):
        yield inside(rng, 45, skewed(rng, [2.1 * c, 1.4 * c, 3.2 * c], 0.4), c, (a, b, d))
