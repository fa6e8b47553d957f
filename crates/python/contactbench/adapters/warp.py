"""warp.HashGrid on the CPU, in f32 (its default), without boxes. A query returns candidates; the
kernel tests their distances. It runs twice: to count each point's neighbours and to write them."""

from functools import cache

import numpy as np


@cache
def kernel():
    import warp as wp

    @wp.kernel
    def neighbours(
        grid: wp.uint64, x: wp.array(dtype=wp.vec3), r: float, starts: wp.array(dtype=int),
        counts: wp.array(dtype=int), js: wp.array(dtype=int), write: bool,
    ):
        i = wp.tid()
        count = int(0)
        for j in wp.hash_grid_query(grid, x[i], r):
            if j != i and wp.length_sq(x[j] - x[i]) < r * r:
                if write:
                    js[starts[i] + count] = j
                count += 1
        counts[i] = count

    return neighbours


def prepare(positions, cell, pbc, cutoff):
    import warp as wp

    if pbc.any():
        raise NotImplementedError("the library supports only open boxes")
    wp.config.quiet = True
    n = len(positions)
    places = wp.array(positions.astype("f4"), dtype=wp.vec3, device="cpu")
    search_kernel = kernel()
    grid = wp.HashGrid(64, 64, 64, device="cpu")

    def search():
        if n == 0:
            return [], [], None
        grid.build(places, cutoff)
        starts, counts, js = (wp.zeros(n, dtype=int, device="cpu") for _ in range(3))
        for write in (False, True):
            inputs = [grid.id, places, cutoff, starts, counts, js, write]
            wp.launch(search_kernel, n, inputs, device="cpu")
            found = counts.numpy()
            if not write:
                starts = wp.array(np.cumsum(found) - found, dtype=int, device="cpu")
                js = wp.zeros(max(int(found.sum()), 1), dtype=int, device="cpu")
        return np.repeat(np.arange(n), found), js.numpy()[: found.sum()], None

    return search
