"""Neighbour lists, compared with tests of all pairs and images."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest

import contactbench
from contactbench import neighbours
from contactbench.neighbours import batch_neighbour_list, max_neighbours, neighbour_list

CELLS = {
    "cube": (np.diag([3.0, 3.0, 3.0]), True),
    "left-handed": (np.array([[0.0, 3.0, 0.0], [3.0, 0.0, 0.0], [0.0, 0.0, 3.0]]), True),
    "skewed": (np.array([[3.0, 0.0, 0.0], [2.5, 2.0, 0.0], [-1.0, 1.5, 2.5]]), True),
    "slab": (np.diag([3.0, 3.0, 1.0]), [True, True, False]),
    "wire": (np.diag([0.0, 0.0, 2.0]), [False, False, True]),
    "small": (np.diag([0.75, 4.0, 4.0]), True),
    "open": (None, None),
}


def brute(x, cell, pbc, cutoff, closed=False):
    """List (i, j, S) by testing all images in reach; coordinates are multiples of 1/4."""
    flags = np.broadcast_to(False if pbc is None else pbc, 3)
    ranges = [range(1)] * 3
    if flags.any():
        axes = np.linalg.inv(np.where(cell.any(axis=1, keepdims=True), cell, np.eye(3)))
        most = (np.ptp(x @ axes, axis=0) if len(x) else 0) + cutoff * np.linalg.norm(axes, axis=0)
        ranges = [range(-int(m) - 1, int(m) + 2) if f else range(1) for f, m in zip(flags, most)]
    found = set()
    for shift in itertools.product(*ranges):
        move = np.zeros(3) if cell is None else np.array(shift) @ cell
        square = ((x[None] + move - x[:, None]) ** 2).sum(axis=2)
        near = square <= cutoff**2 if closed else square < cutoff**2
        for i, j in zip(*np.nonzero(near)):
            if i != j or any(shift):
                found.add((int(i), int(j), *shift))
    return found


def listed(answer):
    rows = np.column_stack(answer)
    assert len(np.unique(rows, axis=0)) == len(rows)
    return set(map(tuple, rows.tolist()))


def places(n=40, low=-1.0, high=2.5, seed=7):
    """Coordinates that are multiples of 1/4, so that sums and squares are exact and ties occur."""
    return np.round(np.random.default_rng(seed).uniform(low, high, (n, 3)) * 4) / 4


@pytest.mark.parametrize("rule", ["<", "<="])
@pytest.mark.parametrize("name", CELLS)
def test_lists_hold_all_neighbours_and_no_others(name, rule):
    cell, pbc = CELLS[name]
    x = places()
    for cutoff in (0.75, 1.5):
        answer = neighbour_list("ijS", x, cell, pbc, cutoff, rule=rule)
        assert listed(answer) == brute(x, cell, pbc, cutoff, rule == "<=")
    # The rules differ here, so the comparison above sees ties.
    assert brute(x, cell, pbc, 1.5) != brute(x, cell, pbc, 1.5, True)


def test_arrays_fit_together():
    cell, pbc = CELLS["skewed"]
    x = places(60)
    i, j, S, d, D, offsets = neighbour_list("ijSdD", x, cell, pbc, 1.5, csr=True, sorted=True)
    assert (i.dtype, j.dtype, S.dtype, d.dtype) == (np.int64, np.int64, np.int32, np.float64)
    np.testing.assert_array_equal(D, x[j] - x[i] + S @ cell)
    np.testing.assert_allclose(d, np.linalg.norm(D, axis=1), rtol=1e-15)
    assert (np.diff(i) >= 0).all() and (offsets == np.searchsorted(i, np.arange(61))).all()
    keys = np.column_stack([i, j, S])
    assert (keys == np.unique(keys, axis=0)).all()
    assert max_neighbours(x, cell, pbc, 1.5) == np.bincount(i).max()
    half = listed(neighbour_list("ijS", x, cell, pbc, 1.5, half=True))
    assert all(row[0] <= row[1] for row in half)
    both = half | {(b, a, -s, -t, -u) for a, b, s, t, u in half}
    assert both == listed((i, j, S)) and 2 * len(half) == len(i)


@pytest.mark.parametrize("scale", [1e-300, 1.0, 1e300])
def test_distances_are_those_of_numbers_whose_squares_are_not(scale):
    x = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0]]) * scale
    i, j, d, D = neighbour_list("ijdD", x, cutoff=6.0 * scale, sorted=True)
    np.testing.assert_allclose(d, np.array([3.0, 5.0, 3.0, 4.0, 5.0, 4.0]) * scale, rtol=1e-15)
    np.testing.assert_array_equal(D, x[j] - x[i])


def test_the_order_of_quantities_is_that_of_the_letters():
    x = places()
    D, i = neighbour_list("Di", x, cutoff=1.0)
    assert D.shape == (len(i), 3) and len(i) > 0
    assert isinstance(neighbour_list("j", x, cutoff=1.0), np.ndarray)


def test_atoms_bring_their_cell():
    cell, pbc = CELLS["slab"]
    atoms = SimpleNamespace(positions=places(), cell=cell, pbc=np.array(pbc))
    expected = listed(neighbour_list("ijS", places(), cell, pbc, 1.5))
    assert listed(neighbours.neighbor_list("ijS", atoms, 1.5)) == expected
    assert len(neighbours.neighbor_list("ij", places(), 1.5)[0]) > 0
    assert listed(neighbour_list("ijS", atoms, cutoff=1.5)) == expected
    with pytest.raises(ValueError, match="atoms"):
        neighbour_list("ij", atoms, cell, cutoff=1.5)


def test_single_precision_is_widened():
    x = places().astype(np.float32)
    assert listed(neighbour_list("ij", x, cutoff=1.5)) == listed(
        neighbour_list("ij", x.astype(float), cutoff=1.5)
    )


def test_queries_find_points():
    cell, pbc = CELLS["skewed"]
    a, b = places(20, seed=1), places(30, seed=2)
    found = listed(neighbours.pairs_between(a, b, cell, pbc, 1.5))
    all_pairs = brute(np.concatenate([a, b]), cell, pbc, 1.5)
    assert found == {(i, j - 20, *s) for i, j, *s in all_pairs if i < 20 <= j}
    assert len(neighbours.pairs_between([], b, cutoff=1.5)[0]) == 0
    assert len(neighbours.pairs_between([], b[:, :2], cutoff=1.5)[0]) == 0


def test_batches_keep_systems_apart():
    parts = [places(20, seed=3), places(0), places(20, seed=3), places(15, seed=4)]
    offsets = np.cumsum([0] + [len(part) for part in parts])
    cells, pbc = [CELLS["cube"][0]] * 4, [[True] * 3, [True] * 3, [False] * 3, [True, False, True]]
    answer = batch_neighbour_list("ijS", np.concatenate(parts), offsets, cells, np.array(pbc), 1.5)
    expected = {
        (i + offsets[k], j + offsets[k], *s, k)
        for k in range(4)
        for i, j, *s in brute(parts[k], cells[k], pbc[k], 1.5)
    }
    assert listed(answer) == expected
    i, again = batch_neighbour_list("ii", parts[0], [0, 5, 20], None, None, 1.5)[:2]
    assert i.max() == again.max() == 19
    assert [len(array) for array in batch_neighbour_list("ij", [], [0], [], None, 1.0)] == [0, 0, 0]
    for arguments, match in [
        (("ij", parts[0], [0, 5], None, None, 1.0), "rise"),
        (("ij", parts[0], 20, None, None, 1.0), "rise"),
        (("ij", parts[0], [0, 20], cells[:1], np.array(pbc), 1.0), "pbc"),
        (("ij", parts[0], [0, 20], cells, True, 1.0), "cells"),
    ]:
        with pytest.raises(ValueError, match=match):
            batch_neighbour_list(*arguments)
    with pytest.raises(ValueError, match="rule"):
        batch_neighbour_list("ij", [], [0], [], None, 1.0, rule="zz")


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        (dict(quantities="ix"), "quantities"),
        (dict(cutoff=None), "cutoff"),
        (dict(cutoff=-1.0), "cutoff"),
        (dict(cutoff=np.nan), "cutoff"),
        (dict(cutoff=5e-324), "cutoff"),
        (dict(cell=np.eye(2)), "cell"),
        (dict(pbc=True), "pbc"),
        (dict(cell=np.diag([1.0, 1.0, 0.0])), "zeros"),
        (dict(positions=np.zeros(3)), "positions"),
        (dict(cell=np.eye(3), pbc=[True, False]), "pbc"),
        (dict(cell=np.eye(3), pbc="xy"), "pbc"),
        (dict(rule="=<"), "rule"),
        (dict(positions=[[np.nan, 0.0, 0.0]]), "finite"),
    ],
)
def test_wrong_arguments_are_refused(arguments, match):
    given = dict(quantities="ij", positions=places(), cutoff=1.0) | arguments
    with pytest.raises(ValueError, match=match):
        neighbour_list(**given)


def test_more_pairs_than_fit_are_refused():
    with pytest.raises(MemoryError):
        neighbour_list("ij", np.zeros((30_000, 3)), cutoff=1.0, memory_limit=1 << 20)


def test_contacts_take_the_open_rule():
    x = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    for box in (None, [4.0, 4.0, 4.0]):
        assert len(contactbench.contacts(x, 0.5, box, arithmetic="exact-open")[0]) == 0
        assert len(contactbench.contacts(x, 0.5, box)[0]) == 1


def test_the_truth_of_the_kit_leaves_out_exact_ties_alone():
    from contactbench.kit import systems
    from contactbench.kit.truth import half_list, squares

    for name in ("cube", "skewed", "slab"):
        cell, pbc = CELLS[name]
        flags = tuple(np.broadcast_to(pbc, 3).tolist())
        system = systems.System(places(), cell, flags, 1.5)
        closed = half_list(system, "<=")
        signs = squares(system, closed, np.ones(len(closed), bool), 1.5)
        assert (signs <= 0).all() and (signs == 0).any()
        np.testing.assert_array_equal(half_list(system, "<"), closed[signs < 0])
