"""ase.neighborlist.primitive_neighbor_list: cells in numpy, in f64."""


def prepare(positions, cell, pbc, cutoff):
    from ase.neighborlist import primitive_neighbor_list

    return lambda: primitive_neighbor_list("ijS", pbc, cell, positions, cutoff)
