"""Cases that vary how the function is called: numbers of atoms, types, memory, repetition."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..systems import OPEN, Random, System, inside, skewed
from .table import case


@case("no atoms")
def empty(rng: Random, c: float) -> Iterator[System]:
    """An empty system is an empty list, not an error."""
    yield inside(rng, 0, np.full(3, 3 * c), c)
    yield inside(rng, 0, np.full(3, 3 * c), c, OPEN)


@case("numbers of atoms", quick=6)
def counts(rng: Random, c: float) -> Iterator[System]:
    """Blocks of 32, 64, 128 or 256 atoms: the last block is cut or read beyond its end."""
    for n in (2, 33, 64, 65, 129, 257, 3, 31, 32, 63, 127, 128, 255, 256):
        yield inside(rng, n, np.full(3, max(1.2, (n / 4) ** (1 / 3)) * c), c)


@case("many atoms", quick=1)
def many(rng: Random, c: float) -> Iterator[System]:
    """Lists change their algorithm above some number of atoms."""
    yield inside(rng, 1200, np.full(3, 7.1 * c), c)
    yield inside(rng, 2100, skewed(rng, [8 * c, 9 * c, 9.5 * c], 0.3), c)
    yield inside(rng, 2500, np.full(3, 9.3 * c), c, OPEN)


@case("float32 input")
def single(rng: Random, c: float) -> Iterator[System]:
    """Positions and cell as float32: read as if they were float64, or refused without reason."""
    for shear in (0.0, 0.5):
        s = inside(rng, 50, skewed(rng, [3.3 * c, 2.9 * c, 3.6 * c], shear), c)
        x, cell = (a.astype(np.float32).astype(np.float64) for a in (s.positions, s.cell))
        yield replace(s, positions=x, cell=cell, dtype="float32")


@case("memory layouts")
def layouts(rng: Random, c: float) -> Iterator[System]:
    """Strided and Fortran arrays are read as if they were contiguous."""
    s = inside(rng, 50, [3.3 * c, 2.9 * c, 3.6 * c], c)
    yield replace(s, memory="F")
    yield replace(s, memory="strided")


@case("ten calls", quick=1)
def repeated(rng: Random, c: float) -> Iterator[System]:
    """Answers that differ from call to call (sisl#633)."""
    yield replace(inside(rng, 60, skewed(rng, [3.3 * c] * 3, 0.3), c), calls=10)
    yield replace(inside(rng, 150, np.full(3, 3.3 * c), c, OPEN), calls=10)


@case("large after small", quick=5)
def alternating(rng: Random, c: float) -> Iterator[System]:
    """Buffers kept from the previous call are too small, or are not cleared."""
    small, large = inside(rng, 8, np.full(3, 2.5 * c), c), inside(rng, 220, np.full(3, 3.5 * c), c)
    other = inside(rng, 60, np.full(3, 1.5 * c), c, OPEN)
    yield from (small, large, small, other, large)


@case("capacity", quick=2)
def capacity(rng: Random, c: float) -> Iterator[System]:
    """One neighbour more than the capacity given: an error, not a cut list (nvalchemi-ops#1)."""
    from ..truth import half_list

    for n in (20, 40):
        s = inside(rng, n, np.full(3, 2.3 * c), c)
        rows = half_list(s)
        most = int(np.bincount(rows[:, :2].ravel(), minlength=n).max())
        yield replace(s, capacity=most, note="the capacity suffices")
        yield replace(s, capacity=most - 1, note="the capacity is exceeded by one")
