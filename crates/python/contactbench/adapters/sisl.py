"""sisl.geom.NeighborFinder: bins in numpy and Cython, in f64. It refuses atoms outside the cell."""

from ._systems import complete


def prepare(positions, cell, pbc, cutoff):
    import sisl

    if not len(positions):
        raise NotImplementedError("the library needs at least one atom")
    cell, origin = complete(positions, cell, pbc, cutoff)
    lattice = sisl.Lattice(cell, boundary_condition=["periodic" if p else "open" for p in pbc])
    geometry = sisl.Geometry(positions - origin, lattice=lattice)
    if ((geometry.fxyz < -1e-8) | (geometry.fxyz > 1 + 1e-8)).any():
        raise NotImplementedError("the library needs all atoms in the cell")

    def search():
        found = sisl.geom.NeighborFinder(geometry, R=cutoff).find_neighbors()
        return found.I, found.J, found.isc

    return search
