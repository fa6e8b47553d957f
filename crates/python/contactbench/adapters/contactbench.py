"""contactbench.neighbours: `streamed-nbs`, decided exactly, for cells of any shape."""


def prepare(positions, cell, pbc, cutoff, half=False):
    # Found also by runners that import the adapters without the package around them.
    from contactbench.neighbours import neighbour_list

    return lambda: neighbour_list("ijS", positions, cell, pbc, cutoff, half=half)


def batch(positions, cells, pbcs, cutoff, offsets, half=False):
    from contactbench.neighbours import batch_neighbour_list

    found = batch_neighbour_list("ijS", positions, offsets, cells, pbcs, cutoff, half=half)
    return found[:3]
