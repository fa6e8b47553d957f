"""matscipy.neighbours.neighbour_list: cells in C, in f64, for boxes of any shape.

It returns each contact from both sides, with its image; one is kept. It supports only 3D: in 2D z
is 0 and the box is open along z. Without a box it gets one around the scene, open along all axes.
"""

from importlib.metadata import version

from runner import Refusal, np, serve, unavailable

try:
    from matscipy.neighbours import neighbour_list
except ImportError as error:
    unavailable("matscipy", "pip install matscipy", error)


def prepare(scene):
    if scene.reach == 0.0 or scene.n == 0:
        raise Refusal("matscipy needs particles and a cutoff above 0")
    points, d = scene.in_space(), scene.dim
    extent = np.ptp(points, axis=0) + 3.0 * scene.reach
    cell, periodic = np.diag(extent), np.zeros(3, bool)
    if scene.box:
        cell[:d, :d] = scene.box.vectors
        periodic[:d] = scene.box.periodic
    # The library compares with <.
    cutoff = float(np.nextafter(scene.reach, np.inf))

    def detect():
        i, j, images = neighbour_list("ijS", positions=points, cell=cell, pbc=periodic, cutoff=cutoff)
        images = images[:, :d]
        first = images[np.arange(len(images)), (images != 0).argmax(axis=1)]
        once = (i < j) | ((i == j) & (first > 0))
        i, j, images = i[once], j[once], images[once]
        if scene.radii is not None:
            i, j, *images = scene.touching(i, j, *([images] if scene.box else []))
            images = images[0] if images else None
        return (i, j, images) if scene.box else (i, j)

    return detect


serve("matscipy", version("matscipy"), prepare, boxes=True)
