"""matscipy_neighbours.neighbour_list: the list of matscipy as a library of its own."""

from ._systems import fill


def prepare(positions, cell, pbc, cutoff):
    from matscipy_neighbours import neighbour_list

    cell = fill(positions, cell, pbc, cutoff)
    system = {"positions": positions, "cell": cell, "pbc": pbc, "cutoff": cutoff, "device": "cpu"}
    return lambda: neighbour_list("ijS", **system)
