"""nvalchemiops.jax.neighbors, cell_list and naive_neighbor_list: Warp kernels called by JAX on the
CPU, in f64 (JAX is set to f64 for the whole process). The list is a padded matrix. Rows that exceed
`max_neighbors` are cut, so it grows until each row has a free place."""

import numpy as np

from ._systems import fill


def prepare(positions, cell, pbc, cutoff, method="cell_list"):
    import jax

    jax.config.update("jax_enable_x64", True)
    from nvalchemiops.jax import neighbors

    cell = fill(positions, cell, pbc, cutoff)
    arrays = {"cell": jax.numpy.asarray(cell[None]), "pbc": jax.numpy.asarray(pbc[None])}
    places = jax.numpy.asarray(positions)
    capacity = 64

    def search():
        nonlocal capacity
        while True:
            call = getattr(neighbors, method)
            answer = call(places, cutoff, max_neighbors=capacity, **arrays)
            most = int(np.asarray(answer[1]).max(initial=0))
            if most < capacity:
                return [np.asarray(part) for part in answer]
            capacity = 2 * max(capacity, most)

    def listed(answer):
        matrix, count, shifts = answer
        filled = np.arange(matrix.shape[1]) < count[:, None]
        return np.nonzero(filled)[0], matrix[filled], shifts[filled]

    search.listed = listed
    return search
