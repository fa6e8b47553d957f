"""contactbench.neighbours: `streamed-nbs`, decided exactly, for cells of any shape."""


def prepare(positions, cell, pbc, cutoff):
    from ..neighbours import neighbour_list

    return lambda: neighbour_list("ijS", positions, cell, pbc, cutoff)
