"""Neighbour lists of released libraries, run in the environment of one release.

``python adapters.py NAME`` reads systems as lines of JSON and answers each with the pairs that the
library lists. It needs Python 3.7 and NumPy, because old releases need old interpreters. An adapter
raises NotImplementedError for systems that the library does not support.
"""

import json
import os
import sys

import numpy as np


def supported(condition, what):
    """Decline a system outside the documented domain of a library."""
    if not condition:
        raise NotImplementedError("supports only " + what)


def heights(cell):
    return 1 / np.linalg.norm(np.linalg.inv(cell), axis=0)


def reduced(cell, pbc, cutoff):
    """Decline cells that are not periodic, lower triangular, and reduced, and large cutoffs."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = cell
    supported(all(pbc), "periodic cells")
    supported(ay == az == bz == 0 and min(ax, by, cz) > 0, "lower triangular cells")
    supported(2 * max(abs(bx), abs(cx)) <= ax and 2 * abs(cy) <= by, "reduced cells")
    supported(2 * cutoff < heights(cell).min(), "cutoffs below half the heights of the cell")


def vesin(positions, cell, pbc, cutoff):
    from vesin import NeighborList

    pairs = NeighborList(cutoff=cutoff, full_list=True)
    return pairs.compute(points=positions, box=cell, periodic=pbc, quantities="ijS")


def sisl(positions, cell, pbc, cutoff):
    from sisl import Geometry, Lattice
    from sisl.geom import NeighborFinder

    supported(len(positions) and np.linalg.det(cell), "atoms in a cell")
    s = np.linalg.solve(cell.T, positions.T).T
    supported(((s >= 0) & (s < 1)).all(), "atoms in the cell")
    kinds = ["periodic" if p else "unknown" for p in pbc]
    geometry = Geometry(positions, lattice=Lattice(cell, boundary_condition=kinds))
    found = NeighborFinder(geometry, R=cutoff).find_neighbors(self_interaction=False)
    return found.I, found.J, found.isc


def pymatgen(positions, cell, pbc, cutoff):
    from pymatgen.core import Lattice, Structure

    supported(all(pbc) and len(positions), "atoms in periodic cells")
    atoms = Structure(Lattice(cell), ["H"] * len(positions), positions, coords_are_cartesian=True)
    i, j, shifts, _ = atoms.get_neighbor_list(cutoff, exclude_self=True)
    return i, j, shifts


def freud(positions, cell, pbc, cutoff, kind="LinkCell"):
    import freud

    supported(len(positions), "at least one atom")
    reduced(cell, pbc, cutoff * 1.000001)  # AABBQuery declines half the box in single precision.
    (ax, _, _), (bx, by, _), (cx, cy, cz) = cell
    box = freud.box.Box(ax, by, cz, bx / by, cx / cz, cy / cz)
    points = np.array([box.wrap(p) for p in positions.astype(np.float32)]).reshape(-1, 3)
    if kind == "chain":
        found = freud.locality.AABBQuery(box, points).queryBall(points, cutoff, exclude_ii=True)
        found = found.toNList()
    else:
        cells = freud.locality.LinkCell(box, cutoff, points)
        query = cells.queryBall(points, cutoff, exclude_ii=True)
        found = query.toNList()
    return np.array(found.index_i, int), np.array(found.index_j, int)


def freud_chain(positions, cell, pbc, cutoff):
    return freud(positions, cell, pbc, cutoff, "chain")


def mdanalysis(positions, cell, pbc, cutoff):
    from MDAnalysis.lib.distances import self_capped_distance
    from MDAnalysis.lib.mdamath import triclinic_box

    supported(len(positions), "at least one atom")
    reduced(cell, pbc, cutoff)
    x, box = positions.astype(np.float32), triclinic_box(*cell).astype(np.float32)
    found = self_capped_distance(x, cutoff, box=box, method="nsgrid", return_distances=False)
    return np.array(found, int).reshape(-1, 2).T


def jax_md(positions, cell, pbc, cutoff):
    import jax

    jax.config.update("jax_enable_x64", True)
    from jax_md import partition, space

    side = np.diag(cell)
    supported((cell == np.diag(side)).all() and all(pbc), "periodic orthorhombic cells")
    supported(2 * cutoff < abs(side).min(), "cutoffs below half the cell")
    box = jax.numpy.array(side)
    kind = partition.NeighborListFormat.Sparse
    make = partition.neighbor_list(space.periodic(box)[0], box, cutoff, 0.0, format=kind)
    i, j = np.asarray(make.allocate(jax.numpy.mod(positions, box)).idx)
    known = (i < len(positions)) & (j < len(positions))
    return i[known], j[known]


def openmm(positions, cell, pbc, cutoff):
    """Read pairs from energies: the charges of i and of its neighbours are powers of two."""
    import openmm as mm

    reduced(cell, pbc, cutoff)
    count = len(positions)
    supported(0 < count <= 70, "small systems here: it asks for N * N / 40 energies")
    system = mm.System()
    system.setDefaultPeriodicBoxVectors(*[mm.Vec3(*map(float, v)) for v in cell])
    force = mm.CustomNonbondedForce("u1*v2 + u2*v1")
    force.addPerParticleParameter("u")
    force.addPerParticleParameter("v")
    force.setNonbondedMethod(force.CutoffPeriodic)
    force.setCutoffDistance(cutoff)
    for _ in range(count):
        system.addParticle(1.0)
        force.addParticle([0.0, 0.0])
    system.addForce(force)
    platform = mm.Platform.getPlatformByName("CPU")
    context = mm.Context(system, mm.VerletIntegrator(0.001), platform, {"Threads": "1"})
    context.setPositions([mm.Vec3(*map(float, p)) for p in positions])
    pairs = []
    for i in range(count):
        for start in range(0, i, 20):
            for k in range(count):
                v = 2.0 ** (k - start) if start <= k < min(start + 20, i) else 0.0
                force.setParticleParameters(k, [float(k == i), v])
            force.updateParametersInContext(context)
            energy = int(context.getState(getEnergy=True).getPotentialEnergy()._value)
            last = min(start + 20, i)
            pairs += [(i, k) for k in range(start, last) if energy >> (k - start) & 1]
    i, j = np.array(pairs, int).reshape(-1, 2).T
    return i, j


def nvalchemi(positions, cell, pbc, cutoff, method="cell_list"):
    import torch

    supported(len(positions) and np.linalg.det(cell) > 0, "atoms in right-handed cells")
    try:
        from nvalchemiops.torch import neighbors as lists
    except ImportError:
        from nvalchemiops import neighborlist as lists
    x, box, axes = torch.tensor(positions), torch.tensor(cell)[None], torch.tensor(pbc)[None]
    options = {"return_neighbor_list": True, "max_neighbors": 4000}
    if method == "cell_list":
        found = lists.cell_list(x, cutoff, box, axes, **options)
    else:
        found = lists.naive_neighbor_list(x, cutoff, pbc=axes, cell=box, **options)
    (i, j), _, shifts = found
    return i, j, shifts


def nvalchemi_naive(positions, cell, pbc, cutoff):
    return nvalchemi(positions, cell, pbc, cutoff, "naive")


def main():
    adapter = globals()[sys.argv[1]]
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # Libraries print to standard output.
    for line in sys.stdin:
        given = json.loads(line)
        positions = np.array(given["positions"], given["dtype"]).reshape(-1, 3)
        cell = np.array(given["cell"], given["dtype"])
        try:
            parts = adapter(positions, cell, given["pbc"], given["cutoff"])
            answer = {"pairs": [np.asarray(part).tolist() for part in parts]}
        except NotImplementedError as error:
            answer = {"refused": str(error)}
        except Exception as error:
            answer = {"error": repr(error)}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
