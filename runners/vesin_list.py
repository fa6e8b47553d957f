"""vesin.NeighborList: cell lists in C++ for atoms, in f64.

It knows only space: in 2D z is 0. The box that it makes around a scene in open space then has no depth; and where there would be more than some 10^5 cells it
has fewer along every axis, down to none, and divides by zero (version 0.6.2). So in 2D it is given a periodic box, larger than the scene by three
times the distance, so that no image is near, and so deep that there are cells along z.

In a box it is given the box, of any shape, and asked for the images, which it names.
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
    # Kept for its buffers; with `copy=False` the arrays are the calculator's own, good until its next call.
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
