"""A kit that holds neighbour lists to the exact truth.

`checking` runs the `cases`; `truth` decides them. `recognise` finds the `convention` of an answer,
`compare` finds wrong pairs, `causes` names the mistake, and `shrinking` reduces the system.
"""

from .checking import check_neighbours
from .convention import Convention
from .failure import NeighbourFailure
from .result import NeighbourCheck
from .systems import System
from .truth import truth

__all__ = [
    "Convention",
    "NeighbourCheck",
    "NeighbourFailure",
    "System",
    "check_neighbours",
    "truth",
]
