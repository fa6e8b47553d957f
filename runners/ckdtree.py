"""scipy.spatial.cKDTree: a k-d tree in C++, and all pairs of it within a distance, as one array.

In f64 and by squares, closed. The tree is built by halving at the middle of the box (`balanced_tree=False`) without tightened nodes, which the documentation
names as the faster way to build.

In a box it knows edges along the axes (`boxsize`), and of each pair the nearest image; it does not say which, and that is added outside the clock. Coordinates
are wrapped once, outside the clock.
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
        # 0 is an axis that is open.
        edges = np.where(scene.box.periodic, scene.box.edges(), 0.0)
        centres, _ = scene.box.wrapped(centres)
        # Rounded, a place may be at the far face, or before the near one, which the library refuses.
        outside = (centres >= edges) | (centres < 0.0)
        centres = np.where(scene.box.periodic & outside, 0.0, centres)

    def detect():
        tree = cKDTree(centres, balanced_tree=False, compact_nodes=False, boxsize=edges)
        pairs = tree.query_pairs(scene.reach, output_type="ndarray")
        return pairs if scene.radii is None else scene.touching(pairs[:, 0], pairs[:, 1])

    return detect


serve("scipy-ckdtree", scipy.__version__, prepare, boxes=True)
