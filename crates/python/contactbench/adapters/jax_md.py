"""jax_md.partition.neighbor_list: cells in JAX, set to f64 for the whole process. The sides
of its boxes are f32. The library grows its capacity itself. It returns no shifts."""

import numpy as np

from ._systems import complete, require_edges, require_wide, wrap


def prepare(positions, cell, pbc, cutoff):
    import jax

    jax.config.update("jax_enable_x64", True)
    from jax_md import partition, space

    if len(positions) < 2:
        raise NotImplementedError("the library needs at least two particles")
    cell, origin = complete(positions, cell, pbc, cutoff)
    edges = require_edges(cell)
    require_wide(cell, cutoff)
    if pbc.any() and not pbc.all():
        raise NotImplementedError("the library needs a cell that is periodic along all vectors")
    places = wrap(positions, cell, pbc, origin) if pbc.any() else positions - origin
    displacement, _ = space.periodic(edges) if pbc.any() else space.free()
    lists = partition.neighbor_list(
        displacement, edges, cutoff, format=partition.NeighborListFormat.Sparse
    )

    def search():
        receivers, senders = np.asarray(lists.allocate(places).idx)
        real = receivers < len(places)
        return senders[real], receivers[real], None

    return search
