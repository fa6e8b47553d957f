"""Find the discs (2D) or spheres (3D) that touch.

>>> import numpy as np
>>> import contactbench
>>> x = np.array([[0.0, 0.0], [1.0, 0.0], [5.0, 0.0]])
>>> pairs, images = contactbench.contacts(x, 0.5)
>>> pairs.tolist()
[[0, 1]]

Two particles touch if |xi - xj| <= ri + rj, decided exactly for the given numbers. All lengths
have the unit of the coordinates. Calls raise `ValueError` for invalid input, `Refused` (a
`ValueError`) if a detector cannot answer, and `MemoryError` if an answer needs too much memory.

Contiguous arrays of float64 are read in place, except by long calls in the main thread, which read
a copy. The interpreter's lock is released meanwhile, so no other thread may write to the arrays
until a call returns.
"""

from . import neighbours
from ._boxes import Box
from ._checking import Check, Failure, check
from ._contactbench import DETECTORS, Refused, __version__
from ._contacts import Detector, Verlet, contacts
from ._recommending import Recommendation, recommend
from ._records import load, provenance, scene
from ._verifying import Pairs, Verification, verify
from .kit import Convention, NeighbourCheck, NeighbourFailure, check_neighbours

__all__ = [
    "DETECTORS",
    "Box",
    "Check",
    "Convention",
    "Detector",
    "Failure",
    "NeighbourCheck",
    "NeighbourFailure",
    "Pairs",
    "Recommendation",
    "Refused",
    "Verification",
    "Verlet",
    "__version__",
    "check",
    "check_neighbours",
    "contacts",
    "load",
    "neighbours",
    "provenance",
    "recommend",
    "scene",
    "verify",
]
