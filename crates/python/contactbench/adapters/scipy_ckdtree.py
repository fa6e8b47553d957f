"""scipy.spatial.cKDTree.query_pairs: a k-d tree in C++, in f64. It returns no shifts."""

import numpy as np

from ._systems import complete, require_edges, require_wide, wrap


def prepare(positions, cell, pbc, cutoff):
    from scipy.spatial import cKDTree

    places, edges = positions, None
    if pbc.any():
        cell, origin = complete(positions, cell, pbc, cutoff)
        edges = require_edges(cell)
        require_wide(cell, cutoff)
        places = wrap(positions, cell, pbc, np.zeros(3))
        # Rounding may put a coordinate on the upper face, which the library refuses.
        places = np.where(pbc & ((places >= edges) | (places < 0.0)), 0.0, places)
        edges = np.where(pbc, edges, 0.0)

    def search():
        tree = cKDTree(places, balanced_tree=False, compact_nodes=False, boxsize=edges)
        return (*tree.query_pairs(cutoff, output_type="ndarray").T, None)

    return search
