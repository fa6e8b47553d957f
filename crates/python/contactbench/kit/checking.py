"""Holds a neighbour list to the truth on all hard cases."""

from __future__ import annotations

import logging
import time
import zlib
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Literal, TypeVar

import numpy as np

from .asking import HANGS, Asker
from .batch_causes import cause_of_batch
from .batches import (
    BATCH,
    Batch,
    BatchAsker,
    across,
    batches_of,
    joined,
    recognised,
    shrink_batch,
)
from .cases import CASES, Case
from .causes import cause_of
from .compare import Difference, failed
from .convention import ASE, Convention
from .failure import NeighbourFailure
from .recognise import Recognised, recognise
from .result import NeighbourCheck
from .shrinking import shrink
from .systems import Refusal, System

Given = TypeVar("Given", System, Batch)
_log = logging.getLogger(__name__)
#: Cutoffs of the systems, of the size of those of molecules in angstrom.
CUTOFFS = (5.0, 3.0)
#: The largest limit of a call that is accepted.
MOST_SECONDS = 1e6
#: Failures that are reduced and explained; the others are counted.
REDUCED = 8
#: The error of a function that is wrong in the first of two calls only.
AGAIN = "right when called again: the answer depends on earlier calls"


def check_neighbours(
    f: Callable[..., Any],
    *,
    quick: bool = False,
    cutoffs: Sequence[float] = CUTOFFS,
    convention: Convention | str | None = None,
    division: Literal["exact", "tolerant"] = "exact",
    refuses: tuple[type[BaseException], ...] = (NotImplementedError,),
    batch: Callable[..., Any] | bool | None = None,
    cases: Sequence[str] | None = None,
    seed: int = 0,
    seconds: float | None = None,
    call_seconds: float = 30.0,
    name: str | None = None,
) -> NeighbourCheck:
    """Compare a neighbour list with the exact truth on hard cases.

    A failing system is made as small as possible. The result prints it with the wrong pairs, the
    likely mistake, and a program that shows it.

    Parameters
    ----------
    f : callable
        ``f(positions, cell, pbc, cutoff)`` returns ``i, j, S``, by default in the convention of
        ASE: each pair from both sides, ``d < cutoff``, and the distance vector is
        ``positions[j] - positions[i] + S @ cell``. If it has a parameter ``max_neighbours`` (or
        ``max_neighbors``), it must raise an exception if an atom has more.
    quick : bool
        Try only the first systems of each case.
    cutoffs : sequence of float
        The cutoffs of the systems. Small whole numbers keep ties exact.
    convention : Convention or str, optional
        How answers are meant, as a `Convention` or text like ``"pairs=half,rule=<="``. By default
        it is recognised by trying `f` on small systems, and printed. Declare it (``"ase"``), or
        shifts with the wrong sign are taken for another convention.
    division : str
        ``exact``, or ``tolerant`` for lists that compute in float32: a pair is wrong only if it is
        farther from the cutoff than rounding explains. The band is printed.
    refuses : tuple of exceptions
        Exceptions by which `f` declines a system. These systems are counted and printed.
    batch : callable or bool, optional
        ``batch(positions, cells, pbcs, cutoff, systems)`` lists the pairs of B systems whose atoms
        follow each other; ``cells`` has the shape (B, 3, 3), and i and j are rows of
        ``positions``. ``systems`` holds for each atom the number of its system, or the B + 1
        offsets of the systems if the convention has ``systems=offsets``, which is recognised.
        Declare it if compiled code may read past an array of the wrong length. If `batch` is True,
        `f` is such a function; a single system is then a batch of one.
    cases : sequence of str, optional
        Names of the hard cases to try; by default all.
    seed : int
        Seed of the random systems.
    seconds : float, optional
        No system begins after this time. The list is then not checked, unless it is wrong.
    call_seconds : float
        A call in Python code that takes longer is a failure.
    name : str, optional
        The name of `f` in messages; as ``module:name`` also in programs that show a failure.

    Examples
    --------
    A list that forgets all but the nearest images:

    >>> import numpy as np
    >>> import contactbench
    >>> def nearest(positions, cell, pbc, cutoff):
    ...     i, j = np.nonzero(~np.eye(len(positions), dtype=bool))
    ...     D = positions[j] - positions[i]
    ...     S = -np.round(D @ np.linalg.inv(cell)).astype(int) * pbc
    ...     near = np.linalg.norm(D + S @ cell, axis=1) < cutoff
    ...     return i[near], j[near], S[near]
    >>> result = contactbench.check_neighbours(nearest, cases=["half the cell"])
    >>> bool(result), result.failures[0].cause
    (False, 'only the nearest image of each pair is listed')
    """
    if not callable(f):
        raise ValueError("f is not a function; give one that takes positions, cell, pbc, cutoff")
    if division not in ("exact", "tolerant"):
        raise ValueError(f"division is {division!r}; give 'exact' or 'tolerant'")
    try:
        cutoffs = [float(cutoff) for cutoff in cutoffs]
    except (TypeError, ValueError):
        raise ValueError(f"cutoffs are {cutoffs!r}; give a sequence of numbers") from None
    if not cutoffs or not all(np.isfinite(c) and c > 0 for c in cutoffs):
        raise ValueError(f"cutoffs are {cutoffs}; give at least one positive number")
    if not 0 < call_seconds <= MOST_SECONDS:
        raise ValueError(
            f"call_seconds is {call_seconds:g}; give a number above 0, at most {MOST_SECONDS:g}"
        )
    if seconds is not None and not seconds >= 0:
        raise ValueError(f"seconds is {seconds:g}; give a number of at least 0")
    if seed < 0:
        raise ValueError(f"seed is {seed}; give a whole number of at least 0")
    if not (batch is None or isinstance(batch, bool) or callable(batch)):
        raise ValueError(f"batch is {batch!r}; give a function, or True if f takes batches")
    batched = batch is True
    batch = (f if batched else None) if isinstance(batch, bool) else batch
    chosen = chosen_cases(cases, batch is not None)
    started = time.monotonic()
    asker = Asker(f, refuses, division == "tolerant", ASE, call_seconds, batched=batched)
    trouble = ""
    if convention is None:
        found = recognised_convention(asker, batch)
        asker.convention, trouble = found.convention, found.trouble
    else:
        asker.convention = declared_convention(asker, convention, batch)
    function = name if name and ":" in name else function_name(f)
    run = _Run(asker, function, started, seconds)
    for case in [] if trouble else chosen:
        _log.info("%s", case.name)
        if batch is not None and case is BATCH:
            run.batches(BatchAsker(asker, batch), batches_of(cutoffs, quick, seed))
        else:
            run.case(case, systems_of(case, cutoffs, quick, seed))
    return NeighbourCheck(
        name or function.rpartition(":")[2],
        run.failures,
        run.compared,
        run.states,
        dict(run.refused),
        asker.convention,
        convention is None,
        trouble,
        division,
        asker.band,
        time.monotonic() - started,
    )


