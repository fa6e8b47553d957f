"""Names the mistake that explains all wrong pairs of an answer."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from .asking import CHANGES, Asker
from .compare import Difference, difference
from .convention import Convention, comparable, expected_rows
from .systems import Refusal, Rows, System
from .truth import band, canonical, distances, half_list


def cause_of(asker: Asker, answers: list[tuple[System, Difference]]) -> str | None:
    """Return the likely mistake, or None if none of the table explains all answers.

    The first system's order of mistakes counts.
    """
    (system, wrong), *others = answers
    also = [set(causes(asker, *other)) for other in others]
    if not all(also):
        return None
    return next(
        (text for text in causes(asker, system, wrong) if all(text in a for a in also)), None
    )


def causes(asker: Asker, system: System, wrong: Difference) -> Iterator[str]:
    """Return the mistakes that explain an answer, the likeliest first."""
    if not wrong.text:
        convention = asker.convention
        listed = comparable(wrong.answer, system, convention)
        for text, rows in _predictions(system, convention):
            if difference(listed, rows, rows[:0], listed) is None:
                yield text
        for test in (_capacity, _single):
            found = test(system, convention, wrong)
            if found:
                yield found
    if wrong.text.startswith(CHANGES):
        return
    for text, remedy in REMEDIES:
        mended = remedy(system)
        if mended is not None and mended.modest() and _right(asker, mended):
            yield text
    if not wrong.text:
        yield from _faces(system, asker.convention, wrong)


def _right(asker: Asker, system: System) -> bool:
    try:
        return asker.wrong(system) is None
    except Refusal:
        return False


def _predictions(system: System, convention: Convention) -> Iterator[tuple[str, Rows]]:
    """Return what lists with one mistake would hold, in the form of `comparable`."""
    half = half_list(system, convention.rule)

    def meant(rows: Rows) -> Rows:
        return expected_rows(rows, system, convention)

    other = "<=" if convention.rule == "<" else "<"
    with_other = half_list(system, other)
    if len(with_other) != len(half):
        yield (
            f"pairs at exactly the cutoff: the rule is {other}, not {convention.rule}",
            meant(with_other),
        )
    full = np.vstack([half, np.hstack([half[:, [1, 0]], -half[:, 2:]])])
    if convention.pairs == "full":
        for rows in (half, canonical(half)[:, [1, 0, 2, 3, 4]]):
            yield (
                "each pair is listed from one side only (a half list)",
                comparable(rows, system, convention),
            )
    else:
        yield (
            "each pair is listed from both sides (a full list)",
            comparable(full, system, convention),
        )
    yield "each pair is listed twice", np.vstack([meant(half), meant(half)])
    yield "pairs of an atom with its own images are missing", meant(half[half[:, 0] != half[:, 1]])
    boxes = system.boxes()
    inner = half[:, 2:] + boxes[half[:, 1]] - boxes[half[:, 0]]
    yield "pairs through periodic images are missing", meant(half[~inner.any(axis=1)])
    for k in (1, 2, 3):
        for name, shifts in (("", half[:, 2:]), (" of wrapped atoms", inner)):
            near = np.abs(shifts).max(axis=1, initial=0) <= k
            yield f"images beyond {k} cell{'s' * (k > 1)}{name} are missing", meant(half[near])
    order = np.argsort(distances(system, half), kind="stable")
    _, first = np.unique(half[order][:, :2], axis=0, return_index=True)
    nearest = half[order][first]
    yield "only the nearest image of each pair is listed", meant(nearest)
    yield (
        "only the nearest image of each pair is listed",
        meant(nearest[nearest[:, 0] != nearest[:, 1]]),
    )
    yield "pairs at distance 0 are missing", meant(half[distances(system, half) > 0])
    sign = np.array([1, 1, -1, -1, -1])
    yield "S has the other sign", comparable(meant(half) * sign, system, convention)
    rows = meant(half).copy()
    rows[:, 2:] += boxes[rows[:, 1]] - boxes[rows[:, 0]]
    yield "S counts from atoms wrapped into the cell", comparable(rows, system, convention)
    for text, changed in _other_systems(system):
        if changed.modest():
            yield text, meant(half_list(changed, convention.rule))


def _other_systems(system: System) -> Iterator[tuple[str, System]]:
    """Return systems that a list with one mistake takes for the system given."""
    if not np.array_equal(system.cell, system.cell.T):
        yield "columns of the cell are taken for its vectors", replace(system, cell=system.cell.T)
    diagonal = np.diag(np.diag(system.cell))
    if not np.array_equal(diagonal, system.cell):
        yield "only the diagonal of the cell is used", replace(system, cell=diagonal)
    if np.linalg.det(system.full_cell()) != 0:
        for axis in range(3):
            pbc = list(system.pbc)
            pbc[axis] = not pbc[axis]
            changed = replace(system, pbc=(pbc[0], pbc[1], pbc[2]))
            if pbc[axis] and system.cell[axis].any():
                yield f"open axis {axis} is treated as periodic", changed
            elif not pbc[axis]:
                yield f"periodic axis {axis} is treated as open", changed
        if not all(system.pbc) and system.cell.any(axis=1).all():
            yield "open axes are treated as periodic", replace(system, pbc=(True, True, True))
    yield "the cutoff is taken twice", replace(system, cutoff=2 * system.cutoff)
    yield "half the cutoff is used", replace(system, cutoff=system.cutoff / 2)


def _capacity(system: System, convention: Convention, wrong: Difference) -> str | None:
    """Return whether each atom that lacks neighbours has the same number of them."""
    if len(wrong.extra) or len(wrong.doubled) or not len(wrong.missing):
        return None
    counts = np.bincount(wrong.answer[:, 0], minlength=len(system))
    lacking = np.unique(wrong.missing[:, 0])
    most = int(counts.max(initial=0))
    if most > 1 and most < len(system) - 1 and (counts[lacking] == most).all():
        return f"each atom has at most {most} neighbours (a capacity)"
    return None


def _single(system: System, convention: Convention, wrong: Difference) -> str | None:
    """Return whether rounding to f64 or f32 explains all wrong pairs."""
    if len(wrong.doubled) or convention.shifts == "none":
        return None
    rows = np.vstack([wrong.missing, wrong.extra])
    if (np.abs(rows[:, 2:]) >= 2**32).any():
        return None
    off, width = np.abs(distances(system, rows) - system.cutoff), band(system, rows)
    if (off <= 2.0**-28 * width).all():
        return "rounding in float64: shifted positions are subtracted; subtract first, then shift"
    plain = (off <= width).all() and (width < 0.01 * system.cutoff).all()
    return "rounding to single precision" if plain else None


def _faces(system: System, convention: Convention, wrong: Difference) -> Iterator[str]:
    """Return what all wrong pairs have in common."""
    rows = np.vstack([wrong.missing, wrong.extra, wrong.doubled])
    if convention.shifts == "none" or not len(rows):
        return
    boxes, x = system.boxes(), system.positions
    needed = half_list(system, convention.rule)

    def through(pairs: Rows) -> npt.NDArray[np.bool_]:
        inner = pairs[:, 2:] + boxes[pairs[:, 1]] - boxes[pairs[:, 0]]
        return np.asarray(inner.any(axis=1))

    def negative(pairs: Rows) -> npt.NDArray[np.bool_]:
        return np.asarray(((x[pairs[:, 0]] < 0) | (x[pairs[:, 1]] < 0)).any(axis=1))

    for text, test in (
        ("all wrong pairs reach through a face of the cell", through),
        ("all wrong pairs have an atom at a negative coordinate", negative),
    ):
        # It explains nothing if nearly all pairs are such.
        if test(rows).all() and len(needed) and test(needed).mean() < 0.8:
            yield text


def _wrapped(system: System) -> System | None:
    return system.wrapped() if system.boxes().any() else None


def _positive(system: System) -> System | None:
    low = system.positions.min(axis=0, initial=0.0)
    return replace(system, positions=system.positions - 1.01 * low) if low.any() else None


def _right_handed(system: System) -> System | None:
    a, b, c = system.pbc
    if np.linalg.det(system.full_cell()) > 0:
        return None
    return replace(system, cell=system.cell[[1, 0, 2]], pbc=(b, a, c))


def _triangular(system: System) -> System | None:
    cell = system.full_cell()
    if not np.triu(cell, 1).any():
        return None
    q, r = np.linalg.qr(cell.T)
    q = q * np.sign(np.diag(r))
    return replace(system, cell=np.tril(cell @ q), positions=system.positions @ q)


def _straight(system: System) -> System | None:
    cell = np.diag(system.heights())
    if not (system.cell - np.diag(np.diag(system.cell))).any():
        return None
    return replace(system, cell=cell, positions=system.fractional() @ cell)


def _larger(system: System) -> System | None:
    n = np.where(system.pbc, np.ceil(4 * system.cutoff / system.heights()), 1).astype(int)
    if n.prod() == 1 or n.prod() * len(system) > 2000:
        return None
    copies = np.stack(np.meshgrid(*map(np.arange, n), indexing="ij"), -1).reshape(-1, 3)
    x = (system.positions + (copies @ system.cell)[:, None]).reshape(-1, 3)
    return replace(system, positions=x, cell=system.cell * n[:, None])


def _contiguous(system: System) -> System | None:
    return None if system.memory == "C" else replace(system, memory="C")


#: Changes of a system after which the answer is right, and the mistake that this shows.
REMEDIES: list[tuple[str, Callable[[System], System | None]]] = [
    ("arrays that are not contiguous in C order are misread", _contiguous),
    ("right if two vectors of the cell are exchanged: left-handed cells", _right_handed),
    ("right if all coordinates are positive: truncation instead of floor?", _positive),
    ("right if all atoms are wrapped into the cell", _wrapped),
    ("right if the cell is turned so that it is lower triangular", _triangular),
    ("right if the angles of the cell are made right: skewed cells", _straight),
    ("right in a supercell of 4 cutoffs: number of images or of cells", _larger),
]
