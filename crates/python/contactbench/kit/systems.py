"""Systems of atoms: what a neighbour list is given, and how the kit makes them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

Doubles = npt.NDArray[np.float64]
Rows = npt.NDArray[np.int64]
Random = np.random.Generator


class Refusal(Exception):
    """A system that the function declines, or that cannot be judged, with the reason."""


@dataclass(frozen=True, eq=False)
class System:
    """Atoms, their cell, and a cutoff."""

    positions: Doubles
    #: One vector per row. Rows of open axes may be zero.
    cell: Doubles
    pbc: tuple[bool, bool, bool]
    cutoff: float
    #: The type in which positions and cell are passed: ``float64`` or ``float32``.
    dtype: str = "float64"
    #: How positions lie in memory: ``C``, ``F`` (Fortran), or ``strided``.
    memory: str = "C"
    #: Number of calls that must give the same answer.
    calls: int = 1
    #: A limit for the neighbours of an atom, passed to functions that take one.
    capacity: int | None = None
    #: Whether any exception counts as a refusal.
    optional: bool = False
    #: How the system was made.
    note: str = ""

    def __len__(self) -> int:
        return len(self.positions)

    def given(self) -> tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[np.bool_], float]:
        """Return fresh arguments in the type and memory layout of this system."""
        x = np.array(self.positions, dtype=self.dtype, order="F" if self.memory == "F" else "C")
        if self.memory == "strided":
            wide = np.full((2 * len(x) + 1, 4), 7.0, dtype=self.dtype)
            wide[: 2 * len(x) : 2, :3] = x
            x = wide[: 2 * len(x) : 2, :3]
        return x, np.array(self.cell, dtype=self.dtype), np.array(self.pbc), float(self.cutoff)

    def full_cell(self) -> Doubles:
        """Return the cell with the zero vectors of open axes completed by unit vectors."""
        cell = self.cell + 0.0
        for axis in range(3):
            if not cell[axis].any():
                rest = cell[cell.any(axis=1)]
                _, _, basis = np.linalg.svd(np.vstack([rest, np.zeros((1, 3))]))
                cell[axis] = basis[len(rest)]
        return cell

    def fractional(self) -> Doubles:
        """Return positions as multiples of the vectors of the cell, rounded."""
        return np.asarray(np.linalg.solve(self.full_cell().T, self.positions.T).T, np.float64)

    def boxes(self) -> Rows:
        """Return for each atom the box that holds it, 0 along open axes."""
        return np.asarray(np.floor(self.fractional()) * np.array(self.pbc), np.int64)

    def wrapped(self) -> System:
        """Return the system with all atoms moved into the cell, up to rounding."""
        return replace(self, positions=self.positions - self.boxes() @ self.full_cell())

    def heights(self) -> Doubles:
        """Return the distances between opposite faces of the cell."""
        return np.asarray(1.0 / np.linalg.norm(np.linalg.inv(self.full_cell()), axis=0))

    def modest(self) -> bool:
        """Return whether the cell has a volume, and the atoms few images within the cutoff."""
        if not self.cell[np.array(self.pbc)].any(axis=1).all():
            return False
        cell = self.full_cell()
        if abs(np.linalg.det(cell)) < 1e-6 * np.linalg.norm(cell, axis=1).prod():
            return False
        images = np.where(self.pbc, 1 + 2 * self.cutoff / self.heights(), 1).prod()
        return bool(len(self) ** 2 * images < 4e5)


PERIODIC = (True, True, True)
OPEN = (False, False, False)


def system(
    positions: Any,
    cell: Any,
    cutoff: float,
    pbc: tuple[bool, bool, bool] = PERIODIC,
    note: str = "",
) -> System:
    """Make a system from lists; `cell` may be three lengths."""
    vectors = np.array(cell, dtype=np.float64)
    if vectors.ndim == 1:
        vectors = np.diag(vectors)
    x = np.array(positions, dtype=np.float64).reshape(-1, 3)
    return System(x, vectors, pbc, float(cutoff), note=note)


def inside(
    rng: Random,
    n: int,
    cell: npt.ArrayLike,
    cutoff: float,
    pbc: tuple[bool, bool, bool] = PERIODIC,
    note: str = "",
) -> System:
    """Make a system of `n` random atoms inside the cell."""
    made = system(np.zeros((n, 3)), cell, cutoff, pbc, note)
    return replace(made, positions=rng.random((n, 3)) @ made.full_cell())


def rotation(rng: Random) -> Doubles:
    """Return a random rotation."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    if np.linalg.det(q) < 0:
        q[:, 0] = -q[:, 0]
    return np.ascontiguousarray(q)


def skewed(rng: Random, heights: npt.ArrayLike, shear: float) -> Doubles:
    """Return a lower triangular cell with these heights along x, y, z before shearing."""
    a, b, c = np.asarray(heights, dtype=np.float64)
    s = shear * rng.uniform(-1, 1, 3)
    return np.array([[a, 0, 0], [s[0] * a, b, 0], [s[1] * a, s[2] * b, c]])