def recognised_convention(asker: Asker, batch: Callable[..., Any] | None) -> Recognised:
    """Find the convention that a function follows, and that of its batches."""
    found = recognise(asker.call, asker.refuses)
    if asker.batched and found.trouble:

        def by_offsets(system: System, convention: Convention) -> Any:
            return asker.call(system, replace(convention, systems="offsets"))

        other = recognise(by_offsets, asker.refuses)
        trouble = f"{found.trouble}; by offsets, {other.trouble}" if other.trouble else ""
        found = found if trouble else other
        systems: Literal["index", "offsets"] = "index" if trouble else "offsets"
        found = Recognised(replace(found.convention, systems=systems), trouble)
    if batch is not None and not found.trouble:
        found = Recognised(recognised(replace(asker, convention=found.convention), batch))
    return found


def declared_convention(
    asker: Asker, convention: Convention | str, batch: Callable[..., Any] | None
) -> Convention:
    """Return a declared convention. The form of batches is recognised if the text has none."""
    if not isinstance(convention, str):
        return convention
    made = Convention.parse(convention)
    if batch is None or "systems" in convention:
        return made
    return recognised(replace(asker, convention=made), batch)


def chosen_cases(names: Sequence[str] | None = None, batch: bool = False) -> list[Case]:
    """Return the hard cases with these names, or all."""
    every = [*CASES, *([BATCH] if batch else [])]
    known = {case.name: case for case in every}
    for name in names or ():
        if name not in known:
            raise ValueError(f"there is no case {name!r}; the cases are: {', '.join(known)}")
    return every if names is None else [known[name] for name in names]


def systems_of(case: Case, cutoffs: Sequence[float], quick: bool, seed: int) -> Iterator[System]:
    """Return the systems of a case, the same for every function."""
    for cutoff in cutoffs[:1] if quick else cutoffs:
        rng = np.random.default_rng([seed, zlib.crc32(case.name.encode())])
        for number, system in enumerate(case.systems(rng, float(cutoff))):
            if quick and number >= case.quick:
                break
            yield system


