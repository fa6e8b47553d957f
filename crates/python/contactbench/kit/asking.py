"""Calls the function under test and judges its answers."""

from __future__ import annotations

import faulthandler
import inspect
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

import numpy as np

from .compare import Difference, compare, failed
from .convention import ASE, Convention, Malformed
from .systems import Refusal, Rows, System
from .truth import half_list, undecided

#: Names under which functions take a limit for the neighbours of an atom.
LIMITS = ("max_neighbours", "max_neighbors", "max_num_neighbors")

#: Start of the error message of a function that writes to its arguments.
CHANGES = "it changes its argument"
#: Start of the error message of a call that takes too long.
HANGS = "no answer after"


class Hang(Exception):
    """A call that has not returned in time."""


#: Whether to end the process if compiled code does not return; the command line sets it.
END_PROCESS = False


@contextmanager
def deadline(seconds: float) -> Iterator[None]:
    """Raise `Hang` in this block after some time: in Python code, in the main thread, on Unix."""
    main = threading.current_thread() is threading.main_thread()
    if not (main and hasattr(signal, "setitimer")):
        yield
        return
    if END_PROCESS:
        faulthandler.dump_traceback_later(seconds + 2, exit=True)

    def ring(signum: int, frame: FrameType | None) -> None:
        raise Hang(f"{HANGS} {seconds:g} s, the limit call_seconds")

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
        if END_PROCESS:
            faulthandler.cancel_dump_traceback_later()


def called(
    f: Callable[..., Any],
    seconds: float,
    refuses: tuple[type[BaseException], ...],
    arguments: tuple[Any, ...],
    more: dict[str, Any] | None = None,
) -> Any:
    """Call a function. What it raises is an `Exception`, one of `refuses`, or KeyboardInterrupt.

    Raises `Malformed` if the function changes an argument.
    """
    kept: tuple[type[BaseException], ...] = (Exception, KeyboardInterrupt, *refuses)
    before = [np.copy(value) for value in arguments]
    with deadline(seconds):
        try:
            answer = f(*arguments, **(more or {}))
        except kept:
            raise
        except BaseException as error:
            # SystemExit, or a panic of Rust. It must not end the check.
            kind: type[Exception] = type(type(error).__name__, (Exception,), {})
            raise kind(str(error)) from None
    names = ("positions", "cell", "pbc", "cutoff", "systems")
    for name, old, new in zip(names, before, arguments, strict=False):
        if not np.array_equal(old, new):
            raise Malformed(f"{CHANGES} {name}")
    return answer


def raised(error: Exception) -> str:
    """Return in words what an exception means."""
    named = isinstance(error, (Hang, Malformed))
    return str(error) if named else f"it raises {type(error).__name__}: {error}"


def division_of(sizes: Sequence[int], convention: Convention) -> Rows:
    """Return the last argument of a batch: numbers or offsets of systems of these sizes."""
    if convention.systems == "offsets":
        return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    return np.repeat(np.arange(len(sizes)), sizes)


def limit_of(f: Callable[..., Any]) -> str | None:
    """Return the keyword by which a function takes a capacity, or None."""
    try:
        parameters = inspect.signature(f).parameters
    except (TypeError, ValueError):
        return None
    return next((name for name in LIMITS if name in parameters), None)


@dataclass
class Asker:
    """A function under test, its convention, and how its answers are judged.

    If the function takes batches, a single system is passed as a batch of one.
    """

    f: Callable[..., Any]
    refuses: tuple[type[BaseException], ...] = (NotImplementedError,)
    tolerant: bool = False
    convention: Convention = ASE
    call_seconds: float = 30.0
    batched: bool = False
    band: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        self.limit = limit_of(self.f)

    def call(self, system: System, convention: Convention) -> Any:
        """Return the answer of the function; raise what it raises."""
        x, cell, pbc, cutoff = system.given()
        if convention.cell == "columns":
            cell = np.ascontiguousarray(cell.T)
        more: dict[str, Any] = {}
        if system.capacity is not None and self.limit is not None:
            more[self.limit] = system.capacity
        arguments: tuple[Any, ...] = (x, cell, pbc, cutoff)
        if self.batched:
            division = division_of([len(x)], convention)
            arguments = (x, cell[None], pbc[None], cutoff, division)
        return called(self.f, self.call_seconds, self.refuses, arguments, more)

    def wrong(self, system: System) -> Difference | None:
        """Return what is wrong on a system, or None; raise `Refusal` if it cannot be judged."""
        exceeded = False
        if system.capacity is not None:
            if self.limit is None:
                raise Refusal(f"the function has no parameter {LIMITS[0]}")
            counts = np.bincount(half_list(system)[:, :2].ravel(), minlength=len(system))
            exceeded = int(counts.max(initial=0)) > system.capacity
        tolerant = self.tolerant or system.dtype == "float32"
        for k in range(system.calls):
            try:
                answer = self.call(system, self.convention)
                found, width = compare(answer, system, self.convention, tolerant)
                self.band = max(self.band, width)
                if found is not None and not tolerant:
                    either = undecided(system)
                    if len(either):
                        found, _ = compare(answer, system, self.convention, either=either)
            except Refusal:
                raise
            except self.refuses as why:
                raise Refusal(f"{type(why).__name__}: {why}") from None
            except Malformed as why:
                found = failed(str(why))
            except Exception as error:
                if exceeded:
                    return None
                if system.optional and not isinstance(error, Hang):
                    text = f"{type(error).__name__}: {error}"
                    raise Refusal(f"{text} (allowed if a vector of the cell is 0)") from None
                found = failed(raised(error))
            if found is not None:
                if k > 0:
                    return failed(f"call {k + 1} differs from the calls before: {found}")
                return found
        return None

    def fails(self, system: System) -> bool:
        """Return whether the function is wrong on a system; not if it refuses."""
        try:
            return self.wrong(system) is not None
        except (Refusal, MemoryError):
            return False
