"""Checks detectors written in Python on small hard scenes."""

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
        Centres of the smallest failing scene found.
    r : ndarray of float64, shape (N,)
        Radii of that scene.
    wrong : str
        The error on that scene. If the detector is right there (its answers depend on earlier
        calls), the error on the first failing scene.
    found_on : str
        Name of the first failing scene.
    found : str
        The error on the first failing scene.
    given : tuple of ndarray
        Centres and radii of the first failing scene.
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
    """The outcome of `check`. It is true if answers were compared and none was wrong.

    Attributes
    ----------
    failures : list of Failure
        At most one: the check ends at the first failing scene.
    verdict : str
        ``right``, ``wrong``, or ``nothing`` if no answer was compared.
    cases : int
        Number of answers compared with the truth.
    scenes : dict
        Number of scenes by origin.
    refused : dict
        Number of scenes that were skipped or refused, by reason.
    cut : bool
        Whether the time was over before all hard cases were tried.
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
        return f"right in {self.cases} cases" + ("; not all were tried" if self.cut else "")


def check(
    detector: Callable[[npt.NDArray[np.float64], npt.NDArray[np.float64]], Any],
    arithmetic: str = "exact",
    seconds: float = 6.0,
    name: str | None = None,
) -> Check:
    """Compare a function that finds contacts with the truth, on the small scenes of ``contactbench
    check``: every generator, the hard cases, scenes that once failed, and random bytes. A failing
    scene is made as small and simple as possible.

    Parameters
    ----------
    detector : callable
        ``detector(x, r)`` takes centres (N, D) and N radii, and returns pairs: an array of whole
        numbers (M, 2), or a set or list of pairs, in any order, each once. A `NotImplementedError`,
        `Refused` or `MemoryError` refuses the scene; any other exception is a failure. A detector
        that refuses every scene does not pass. Scenes are in open space. There is no time limit for
        a call.
    arithmetic : str
        How contacts must be decided: exactly or, for a detector that rounds, by one of the rounded
        tests of `contacts`.
    seconds : float
        No scene begins after this time, but every generator is tried.
    name : str, optional
        The detector's name in messages; by default the function's name.

    Examples
    --------
    A detector that misses pairs that touch in one point:

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
        raise ValueError("detector is not a function; give one that takes x and r")
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
    verdict = "wrong" if failures else "right" if found["cases"] else "nothing"
    return Check(failures, verdict, **found)
