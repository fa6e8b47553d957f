"""nvalchemiops.jax.neighbors.naive_neighbor_list: all pairs, otherwise as `nvalchemi`."""

from . import nvalchemi


def prepare(positions, cell, pbc, cutoff):
    return nvalchemi.prepare(positions, cell, pbc, cutoff, "naive_neighbor_list")
