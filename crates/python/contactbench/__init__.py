"""Which discs (2D) and spheres (3D) touch?

>>> import numpy as np
>>> import contactbench
>>> x = np.array([[0.0, 0.0], [1.0, 0.0], [5.0, 0.0]])
>>> pairs, images = contactbench.contacts(x, 0.5)
>>> pairs.tolist()
[[0, 1]]

Two particles touch when |xi - xj| <= ri + rj, decided exactly for the numbers given. All lengths are
in one unit, that of the coordinates. What cannot be answered is an exception with one sentence:
`ValueError` for what is wrong with the input, `Refused` (a `ValueError`) where a detector cannot
answer, `MemoryError` for what would take too much memory.

Arrays are read where they are, without a copy, if they are contiguous and of float64; the
interpreter's lock is released meanwhile, so no other thread may write to them until a call returns.
"""

from ._boxes import Box
from ._checking import Check, Failure, check
from ._contactbench import DETECTORS, Refused, __version__
from ._contacts import Detector, Verlet, contacts
from ._recommending import Recommendation, recommend
from ._records import load, provenance, scene
from ._verifying import Pairs, Verification, verify

__all__ = [
    "DETECTORS",
    "Box",
    "Check",
    "Detector",
    "Failure",
    "Pairs",
    "Recommendation",
    "Refused",
    "Verification",
    "Verlet",
    "__version__",
    "check",
    "contacts",
    "load",
    "provenance",
    "recommend",
    "scene",
    "verify",
]
