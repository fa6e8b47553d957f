"""scipy.spatial.cKDTree: a k-d tree in C++, and all pairs of it within a distance, as one array.

In f64 and by squares, closed. The tree is built by halving at the middle of the box (`balanced_tree=False`) without tightened nodes, which the documentation
names as the faster way to build.
"""

from runner import serve, unavailable

try:
    import scipy
    from scipy.spatial import cKDTree
except ImportError as error:
    unavailable("scipy", "pip install scipy", error)


def prepare(scene):
    def detect():
        tree = cKDTree(scene.centres, balanced_tree=False, compact_nodes=False)
        pairs = tree.query_pairs(scene.reach, output_type="ndarray")
        return pairs if scene.radii is None else scene.touching(pairs[:, 0], pairs[:, 1])

    return detect


serve("scipy-ckdtree", scipy.__version__, prepare)
