"""vesin.NeighborList: cell lists in C++ for atoms, in f64.

It supports only 3D: in 2D z is 0. In open space it makes a box around the scene, which in 2D has no
depth. If there would be more than about 10^5 cells, it reduces their number along every axis, down
to zero, and divides by zero (version 0.6.2). So 2D scenes get a periodic box that exceeds them by
three times the distance, so that no image is near, and so deep that there are cells along z.

Periodic boxes may have any shape, and the library returns the images.
"""

from importlib.metadata import version

from runner import Refusal, np, serve, unavailable

try:
    from vesin import NeighborList
except ImportError as error:
    unavailable("vesin", "pip install vesin", error)


def prepare(scene):
    points, flat = scene.in_space(), scene.dim == 2
    extent = np.ptp(points, axis=0) if scene.n else np.zeros(3)
    edges = extent + 3.0 * scene.reach
    if flat:
        edges[2] = max(edges[2], 4.0 * np.sqrt(edges[0] * edges[1] / 1e5))
    box = np.diag(edges) if flat else np.zeros((3, 3))
    periodic, asked = flat, "ij"
    if scene.box:
        d = scene.dim
        box[:d, :d] = scene.box.vectors
        periodic, asked = [*scene.box.periodic, *[False] * (3 - d)], "ijS"
    if scene.reach == 0.0:
        raise Refusal("vesin needs a cutoff above 0")
    # Reused for its buffers. With `copy=False` the arrays stay valid until the next call.
    calculator = NeighborList(cutoff=scene.reach, full_list=False)

    def detect():
        if scene.n < 2 and not scene.box:
            return np.zeros((0, 2), "u4")
        i, j, *images = calculator.compute(points=points, box=box, periodic=periodic, quantities=asked, copy=False)
        # Of the pairs (i, j, S) and (j, i, -S) it gives one.
        images = [image[:, : scene.dim] for image in images]
        return (i, j, *images) if scene.radii is None else scene.touching(i, j, *images)

    return detect


serve("vesin", version("vesin"), prepare, boxes=True)
