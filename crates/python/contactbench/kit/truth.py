"""The exact list of neighbours of a system, and what rounding may decide otherwise."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .._boxes import Box
from .._contacts import contacts
from .systems import Doubles, Refusal, Rows, System

#: Pairs closer to the cutoff than this (relative) are decided in whole numbers.
NEAR = 1e-9
#: Half the distance from 1 to the next number of float32.
UNIT32 = 2.0**-24


def truth(
    positions: npt.ArrayLike,
    cell: npt.ArrayLike,
    pbc: tuple[bool, bool, bool],
    cutoff: float,
    rule: str = "<",
) -> tuple[Rows, Rows, Rows]:
    """Return each pair of neighbours once, decided exactly for the given numbers.

    Pairs (i, j, S) have i < j, or i == j and S lexicographically positive, and are sorted. The
    distance vector is ``positions[j] - positions[i] + S @ cell``.
    """
    rows = half_list(
        System(np.asarray(positions, float), np.asarray(cell, float), pbc, cutoff), rule
    )
    return rows[:, 0], rows[:, 1], rows[:, 2:]


def half_list(system: System, rule: str = "<", cutoff: float | None = None) -> Rows:
    """Return `truth` of a system as rows (i, j, S), at another cutoff if one is given."""
    limit = system.cutoff if cutoff is None else cutoff
    if len(system) == 0:
        return np.empty((0, 5), dtype=np.int64)
    box = Box(system.full_cell(), periodic=system.pbc)
    arithmetic = "exact-open" if rule == "<" else "exact"
    pairs, images = contacts(system.positions, limit / 2, box, arithmetic=arithmetic)
    return canonical(np.hstack([pairs.astype(np.int64), images.astype(np.int64)]))


def canonical(rows: Rows) -> Rows:
    """Turn rows (i, j, S) so that i < j, or i == j and S is positive; sort them."""
    signs = np.sign(rows[:, 2:])
    first = np.where(signs[:, 0] != 0, signs[:, 0], np.where(signs[:, 1] != 0, *signs.T[1:]))
    turn = (rows[:, 0] > rows[:, 1]) | ((rows[:, 0] == rows[:, 1]) & (first < 0))
    turned = np.where(turn[:, None], np.hstack([rows[:, [1, 0]], -rows[:, 2:]]), rows)
    return turned[np.lexsort(turned.T[::-1])]


def vectors(system: System, rows: Rows) -> Doubles:
    """Return the distance vectors of rows (i, j, S), rounded."""
    x = system.positions
    return x[rows[:, 1]] - x[rows[:, 0]] + rows[:, 2:] @ system.full_cell()


def distances(system: System, rows: Rows) -> Doubles:
    """Return the distances of rows (i, j, S), rounded."""
    return np.asarray(np.sqrt((vectors(system, rows) ** 2).sum(axis=1)))


def _near(system: System, rows: Rows, cutoff: float) -> npt.NDArray[np.bool_]:
    """Return which pairs are so close to the cutoff that f64 might not decide them."""
    size = np.abs(system.positions).max(initial=0.0) + (
        np.abs(rows[:, 2:]) @ np.abs(system.full_cell())
    ).max(axis=1, initial=0.0)
    margin = NEAR * cutoff + 2.0**-49 * size
    return np.asarray(np.abs(distances(system, rows) - cutoff) <= margin)


def _whole(system: System, cutoff: float) -> tuple[Rows, Rows, int]:
    """Return positions, cell and cutoff as Python integers in one common unit, 2^-k."""
    numbers = [*system.positions.flat, *system.full_cell().flat, cutoff]
    ratios = [float(number).as_integer_ratio() for number in numbers]
    unit = max(below for _, below in ratios)
    whole = np.array([above * (unit // below) for above, below in ratios], dtype=object)
    n = system.positions.size
    return whole[:n].reshape(-1, 3), whole[n:-1].reshape(3, 3), whole[-1]


def squares(
    system: System, rows: Rows, which: npt.NDArray[np.bool_], cutoff: float
) -> npt.NDArray[np.int8]:
    """Return the sign of d^2 - cutoff^2, exact for pairs in `which` and 1 for others."""
    signs = np.ones(len(rows), dtype=np.int8)
    if which.any():
        x, cell, limit = _whole(system, cutoff)
        i, j = rows[which, 0], rows[which, 1]
        d = x[j] - x[i] + rows[which, 2:].astype(object) @ cell
        over = (d * d).sum(axis=1) - limit * limit
        signs[which] = [(value > 0) - (value < 0) for value in over]
    return signs


def undecided(system: System) -> Rows:
    """Return the pairs that careful f64 arithmetic may decide either way.

    The others are farther from the cutoff than 1e-9 (relative), or at exactly the cutoff with
    vectors, shifts and squares that f64 represents.
    """
    limit = system.cutoff * (1 + 4 * NEAR)
    rows = half_list(system, "<=", limit + 2.0**-48 * np.abs(system.positions).max(initial=0.0))
    rows = rows[_near(system, rows, system.cutoff)]
    if len(rows) == 0:
        return rows
    tie = squares(system, rows, np.ones(len(rows), bool), system.cutoff) == 0
    x, cell, limit_ = _whole(system, system.cutoff)
    shift = rows[:, 2:].astype(object) @ cell
    d = x[rows[:, 1]] - x[rows[:, 0]] + shift
    square = d * d
    needed = np.hstack([shift, d, square, square.sum(axis=1)[:, None]])
    exact = [all(_bits(int(number)) <= 53 for number in (*row, limit_ * limit_)) for row in needed]
    return np.asarray(rows[~(tie & np.array(exact))], np.int64)


def _bits(number: int) -> int:
    """Return the length of a mantissa that holds the number."""
    return number.bit_length() - ((number & -number).bit_length() - 1 if number else 0)


def _spread(system: System) -> Doubles:
    """Return |C^-1| |C| of the cell C, componentwise."""
    cell = system.full_cell()
    return np.asarray(np.abs(np.linalg.inv(cell)) @ np.abs(cell))


def band(system: System, rows: Rows) -> Doubles:
    """Return for each pair how far from the cutoff f32 arithmetic may decide it otherwise.

    The band is ``16 u (a_i + a_j + s + cutoff)`` with u = 2^-24. Here a_i is the length of
    ``|x_i| |C^-1| |C|``, taken componentwise, and s is the length of ``|S| |C|``. C is the cell.

    Proof. Rounding x_i to f32 changes it by at most u|x_i|. Fractional coordinates x_i C^-1, their
    integer part, and the product with C are sums of three products: each adds at most 4u
    |x_i| |C^-1| |C|, and |x_i| <= |x_i| |C^-1| |C|. The shift S C adds 4u |S| |C|, and the two
    sums of a distance vector add 2u of all terms. The square, the sum of three and the root, or
    the square of the cutoff, add 4u d. Near the cutoff d is at most 2 cutoff. The sum is below
    16u of each term; terms of u^2 are below the difference.
    """
    cell = np.abs(system.full_cell())
    reach = np.linalg.norm(np.abs(system.positions) @ _spread(system), axis=1)
    shift = np.linalg.norm(np.abs(rows[:, 2:]) @ cell, axis=1)
    return np.asarray(16 * UNIT32 * (reach[rows[:, 0]] + reach[rows[:, 1]] + shift + system.cutoff))


def widest_band(system: System) -> float:
    """Return a bound of `band` over all pairs of the system that an f32 list may hold.

    Let C be the cell, P = ``|C^-1| |C|``, and d the distance vector. S C = d - x_j + x_i, so
    ``|S| |C|`` is at most ``(|d| + |x_i| + |x_j|) P``, and its length at most a_i + a_j + |d| |P|.
    |d| is at most the cutoff and the band.
    """
    spread = _spread(system)
    reach = np.linalg.norm(np.abs(system.positions) @ spread, axis=1).max(initial=0.0)
    stretch, unit = float(np.linalg.norm(spread)), 16 * UNIT32
    if unit * stretch > 0.5:
        return np.inf
    return float(unit * (4 * reach + (1 + stretch) * system.cutoff) / (1 - unit * stretch))


def tolerant_list(system: System) -> tuple[Rows, npt.NDArray[np.bool_], float]:
    """Return all pairs that an f32 list may hold, whether it must, and the widest band.

    Raises `Refusal` if rounding may decide nearly all pairs.
    """
    widest = widest_band(system)
    if widest > 4 * system.cutoff:
        raise Refusal("single precision rounds positions by more than the cutoff")
    rows = half_list(system, "<=", system.cutoff + widest)
    d, width = distances(system, rows), band(system, rows)
    near = d - width <= system.cutoff
    least = 16 * UNIT32 * system.cutoff
    return rows[near], (d + width < system.cutoff)[near], float(width[near].max(initial=least))
