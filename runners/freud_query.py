"""freud.locality.AABBQuery: all pairs of points within a distance, by a tree of boxes.

The library computes in single precision and needs a periodic box. For open space this box exceeds
the scene by three times the distance, so that no image is near. In 2D it is flat. Coordinates are
shifted to its middle and converted to f32 once, outside the clock. The neighbour list has each pair
twice; one is kept.

Periodic boxes may have any shape. The library finds the nearest image of each pair but does not
return it; the images are added outside the clock. Its other method, LinkCell, is not measured: it
took 250 us per particle at N = 10^4, a hundred times as long.
"""

from runner import Refusal, np, serve, unavailable

try:
    import freud
except ImportError as error:
    unavailable("freud", "pip install freud-analysis", error)

freud.parallel.set_num_threads(1)


def prepare(scene):
    points = scene.in_space()
    low, high = points.min(axis=0, initial=np.inf), points.max(axis=0, initial=-np.inf)
    points = (points - (low + high) / 2).astype("f4") if scene.n else points.astype("f4")
    edges = (np.maximum(high - low, 0.0) if scene.n else np.zeros(3)) + 3.0 * scene.reach
    if scene.n == 0 or scene.reach == 0.0 or not np.isfinite(edges).all():
        raise Refusal("freud needs points, a finite box and a distance above 0")
    box = freud.box.Box(edges[0], edges[1], edges[2] if scene.dim == 3 else 0.0, is2D=scene.dim == 2)
    if scene.box:
        # Open vectors are long enough to pass.
        scene.box.holds(scene.reach)
        vectors = np.eye(3)
        vectors[: scene.dim, : scene.dim] = scene.box.vectors
        if np.count_nonzero(np.triu(vectors, 1)):
            raise Refusal("freud needs boxes whose vectors form a lower triangle")
        lx, ly, lz = np.diag(vectors)
        tilts = (vectors[1, 0] / ly, vectors[2, 0] / lz, vectors[2, 1] / lz)
        box = freud.box.Box(lx, ly, lz if scene.dim == 3 else 0.0, *tilts, is2D=scene.dim == 2)
        # The boxes of freud have their middle at the origin.
        middle = scene.box.origin + scene.box.vectors.sum(axis=0) / 2
        points = np.pad(scene.centres - middle, ((0, 0), (0, 3 - scene.dim)))
        points = box.wrap(points.astype("f4"))

    def detect():
        query = freud.locality.AABBQuery(box, points)
        found = query.query(points, {"r_max": scene.reach, "exclude_ii": True}).toNeighborList(sort_by_distance=False)
        i, j = found.query_point_indices, found.point_indices
        once = i < j
        i, j = i[once], j[once]
        return (i, j) if scene.radii is None else scene.touching(i, j)

    return detect


serve("freud-aabb", freud.__version__, prepare, boxes=True)
