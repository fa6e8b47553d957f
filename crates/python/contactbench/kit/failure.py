"""A failure of a neighbour list: the smallest system, what is wrong there, and how to see it."""

from __future__ import annotations

import re
import textwrap
from dataclasses import dataclass

import numpy as np

from .asking import division_of
from .compare import Difference
from .convention import Convention, expected_rows
from .systems import Rows, System
from .truth import distances, half_list

#: Pairs of each kind that are printed.
MOST = 6


@dataclass(frozen=True)
class NeighbourFailure:
    """A system on which a neighbour list is wrong.

    Attributes
    ----------
    case : str
        Name of the hard case.
    reason : str
        The mistake that the case looks for.
    given : System
        The first failing system of the case.
    found : Difference
        The error there.
    system : System
        The smallest failing system; `given` if it could not be reduced.
    wrong : Difference
        The error there: pairs that are missing, extra, or listed too often.
    cause : str or None
        The mistake that explains all wrong pairs.
    convention : Convention
        The convention in which the answer was read.
    function : str
        The function, as ``module:name``.
    batch : tuple of System
        The smallest batch of systems, for a function that takes batches.
    limit : str or None
        The keyword by which the function takes a capacity.
    """

    case: str
    reason: str
    given: System
    found: Difference
    system: System
    wrong: Difference
    cause: str | None
    convention: Convention
    function: str
    batch: tuple[System, ...] = ()
    limit: str | None = None

    @property
    def heading(self) -> str:
        """One line: the case, the size, and the error."""
        size = f"{len(self.system)} atom{'s' * (len(self.system) != 1)}"
        if len(self.batch) > 1:
            size += f" in {len(self.batch)} systems"
        return f"{self.case}: {self.wrong} ({size})"

    def __str__(self) -> str:
        lines = [self.heading]
        if self.cause:
            lines.append(f"  cause: {self.cause}")
        lines.append(f"  looks for: {self.reason}")
        note = f" ({self.given.note})" if self.given.note else ""
        if self.given is not self.system:
            lines.append(f"  reduced from {len(self.given)} atoms{note}: {self.found}")
        elif note:
            lines.append(f"  system:{note}")
        if self.wrong.band:
            lines.append(f"  rounding may decide pairs within {self.wrong.band:.3g} of the cutoff")
        text = "\n".join(textwrap.fill(line, 80, subsequent_indent="    ") for line in lines)
        return "\n".join([text, *self._pairs(), "", self.xyz(), self.program()])

    def _pairs(self) -> list[str]:
        lines = []
        for name in ("missing", "extra", "doubled"):
            rows: Rows = getattr(self.wrong, name)
            lines += [f"  {name}: {self._pair(row)}" for row in rows[:MOST]]
            if len(rows) > MOST:
                lines.append(f"  {name}: {len(rows) - MOST} more")
        return lines

    def _pair(self, row: Rows) -> str:
        """Return a pair with its shift and distance, or the reason why it has no distance."""
        pair = f"({row[0]}, {row[1]})"
        systems = self.batch or (self.system,)
        ends = np.cumsum([len(s) for s in systems])
        one, other = (int(k) for k in np.searchsorted(ends, row[:2], side="right"))
        if one != other:
            return f"{pair}, atoms of the systems {one} and {other}"
        if (np.abs(row[2:]) >= 2**32).any():
            return f"{pair}, fits no image"
        shift = f", S = {row[2:].tolist()}" if self.convention.shifts != "none" else ""
        start = ends[one] - len(systems[one])
        (d,) = distances(systems[one], (row - np.array([start, start, 0, 0, 0]))[None])
        return f"{pair}{shift}, distance {float(d)!r}"

    def xyz(self) -> str:
        """Return the smallest system as extended XYZ; one frame for each system of a batch."""
        return "".join(map(_frame, self.batch or (self.system,)))

    def program(self) -> str:
        """Return a program that shows the error; it needs NumPy and the library."""
        s, convention = self.system, self.convention
        module, _, name = self.function.partition(":")
        root = re.split(r"[.(\[]", name)[0]
        known = root.isidentifier() and "<" not in name and module not in ("", "__main__")
        name = name if known else "f"
        where = f"from {module} import {root}" if known else f"# f = {self.function}"
        kind = "" if s.dtype == "float64" else f", dtype=np.{s.dtype}"
        systems = self.batch or (s,)
        # Adding 0 removes the sign of -0.0.
        cells = [(b.cell.T if convention.cell == "columns" else b.cell) + 0.0 for b in systems]
        flags = [list(b.pbc) for b in systems]
        cell, pbc = ([c.tolist() for c in cells], flags) if self.batch else (cells[0].tolist(),
                                                                             flags[0])  # fmt: skip
        more = ""
        if self.batch:
            sizes = [len(b) for b in self.batch]
            offsets = division_of(sizes, convention).tolist()
            index = f"np.repeat(range({len(sizes)}), {sizes})"
            more = f", np.array({offsets})" if convention.systems == "offsets" else f", {index}"
        if self.limit and s.capacity is not None:
            more += f", {self.limit}={s.capacity}"
        step = "    " * (s.calls > 1)
        head = str(convention).split(", cell")[0]
        return "\n".join(
            [
                "import numpy as np",
                where,
                "",
                f"positions = np.array({(s.positions + 0.0).tolist()}{kind}).reshape(-1, 3)",
                *_LAYOUTS.get(s.memory, ()),
                f"cell = np.array({cell}{kind})",
                *([f"for _ in range({s.calls}):"] if s.calls > 1 else []),
                f"{step}answer = {name}(positions, cell, np.array({pbc}), {s.cutoff!r}{more})",
                f"{step}print(*answer, sep='\\n')",
                f"# Expected ({head}):",
                *_expected(systems, convention),
                "",
            ]
        )


#: Statements that give positions their layout in memory.
_LAYOUTS = {
    "F": ("positions = np.asfortranarray(positions)",),
    "strided": (
        "wide = np.full((2 * len(positions) + 1, 4), 7.0, dtype=positions.dtype)",
        "wide[:-1:2, :3] = positions",
        "positions = wide[:-1:2, :3]",
    ),
}


def _frame(s: System) -> str:
    lattice = " ".join(repr(float(value) + 0.0) for value in s.cell.flat)
    pbc = " ".join("FT"[on] for on in s.pbc)
    head = f'Lattice="{lattice}" pbc="{pbc}" Properties=species:S:1:pos:R:3 cutoff={s.cutoff!r}'
    atoms = [" ".join(["X", *(repr(float(value)) for value in x)]) for x in s.positions + 0.0]
    return "\n".join([str(len(s)), head, *atoms, ""])


def _expected(systems: tuple[System, ...], convention: Convention) -> list[str]:
    """Return comments with the rows of the right answer, at most 20."""
    lines: list[str] = []
    start: int = convention.base
    for s in systems:
        for i, j, *shifts in expected_rows(half_list(s, convention.rule), s, convention).tolist():
            third = f", S = {[convention.sign * k for k in shifts]}"
            lines.append(f"# ({i + start}, {j + start}){third * (convention.shifts == 'S')}")
        start += len(s)
    return (
        [*lines[:20], f"# and {len(lines) - 20} more"] if len(lines) > 20 else lines or ["# none"]
    )
