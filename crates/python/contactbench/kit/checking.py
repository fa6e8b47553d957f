"""Holds a neighbour list to the truth on all hard cases."""

from __future__ import annotations

import logging
import time
import zlib
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from .asking import Asker
from .batches import BATCH, BatchAsker, batches, joined, shrink_batch
from .cases import CASES, Case
from .causes import cause_of
from .compare import failed
from .convention import Convention
from .failure import NeighbourFailure
from .recognise import recognise
from .result import NeighbourCheck
from .shrinking import shrink
from .systems import Refusal, System

_log = logging.getLogger(__name__)
#: Cutoffs of the systems, of the size of those of molecules in angstrom.
CUTOFFS = (5.0, 3.0)
#: The largest limit of a call that is accepted.
MOST_SECONDS = 1e6
#: Failures that are reduced and explained; the others are counted.
REDUCED = 8


def check_neighbours(
    f: Callable[..., Any],
    *,
    quick: bool = False,
    cutoffs: Sequence[float] = CUTOFFS,
    convention: Convention | str | None = None,
    division: Literal["exact", "tolerant"] = "exact",
    refuses: tuple[type[BaseException], ...] = (NotImplementedError,),
    batch: Callable[..., Any] | None = None,
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
        it is recognised by trying `f` on small systems, and printed.
    division : str
        ``exact``, or ``tolerant`` for lists that compute in float32: a pair is wrong only if it is
        farther from the cutoff than rounding explains. The band is printed.
    refuses : tuple of exceptions
        Exceptions by which `f` declines a system. These systems are counted and printed.
    batch : callable, optional
        ``batch(positions, cells, pbcs, cutoff, systems)`` lists the pairs of several systems at
        once. ``systems`` holds for each atom the number of its system, ``cells`` has the shape
        (B, 3, 3), and atoms are numbered across all systems.
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
    chosen = chosen_cases(cases, batch is not None)
    started = time.monotonic()
    asker = Asker(f, refuses, division == "tolerant", call_seconds=call_seconds)
    trouble = ""
    if convention is None:
        found = recognise(asker.call, refuses)
        asker.convention, trouble = found.convention, found.trouble
    else:
        asker.convention = (
            Convention.parse(convention) if isinstance(convention, str) else convention
        )
    function = name if name and ":" in name else function_name(f)
    run = _Run(asker, function, started, seconds)
    for case in [] if trouble else chosen:
        _log.info("%s", case.name)
        if batch is not None and case is BATCH:
            run.batches(BatchAsker(asker, batch), seed, cutoffs[0])
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
        state = ""
        for system in systems:
            if self.over():
                state = "not tried"
                break
            try:
                wrong = self.asker.wrong(system)
            except Refusal as why:
                self.refused[str(why)] += 1
                state = state or "refused"
                continue
            self.compared += 1
            state = "right"
            if wrong is not None:
                self.failures.append(self._failure(case, system))
                state = "wrong"
                break
        self.states[case.name] = state or "not tried"

    def _failure(self, case: Case, system: System) -> NeighbourFailure:
        """Reduce and explain a failing system."""
        asker, small, cause = self.asker, system, None
        found = asker.wrong(system)
        if found is None:
            found = failed("right when called again: the answer depends on earlier calls")
        elif len(self.failures) < REDUCED:
            small = shrink(asker.fails, system)
        wrong = (asker.wrong(small) or found) if small is not system else found
        if small is not system:
            cause = cause_of(asker, [(system, found), (small, wrong)])
        elif len(self.failures) < REDUCED:
            cause = cause_of(asker, [(system, found)])
        return NeighbourFailure(
            case.name, case.reason, system, found, small, wrong, cause, asker.convention,
            self.function, limit=asker.limit,
        )  # fmt: skip

    def batches(self, asker: BatchAsker, seed: int, cutoff: float) -> None:
        """Try the batches until one fails."""
        state = "right"
        for note, batch in batches(np.random.default_rng(seed), float(cutoff)):
            if self.over():
                state = "not tried"
                break
            try:
                found = asker.wrong(batch)
            except Refusal as why:
                self.refused[str(why)] += 1
                state = "refused"
                break
            self.compared += 1
            if found is not None:
                small = shrink_batch(asker, batch)
                wrong = asker.wrong(small) or found
                given = replace(joined(batch), note=note)
                self.failures.append(NeighbourFailure(
                    BATCH.name, BATCH.reason, given, found, joined(small), wrong, None,
                    self.asker.convention, function_name(asker.f), small,
                ))  # fmt: skip
                state = "wrong"
                break
        self.states[BATCH.name] = state
