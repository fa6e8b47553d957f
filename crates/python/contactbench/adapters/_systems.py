"""Conversions that several adapters share. Rows of `cell` are its vectors."""

import numpy as np


def complete(positions, cell, pbc, cutoff):
    """Return a cell whose open vectors are at right angles to the periodic ones, and its origin. It
    holds all positions, with more than the cutoff to spare along open vectors."""
    cell, origin = np.array(cell, float), np.zeros(3)
    if pbc.all():
        return cell, origin
    free = np.flatnonzero(~pbc)
    axes = np.eye(3)[free]
    if np.any(axes @ cell[pbc].T):
        axes = np.linalg.svd(cell[pbc])[2][3 - len(free) :]
    for row, axis in zip(free, axes):
        along = positions @ axis if len(positions) else np.zeros(1)
        cell[row] = axis * (np.ptp(along) + 4.0 * cutoff)
        origin += axis * (along.min() - 2.0 * cutoff)
    return cell, origin


def fill(positions, cell, pbc, cutoff):
    """Return the cell as it is, or complete if its vectors do not span space."""
    with np.errstate(divide="ignore", invalid="ignore"):
        volume = np.linalg.det(cell / np.linalg.norm(cell, axis=1)[:, None])
    return cell if np.abs(volume) > 1e-12 else complete(positions, cell, pbc, cutoff)[0]


def heights(cell):
    """Return the distances between opposite faces."""
    return 1.0 / np.linalg.norm(np.linalg.inv(cell), axis=0)


def require_wide(cell, cutoff):
    """Refuse cells in which two images of a particle may be neighbours of the same particle."""
    if np.float32(2.0 * cutoff) >= np.float32(heights(cell).min()):
        raise NotImplementedError("the library needs a cell wider than twice the cutoff")


def require_edges(cell):
    """Return the edges of a cell along the axes, or refuse the cell."""
    edges = np.diag(cell)
    if np.count_nonzero(cell - np.diag(edges)) or (edges <= 0.0).any():
        raise NotImplementedError("the library needs a cell with edges along the axes")
    return edges


def require_lower(cell):
    """Refuse cells that do not form a lower triangle with a positive diagonal."""
    if np.count_nonzero(np.triu(cell, 1)) or (np.diag(cell) <= 0.0).any():
        raise NotImplementedError("the library needs a cell that is a lower triangle")


def wrap(positions, cell, pbc, origin):
    """Return positions in the cell, relative to its origin."""
    places = positions - origin
    return places - np.where(pbc, np.floor(places @ np.linalg.inv(cell)), 0.0) @ cell


def nearest(positions, cell, pbc, i, j):
    """Return the shifts to the nearest image of each j, in a cell wider than twice the cutoff."""
    pbc = np.asarray(pbc, bool)
    if not pbc.any():
        return np.zeros((len(i), 3), np.int64)
    cell, _ = complete(positions, cell, pbc, 1.0)
    apart = (positions[i] - positions[j]) @ np.linalg.inv(cell)
    return np.where(pbc, np.rint(apart), 0.0).astype(np.int64)


def both_sides(i, j):
    """Return a half list as a full one."""
    return np.concatenate([i, j]), np.concatenate([j, i])
