"""scipy.spatial.cKDTree: a k-d tree in C++, which returns all pairs within a distance as one array.

It compares squares in f64 with `<=`. The tree is halved at the middle of its box
(`balanced_tree=False`), without tightened nodes, which its documentation calls the faster build.

Periodic boxes must have edges along the axes (`boxsize`). The library finds the nearest image of
each pair but does not return it. The images, and wrapped coordinates, are computed outside the
clock.
"""

from runner import np, serve, unavailable

try:
    import scipy
    from scipy.spatial import cKDTree
except ImportError as error:
    unavailable("scipy", "pip install scipy", error)


def prepare(scene):
    centres, edges = scene.centres, None
    if scene.box:
        # 0 marks an open axis.
        edges = np.where(scene.box.periodic, scene.box.edges(), 0.0)
        centres, _ = scene.box.wrapped(centres)
        # Rounding may put a coordinate outside the half-open box, which the library refuses.
        outside = (centres >= edges) | (centres < 0.0)
        centres = np.where(scene.box.periodic & outside, 0.0, centres)

    def detect():
        tree = cKDTree(centres, balanced_tree=False, compact_nodes=False, boxsize=edges)
        pairs = tree.query_pairs(scene.reach, output_type="ndarray")
        return pairs if scene.radii is None else scene.touching(pairs[:, 0], pairs[:, 1])

    return detect


serve("scipy-ckdtree", scipy.__version__, prepare, boxes=True)
