"""MDAnalysis.lib.distances.self_capped_distance: all pairs within a distance, by cells ('nsgrid').

The library computes in single precision, so expect wrong answers if particles nearly touch. It
supports only 3D: in 2D z is 0. For open space it gets a periodic box that exceeds the scene by
three times the distance, so that no image is near. (Otherwise it makes a box itself. In 2D that box
has no depth, and the search takes a thousand times as long.)

A box must be periodic along all three vectors; the library gets its lengths and angles. It finds
the nearest image of each pair but does not return it; the images are added outside the clock.
Coordinates are shifted into the box and converted to f32 once, outside the clock.
"""

from runner import Refusal, np, serve, unavailable

try:
    import MDAnalysis
    from MDAnalysis.lib.distances import self_capped_distance
    from MDAnalysis.lib.mdamath import triclinic_box
except ImportError as error:
    unavailable("MDAnalysis", "pip install MDAnalysis", error)


def prepare(scene):
    points = scene.in_space()
    low, high = (points.min(axis=0), points.max(axis=0)) if scene.n else (np.zeros(3), np.zeros(3))
    if scene.reach == 0.0:
        raise Refusal("MDAnalysis needs a distance above 0")
    box = np.array([*(high - low + 3.0 * scene.reach), 90.0, 90.0, 90.0], "f4")
    if scene.box:
        if scene.dim == 2 or not scene.box.periodic.all():
            raise Refusal("MDAnalysis supports only boxes that are periodic along all three vectors")
        if np.count_nonzero(np.triu(scene.box.vectors, 1)):
            raise Refusal("MDAnalysis rotates boxes whose vectors do not form a lower triangle")
        scene.box.holds(scene.reach)
        box = triclinic_box(*scene.box.vectors.astype("f4"))
        points, _ = scene.box.wrapped(points)
        points = points.astype("f4")
    else:
        points = (points - low + 1.5 * scene.reach).astype("f4")

    def detect():
        if scene.n < 2:
            return np.zeros((0, 2), "u4")
        pairs = self_capped_distance(points, scene.reach, box=box, method="nsgrid", return_distances=False)
        return pairs if scene.radii is None else scene.touching(pairs[:, 0], pairs[:, 1])

    return detect


serve("mdanalysis-nsgrid", MDAnalysis.__version__, prepare, boxes=True)
