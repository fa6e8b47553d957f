"""MDAnalysis.lib.distances.self_capped_distance: all pairs of points within a distance, by cells ('nsgrid').

The library computes in single precision: wrong answers are to be expected where particles nearly touch. It knows only space: in 2D z is 0. It is given a periodic
box, larger than the scene by three times the distance, so that no image is near: without one it makes one of its own, which has no depth in 2D and then
takes a thousand times as long. A box that repeats along all three axes is given to it as lengths and angles; it
knows of each pair the nearest image and does not say which: that is added outside the clock. Coordinates are shifted into the box and converted to f32 once, outside the clock.
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
            raise Refusal("MDAnalysis knows boxes that repeat along all of three vectors only")
        if np.count_nonzero(np.triu(scene.box.vectors, 1)):
            raise Refusal("MDAnalysis turns boxes whose vectors are not a lower triangle")
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
