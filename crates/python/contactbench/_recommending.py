"""Recommends a detector for a scene."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from typing import Any

import numpy.typing as npt

from . import _contactbench as native
from ._boxes import BoxLike, arrays, count, limit

#: Loads only the native module, in a hundredth of the time of the package with NumPy, and serves as
#: a runner. Arguments: the module's file, and those of ``contactbench runner``.
_RUNNER = """
import signal, sys
from importlib.util import module_from_spec, spec_from_file_location
signal.signal(signal.SIGINT, signal.SIG_DFL)
spec = spec_from_file_location("_contactbench", sys.argv[1])
module = module_from_spec(spec)
spec.loader.exec_module(module)
given = dict(zip(sys.argv[3::2], sys.argv[4::2]))
detector, arithmetic = given["--detector"], given["--arithmetic"]
module.serve(detector, arithmetic, int(given["--threads"]), int(given["--memory-limit"]))
"""


@dataclass(frozen=True)
class Recommendation:
    """The outcome of `recommend`.

    Attributes
    ----------
    use : str or None
        The detector to pass to `contacts`; None if none gave a right answer in time.
    because : str or None
        The reason, with times and memory per particle.
    cannot_tell_apart : list of str
        Detectors whose difference from the fastest is undecided.
    detectors : list of dict
        All detectors measured, with ``detector``, ``outcome``, ``reason``, ``ns_per_particle``
        (median and 95% interval), ``ratio_to_fastest``, ``bytes_per_particle``, ...
    """

    use: str | None
    because: str | None
    cannot_tell_apart: list[str]
    detectors: list[dict[str, Any]]

    def __str__(self) -> str:
        return f"use {self.because}" if self.use else "use none: no detector was right in time"


def recommend(
    x: npt.ArrayLike,
    r: npt.ArrayLike,
    box: BoxLike | None = None,
    arithmetic: str = "exact",
    threads: int = 1,
    seconds: float = 10.0,
    memory_limit: int | None = None,
) -> Recommendation:
    """Measure all detectors on this scene and recommend one, like the command ``contactbench
    recommend``.

    Every answer is compared with the exact truth. Detectors are timed in separate processes, in
    blocks in random order, and compared by intervals. Detectors that are far slower drop out early.

    Parameters
    ----------
    x, r, box, arithmetic, threads
        As in `contacts`.
    seconds : float
        Time for the measurements, about. Computing the truth takes extra time.
    memory_limit : int, optional
        Limit in bytes for a detector's arrays. The default is that of `contacts`.

    Raises
    ------
    ValueError, MemoryError
        As `contacts`, and for a scene without particles.
    """
    program = [sys.executable, "-I", "-S", "-c", _RUNNER, str(native.__file__)]
    text = native.recommend(
        *arrays(x, r, box), arithmetic, count(threads, "threads", 1, 1024), seconds,
        limit(memory_limit), program,
    )  # fmt: skip
    said = json.loads(text)
    return Recommendation(
        said["use"], said["because"], said["cannot_tell_apart"] or [], said["detectors"]
    )
