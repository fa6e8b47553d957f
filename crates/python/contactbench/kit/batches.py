"""Batches: the neighbours of several systems, found by one call."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from .asking import Asker, called
from .cases import Case
from .compare import NONE, Difference, compare, failed
from .convention import Malformed, parts, with_
from .systems import OPEN, PERIODIC, Random, Refusal, Rows, System, inside, skewed

Batch = tuple[System, ...]


def _no_systems(rng: Random, cutoff: float) -> Iterator[System]:
    yield from ()


#: The case of all batches. It is tried if a function for batches is given.
BATCH = Case(
    "batches",
    "Pairs across systems (nvalchemi-toolkit#106), lost pairs (nvalchemi-ops#2), empty systems.",
    _no_systems,
    1,
)


def batches(rng: Random, c: float) -> Iterator[tuple[str, Batch]]:
    """Return batches with the reason why each is hard."""
    cubes = tuple(inside(rng, n, np.full(3, 3.3 * c), c) for n in (30, 17, 45))
    yield "one system", cubes[:1]
    yield "systems that overlap in space", cubes
    yield "the same system twice", (cubes[0], cubes[0])
    empty = inside(rng, 0, np.full(3, 2 * c), c)
    yield "an empty system in the middle", (cubes[0], empty, cubes[1])
    yield "empty systems at both ends", (empty, cubes[1], empty)
    yield "no atoms at all", (empty, empty)
    yield "systems of one atom", tuple(inside(rng, 1, np.full(3, k * c), c) for k in (0.8, 3, 0.6))
    yield (
        "different cells",
        (
            inside(rng, 30, skewed(rng, [2.3 * c, 3.1 * c, 2.7 * c], 0.6), c),
            inside(rng, 5, np.full(3, 0.7 * c), c),
            inside(rng, 30, [7 * c, 2 * c, 3 * c], c),
        ),
    )
    yield (
        "different axes",
        (
            inside(rng, 30, np.full(3, 2.4 * c), c, OPEN),
            inside(rng, 30, np.full(3, 2.4 * c), c, PERIODIC),
            inside(rng, 30, np.full(3, 2.4 * c), c, (True, False, True)),
        ),
    )
    yield (
        "many small systems",
        tuple(inside(rng, int(rng.integers(0, 7)), np.full(3, 2.1 * c), c) for _ in range(40)),
    )


class BatchAsker:
    """A function for batches, judged in the convention of the function for single systems."""

    def __init__(self, asker: Asker, f: Callable[..., Any]) -> None:
        self.asker, self.f = asker, f

    def wrong(self, batch: Batch) -> Difference | None:
        """Return what is wrong on a batch, or None. Atoms are numbered across all its systems."""
        try:
            return self._compared(batch)
        except Refusal:
            raise
        except self.asker.refuses as why:
            raise Refusal(f"batches: {type(why).__name__}: {why}") from None
        except Malformed as why:
            return failed(str(why))
        except Exception as error:
            return failed(f"it raises {type(error).__name__}: {error}")

    def _compared(self, batch: Batch) -> Difference | None:
        convention = self.asker.convention
        whole = joined(batch)
        cells = np.array([system.cell for system in batch])
        if convention.cell == "columns":
            cells = cells.transpose(0, 2, 1).copy()
        pbcs, owner = np.array([system.pbc for system in batch]), owners(batch)
        arguments = (whole.positions.copy(), cells, pbcs, whole.cutoff, owner.copy())
        answer = called(self.f, self.asker.call_seconds, self.asker.refuses, arguments)
        i, j, third = parts(answer, whole, convention)
        i, j = i - convention.base, j - convention.base
        known = (i >= 0) & (j >= 0) & (i < len(whole)) & (j < len(whole))
        if not known.all():
            if not convention.padding and convention.layout != "matrix":
                raise Malformed(f"a pair holds the number of no atom; there are {len(whole)}")
            i, j, third = i[known], j[known], None if third is None else third[known]
        across = owner[i] != owner[j]
        found = [Difference(NONE, _rows(i[across], j[across]), NONE, NONE, 0)]
        flat, start = with_(convention, layout="flat", padding=False), 0
        for number, system in enumerate(batch):
            own = ~across & (owner[i] == number)
            local = [i[own] - start + flat.base, j[own] - start + flat.base]
            local += [] if third is None else [third[own]]
            wrong, _ = compare(local, system, flat, self.asker.tolerant)
            if wrong is not None:
                found.append(_moved(wrong, start))
            start += len(system)
        missing, extra, doubled = (
            np.vstack([getattr(d, kind) for d in found]) for kind in ("missing", "extra", "doubled")
        )
        if len(missing) + len(extra) + len(doubled) == 0:
            return None
        text = f"{across.sum()} pairs across systems" if across.any() else ""
        needed = sum(d.needed for d in found)
        return Difference(missing, extra, doubled, _rows(i, j), needed, text=text)


def owners(batch: Batch) -> Rows:
    """Return for each atom the number of its system."""
    return np.repeat(np.arange(len(batch)), [len(system) for system in batch])


def joined(batch: Batch) -> System:
    """Return the atoms of all systems as one."""
    return replace(batch[0], positions=np.vstack([system.positions for system in batch]))


def _rows(i: Rows, j: Rows) -> Rows:
    return np.column_stack([i, j, np.zeros((len(i), 3), dtype=np.int64)])


def _moved(wrong: Difference, start: int) -> Difference:
    move = np.array([start, start, 0, 0, 0])
    return replace(
        wrong,
        missing=wrong.missing + move,
        extra=wrong.extra + move,
        doubled=wrong.doubled + move,
    )


def shrink_batch(asker: BatchAsker, batch: Batch) -> Batch:
    """Drop systems, then atoms, as long as the batch fails."""

    def fails(candidate: Batch) -> bool:
        try:
            return bool(candidate) and asker.wrong(candidate) is not None
        except Refusal:
            return False

    number = 0
    while number < len(batch):
        fewer = batch[:number] + batch[number + 1 :]
        batch, number = (fewer, number) if fails(fewer) else (batch, number + 1)
    for number in range(len(batch)):
        atom = 0
        while atom < len(batch[number]):
            kept = np.delete(batch[number].positions, atom, axis=0)
            less = (*batch[:number], replace(batch[number], positions=kept), *batch[number + 1 :])
            batch, atom = (less, atom) if fails(less) else (batch, atom + 1)
    return batch
