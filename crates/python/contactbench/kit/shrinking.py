"""Makes a failing system as small and simple as possible."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from .systems import System


def shrink(fails: Callable[[System], bool], system: System, seconds: float = 4.0) -> System:
    """Return a smaller system that fails, or the system itself if none was found."""
    end = time.monotonic() + seconds

    def still(candidate: System) -> bool:
        return (
            time.monotonic() < end
            and (candidate is system or candidate.modest())
            and fails(candidate)
        )

    if not still(system):  # The answer depends on earlier calls.
        return system
    system = _fewer(still, system)
    changed = True
    while changed and time.monotonic() < end:
        changed = False
        for simpler in _simpler(system):
            if still(simpler):
                system, changed = simpler, True
                break
    return _fewer(still, system)


def _fewer(still: Callable[[System], bool], system: System) -> System:
    """Drop atoms, first halves, then smaller parts, then each."""
    part = max(1, len(system) // 2)
    while len(system) > 0:
        start, dropped = 0, False
        while start < len(system):
            kept = np.delete(system.positions, slice(start, start + part), axis=0)
            smaller = replace(system, positions=kept)
            if still(smaller):
                system, dropped = smaller, True
            else:
                start += part
        if part > 1:
            part = max(1, part // 2)
        elif not dropped:
            break
    return system


def _simpler(system: System) -> Iterator[System]:
    """Return systems that are simpler in one respect; only such that differ."""
    if system.calls > 1:
        yield replace(system, calls=1)
    if system.dtype != "float64":
        yield replace(system, dtype="float64")
    if system.memory != "C":
        yield replace(system, memory="C")
    cell, x = system.cell, system.positions
    for axis in range(3):
        if system.pbc[axis]:
            pbc = tuple(on and k != axis for k, on in enumerate(system.pbc))
            yield replace(system, pbc=(pbc[0], pbc[1], pbc[2]))
    for row in range(3):
        for column in range(3):
            if row != column and cell[row, column] != 0:
                flat = cell.copy()
                flat[row, column] = 0
                yield replace(system, cell=flat)
    if len(x) and x[0].any():
        yield replace(system, positions=x - x[0])
    for digits in (0, 1, 2, 3):
        rounded = np.round(cell, digits)
        if not np.array_equal(rounded, cell):
            yield replace(system, cell=rounded)
        limit = round(system.cutoff, digits)
        if limit not in (0, system.cutoff):
            yield replace(system, cutoff=limit)
        rounded = np.round(x, digits) + 0.0
        if not np.array_equal(rounded, x):
            yield replace(system, positions=rounded)
    for atom, axis in np.argwhere(x != 0):
        for value in (0.0, *(round(float(x[atom, axis]), digits) for digits in (0, 1, 2, 3))):
            if value != x[atom, axis] and len(str(value)) < len(str(float(x[atom, axis]))):
                moved = x.copy()
                moved[atom, axis] = value
                yield replace(system, positions=moved)
