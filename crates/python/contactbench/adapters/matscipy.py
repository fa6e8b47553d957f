"""matscipy.neighbours.neighbour_list: cells in C, in f64, for cells of any shape. Open vectors may
not be zero."""

from ._systems import fill


def prepare(positions, cell, pbc, cutoff):
    from matscipy.neighbours import neighbour_list

    if not len(positions):
        raise NotImplementedError("the library needs at least one atom")
    cell = fill(positions, cell, pbc, cutoff)
    system = {"positions": positions, "cell": cell, "pbc": pbc, "cutoff": cutoff}
    return lambda: neighbour_list("ijS", **system)
