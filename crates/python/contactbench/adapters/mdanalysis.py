"""MDAnalysis.lib.distances.self_capped_distance: cells ("nsgrid") in C++, in f32. It returns no
shifts. Without a box it makes one; here it always gets one, whose open sides have room."""

import numpy as np

from ._systems import complete, require_lower, require_wide, wrap


def prepare(positions, cell, pbc, cutoff):
    from MDAnalysis.lib.distances import self_capped_distance
    from MDAnalysis.lib.mdamath import triclinic_box

    if pbc.any() and not pbc.all():
        raise NotImplementedError("the library needs a cell that is periodic along all vectors")
    cell, origin = complete(positions, cell, pbc, cutoff)
    require_lower(cell)
    require_wide(cell, cutoff)
    box = triclinic_box(*cell.astype("f4"))
    places = wrap(positions, cell, pbc, origin).astype("f4")
    options = {"box": box, "method": "nsgrid", "return_distances": False}

    def search():
        if len(places) < 2:
            return [], [], None
        return (*self_capped_distance(places, cutoff, **options).T, None)

    return search
