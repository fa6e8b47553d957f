"""freud.locality.LinkCell: cells in C++, in f32, as wide as the cutoff. It returns no shifts. The
default width of cells depends on the number of points and fails if there are few."""

from . import freud_aabb


def prepare(positions, cell, pbc, cutoff):
    return freud_aabb.prepare(positions, cell, pbc, cutoff, "LinkCell", cell_width=cutoff)
