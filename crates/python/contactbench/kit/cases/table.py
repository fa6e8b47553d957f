"""The table of hard cases."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ..systems import Random, System

Maker = Callable[[Random, float], Iterator[System]]


@dataclass(frozen=True)
class Case:
    """A hard case."""

    name: str
    #: The mistake that it finds, with a thread in which it was reported.
    reason: str
    systems: Maker
    #: Number of systems tried if the check is quick.
    quick: int


CASES: list[Case] = []


def case(name: str, quick: int = 2) -> Callable[[Maker], Maker]:
    """Enter a function in the table; the first line of its docstring is the reason."""

    def enter(maker: Maker) -> Maker:
        reason = (maker.__doc__ or "").strip().splitlines()[0]
        CASES.append(Case(name, reason, maker, quick))
        return maker

    return enter
