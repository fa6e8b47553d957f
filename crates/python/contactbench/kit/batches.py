"""Batches: the neighbours of several systems, found by one call."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .asking import Asker, Hang, called, division_of, raised
from .cases import Case
from .compare import NONE, Difference, compare, failed
from .convention import Convention, Malformed, parts
from .recognise import outside, probes
from .shrinking import shrink
from .systems import OPEN, PERIODIC, Random, Refusal, System, inside, skewed

Batch = tuple[System, ...]


def _no_systems(rng: Random, cutoff: float) -> Iterator[System]:
    yield from ()


#: The hard case for functions that take batches.
BATCH = Case(
    "batches",
    "Pairs across systems (nvalchemi-toolkit#106), lost pairs (nvalchemi-ops#2), empty systems.",
    _no_systems,
    1,
)


def batches_of(cutoffs: Sequence[float], quick: bool, seed: int) -> Iterator[Batch]:
    """Return the batches, the same for every function."""
    for cutoff in cutoffs[:1] if quick else cutoffs:
        for note, batch in _batches(np.random.default_rng(seed), float(cutoff)):
            yield tuple(replace(system, note=note) for system in batch)


def _batches(rng: Random, c: float) -> Iterator[tuple[str, Batch]]:
    """Return batches with the reason why each is hard."""
    cubes = tuple(inside(rng, n, np.full(3, 3.3 * c), c) for n in (30, 17, 45))
    yield "one system", cubes[:1]
    yield "systems that overlap in space", cubes
    yield "the same system twice", (cubes[0], cubes[0])
    slab = (True, True, False)
    skew = inside(rng, 30, skewed(rng, [2.3 * c, 3.1 * c, 2.7 * c], 0.6), c, slab)
    small, flat = inside(rng, 5, np.full(3, 0.7 * c), c), inside(rng, 30, [7 * c, 2 * c, 3 * c], c)
    yield "different cells and axes", (skew, small, flat)
    axes = (OPEN, PERIODIC, (True, False, True))
    yield "different axes", tuple(inside(rng, 30, np.full(3, 2.4 * c), c, pbc) for pbc in axes)
    far = (
        replace(s, positions=s.positions + rng.integers(-3, 4, (len(s), 3)) * s.pbc @ s.cell)
        for s in (flat, skew)
    )
    yield "atoms outside different cells", tuple(far)
    empty = inside(rng, 0, np.full(3, 2 * c), c)
    other = inside(rng, 0, [9 * c, c, 4 * c], c, (True, False, True))
    yield "an empty system in the middle", (cubes[0], empty, skew, flat)
    yield "an empty system at the start", (empty, skew, cubes[1])
    yield "an empty system at the end", (skew, cubes[1], empty)
    yield "empty systems at both ends", (empty, cubes[1], other)
    yield "two empty systems in the middle", (cubes[0], empty, other, skew)
    yield "one empty system", (empty,)
    yield "no atoms at all", (empty, other)
    yield "systems of one atom", tuple(inside(rng, 1, np.full(3, k * c), c) for k in (0.8, 3, 0.6))
    crowd = inside(rng, 200, np.full(3, 4.1 * c), c)
    yield "a large system between small ones", (cubes[1], crowd, small)
    yield (
        "many small systems",
        tuple(inside(rng, int(rng.integers(0, 7)), np.full(3, 2.1 * c), c) for _ in range(40)),
    )
    molecule = replace(cubes[1], cell=np.zeros((3, 3)), pbc=OPEN, optional=True)
    yield "open systems without a cell among others", (skew, molecule, cubes[0])


@dataclass
class BatchAsker:
    """A function for batches, judged in the convention of the function for single systems."""

    asker: Asker
    f: Callable[..., Any]

    def wrong(self, batch: Batch) -> Difference | None:
        """Return what is wrong on a batch, or None. Atoms are numbered across all its systems."""
        try:
            return self._compared(batch)
        except Refusal:
            raise
        except self.asker.refuses as why:
            raise Refusal(f"batches: {type(why).__name__}: {why}") from None
        except Exception as error:
            late = isinstance(error, (Hang, Malformed))
            if any(system.optional for system in batch) and not late:
                raise Refusal(f"batches: {type(error).__name__}: {error}") from None
            return failed(raised(error))

    def fails(self, batch: Batch, mixed: bool = False) -> bool:
        """Return whether the function is wrong on a batch, and mixes systems if `mixed`."""
        try:
            wrong = self.wrong(batch) if batch else None
        except (Refusal, MemoryError):
            return False
        return wrong is not None and (not mixed or across(batch, wrong))

    def _compared(self, batch: Batch) -> Difference | None:
        convention = self.asker.convention
        whole = joined(batch)
        cells = np.array([system.cell for system in batch])
        if convention.cell == "columns":
            cells = cells.transpose(0, 2, 1).copy()
        pbcs, sizes = np.array([system.pbc for system in batch]), [len(s) for s in batch]
        arguments = (whole.positions, cells, pbcs, whole.cutoff, division_of(sizes, convention))
        answer = called(self.f, self.asker.call_seconds, self.asker.refuses, arguments)
        i, j, third = parts(answer, whole, convention)
        i, j = i - convention.base, j - convention.base
        known = (i >= 0) & (j >= 0) & (i < len(whole)) & (j < len(whole))
        if not known.all():
            if not convention.padding and convention.layout != "matrix":
                raise Malformed(f"a pair holds the number of no atom; there are {len(whole)}")
            i, j, third = i[known], j[known], None if third is None else third[known]
        owner = np.repeat(np.arange(len(batch)), sizes)
        apart = owner[i] != owner[j]
        rows = np.column_stack([i, j, np.zeros((len(i), 3), dtype=np.int64)])
        found = [Difference(NONE, rows[apart], NONE, NONE, 0)]
        flat, start = replace(convention, layout="flat", padding=False), 0
        for number, system in enumerate(batch):
            own = ~apart & (owner[i] == number)
            local = [i[own] - start + flat.base, j[own] - start + flat.base]
            local += [] if third is None else [third[own]]
            wrong, width = compare(local, system, flat, self.asker.tolerant)
            self.asker.band = max(self.asker.band, width)
            if wrong is not None:
                found.append(_moved(wrong, start))
            start += len(system)
        missing, extra, doubled = (
            np.vstack([getattr(d, kind) for d in found]) for kind in ("missing", "extra", "doubled")
        )
        if len(missing) + len(extra) + len(doubled) == 0:
            return None
        if third is not None and convention.shifts == "S":
            rows[:, 2:] = third * convention.sign
        return Difference(missing, extra, doubled, rows, sum(d.needed for d in found))


def recognised(asker: Asker, f: Callable[..., Any]) -> Convention:
    """Return the convention of `asker` with the form in which `f` takes systems.

    It is the form with the fewest wrong pairs on a batch of two systems.
    """
    best, chosen = np.inf, asker.convention
    for pbc in (PERIODIC, OPEN):
        pair = tuple(replace(s, pbc=pbc) for s in (next(probes())[1], outside()))
        for systems in ("index", "offsets"):
            trial = replace(asker, convention=replace(asker.convention, systems=systems))
            try:
                wrong = BatchAsker(trial, f).wrong(pair)
            except Refusal:
                continue
            if wrong is None:
                return trial.convention
            if not wrong.text and wrong.wrong < best:
                best, chosen = wrong.wrong, trial.convention
    return chosen


def across(batch: Batch, wrong: Difference) -> bool:
    """Return whether pairs of atoms of different systems are listed."""
    ends = np.cumsum([len(system) for system in batch])
    owners = np.searchsorted(ends, wrong.extra[:, :2], side="right")
    return bool((owners[:, 0] != owners[:, 1]).any())


def joined(batch: Batch) -> System:
    """Return the atoms of all systems as one."""
    return replace(batch[0], positions=np.vstack([system.positions for system in batch]))


def _moved(wrong: Difference, start: int) -> Difference:
    move = np.array([start, start, 0, 0, 0])
    return replace(
        wrong,
        missing=wrong.missing + move,
        extra=wrong.extra + move,
        doubled=wrong.doubled + move,
    )


def shrink_batch(fails: Callable[[Batch], bool], batch: Batch, seconds: float = 6.0) -> Batch:
    """Drop systems, then make each as small and simple as possible, as long as the batch fails."""
    end = time.monotonic() + seconds

    def still(candidate: Batch) -> bool:
        return time.monotonic() < end and fails(candidate)

    def with_system(at: int, system: System) -> Batch:
        return (*batch[:at], system, *batch[at + 1 :])

    for at, system in enumerate(batch):
        without = with_system(at, replace(system, positions=system.positions[:0]))
        batch = without if still(without) else batch
    part = max(1, len(batch) // 2)
    while part:
        at = 0
        while at < len(batch):
            fewer = batch[:at] + batch[at + part :]
            batch, at = (fewer, at) if still(fewer) else (batch, at + part)
        part //= 2
    # The systems of a batch share their cutoff.
    cutoff, n = batch[0].cutoff, len(batch)
    if all(np.array_equal(system.positions, batch[0].positions) for system in batch):
        same = shrink(lambda s: s.cutoff == cutoff and still((s,) * n), batch[0], seconds)
        batch = (same,) * n if still((same,) * n) else batch
    for at in range(n):

        def fails_with(system: System, at: int = at) -> bool:
            return system.cutoff == cutoff and still(with_system(at, system))

        batch = with_system(at, shrink(fails_with, batch[at], (end - time.monotonic()) / (n - at)))
    return batch
