"""A small cell list in NumPy, and the mistakes that authors of cell lists make."""

import time
from itertools import product

import numpy as np

#: The mistakes. For each a hard case that finds it, and a part of the cause that is then named.
MISTAKES = {
    "truncation": ("outside the cell", "truncation instead of floor"),
    "no wrap": ("outside the cell", "wrapped into the cell"),
    "lost at the upper face": ("one ulp from faces", None),
    "bins in single precision": ("upper faces of skewed cells", None),
    "first images only": ("cutoff beyond the cell", "images beyond 1 cell"),
    "nearest image only": ("half the cell", "only the nearest image"),
    "no own images": ("one atom", "own images are missing"),
    "cells rounded up": ("turned axes", "number of images or of cells"),
    "lengths for heights": ("needles", "skewed cells"),
    "twice in two cells": ("unequal sizes", "number of images or of cells"),
    "half stencil doubled": ("liquid", None),
    "sign of the volume": ("left-handed cells", "through periodic images"),
    "columns for rows": ("rotated cells", "columns of the cell"),
    "diagonal only": ("skewed cells", "only the diagonal"),
    "open as periodic": ("slabs", "axis 2 is treated as periodic"),
    "axes mixed up": ("slabs", None),
    "<=": ("ties", "the rule is <=, not <"),
    "half list": ("liquid", "one side only"),
    "each pair twice": ("gas", "listed twice"),
    "sign of S": ("liquid", "other sign"),
    "S of wrapped atoms": ("outside the cell", "counts from atoms wrapped"),
    "single precision": ("next to the cutoff", "single precision"),
    "distance zero": ("two atoms at one place", "distance 0"),
    "capacity of 32": ("crowded", "at most 32 neighbours"),
    "last block of 32": ("numbers of atoms", None),
    "stale buffer": ("large after small", None),
    "every ninth call": ("ten calls", None),
    "writes to positions": ("outside the cell", None),
    "ignores strides": ("memory layouts", "not contiguous"),
    "no atoms is an error": ("no atoms", None),
}


def heights(cell):
    return 1 / np.linalg.norm(np.linalg.inv(cell), axis=0)


def completed(cell):
    """The cell with unit vectors in place of zero vectors."""
    for axis in np.flatnonzero(~cell.any(axis=1)):
        rest = np.vstack([cell[cell.any(axis=1)], np.zeros((1, 3))])
        cell[axis] = np.linalg.svd(rest)[2][len(rest) - 1]
    return cell


