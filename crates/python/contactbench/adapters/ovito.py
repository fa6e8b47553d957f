"""ovito.data.CutoffNeighborFinder: cells in C++, in f64. It returns vectors, from which shifts
follow. A particle and its own image are not in its list."""

import numpy as np

from ._systems import fill


def prepare(positions, cell, pbc, cutoff):
    from ovito.data import CutoffNeighborFinder, DataCollection

    cell = fill(positions, cell, pbc, cutoff)
    data = DataCollection()
    data.create_cell(np.column_stack([cell.T, np.zeros(3)]), [bool(p) for p in pbc])
    data.create_particles(count=len(positions)).create_property("Position", data=positions)
    inverse = np.linalg.inv(cell)

    def search():
        try:
            pairs, vectors = CutoffNeighborFinder(cutoff, data).find_all()
        except RuntimeError as error:  # The cutoff is too large for the cell.
            raise NotImplementedError(str(error)) from error
        i, j = pairs.T
        return i, j, np.rint((vectors - positions[j] + positions[i]) @ inverse)

    return search
