"""Which detector for a scene."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from typing import Any

import numpy.typing as npt

from . import _contactbench as native
from ._boxes import BoxLike, arrays, count, limit

#: Loads the native module alone, which takes a hundredth of the time of the package with NumPy, and
#: serves; the first argument is its file.
_RUNNER = """
import signal, sys
from importlib.util import module_from_spec, spec_from_file_location
signal.signal(signal.SIGINT, signal.SIG_DFL)
spec = spec_from_file_location("_contactbench", sys.argv[1])
module = module_from_spec(spec)
spec.loader.exec_module(module)
module.serve(sys.argv[2:])
"""


@dataclass(frozen=True)
class Recommendation:
    """The outcome of `recommend`.

    Attributes
    ----------
    use : str or None
        The detector to use, for `contacts`; None if none gave a right answer in time.
    because : str or None
        Why, with times and memory per particle.
    cannot_tell_apart : list of str
        Detectors that are neither slower nor faster for sure.
    detectors : list of dict
        All who were asked, with ``detector``, ``outcome``, ``reason``, ``ns_per_particle`` (median
        and 95% interval), ``ratio_to_fastest``, ``bytes_per_particle``, ...
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
    """Measures all detectors on this scene, and says which one to use; as the command
    ``contactbench recommend``.

    Every answer is held to the truth. Times are taken in processes of their own, in blocks in random
    order, and compared by intervals; detectors that are far behind drop out early.

    Parameters
    ----------
    x, r, box, arithmetic, threads
        As in `contacts`.
    seconds : float
        The measurements take about so long, besides finding the truth.
    memory_limit : int, optional
        Bytes for a detector's arrays; as in `contacts` if none is given.

    Raises
    ------
    ValueError, MemoryError
        As `contacts`; a scene without particles.
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
