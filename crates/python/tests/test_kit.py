"""The kit for neighbour lists: truth, conventions, failures, and their reports."""

import itertools

import numpy as np
import pytest

import contactbench
from contactbench.kit.cases import CASES
from contactbench.kit.checking import CUTOFFS, systems_of
from contactbench.kit.convention import Convention
from contactbench.kit.recognise import recognise
from contactbench.kit.systems import System, system
from contactbench.kit.truth import fair, half_list, truth, vectors


def brute(s, rule="<"):
    """All pairs by trying all images, in whole numbers where floats are exact."""
    n = 4
    shifts = np.array(list(itertools.product(range(-n, n + 1), repeat=3)))
    shifts = shifts[(shifts * ~np.array(s.pbc) == 0).all(axis=1)]
    rows = [(i, j, *S) for i in range(len(s)) for j in range(i, len(s)) for S in shifts.tolist()]
    rows = [row for row in rows if row[0] < row[1] or tuple(row[2:]) > (0, 0, 0)]
    rows = np.array(rows, dtype=np.int64).reshape(-1, 5)
    d2 = (vectors(s, rows) ** 2).sum(axis=1)
    limit = s.cutoff**2
    return rows[d2 < limit if rule == "<" else d2 <= limit]


@pytest.mark.parametrize("rule", ["<", "<="])
@pytest.mark.parametrize("pbc", [(True, True, True), (True, False, True), (False, False, False)])
def test_truth_is_that_of_all_pairs(rule, pbc):
    x = np.array(list(itertools.product(range(3), repeat=3)), float)[:14]
    for cell in (np.diag([3.0, 3.0, 3.0]), np.array([[3, 0, 0], [1, -2, 0], [0.5, 0, 2.0]])):
        s = system(x, cell, 2.0, pbc)
        i, j, S = truth(s.positions, s.cell, pbc, 2.0, rule)
        found = np.column_stack([i, j, S])
        right = brute(s, rule)
        assert {*map(tuple, found.tolist())} == {*map(tuple, right.tolist())} and len(found)
        assert (np.lexsort(found.T[::-1]) == np.arange(len(found))).all()


def test_ties_are_decided_in_whole_numbers():
    # 0.1 + 0.2 > 0.3, but floats may not decide so after squaring.
    x = [[0.1, 0, 0], [-0.2, 0, 0]]
    open_ = (False, False, False)
    for cutoff, rule, pairs in ((0.3, "<=", 0), (0.1 + 0.2, "<=", 1), (0.1 + 0.2, "<", 1)):
        assert len(half_list(system(x, [9, 9, 9], cutoff, open_), rule)) == pairs
    assert len(half_list(system([[0, 0, 0], [3, 4, 0]], [9, 9, 9], 5, open_), "<")) == 0


def test_careful_arithmetic_decides_all_hard_cases():
    for case in CASES:
        for number, s in enumerate(systems_of(case, CUTOFFS, True, 0)):
            assert fair(s), f"{case.name}, {number}"
    assert not fair(system([[0, 0, 0], [0.1, 0.1, 0.1]], [9, 9, 9], np.sqrt(0.03)))


def listed(convention):
    """A right list in a convention."""

    def call(x, cell, pbc, cutoff):
        s = System(x, cell.T if convention.cell == "columns" else cell, tuple(pbc), cutoff)
        rows = half_list(s, convention.rule)
        rows = rows if convention.self_images else rows[rows[:, 0] != rows[:, 1]]
        if convention.pairs == "full":
            rows = np.vstack([rows, np.hstack([rows[:, [1, 0]], -rows[:, 2:]])])
        if convention.self_pairs:
            rows = np.vstack([rows, np.arange(len(x))[:, None] * [[1, 1, 0, 0, 0]]])
        D, S = vectors(s, rows), rows[:, 2:]
        if convention.wrapped:
            S = S - s.boxes()[rows[:, 0]] + s.boxes()[rows[:, 1]]
        third = {"S": (convention.sign * S,), "vectors": (convention.sign * D,), "none": ()}
        pairs = rows[:, :2].T + convention.base
        if convention.padding:
            pairs = np.hstack([pairs, np.full((2, 3), len(x) + 5)])
            third = {kind: tuple(np.vstack([t, t[:1] * 0, t[:1] * 0, t[:1] * 0]) for t in value)
                     for kind, value in third.items()}  # fmt: skip
        if convention.layout == "flat":
            return (*pairs, *third[convention.shifts])
        return (pairs if convention.layout == "columns" else pairs.T, *third[convention.shifts])

    return call


THIRDS = ["shifts=S", "shifts=S,sign=-1", "shifts=S,wrapped=true", "shifts=vectors",
          "shifts=vectors,sign=-1", "shifts=none"]  # fmt: skip
TEXTS = [
    ",".join(parts)
    for parts in itertools.product(
        ("pairs=full", "pairs=half"), ("rule=<", "rule=<="), THIRDS, ("cell=rows", "cell=columns")
    )
] + [
    "base=1", "self_pairs=true", "self_images=false", "padding=true", "layout=rows",
    "layout=columns,shifts=none", "base=1,pairs=half,self_pairs=true,self_images=false",
]  # fmt: skip


@pytest.mark.parametrize("text", TEXTS)
def test_conventions_are_recognised(text):
    convention = Convention.parse(text)
    call = listed(convention)

    def asked(s, tried):
        x, cell, pbc, cutoff = s.given()
        return call(x, cell.T.copy() if tried.cell == "columns" else cell, pbc, cutoff)

    found = recognise(asked, ())
    assert not found.trouble and found.convention == convention


def test_an_unknown_convention_is_a_failure_with_the_closest():
    def fewer(x, cell, pbc, cutoff):
        i, j, S = listed(Convention.parse("rule=<="))(x, cell, pbc, cutoff)
        return i[1:], j[1:], S[1:]

    found = contactbench.check_neighbours(fewer)
    assert not found and "1 missing" in found.trouble and "d <= cutoff" in found.trouble
    assert "WRONG: " in str(found) and found.systems == 0
    with pytest.raises(ValueError, match="rule of the convention is '='"):
        contactbench.check_neighbours(fewer, convention="rule==")
