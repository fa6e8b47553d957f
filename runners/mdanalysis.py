"""MDAnalysis.lib.distances.self_capped_distance: all pairs of points within a distance, by cells ('nsgrid') or a k-d tree ('pkdtree').

The library computes in single precision: wrong answers are to be expected where elements touch nearly. It knows only space: in 2D z is 0. Coordinates are
converted to f32 once, outside the clock. Usage: mdanalysis.py nsgrid|pkdtree
"""

import sys

from runner import serve, unavailable

try:
    import MDAnalysis
    from MDAnalysis.lib.distances import self_capped_distance
except ImportError as error:
    unavailable("MDAnalysis", "pip install MDAnalysis", error)

method = sys.argv[1] if len(sys.argv) > 1 else "nsgrid"


def prepare(scene):
    points = scene.in_space().astype("f4")

    def detect():
        if scene.n < 2 or scene.reach == 0.0:
            return points[:0, :2].astype("u4")
        pairs = self_capped_distance(points, scene.reach, method=method, return_distances=False)
        return pairs if scene.radii is None else scene.touching(pairs[:, 0], pairs[:, 1])

    return detect


serve(f"mdanalysis-{method}", MDAnalysis.__version__, prepare)
