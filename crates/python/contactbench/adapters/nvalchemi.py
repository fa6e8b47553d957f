"""nvalchemiops.jax.neighbors, cell_list and naive_neighbor_list: Warp kernels called by JAX on the
CPU, in f64 (JAX is set to f64 for the whole process). The list is a padded matrix. Rows that exceed
`max_neighbors` are cut, so it grows until each row has a free place."""

import numpy as np

from ._systems import fill


def prepare(positions, cell, pbc, cutoff, method="cell_list"):
    cell = fill(positions, cell, pbc, cutoff)
    return _prepare(method, positions, cutoff, cell=cell[None], pbc=pbc[None])


def batch(positions, cells, pbcs, cutoff, offsets, method="cell_list"):
    own = np.split(positions, offsets[1:-1])
    cells = np.array([fill(*system, cutoff) for system in zip(own, cells, pbcs)])
    index = np.repeat(np.arange(len(cells)), np.diff(offsets)).astype(np.int32)
    systems = {"batch_idx": index, "batch_ptr": offsets.astype(np.int32)}
    search = _prepare(f"batch_{method}", positions, cutoff, cell=cells, pbc=pbcs, **systems)
    return search.listed(search())


def _prepare(method, positions, cutoff, **arrays):
    import jax

    jax.config.update("jax_enable_x64", True)
    from nvalchemiops.jax import neighbors

    arrays = {name: jax.numpy.asarray(array) for name, array in arrays.items()}
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