def function_name(f: Callable[..., Any]) -> str:
    """Return a function as module:name."""
    owner: Any = getattr(f, "__self__", None)
    if "__qualname__" in getattr(owner, "__dict__", {}):
        # `f` is a method of an adapter.
        return f"{owner.__module__}:{owner.__qualname__}.{f.__name__}"
    name = getattr(f, "__qualname__", None) or f"{type(f).__qualname__}()"
    return f"{getattr(f, '__module__', '')}:{name}"


class _Run:
    """The state of a check."""

    def __init__(self, asker: Asker, function: str, started: float, seconds: float | None) -> None:
        self.asker, self.function = asker, function
        self.end = None if seconds is None else started + seconds
        self.failures: list[NeighbourFailure] = []
        self.states: dict[str, str] = {}
        self.refused: Counter[str] = Counter()
        self.compared = 0

    def over(self) -> bool:
        return self.end is not None and time.monotonic() > self.end

    def case(self, case: Case, systems: Iterator[System]) -> None:
        """Try the systems of a case until one fails."""
        self._try(case, systems, self.asker.wrong, lambda *wrong: self._failure(case, *wrong))

    def batches(self, asker: BatchAsker, batches: Iterator[Batch]) -> None:
        """Try the batches until one fails."""
        self._try(BATCH, batches, asker.wrong, lambda *wrong: self._batch_failure(asker, *wrong))

    def _try(
        self,
        case: Case,
        given: Iterator[Given],
        wrong: Callable[[Given], Difference | None],
        failure: Callable[[Given, Difference], NeighbourFailure],
    ) -> None:
        state = ""
        for each in given:
            if self.over():
                state = "not tried"
                break
            try:
                found = wrong(each)
            except Refusal as why:
                self.refused[str(why)] += 1
                state = state or "refused"
                continue
            self.compared += 1
            state = "right"
            if found is not None:
                self.failures.append(failure(each, found))
                state = "wrong"
                break
        self.states[case.name] = state or "not tried"

    def _failure(self, case: Case, system: System, first: Difference) -> NeighbourFailure:
        """Reduce and explain a failing system."""
        asker, small, cause = self.asker, system, None
        found = wrong = _repeated(asker.wrong, system, first)
        if found.text != AGAIN and not _late(found) and len(self.failures) < REDUCED:
            small, wrong = _reduced(asker.wrong, system, shrink(asker.fails, system), found)
            pairs = [(system, found), (small, wrong)]
            cause = cause_of(asker, pairs[: 1 if small is system else 2])
        return NeighbourFailure(
            case.name, case.reason, system, found, small, wrong, cause, asker.convention,
            self.function, (small,) if asker.batched else (), asker.limit,
        )  # fmt: skip

    def _batch_failure(
        self, asker: BatchAsker, batch: Batch, first: Difference
    ) -> NeighbourFailure:
        """Reduce and explain a failing batch."""
        small, cause = batch, None
        found = wrong = _repeated(asker.wrong, batch, first)
        if found.text != AGAIN and not _late(found):
            mixed = across(batch, found)
            small = shrink_batch(lambda candidate: asker.fails(candidate, mixed), batch)
            small, wrong = _reduced(asker.wrong, batch, small, found)
            cause = cause_of_batch(asker, [(batch, found), (small, wrong)])
        return NeighbourFailure(
            BATCH.name, BATCH.reason, joined(batch), found, joined(small), wrong, cause,
            self.asker.convention, self.function if asker.asker.batched else function_name(asker.f),
            small,
        )  # fmt: skip


def _late(wrong: Difference) -> bool:
    """Return whether a call took too long. It is not repeated: it may be in time, or take long."""
    return wrong.text.startswith(HANGS)


def _repeated(
    wrong: Callable[[Given], Difference | None], given: Given, first: Difference
) -> Difference:
    """Return what a second call does wrong."""
    if _late(first):
        return first
    try:
        return wrong(given) or failed(AGAIN)
    except Refusal:
        return failed(AGAIN)


def _reduced(
    wrong: Callable[[Given], Difference | None], given: Given, small: Given, found: Difference
) -> tuple[Given, Difference]:
    """Return the reduced system or batch and what is wrong on it, if a repeated call shows it."""
    again = failed(AGAIN) if small is given else _repeated(wrong, small, found)
    return (given, found) if again.text == AGAIN else (small, again)
