"""The flow of chute.lammps, in YADE. codes.py runs it; alone:
yade -x -n -j1 chute_yade.py '{"start": "start.data", "steps": 2000}'

`verletDist` is YADE's: a length, or, below 0, minus that many smallest radii.
"""

import json
import math
import sys

said = {"start": "start.data", "steps": 700, "verletDist": -0.5, "dump": 0, "keep": 0}
said.update(json.loads(sys.argv[1]))


def sections(path):
    """Read box, atoms and velocities of a LAMMPS data file of spheres, by id."""
    box, tables, table = [], {"Atoms": {}, "Velocities": {}}, None
    with open(path) as file:
        for line in file:
            words = line.split()
            if words and words[0] in tables:
                table = tables[words[0]]
            elif len(words) > 3 and words[2].endswith("lo"):
                box.append((float(words[0]), float(words[1])))
            elif table is not None and words:
                table[int(words[0])] = [float(word) for word in words[1:]]
    return box, tables["Atoms"], tables["Velocities"]


box, atoms, velocities = sections(said["start"])
edges = [high - low for low, high in box]
# A contact has half of this stiffness: the product of both over their sum.
material = O.materials.append(
    ViscElMat(density=6 / math.pi, kn=40000, cn=16, ks=11428, cs=8, frictionAngle=math.atan(0.5))
)
O.periodic = True
# YADE's box is also periodic along z; its height keeps spheres away from their images.
O.cell.setBox(edges[0], edges[1], 2 * edges[2])
for number in sorted(atoms):
    kind, diameter, _, x, y, z = atoms[number][:6]
    body = sphere((x, y, z), diameter / 2, material=material, fixed=kind == 1)
    body.state.vel = velocities[number][:3]
    body.state.angVel = velocities[number][3:]
    O.bodies.append(body)


def write():
    """Write particles and contacts of one step. Called between InteractionLoop and
    NewtonIntegrator, because after a step the positions are one step ahead of the contacts."""
    lattice = " ".join(repr(v) for v in [edges[0], 0, 0, 0, edges[1], 0, 0, 0, 2 * edges[2]])
    where.write(
        f'{len(O.bodies)}\nLattice="{lattice}" pbc="T T F" '
        f"Properties=species:S:1:pos:R:3:radius:R:1 step={O.iter}\n"
    )
    for body in O.bodies:
        x, y, z = body.state.pos
        where.write(f"A {x!r} {y!r} {z!r} {body.shape.radius!r}\n")
    for contact in O.interactions:
        if contact.isReal and contact.geom.penetrationDepth >= 0:
            who.write(f"{O.iter},{contact.id1},{contact.id2}\n")


def keep(path):
    with open(path, "w") as file:
        file.write(f"YADE\n\n{len(O.bodies)} atoms\n3 atom types\n")
        for (low, high), axis in zip(box, "xyz"):
            file.write(f"{low!r} {high!r} {axis}lo {axis}hi\n")
        file.write("\nAtoms # sphere\n\n")
        for number, body in enumerate(O.bodies, 1):
            kind, diameter, density = atoms[number][:3]
            x, y, z = O.cell.wrap(body.state.pos)
            file.write(f"{number} {int(kind)} {diameter!r} {density!r} {x!r} {y!r} {z!r}\n")
        file.write("\nVelocities\n\n")
        for number, body in enumerate(O.bodies, 1):
            six = [*body.state.vel, *body.state.angVel]
            file.write(f"{number} {' '.join(map(repr, six))}\n")


collider = InsertionSortCollider(
    [Bo1_Sphere_Aabb()], verletDist=said["verletDist"], allowBiggerThanPeriod=True
)
O.engines = [
    ForceResetter(),
    collider,
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom()],
        [Ip2_ViscElMat_ViscElMat_ViscElPhys()],
        [Law2_ScGeom_ViscElPhys_Basic()],
    ),
]
if said["dump"]:
    where, who = open("where.xyz", "w"), open("who.csv", "w")
    who.write("step,i,j\n")
    O.engines += [PyRunner(command="write()", iterPeriod=said["dump"], firstIterRun=0)]
slope = math.radians(26)
O.engines += [NewtonIntegrator(gravity=(math.sin(slope), 0, -math.cos(slope)), damping=0)]
O.dt = 0.0005
# The first step sorts all spheres; timing begins after it.
O.run(1, wait=True)
O.timingEnabled = True
for engine in O.engines:
    engine.execTime, engine.execCount = 0, 0
O.run(said["steps"] - 1, wait=True)
if said["keep"]:
    keep("end.data")
if said["dump"]:
    where.close(), who.close()
report = {
    "steps": said["steps"] - 1,
    "loop_ns": sum(engine.execTime for engine in O.engines),
    "search_ns": collider.execTime,
    "builds": collider.execCount,
}
with open("report.json", "w") as file:
    json.dump(report, file)
