"""vesin.NeighborList: cells in C++, in f64, for cells of any shape."""


def prepare(positions, cell, pbc, cutoff, half=False):
    from vesin import NeighborList

    search = NeighborList(cutoff=cutoff, full_list=not half)
    system = {"points": positions, "box": cell, "periodic": pbc, "quantities": "ijS"}
    return lambda: search.compute(**system, copy=True)
