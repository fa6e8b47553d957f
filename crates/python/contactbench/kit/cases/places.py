"""Cases that vary where atoms lie."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..systems import OPEN, Doubles, Random, System, inside, skewed, system
from .table import case


def lattice(n: int, basis: list[list[float]]) -> Doubles:
    """Return n x n x n lattice points with unit spacing, each with this basis."""
    points = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 1, 3)
    return np.asarray((points + np.array(basis)).reshape(-1, 3), dtype=np.float64)


SIMPLE = [[0.0, 0.0, 0.0]]
CENTRED = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.5]]
FACES = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]]


@case("liquid", quick=2)
def liquid(rng: Random, c: float) -> Iterator[System]:
    """The ordinary scene: a half stencil that is doubled or incomplete shows here."""
    for side in (3.3, 2.1, 4.2, 5.4):
        yield inside(rng, 90, np.full(3, side * c), c)


@case("gas")
def gas(rng: Random, c: float) -> Iterator[System]:
    """Most cells are empty; lists that skip empty cells lose their neighbours."""
    yield inside(rng, 60, [9 * c, 7 * c, 8 * c], c)
    yield inside(rng, 12, [16.5 * c, 30 * c, 2.5 * c], c)


@case("crystals")
def crystals(rng: Random, c: float) -> Iterator[System]:
    """All atoms have equal neighbourhoods, slightly disturbed."""
    for basis, spacing in ((FACES, 1.1), (CENTRED, 0.8), (SIMPLE, 0.6)):
        x = lattice(3, basis) * spacing * c
        yield system(x + rng.normal(0, 0.02 * c, x.shape), np.full(3, 3 * spacing * c), c)


@case("clusters")
def clusters(rng: Random, c: float) -> Iterator[System]:
    """Many atoms in few cells of the grid, also across the faces of the cell."""
    for middle in (0.0, 0.5):
        x = rng.normal(middle * 6 * c, 0.3 * c, (60, 3))
        more = rng.normal(3.4 * c, 0.1 * c, (30, 3))
        yield system(np.vstack([x, more]), np.full(3, 6 * c), c)


@case("outside the cell", quick=3)
def outside(rng: Random, c: float) -> Iterator[System]:
    """Atoms up to k boxes outside: images counted from unwrapped atoms (jax-md#322)."""
    for k, shear in ((1, 0.0), (1, 0.7), (3, 0.4), (40, 0.0)):
        s = inside(rng, 60, skewed(rng, [3.3 * c, 2.6 * c, 4.1 * c], shear), c)
        moves = rng.integers(-k, k + 1, (60, 3)).astype(float)
        yield replace(
            s, positions=s.positions + moves @ s.cell, note=f"up to {k} box{'es' * (k > 1)} outside"
        )


@case("negative coordinates", quick=3)
def negative(rng: Random, c: float) -> Iterator[System]:
    """Truncation instead of floor (warp#1256), or a bound of 0 on open axes (vesin 0.5.7)."""
    s = inside(rng, 12, [0.25 * c] * 3, c, OPEN)
    yield replace(s, positions=s.positions - 27.5 * c)
    for pbc in ((True, True, True), OPEN):
        s = inside(rng, 70, [3.5 * c, 4.5 * c, 3.2 * c], c, pbc)
        yield replace(s, positions=s.positions - s.cell.sum(axis=0))
        yield replace(s, positions=s.positions - 0.5 * s.cell.sum(axis=0))


@case("on faces")
def faces(rng: Random, c: float) -> Iterator[System]:
    """Atoms at exactly 0 and exactly L: wrapped once too often, or indexed one cell too far."""
    for side in (4.0, 3.0):
        x = rng.choice([0.0, 1.0, 0.5, 0.25, -1.0], (40, 3)) * side * c
        yield system(x + (rng.random((40, 3)) < 0.4) * 0.3125 * c, np.full(3, side * c), c)


@case("upper faces of skewed cells", quick=4)
def upper(rng: Random, c: float) -> Iterator[System]:
    """Atoms on upper faces, edges and corners, or one ulp below: OpenMM 8.6.1 loses their pairs."""
    corners = lattice(2, SIMPLE)[1:]
    for ulps in (0, 0, 1, 1):
        cell = skewed(rng, rng.uniform(4.6, 6.4, 3) * c, 0.45)
        s = np.where(np.tile(corners, (4, 1)) == 1, 1.0, rng.random((28, 3)))
        x = s @ cell
        x = np.where(s == 1, x - ulps * np.spacing(x), x)
        along = rng.normal(size=(28, 3))
        along *= rng.uniform(0.3, 0.99, (28, 1)) * c / np.linalg.norm(along, axis=1)[:, None]
        yield system(np.vstack([x, x + along]), cell, c, note="one ulp below" * ulps)


@case("one ulp from faces", quick=3)
def ulps(rng: Random, c: float) -> Iterator[System]:
    """Wrapping rounds the coordinate -1e-20 to L, which is then indexed beyond the last cell."""
    for side in (4.0, 3.7, 1.3):
        length = side * c
        ends = [
            np.nextafter(length, 0), np.nextafter(length, np.inf), length,
            -1e-20, -5e-324, -2.0**-60, 5e-324, 0.0, np.nextafter(-length, 0),
        ]  # fmt: skip
        x = rng.random((45, 3)) * length
        x[np.arange(45), rng.integers(0, 3, 45)] = np.resize(ends, 45)
        yield system(x, np.full(3, length), c)


@case("two atoms at one place")
def coincident(rng: Random, c: float) -> Iterator[System]:
    """Distance 0 is taken for the atom itself, or divides by 0."""
    x: Doubles = rng.random((12, 3)) * 3 * c
    cell = np.full(3, 4 * c)
    yield system(np.vstack([x, x[:6], x[:2]]), cell, c)
    yield system([[c, c, c], [c, c, c]], cell, c, OPEN)
    moved = np.round(x * 64 / c) / 64 * c
    yield system(np.vstack([moved, moved[:5] + [4 * c, -4 * c, 0]]), cell, c, note="by a box")


@case("ties", quick=4)
def ties(rng: Random, c: float) -> Iterator[System]:
    """Pairs at exactly the cutoff: < or <= (LAMMPS#3846); lattices with spacing = cutoff."""
    yield system(lattice(4, SIMPLE) * c, np.full(3, 4 * c), c)
    yield system([[0, 0, 0]], np.full(3, c), c, note="own images at the cutoff")
    yield system(lattice(3, SIMPLE) * c, np.full(3, 16 * c), c, OPEN)
    yield system(lattice(2, CENTRED) * 2 * c, np.full(3, 4 * c), 2 * c)
    yield system((lattice(2, SIMPLE) - 1) * c, np.full(3, 2 * c), c, note="both images tie")
    yield system([[0, 0, 0], [3 * c, 4 * c, 0]], np.full(3, 16 * c), 5 * c, OPEN)


@case("next to the cutoff")
def next_to(rng: Random, c: float) -> Iterator[System]:
    """Distances within 1e-8 of the cutoff: single precision inside a list in double precision."""
    for pbc in ((True, True, True), OPEN):
        x = rng.random((16, 3)) * 8 * c
        along = rng.normal(size=(16, 3))
        along /= np.linalg.norm(along, axis=1)[:, None]
        beyond = x + along * c * np.resize([1 + 1e-8, 1 - 1e-8], 16)[:, None]
        yield system(np.vstack([x, beyond]), np.full(3, 8 * c), c, pbc)


@case("large offsets", quick=2)
def offsets(rng: Random, c: float) -> Iterator[System]:
    """All atoms 2^20 from the origin: single precision inside a list in double precision."""
    s = inside(rng, 50, np.full(3, 4 * c), c)
    x = np.round(s.positions * 2**12 / c) / 2**12 * c
    for pbc in (OPEN, (True, True, True)):
        yield replace(s, positions=x + 2.0**20, pbc=pbc)
    yield replace(s, positions=x + np.array([0.0, -(2.0**17), 0.0]), pbc=OPEN)


@case("far apart")
def apart(rng: Random, c: float) -> Iterator[System]:
    """Two clusters with a wide gap: the number of cells of a grid has to be limited."""
    for gap in (20.0, 50.0):
        x = rng.random((30, 3)) * 2 * c
        x[15:] += gap * c
        yield system(x, np.full(3, (gap + 2) * c), c, OPEN)


@case("small cutoff")
def small_cutoff(rng: Random, c: float) -> Iterator[System]:
    """Cells of a grid far smaller than the box, and hardly any pairs (GPUMD#1525)."""
    for side in (40.0, 70.0):
        x = rng.random((40, 3)) * side * c
        x[20:] = x[:20] + rng.normal(0, 0.4 * c, (20, 3))
        yield system(x, np.full(3, side * c), c)


@case("crowded", quick=2)
def crowded(rng: Random, c: float) -> Iterator[System]:
    """An atom with more neighbours than a fixed capacity (torch_cluster#250, Molly.jl#280)."""
    for n in (34, 257, 70, 130):
        x = rng.normal(0, 0.08 * c, (n, 3)) + 2 * c
        yield system(x, np.full(3, 4 * c), c)
