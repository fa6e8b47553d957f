"""contactbench.neighbours: `streamed-nbs`, decided exactly, for cells of any shape."""


def prepare(positions, cell, pbc, cutoff, half=False):
    # Found also by runners that import the adapters without the package around them.
    from contactbench.neighbours import neighbour_list

    return lambda: neighbour_list("ijS", positions, cell, pbc, cutoff, half=half)
