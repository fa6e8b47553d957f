"""pymatgen.optimization.neighbors.find_points_in_spheres: cells in Cython, in f64. An atom is its
own neighbour in that list; it is removed here. `tol` widens the cutoff, so it is set to 0. Version
2026.10.24 corrupts memory in some cells smaller than the cutoff, so a process may abort."""

import numpy as np

from ._systems import fill


def prepare(positions, cell, pbc, cutoff):
    from pymatgen.optimization.neighbors import find_points_in_spheres

    if not len(positions):
        raise NotImplementedError("the library needs at least one atom")
    cell = fill(positions, cell, pbc, cutoff)
    system = {"r": cutoff, "pbc": pbc.astype(np.int64), "lattice": cell, "tol": 0.0}

    def search():
        i, j, S, _ = find_points_in_spheres(positions, positions, **system)
        other = (i != j) | S.any(axis=1)
        return i[other], j[other], S[other]

    return search
