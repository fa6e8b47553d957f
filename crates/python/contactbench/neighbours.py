"""Neighbour lists: all pairs of particles that are closer than a cutoff, also through periodic
images, decided exactly for the given numbers.

>>> from contactbench.neighbours import neighbour_list
>>> i, j, d = neighbour_list("ijd", [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], cutoff=1.5)
>>> i.tolist(), j.tolist(), d.tolist()
([0, 1], [1, 0], [1.0, 1.0])

Results are those of ASE's ``neighbor_list``: pairs at exactly the cutoff are left out, each pair is
listed from both sides, and the distance vector is ``D = x[j] - x[i] + S @ cell``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from . import _contactbench as native
from ._boxes import count, numbers

if TYPE_CHECKING:
    from ._contactbench import Edges

__all__ = [
    "batch_neighbour_list",
    "max_neighbours",
    "neighbor_list",
    "neighbour_list",
    "pairs_between",
]

Ints: TypeAlias = npt.NDArray[np.int64]

_QUANTITIES = "ijSdD"
_RULES = {"<": "exact-open", "<=": "exact"}


def _edges(cell: npt.ArrayLike | None, pbc: Any, dim: int) -> Edges | None:
    """Return vectors, flags and corner of a cell; vectors of zeros along open axes are replaced.

    A cell gives `dim` lengths or vectors as rows. Vectors of open axes do not affect a list, so ASE
    allows them to be zero. None stands for open space.
    """
    flags = np.asarray(True if pbc is None else pbc)
    if flags.shape not in ((), (dim,)) or flags.dtype.kind not in "biu":
        raise ValueError(f"pbc is {pbc!r}; give one bool, or {dim}, one for each vector")
    flags = np.broadcast_to(flags.astype(bool), dim)
    if cell is None:
        if pbc is not None and flags.any():
            raise ValueError(f"pbc is {pbc!r} without a cell; give the cell, or pbc=None")
        return None
    vectors = numbers(cell, "cell")
    if vectors.shape == (dim,):
        vectors = np.diag(vectors)
    if vectors.shape != (dim, dim):
        raise ValueError(
            f"cell has the shape {vectors.shape}; give {dim} lengths, or {dim} vectors as rows"
        )
    if not flags.any():
        return None
    missing = ~vectors.any(axis=1)
    if (missing & flags).any():
        raise ValueError(f"cell has a vector of zeros along a periodic axis; pbc is {pbc!r}")
    if missing.any():
        # Rows of the last factor that are orthogonal to all given vectors.
        free = np.linalg.svd(vectors)[2][dim - missing.sum() :]
        vectors = vectors.copy()
        vectors[missing] = free * (np.abs(vectors).max() or 1.0)
    edges = np.eye(3)
    edges[:dim, :dim] = vectors
    return edges.tolist(), [*flags.tolist(), False][:3], [0.0] * 3


def _system(positions: Any, cell: Any, pbc: Any, cutoff: Any) -> tuple[Any, Any, Any, Any]:
    """Take positions, cell and pbc from an object such as `ase.Atoms`."""
    if cutoff is None and cell is not None and np.ndim(cell) == 0:
        cell, cutoff = None, cell
    if not all(hasattr(positions, name) for name in ("positions", "cell", "pbc")):
        return positions, cell, pbc, cutoff
    if cell is not None or pbc is not None:
        raise ValueError("atoms have their own cell and pbc; give atoms and a cutoff only")
    return positions.positions, np.asarray(positions.cell), positions.pbc, cutoff


def _half(cutoff: object) -> npt.NDArray[np.float64]:
    """Return the radius of particles that touch within the cutoff."""
    if cutoff is None:
        raise ValueError("cutoff is missing; give a length, as in cutoff=5.0")
    half = numbers(cutoff, "cutoff")
    if half.shape != () or not 0.0 <= half < np.inf:
        raise ValueError(f"cutoff is {cutoff!r}; give one finite length of at least 0")
    if half * 0.5 * 2.0 != half:
        raise ValueError(f"cutoff is {cutoff!r}, and float64 would round its half; scale lengths up")
    return np.asarray(half * 0.5)


def _found(
    positions: Any,
    cell: Any,
    pbc: Any,
    cutoff: Any,
    rule: str,
    threads: int,
    memory_limit: int | None,
    **wanted: bool,
) -> Any:
    """Return offsets, i, j, and what else is wanted: S, D and d, or None for each."""
    if rule not in _RULES:
        raise ValueError(f"rule is {rule!r}; give '<' or '<='")
    positions, cell, pbc, cutoff = _system(positions, cell, pbc, cutoff)
    half, x = _half(cutoff), numbers(positions, "positions")
    if x.size == 0 and x.ndim < 2:
        x = x.reshape(0, 3)
    if x.ndim != 2 or x.shape[1] not in (2, 3):
        raise ValueError(f"positions have the shape {x.shape}; give N rows of 2 or 3 numbers")
    edges = _edges(cell, pbc, x.shape[1])
    if memory_limit is None:
        memory_limit = max(native.limit_for(len(x)), 4 << 30)
    threads = count(threads, "threads")
    search = native.Search(native.DEFAULT, False, _RULES[rule], threads, memory_limit)
    asked = {"half": False, "sorted": False, "shifts": False, "vectors": False} | wanted
    return native.neighbours(search, x, half, edges, asked)


def neighbour_list(
    quantities: str,
    positions: Any,
    cell: npt.ArrayLike | None = None,
    pbc: Any = None,
    cutoff: float | None = None,
    *,
    rule: str = "<",
    half: bool = False,
    sorted: bool = False,
    csr: bool = False,
    threads: int = 1,
    memory_limit: int | None = None,
) -> Any:
    """Find all pairs of particles that are closer than a cutoff.

    Parameters
    ----------
    quantities : str
        The arrays to return, in this order: ``i`` and ``j``, the two particles, int64 (M,); ``S``,
        the shift of j in cell vectors, int32 (M, 3); ``d``, the distance, float64 (M,); ``D``, the
        vector from i to the image of j, float64 (M, 3).
    positions : array_like, shape (N, 3) or (N, 2), or atoms
        Positions, inside or outside the cell; or an object with `positions`, `cell` and `pbc`, such
        as `ase.Atoms`, whose cutoff may follow as in ASE: ``neighbour_list("ij", atoms, 5.0)``.
        Other float types are widened without rounding.
    cell : array_like, shape (3, 3) or (3,), optional
        Three vectors as rows, of any direction and handedness, or three lengths. A vector along an
        open axis may be zero. Without a cell, space is open.
    pbc : bool or sequence of 3 bool, optional
        The periodic vectors; by default all.
    cutoff : float
        The distance below which particles are neighbours, in the unit of `positions`. It may exceed
        the cell.
    rule : {"<", "<="}
        Whether pairs at exactly the cutoff are left out or listed.
    half : bool
        List each pair once, with i <= j, instead of from both sides.
    sorted : bool
        Order the neighbours of each particle by j and shift. Rows are always ordered by i.
    csr : bool
        Also return offsets, int64 (N + 1,), as the last array: neighbours of particle k are entries
        ``offsets[k]`` to ``offsets[k + 1]``.
    threads : int
        Number of threads of the search.
    memory_limit : int, optional
        Limit in bytes for the pairs, and again for the images. By default at least 4 GiB.

    Returns
    -------
    tuple of ndarray, or one ndarray for a single quantity

    Raises
    ------
    ValueError
        Invalid input, as for `contactbench.contacts`.
    MemoryError
        The pairs or the images would take more than `memory_limit`, or memory is exhausted.

    Notes
    -----
    ``D`` and ``d`` are rounded; which pairs are listed is decided exactly, whatever the rounding.
    A particle is its own neighbour through images, as in ASE.
    """
    unknown = set(quantities) - set(_QUANTITIES)
    if unknown or not quantities:
        raise ValueError(f"quantities are {quantities!r}; give letters of {_QUANTITIES!r}")
    offsets, *arrays = _found(
        positions,
        cell,
        pbc,
        cutoff,
        rule,
        threads,
        memory_limit,
        half=half,
        sorted=sorted,
        shifts="S" in quantities,
        vectors="d" in quantities or "D" in quantities,
    )
    of = dict(zip("ijSDd", arrays))
    result = [of[letter] for letter in quantities] + ([offsets] if csr else [])
    return result[0] if len(result) == 1 else tuple(result)


neighbor_list = neighbour_list


def max_neighbours(
    positions: Any,
    cell: npt.ArrayLike | None = None,
    pbc: Any = None,
    cutoff: float | None = None,
    *,
    rule: str = "<",
) -> int:
    """Return the largest number of neighbours of a particle: the capacity that a list of fixed width
    needs for this system. Arguments are those of `neighbour_list`.
    """
    offsets = _found(positions, cell, pbc, cutoff, rule, 1, None)[0]
    return int(np.diff(offsets).max(initial=0))


def pairs_between(
    queries: npt.ArrayLike,
    points: npt.ArrayLike,
    cell: npt.ArrayLike | None = None,
    pbc: Any = None,
    cutoff: float | None = None,
    *,
    rule: str = "<",
) -> tuple[Ints, Ints, npt.NDArray[np.int32]]:
    """Find the points that are closer than a cutoff to each query.

    Returns the row of the query, the row of the point, and the shift S of the point, such that the
    distance vector is ``points[j] - queries[i] + S @ cell``. Queries are not neighbours of each
    other. Other arguments are those of `neighbour_list`. The search also finds the pairs within each
    set, so two dense sets cost more than their answer.
    """
    sets = [numbers(queries, "queries"), numbers(points, "points")]
    width = max((x.shape[1] for x in sets if x.ndim == 2), default=3)
    sets = [np.reshape(x, (0, width)) if x.size == 0 and x.ndim < 2 else x for x in sets]
    if any(x.ndim != 2 for x in sets) or sets[0].shape[1] != sets[1].shape[1]:
        raise ValueError(
            f"queries and points have the shapes {sets[0].shape} and {sets[1].shape}; give rows of "
            "equal length"
        )
    both, first = np.concatenate(sets), len(sets[0])
    i, j, shifts = neighbour_list("ijS", both, cell, pbc, cutoff, rule=rule)
    kept = (i < first) & (j >= first)
    return i[kept], j[kept] - first, shifts[kept]


def batch_neighbour_list(
    quantities: str,
    positions: npt.ArrayLike,
    offsets: Sequence[int] | Ints,
    cells: Sequence[Any] | npt.NDArray[Any] | None = None,
    pbc: Any = None,
    cutoff: float | None = None,
    **options: Any,
) -> Any:
    """Find the neighbours within each of several systems whose positions follow each other.

    System k has the positions ``offsets[k]`` to ``offsets[k + 1]``, the cell ``cells[k]``, and
    ``pbc[k]`` if pbc has a row for each system. Numbers i and j are rows of `positions`. Empty
    systems are allowed. Returns the arrays of `neighbour_list`, followed by the system of each pair,
    int64 (M,). Other arguments are those of `neighbour_list`, except csr.
    """
    x, ends = numbers(positions, "positions"), np.asarray(offsets)
    ends = ends.astype(np.int64) if ends.dtype.kind in "iu" and ends.ndim == 1 else np.array([-1])
    if len(ends) < 1 or ends[0] != 0 or (np.diff(ends) < 0).any() or ends[-1] != len(x):
        raise ValueError(
            f"offsets are {offsets!r}; give whole numbers that rise from 0 to {len(x)}, the number "
            "of positions"
        )
    systems = len(ends) - 1
    if cells is not None and len(cells) != systems:
        raise ValueError(f"there are {len(cells)} cells for {systems} systems; give one for each")
    if np.ndim(pbc) == 2 and len(pbc) != systems:
        raise ValueError(f"pbc has {len(pbc)} rows for {systems} systems; give one for each")
    if options.pop("csr", False):
        raise ValueError("csr: a batch has the system of each pair instead; leave csr out")
    parts, counts = [], []
    for k in range(systems):
        of = (pbc[k] if np.ndim(pbc) == 2 else pbc, cutoff)
        cell = None if cells is None else cells[k]
        *own, rows = neighbour_list(
            quantities, x[ends[k] : ends[k + 1]], cell, *of, csr=True, **options
        )
        for letter in {"i", "j"}.intersection(quantities):
            own[quantities.index(letter)] += ends[k]
        parts.append(own)
        counts.append(rows[-1])
    if not parts:
        return batch_neighbour_list(quantities, x, [0, 0], None, None, cutoff, **options)
    lists = (np.concatenate(arrays) for arrays in zip(*parts))
    return *lists, np.repeat(np.arange(systems), counts)
