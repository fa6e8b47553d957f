"""Hard cases for neighbour lists, by what makes them hard.

`places` varies where atoms lie, `cells` the shape and size of the cell, `axes` which axes are
periodic, `calls` how the function is called, and `relations` moves systems that are known.
"""

from . import places, cells, axes, calls, relations  # noqa: I001 - the order of the table
from .table import CASES, Case

__all__ = ["CASES", "Case", "axes", "calls", "cells", "places", "relations"]
