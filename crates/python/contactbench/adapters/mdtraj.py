"""mdtraj.compute_neighborlist: cells in C++, in f32. It returns no shifts. Version 1.11.1 misses
pairs of atoms outside the cell: [[2, 3, 8], [3, 3, 3]] in a cube of 5, with the cutoff 1.7."""

import numpy as np

from ._systems import complete, require_lower, require_wide


def prepare(positions, cell, pbc, cutoff):
    import mdtraj

    if pbc.any() and not pbc.all():
        raise NotImplementedError("the library needs a cell that is periodic along all vectors")
    if not len(positions):
        raise NotImplementedError("the library needs at least one atom")
    frame = mdtraj.Trajectory(positions[None].astype("f4"), None)
    if pbc.all():
        cell, _ = complete(positions, cell, pbc, cutoff)
        require_lower(cell)
        require_wide(cell, cutoff)
        frame.unitcell_vectors = cell[None].astype("f4")

    def search():
        found = mdtraj.compute_neighborlist(frame, cutoff, periodic=bool(pbc.all()))
        i = np.repeat(np.arange(len(found)), [len(row) for row in found])
        return i, np.concatenate([[], *found]).astype(int), None

    return search
