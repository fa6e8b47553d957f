"""The cases of codes.py, and the loose layers from which they start.

The unit of length is the diameter of a small sphere, the unit of mass is its mass, and gravity is
1.
"""

import dataclasses
import math
import random
from collections.abc import Callable

# Initial distance between the centres of small spheres.
GAP = 1.05


@dataclasses.dataclass
class Body:
    kind: int
    diameter: float
    place: tuple
    velocity: tuple = (0.0, 0.0, 0.0)
    # As a multiple of the density of a small sphere.
    density: float = 1.0


@dataclasses.dataclass
class Case:
    # Name of the scripts; each code has one.
    script: str
    # Number of steps of the preparation, and of a run.
    settle: int
    steps: int
    # begin(quick) returns the bounds along each axis, the spheres, and variables of the script.
    begin: Callable
    # Variables of the preparation.
    prepared: dict = dataclasses.field(default_factory=dict)

    def settling(self, quick):
        return 500 if quick else self.settle


def cells(columns, rows, layers, edge, draw):
    """Yield the centres of cells, layer by layer from below, each with a small random shift."""
    for k in range(layers):
        for i in range(columns):
            for j in range(rows):
                centre = tuple((at + 0.5) * edge for at in (i, j, k))
                yield centre, tuple(draw.uniform(-0.02, 0.02) for _ in range(3))


def filled(kind, ratio, centre, shift, edge, **more):
    """Yield one sphere of diameter `ratio`; if it is 1, as many small ones as fit."""
    count = 1 if ratio > 1 else max(1, int(edge / GAP + 0.01))
    parts = [((k + 0.5) / count - 0.5) * edge for k in range(count)]
    for off in [(a, b, c) for a in parts for b in parts for c in parts]:
        place = tuple(at + part + by for at, part, by in zip(centre, off, shift))
        yield Body(kind, float(ratio), place, **more)


def chute(counts, ratio):
    """A frozen floor and, above it, cells of small spheres, or half of them large if ratio > 1."""
    def begin(quick):
        draw = random.Random(1)
        columns, rows, layers = [max(2, 6 // ratio) for _ in counts] if quick else counts
        edge = ratio * GAP
        length, width, height = (edge * count for count in (columns, rows, layers))
        # Spheres of the floor do not touch, because codes skip pairs of frozen spheres.
        along, across = (max(1, int(extent / 1.1)) for extent in (length, width))
        found = []
        for i in range(along):
            for j in range(across):
                x, y = (k + 0.5 + draw.uniform(-0.04, 0.04) for k in (i, j))
                found.append(Body(1, 1.0, (x * length / along, y * width / across, draw.uniform(0.5, 1.0))))
        for (x, y, z), shift in cells(columns, rows, layers, edge, draw):
            large = ratio > 1 and draw.random() < 0.5
            # About the profile of a steady flow (Bagnold), which would take long to develop. A low
            # flow is as fast as a high one, so that its lists are tested.
            fall = 0.07 * max(height, 25.0) ** 1.5 * (1 - max(0.0, 1 - z / height) ** 1.5)
            kind, size = (3, ratio) if large else (2, 1)
            found += filled(kind, size, (x, y, z + 1.55), shift, edge, velocity=(fall, 0.0, 0.0))
        return [(0.0, length), (0.0, width), (0.0, height + 10.0 + ratio)], found, {}
    return begin


def drum(quick):
    """Large spheres, and small ones above them, in the lower half of a drum."""
    radius, half, large, small = (12.0, 5.0, 40, 40) if quick else (50.0, 15.0, 8000, 3750)
    draw, found, edge = random.Random(1), [], 2 * GAP
    count, rows = int(2 * radius / edge), int((2 * half - 0.1) / edge)
    middle = [count * edge / 2, rows * edge / 2, count * edge / 2]
    inside = radius - edge / math.sqrt(2) - 0.05
    for centre, shift in cells(count, rows, count, edge, draw):
        x, y, z = centre = tuple(at - by for at, by in zip(centre, middle))
        if math.hypot(x, z) > inside or not large + small:
            continue
        if large:
            found += filled(2, 2, centre, shift, edge, density=0.8)
            large -= 1
        else:
            found += filled(1, 1, centre, shift, edge)
            small -= 1
    box = [(-end - 2, end + 2) for end in (radius, half, radius)]
    return box, found, {"case": "drum", "radius": radius, "half": half}


def penetration(quick):
    """A bed, and a large sphere that reaches it when the preparation ends."""
    # `top` is the height of the settled bed, measured once.
    wide, half, count, top = (6.0, 6.0, 500, 5.1) if quick else (25.0, 15.0, 25000, 17.2)
    draw, found = random.Random(1), []
    columns, rows = (int((2 * end - 0.1) / GAP) for end in (wide, half))
    for centre, shift in cells(columns, rows, -(-count // (columns * rows)), GAP, draw):
        middle = (columns * GAP / 2, rows * GAP / 2, 0.0)
        found += filled(1, 1, tuple(at - by for at, by in zip(centre, middle)), shift, GAP)
    del found[count:]
    # The speed is 5 m/s at the bed, converted to diameters per unit of time.
    time = SOFT_STEP * PENETRATION.settling(quick)
    speed = 5.0 / math.sqrt(9.81 * 0.002) - time
    way = speed * time + time**2 / 2
    found.append(Body(2, 10.0, (0.0, 0.0, top + 5.0 + way), (0.0, 0.0, -speed), 7200 / 2500))
    box = [(-wide - 2, wide + 2), (-half - 2, half + 2), (-2.0, top + way + 12.0)]
    return box, found, {"case": "penetration", "wide": wide, "half": half}


# Time step of the preparation, as in bulk.lammps.
SOFT_STEP = 0.0005
CHUTE = Case("chute", 6000, 300, chute((40, 20, 39), 1))
CHUTE_SIZES = Case("chute", 4000, 300, chute((10, 5, 9), 4), {"style": "multi"})
CHUTE_SMALL = Case("chute", 2000, 300, chute((20, 20, 20), 1))
DRUM = Case("bulk", 20000, 1500, drum, {"soft": 1})
PENETRATION = Case("bulk", 8000, 1000, penetration, {"soft": 1, "style": "multi"})


def write_start(path, case, quick):
    """Write a LAMMPS data file; return the number of spheres and the script's variables."""
    box, found, variables = case.begin(quick)
    with open(path, "w") as file:
        file.write(f"{case.script}\n\n{len(found)} atoms\n3 atom types\n\n")
        for (low, high), axis in zip(box, "xyz"):
            file.write(f"{low!r} {high!r} {axis}lo {axis}hi\n")
        file.write("\nAtoms # sphere\n\n")
        for at, body in enumerate(found, 1):
            x, y, z = body.place
            density = body.density * 6 / math.pi
            file.write(f"{at} {body.kind} {body.diameter!r} {density!r} {x!r} {y!r} {z!r}\n")
        file.write("\nVelocities\n\n")
        for at, body in enumerate(found, 1):
            file.write(f"{at} {' '.join(map(repr, body.velocity))} 0 0 0\n")
    return len(found), variables
