"""Recognises the convention of a function by trying it on small systems."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from .asking import raised
from .compare import compare
from .convention import ASE, Convention, Malformed
from .systems import OPEN, System, system

Call = Callable[[System, Convention], Any]


@dataclass(frozen=True)
class Recognised:
    """The convention found, or the closest and how the answers differ from it."""

    convention: Convention
    trouble: str = ""


def probes() -> Iterator[tuple[str, System]]:
    """Return systems that tell conventions apart; simpler ones follow for lists that refuse."""
    # Atoms 0 to 3 are a row with the spacing of the cutoff, far from all faces.
    x = [
        [5, 5, 5], [9, 5, 5], [9, 9, 5], [6, 6, 7], [0.25, 1, 1.5], [13.5, 4, 2], [8, 14.5, 9],
        [12, 12.25, 13], [3, 13, 0.5], [1.5, 3.25, 12.25],
    ]  # fmt: skip
    yield "a skewed cell", system(x, [[14, 0, 0], [1.5, 15, 0], [-1, 2, 13]], 4)
    yield "a cell with right angles", system(x, [14, 15, 16], 4)
    yield "open space", system(x, [14, 15, 16], 4, OPEN)


def outside() -> System:
    """Return a system with atoms outside the cell, none of them on a face."""
    x = [[-3.25, 5, 5], [13, 5, 5.5], [9, 20, 5], [9, 3.25, 6], [27, 7, -13], [2, 6.5, 12.5]]
    return system(x, [14, 15, 13], 4)


def alone() -> System:
    """Return two atoms in a cell that is shorter than the cutoff along one axis."""
    return system([[1, 5, 5], [2.25, 6, 5]], [3, 15, 16], 4)


def _candidates(periodic: bool) -> Iterator[Convention]:
    """Return all conventions that differ in the cell, the default first."""
    thirds: list[dict[str, Any]] = [
        {"shifts": "S"},
        {"shifts": "S", "sign": -1},
        {"shifts": "vectors"},
        {"shifts": "vectors", "sign": -1},
        {"shifts": "none"},
    ]
    for layout, padding, cell, base, third, own, pairs, rule in product(
        ("flat", "rows", "columns", "matrix"),
        (False, True),
        ("rows", "columns") if periodic else ("rows",),
        (0, 1),
        thirds,
        (False, True),
        ("full", "half"),
        ("<", "<="),
    ):
        if layout == "matrix" and padding:
            continue
        yield replace(
            ASE, layout=layout, padding=padding, cell=cell, base=base, self_pairs=own,
            pairs=pairs, rule=rule, **third,
        )  # fmt: skip


def recognise(call: Call, refuses: tuple[type[BaseException], ...]) -> Recognised:
    """Find the convention in which the answers of a function are right."""
    for name, probe in probes():
        answers: dict[str, Any] = {}
        try:
            for cell in ("rows", "columns"):
                answers[cell] = call(probe, replace(ASE, cell=cell))
        except refuses:
            continue
        except Exception as error:
            return Recognised(ASE, f"on {name}: {raised(error)}{_line(error)}")
        found = _best(probe, answers, _candidates(any(probe.pbc)))
        if found.trouble:
            return Recognised(found.convention, f"on {name}: {found.trouble}")
        return _refined(call, found.convention) if any(probe.pbc) else found
    return Recognised(ASE)


def _line(error: Exception) -> str:
    """Return the line of the function under test that raised an error, in brackets."""
    for frame in traceback.extract_tb(error.__traceback__):
        file = Path(frame.filename)
        if file.parent != Path(__file__).parent:
            return f" ({file.name}, line {frame.lineno})"
    return ""


def _best(probe: System, answers: dict[str, Any], candidates: Iterator[Convention]) -> Recognised:
    """Return the convention with the fewest wrong rows, and what is wrong there."""
    best, convention, text = np.inf, ASE, "the answer is no list of pairs"
    for candidate in candidates:
        try:
            wrong, _ = compare(answers[candidate.cell], probe, candidate)
        except Malformed as error:
            if best == np.inf and candidate == ASE:
                text = str(error)
            continue
        if wrong is None:
            return Recognised(candidate)
        if wrong.wrong < best:
            best, convention, text = wrong.wrong, candidate, str(wrong)
    if best == np.inf:
        return Recognised(ASE, f"{text}; return three arrays: i, j and S")
    return Recognised(convention, f"{text}; the closest convention is: {convention}")


def _refined(call: Call, convention: Convention) -> Recognised:
    """Find what shows only outside the cell and in small cells; keep the default if unclear."""
    if convention.shifts == "S":
        convention = _chosen(call, outside(), convention, "wrapped", (False, True))
    if convention.shifts == "none":
        convention = _chosen(call, alone(), convention, "nearest", (False, True))
    if not convention.nearest:
        convention = _chosen(call, alone(), convention, "self_images", (True, False))
    return Recognised(convention)


def _chosen(
    call: Call, probe: System, convention: Convention, field: str, values: tuple[bool, bool]
) -> Convention:
    for value in values:
        change: dict[str, Any] = {field: value}
        candidate = replace(convention, **change)
        try:
            if compare(call(probe, candidate), probe, candidate)[0] is None:
                return candidate
        except Exception:  # noqa: BLE001 - the cases that follow report it
            continue
    return convention
