"""freud.locality, in f32: AABBQuery uses a tree of boxes, LinkCell cells as wide as the cutoff. The
default width of the cells depends on the number of points and fails if there are few. They return
no shifts."""

import numpy as np

from ._systems import complete, require_lower, require_wide, wrap


def prepare(positions, cell, pbc, cutoff, query="AABBQuery"):
    import freud

    if not len(positions):
        raise NotImplementedError("the library needs at least one point")
    cell, origin = complete(positions, cell, pbc, cutoff)
    require_lower(cell)
    require_wide(cell, cutoff)
    lx, ly, lz = np.diag(cell)
    box = freud.box.Box(lx, ly, lz, cell[1, 0] / ly, cell[2, 0] / lz, cell[2, 1] / lz)
    # The middle of freud's boxes is at the origin.
    places = wrap(positions, cell, pbc, origin) - cell.sum(axis=0) / 2
    places = box.wrap(places.astype("f4"))
    locality = getattr(freud.locality, query)
    width = {"cell_width": cutoff} if query == "LinkCell" else {}
    freud.parallel.set_num_threads(1)

    def search():
        found = locality(box, places, **width).query(places, {"r_max": cutoff, "exclude_ii": True})
        pairs = found.toNeighborList(sort_by_distance=False)
        return pairs.query_point_indices, pairs.point_indices, None

    return search
