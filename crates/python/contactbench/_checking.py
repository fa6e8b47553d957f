"""Detectors in Python on small hard scenes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _contactbench as native
from ._boxes import whole


@dataclass(frozen=True)
class Failure:
    """A scene on which a detector is wrong.

    Attributes
    ----------
    x : ndarray of float64, shape (N, D)
        Centres of the smallest scene that was found on which it is still wrong.
    r : ndarray of float64, shape (N,)
        Its radii.
    wrong : str
        In which way it is wrong there; if it is right there (what it answers depends on what it was
        asked before), in which way it was at first.
    found_on : str
        The scene on which it was noticed.
    found : str
        In which way it was wrong there.
    given : tuple of ndarray
        Centres and radii of that scene.
    """

    x: npt.NDArray[np.float64]
    r: npt.NDArray[np.float64]
    wrong: str
    found_on: str
    found: str
    given: tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]

    def __str__(self) -> str:
        return (
            f"{self.found_on}: {self.found}\n"
            f"wrong on {len(self.x)} particles: {self.wrong}\n"
            f"x = {self.x.tolist()}\nr = {self.r.tolist()}"
        )


@dataclass(frozen=True)
class Check:
    """What `check` found. It is true if answers were compared and none was wrong.

    Attributes
    ----------
    failures : list of Failure
        The first scene on which the detector is wrong, or none: a check ends there.
    verdict : str
        ``right``, ``wrong``, or ``nothing`` where no answer was compared.
    cases : int
        Answers compared with the truth.
    scenes : dict
        Scenes by where they are from.
    refused : dict
        Scenes that were not asked about, or refused, by reason.
    cut : bool
        The time was over before all hard cases had been asked about.
    """

    failures: list[Failure]
    verdict: str
    cases: int
    scenes: dict[str, int]
    refused: dict[str, int]
    cut: bool

    def __bool__(self) -> bool:
        return self.verdict == "right"

    def __str__(self) -> str:
        if self.failures:
            return "\n".join(map(str, self.failures))
        if self.verdict == "nothing":
            return f"nothing was compared: {sum(self.refused.values())} scenes were refused"
        return f"right in {self.cases} cases" + (", and not all were asked" if self.cut else "")


def check(
    detector: Callable[[npt.NDArray[np.float64], npt.NDArray[np.float64]], Any],
    arithmetic: str = "exact",
    seconds: float = 6.0,
    name: str | None = None,
) -> Check:
    """Holds a function that finds contacts to the truth, on the small scenes of ``contactbench
    check``: every generator, the catalogue of hard cases, scenes that were once got wrong, random
    bytes. Where it is wrong, the scene is made as small and simple as it can be.

    Parameters
    ----------
    detector : callable
        ``detector(x, r)`` takes centres (N, D) and N radii, and gives pairs: an array of whole
        numbers (M, 2), or a set or list of pairs, in any order, each once. A `NotImplementedError`,
        `Refused` or `MemoryError` refuses the scene; any other exception is a failure. A detector
        that refuses every scene does not pass. Scenes in boxes are left out. A call that never
        returns is not noticed.
    arithmetic : str
        How contacts are to be decided: by the exact sign, or, of a detector that rounds, by one of
        the rounded tests of `contacts`.
    seconds : float
        No scene is begun after this time, once every generator has been asked for.
    name : str, optional
        What it is called in messages; by default the function's name.

    Examples
    --------
    A detector that leaves out pairs that touch in one point:

    >>> import contactbench
    >>> import numpy as np
    >>> def strict(x, r):
    ...     i, j = np.triu_indices(len(x), 1)
    ...     near = ((x[i] - x[j]) ** 2).sum(axis=1) < (r[i] + r[j]) ** 2
    ...     return np.column_stack([i[near], j[near]])
    >>> failure = contactbench.check(strict).failures[0]
    >>> len(failure.x)
    2
    """
    if not callable(detector):
        raise ValueError("detector is no function; give one that takes x and r")
    name = name or str(getattr(detector, "__name__", "detector"))

    def asked(x: npt.NDArray[np.float64], r: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
        return whole(detector(x, r), "what it returns", 2)

    found = native.check(asked, name, arithmetic, seconds)
    failures = [
        Failure(
            x=each["smallest"][0],
            r=each["smallest"][1],
            wrong=each["wrong"] or each["found"],
            found_on=each["found_on"],
            found=each["found"],
            given=each["given"],
        )
        for each in found.pop("failures")
    ]
    return Check(failures, **found)
