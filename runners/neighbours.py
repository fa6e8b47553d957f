"""The neighbour list of a library, by its adapter: ``python3 runners/neighbours.py NAME``.

NAME is one of the adapters in crates/python/contactbench/adapters. The clock has the library's call
and, in some adapters, a conversion of its result. Afterwards, the answer is turned into arrays, a
full list is halved, and shifts are added if the library returns none. All libraries are for 3D: in
2D, z is 0 and the box is open along z. Libraries that compute in single precision may be wrong if
particles nearly touch.
"""

import os
import sys

from runner import Refusal, np, serve, unavailable

root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
sys.path.insert(0, os.path.join(root, "crates", "python", "contactbench"))
from adapters import ADAPTERS, listed, shifts

if len(sys.argv) != 2 or sys.argv[1] not in ADAPTERS:
    sys.exit(f"give one of the libraries {', '.join(ADAPTERS)}")
name = sys.argv[1]
adapter = ADAPTERS[name]
if adapter.missing:
    unavailable(name, f"pip install {adapter.package}", adapter.missing)


def prepare(scene):
    if scene.n == 0 or scene.reach == 0.0:
        raise Refusal("neighbour lists need particles and a cutoff above 0")
    points, d = scene.in_space(), scene.dim
    cell, periodic = np.zeros((3, 3)), np.zeros(3, bool)
    if scene.box:
        cell[:d, :d], periodic[:d] = scene.box.vectors, scene.box.periodic
    elif d == 2 and name.startswith("vesin"):
        # Its own box has no depth in 2D, and with more than 10^5 cells it divides by zero (0.6.2).
        # This one is so large that no image is near, and has cells along z.
        edges = np.ptp(points, axis=0) + 3.0 * scene.reach
        edges[2] = max(edges[2], 4.0 * np.sqrt(edges[0] * edges[1] / 1e5))
        cell, periodic = np.diag(edges), np.ones(3, bool)
    cutoff = scene.reach if adapter.rule == "<=" else float(np.nextafter(scene.reach, np.inf))
    try:
        search = adapter.prepare(points, cell, periodic, cutoff)
    except NotImplementedError as refusal:
        raise Refusal(str(refusal)) from refusal

    def finish(answer):
        i, j, images = shifts(points, cell, periodic, *listed(search, answer))
        if not adapter.half:
            first = images[np.arange(len(images)), (images != 0).argmax(axis=1)]
            once = (i < j) | ((i == j) & (first > 0))
            i, j, images = i[once], j[once], images[once]
        return (i, j, images[:, :d]) if scene.box else (i, j)

    def detect():
        answer = search()
        # The contact test of different radii is inside the clock.
        return answer if scene.radii is None else scene.touching(*finish(answer))

    if scene.radii is None:
        detect.finish = finish
    return detect


serve(name, adapter.version, prepare, boxes=True)
