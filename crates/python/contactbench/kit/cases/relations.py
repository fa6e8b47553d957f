"""Cases that move, copy or turn one system, so that the list must follow."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..systems import Random, System, inside, skewed
from .table import case


def _base(rng: Random, c: float) -> System:
    return inside(rng, 40, skewed(rng, [3.3 * c, 2.4 * c, 2.8 * c], 0.5), c)


@case("moved by lattice vectors", quick=3)
def moved(rng: Random, c: float) -> Iterator[System]:
    """All atoms moved by lattice vectors (openmm#5382: 2,090 of 4,084 pairs missing)."""
    s = _base(rng, c)
    for k in ([0, 0, 0], [1, 0, -1], [-5, 3, 2], [0, 17, 0], [1000, -1000, 1]):
        yield replace(s, positions=s.positions + np.array(k) @ s.cell, note=f"moved by {k}")


@case("moved by a part of the cell", quick=2)
def shifted(rng: Random, c: float) -> Iterator[System]:
    """All atoms moved by any vector, and then wrapped or not (jax-md#302)."""
    s = _base(rng, c)
    for _ in range(3):
        t = replace(s, positions=s.positions + rng.uniform(-9 * c, 9 * c, 3))
        yield t
        yield t.wrapped()


@case("supercells", quick=2)
def supercells(rng: Random, c: float) -> Iterator[System]:
    """A small cell repeated: each atom keeps its number of neighbours."""
    s = inside(rng, 6, skewed(rng, [1.3 * c, 0.9 * c, 1.7 * c], 0.4), c)
    for n in ([1, 1, 1], [2, 1, 3], [3, 3, 2], [1, 5, 1]):
        copies = np.stack(np.meshgrid(*map(np.arange, n), indexing="ij"), -1).reshape(-1, 3)
        x = (s.positions + (copies @ s.cell)[:, None]).reshape(-1, 3)
        yield replace(s, positions=x, cell=s.cell * np.array(n)[:, None], note=f"supercell {n}")


@case("permuted atoms", quick=1)
def permuted(rng: Random, c: float) -> Iterator[System]:
    """The same atoms in another order."""
    s = _base(rng, c)
    yield replace(s, positions=s.positions[::-1].copy(), note="reversed")
    yield replace(s, positions=s.positions[rng.permutation(len(s))], note="shuffled")
    yield replace(s, positions=s.positions[np.lexsort(s.positions.T)], note="sorted along z")


@case("turned by 90 degrees", quick=2)
def turned(rng: Random, c: float) -> Iterator[System]:
    """Everything turned about an axis, or axes exchanged (torch_cluster#219)."""
    s = _base(rng, c)
    for axes in ([1, 2, 0], [2, 1, 0], [0, 2, 1]):
        turn = np.eye(3)[axes]
        yield replace(s, positions=s.positions @ turn, cell=s.cell @ turn, note="axes exchanged")
    turn = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    yield replace(s, positions=s.positions @ turn, cell=s.cell @ turn, note="about z")


@case("mirrored", quick=1)
def mirrored(rng: Random, c: float) -> Iterator[System]:
    """Everything mirrored at a plane, so that the cell is left-handed."""
    s = _base(rng, c)
    mirror = np.diag([-1.0, 1.0, 1.0])
    yield replace(s, positions=s.positions @ mirror, cell=s.cell @ mirror)
    yield replace(s, positions=-s.positions, cell=-s.cell, note="at a point")


@case("another cell of the same lattice", quick=2)
def other_cells(rng: Random, c: float) -> Iterator[System]:
    """The same crystal with other vectors: shifts change, distances do not."""
    s = _base(rng, c)
    for change in ([[1, 0, 0], [1, 1, 0], [0, 0, 1]], [[1, 0, 0], [-2, 1, 0], [3, 1, 1]]):
        yield replace(s, cell=np.array(change) @ s.cell, note="other vectors")
        yield replace(s, cell=np.array(change) @ s.cell).wrapped()
