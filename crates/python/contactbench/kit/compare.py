"""Compares an answer with the truth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .convention import Convention, Malformed, comparable, expected, read
from .systems import Rows, System


@dataclass(frozen=True)
class Difference:
    """How an answer differs from the truth, as rows (i, j, S) in the convention of ASE."""

    missing: Rows
    extra: Rows
    doubled: Rows
    #: The whole answer.
    answer: Rows
    #: Number of rows that the answer must hold.
    needed: int
    #: The widest rounding band; 0 in the exact division.
    band: float = 0.0
    #: The error, if the answer is no list of pairs.
    text: str = ""

    @property
    def wrong(self) -> int:
        """Number of wrong rows."""
        return len(self.missing) + len(self.extra) + len(self.doubled)

    def __str__(self) -> str:
        if self.text:
            return self.text
        counts = {"missing": self.missing, "extra": self.extra, "listed too often": self.doubled}
        found = ", ".join(f"{len(rows)} {name}" for name, rows in counts.items() if len(rows))
        return f"{found} of {self.needed} rows"


NONE = np.empty((0, 5), dtype=np.int64)


def failed(text: str) -> Difference:
    """Return the difference of an answer that cannot be compared."""
    return Difference(NONE, NONE, NONE, NONE, 0, text=text)


def compare(
    answer: Any,
    system: System,
    convention: Convention,
    tolerant: bool = False,
    either: Rows | None = None,
) -> tuple[Difference | None, float]:
    """Return how an answer differs from the truth (None if it does not), and the band.

    Pairs of the half list `either` may be listed or not.
    """
    try:
        listed = read(answer, system, convention)
    except Malformed:
        raise
    except Exception as error:
        raise Malformed(f"the answer cannot be read: {type(error).__name__}: {error}") from None
    needed, optional, width = expected(system, convention, tolerant, either)
    rows = comparable(listed, system, convention)
    return difference(rows, needed, optional, listed, width), width


def difference(
    listed: Rows, needed: Rows, optional: Rows, answer: Rows, width: float = 0.0
) -> Difference | None:
    """Compare rows with multiplicity; rows of `optional` may be listed or not."""
    if len(listed) == len(needed) == 0:
        return None
    every = np.vstack([needed, optional, listed])
    rows, which = np.unique(every, axis=0, return_inverse=True)
    which = np.ravel(which)
    ends = [len(needed), len(needed) + len(optional), len(every)]
    low, more, got = (
        np.bincount(which[start:end], minlength=len(rows))
        for start, end in zip([0, *ends], ends, strict=False)
    )
    over = got > low + more
    missing, extra, doubled = got < low, over & (low + more == 0), over & (low + more > 0)
    if not (missing | extra | doubled).any():
        return None
    return Difference(rows[missing], rows[extra], rows[doubled], answer, len(needed), width)