class CellList:
    """A neighbour list in the convention of ASE, with one mistake or none."""

    def __init__(self, mistake=None):
        assert mistake is None or mistake in MISTAKES
        self.mistake, self.calls, self.buffer = mistake, 0, np.empty((0, 5), int)

    def __call__(self, positions, cell, pbc, cutoff):
        rows = self.rows(positions, cell, pbc, cutoff)
        return rows[:, 0], rows[:, 1], rows[:, 2:]

    def rows(self, x, cell, pbc, cutoff):

        def wrong(mistake):
            return mistake == self.mistake

        self.calls += 1
        if len(x) == 0:
            if wrong("no atoms is an error"):
                raise IndexError("index 0 is out of bounds")
            return np.empty((0, 5), int)
        if wrong("ignores strides") and not x.flags.c_contiguous:
            x = (x.T if x.base is None else x.base).ravel()[: x.size].reshape(-1, 3)
        given, x, cell = x, np.array(x, float), completed(np.array(cell, float))
        if wrong("single precision"):
            x, cell = x.astype("f4"), cell.astype("f4")
        if wrong("columns for rows"):
            cell = cell.T
        if wrong("diagonal only") and np.diag(cell).all():
            cell = np.diag(np.diag(cell))
        pbc = np.ones(3, bool) if wrong("open as periodic") else pbc
        pbc = pbc[[1, 0, 2]] if wrong("axes mixed up") else pbc

        fractional = np.linalg.solve(cell.T, x.T).T
        floor = np.trunc if wrong("truncation") else np.floor
        boxes = floor(fractional) * pbc * (not wrong("no wrap"))
        inside = fractional - boxes
        low = np.where(pbc, 0, inside.min(axis=0))
        span = np.where(pbc, 1, np.maximum(np.ptp(inside, axis=0), 1e-9))
        height = np.linalg.norm(cell, axis=1) if wrong("lengths for heights") else heights(cell)
        height = (
            height * span * (np.sign(np.linalg.det(cell)) if wrong("sign of the volume") else 1)
        )
        up = np.ceil if wrong("cells rounded up") else np.floor
        cells = np.clip(up(height / cutoff), 1, 20).astype(int)
        reach = np.maximum(np.floor(cutoff / (height / cells)).astype(int) + 1, 0)
        reach = np.where(pbc, reach, np.minimum(reach, cells - 1))
        if wrong("cells rounded up") or wrong("first images only"):
            reach = np.minimum(reach, 1)

        bins = np.floor((inside - low) / span * cells).astype(int)
        kept = (bins < cells).all(axis=1) if wrong("lost at the upper face") else bins[:, 0] > -9
        if wrong("bins in single precision"):
            kept = (np.float32((inside - low) / span) < 1).all(axis=1)
        bins = np.clip(bins, 0, cells - 1)
        index = np.where(kept, np.ravel_multi_index(bins.T, cells), -1)
        order = np.argsort(index, kind="stable")
        starts = np.searchsorted(index[order], np.arange(cells.prod() + 1))
        found = []
        for offset in product(*(range(-r, r + 1) for r in reach)):
            images, target = np.divmod(bins + offset, cells)
            valid = kept & ((images == 0) | pbc).all(axis=1)
            at = np.ravel_multi_index(target.T, cells)
            counts = np.where(valid, starts[at + 1] - starts[at], 0)
            i = np.repeat(np.arange(len(x)), counts)
            within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
            j = order[starts[at][i] + within]
            S = images[i] - boxes[j].astype(int) + boxes[i].astype(int)
            if wrong("twice in two cells") and 2 in cells:
                nearest = -np.rint(fractional[j] - fractional[i]).astype(int) * pbc
                S = np.where(cells == 2, nearest, S)
            rows = np.column_stack([i, j, S])
            d2 = ((x[j] - x[i] + S.astype(cell.dtype) @ cell) ** 2).sum(axis=1)
            limit = d2.dtype.type(cutoff) ** 2
            near = (d2 <= limit) if wrong("<=") else (d2 < limit)
            own = (i == j) if wrong("no own images") else (i == j) & ~S.any(axis=1)
            near &= ~own & ((d2 > 0) | (not wrong("distance zero")))
            found += [rows[near]]
            if wrong("half stencil doubled") and not any(offset):
                found += [rows[near]]
        return self.spoiled(np.vstack(found), given, cell, pbc, boxes)

    def spoiled(self, rows, x, cell, pbc, boxes):
        """The rows with a mistake that is made after the search."""
        i, j = rows[:, 0], rows[:, 1]
        if self.mistake == "sign of S":
            rows[:, 2:] *= -1
        elif self.mistake == "S of wrapped atoms":
            rows[:, 2:] += (boxes[j] - boxes[i]).astype(int)
        elif self.mistake == "half list":
            return rows[(i < j) | ((i == j) & (rows[:, 2:] @ [10**6, 10**3, 1] > 0))]
        elif self.mistake == "each pair twice":
            return np.vstack([rows, rows])
        elif self.mistake == "nearest image only":
            d = np.linalg.norm(x[j] - x[i] + rows[:, 2:] @ cell, axis=1)
            rows = rows[np.lexsort([d, j, i])]
            return rows[np.unique(rows[:, :2], axis=0, return_index=True)[1]]
        elif self.mistake == "capacity of 32":
            rows = rows[np.argsort(i, kind="stable")]
            rank = np.arange(len(rows)) - np.searchsorted(rows[:, 0], rows[:, 0])
            return rows[rank < 32]
        elif self.mistake == "last block of 32" and len(x) > 32:
            return rows[i < len(x) // 32 * 32]
        elif self.mistake == "stale buffer":
            rows = np.vstack([rows, self.buffer[len(rows) :]])
            self.buffer = rows
        elif self.mistake == "every ninth call" and self.calls % 9 == 0:
            return rows[:-1]
        elif self.mistake == "writes to positions":
            x -= (boxes @ cell).astype(x.dtype)
        return rows


right, wrong = CellList(), CellList("nearest image only")


def limited(positions, cell, pbc, cutoff, max_neighbours=10**6, cut=False):
    """A list with a capacity, which raises an exception or cuts the list."""
    i, j, S = CellList()(positions, cell, pbc, cutoff)
    order = np.argsort(i, kind="stable")
    rank = np.arange(len(i)) - np.searchsorted(i[order], i[order])
    if (rank >= max_neighbours).any() and not cut:
        raise ValueError("an atom has more than max_neighbours neighbours")
    kept = order[rank < max_neighbours]
    return i[kept], j[kept], S[kept]


#: The mistakes of lists for batches, and a part of the cause that is then named.
BATCH_MISTAKES = {
    "all systems are one": "different systems are listed",
    "pairs across systems": "different systems are listed",
    "local numbers": "numbers of atoms begin at 0",
    "first cell for all": "cell and axes of the first",
    "last cell for all": "cell and axes of the last",
    "cell of the system before": "cell and axes of the system before",
    "first axes for all": "all systems get the axes of the first",
    "cells of systems with atoms": "after an empty one get the cell and axes of another",
    "ends at an empty system": "after an empty one are left out",
    "counts systems with atoms": "the last systems are left out",
    "last system left out": "the last system is left out",
    "equal systems once": None,
    "empty is an error": None,
    "empty among others is an error": "right without empty systems",
    "last atom left out": None,
    "sign of S": "S has the other sign",
    "writes to systems": None,
    "blocks of 32 systems": None,
}


def batch(positions, cells, pbcs, cutoff, systems, mistake=None):
    """A list for several systems, with one mistake or none."""
    assert mistake is None or mistake in BATCH_MISTAKES
    if mistake == "all systems are one":
        return CellList()(positions, cells[0], pbcs[0], cutoff)
    parts = [(np.empty(0, int), np.empty(0, int), np.empty((0, 3), int))]
    full, seen = np.unique(systems), set()
    for number in range(len(full) if mistake == "counts systems with atoms" else len(cells)):
        own = np.flatnonzero(systems == number)
        if len(own) == 0 and mistake == "ends at an empty system":
            break
        if len(own) == 0 and "is an error" in str(mistake):
            if len(positions) or mistake == "empty is an error":
                raise IndexError("index 0 is out of bounds")
        if mistake == "equal systems once" and positions[own].tobytes() in seen:
            continue
        if mistake == "blocks of 32 systems" and number >= 32:
            continue
        seen.add(positions[own].tobytes())
        at = {
            "first cell for all": 0,
            "last cell for all": len(cells) - 1,
            "cell of the system before": number - 1,
            "cells of systems with atoms": np.searchsorted(full, number),
        }.get(mistake, number)
        pbc = pbcs[0 if mistake == "first axes for all" else min(at, len(cells) - 1)]
        own = own[:-1] if mistake == "last atom left out" else own
        i, j, S = CellList()(positions[own], cells[min(at, len(cells) - 1)], pbc, cutoff)
        S = -S if mistake == "sign of S" else S
        parts.append((i, j, S) if mistake == "local numbers" else (own[i], own[j], S))
    if mistake == "last system left out" and len(parts) > 2:
        parts.pop()
    if mistake == "pairs across systems":
        i, j, S = CellList()(positions, cells[0], np.zeros(3, bool), cutoff)
        across = systems[i] != systems[j]
        parts.append((i[across], j[across], S[across]))
    if mistake == "writes to systems":
        systems += 1
    return tuple(np.concatenate(part) for part in zip(*parts, strict=True))


def by_offsets(positions, cells, pbcs, cutoff, offsets, mistake=None):
    """`batch` with the first atom of each system instead of the system of each atom."""
    assert offsets[0] == 0 and offsets[-1] == len(positions) and len(offsets) == len(cells) + 1
    systems = np.repeat(np.arange(len(cells)), np.diff(offsets))
    if mistake == "writes to systems":
        offsets += 1
    return batch(positions, cells, pbcs, cutoff, systems, mistake)


def mixed(*arguments):
    """A list of batches that takes all systems for one."""
    return batch(*arguments, mistake="all systems are one")


def wait(seconds, *arguments):
    """A right list that takes its time."""
    time.sleep(seconds)
    return right(*arguments)
