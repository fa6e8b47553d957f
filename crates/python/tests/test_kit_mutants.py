"""Each mistake that authors of cell lists make is found, and its cause is named."""

from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import mutants
import numpy as np
import pytest
from mutants import BATCH_MISTAKES, MISTAKES, CellList

import contactbench
from contactbench.kit import batches, shrinking
from contactbench.kit.systems import system


@pytest.fixture(autouse=True)
def no_time_passes(monkeypatch):
    """Systems are shrunk to the end, however slow the machine is."""
    for module in (batches, shrinking):
        monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: 0.0))


def test_a_right_cell_list_passes():
    found = contactbench.check_neighbours(CellList(), quick=True, batch=mutants.batch)
    assert found and found.recognised and set(found.cases.values()) == {"right", "refused"}
    assert [name for name, state in found.cases.items() if state == "refused"] == ["capacity"]
    assert found.convention == contactbench.Convention() and found.systems > 130
    assert "RIGHT: CellList()" in str(found)


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_found(mistake):
    case, cause = MISTAKES[mistake]
    options = {"quick": True, "convention": "ase", "cases": [case]}
    assert contactbench.check_neighbours(CellList(), **options)
    found = contactbench.check_neighbours(CellList(mistake), **options)
    (failure,) = found.failures
    assert not found and failure.case == case
    assert len(failure.system) <= (34 if "32" in mistake else 9)
    assert cause is None or cause in failure.cause, failure.cause


@pytest.mark.parametrize(
    "mistake, text",
    [
        ("columns for rows", "cell in columns"),
        ("<=", "d <= cutoff"),
        ("half list", "half list"),
        ("sign of S", "- S @ cell"),
        ("S of wrapped atoms", "of wrapped atoms"),
        ("no own images", "without own images"),
    ],
)
def test_a_mistake_that_is_a_convention_is_printed(mistake, text):
    found = contactbench.check_neighbours(CellList(mistake), cases=["liquid", "slabs", "ties"])
    assert found and text in str(found.convention) and text in " ".join(str(found).split())


@pytest.mark.parametrize("mistake", ["half stencil doubled", "each pair twice"])
def test_a_mistake_that_is_no_convention_fails_at_once(mistake):
    found = contactbench.check_neighbours(CellList(mistake))
    assert not found and "listed too often" in found.trouble


@pytest.mark.parametrize("mistake", BATCH_MISTAKES)
@pytest.mark.parametrize("form", [mutants.batch, mutants.by_offsets])
def test_a_mistake_of_batches_is_found(mistake, form):
    systems = "offsets" if form is mutants.by_offsets else "index"
    options = {"quick": True, "convention": f"systems={systems}", "cases": ["batches"]}
    wrong = partial(form, mistake=mistake)
    (failure,) = contactbench.check_neighbours(CellList(), batch=wrong, **options).failures
    cause = BATCH_MISTAKES[mistake]
    assert cause is None or cause in str(failure.cause), failure.cause
    assert len(failure.batch) <= (33 if "32" in mistake else 3) and len(failure.system) <= 5
    assert failure.xyz().count("Lattice") == len(failure.batch)
    division = "np.array([0" if systems == "offsets" else "np.repeat(range("
    assert division in failure.program()


@pytest.mark.parametrize("form", [mutants.batch, mutants.by_offsets])
def test_a_function_may_take_batches_only(form):
    found = contactbench.check_neighbours(form, quick=True, batch=True)
    assert found and found.recognised and found.cases["batches"] == "right", found
    assert found.convention.systems == ("index" if form is mutants.batch else "offsets")
    both = contactbench.check_neighbours(CellList(), batch=form, cases=["batches", "gas"])
    assert both and both.convention == found.convention
    wrong = partial(form, mistake="local numbers")
    found = contactbench.check_neighbours(wrong, quick=True, batch=True)
    assert [failure.case for failure in found.failures] == ["batches"]
    assert found.convention.systems == both.convention.systems
    wrong = partial(form, mistake="last atom left out")
    found = contactbench.check_neighbours(wrong, batch=True)
    assert "missing of 12 rows" in found.trouble, found.trouble


def test_a_single_system_is_a_batch_of_one():
    def f(*given):
        return mutants.by_offsets(*given, mistake="last atom left out")

    options = {"batch": True, "convention": "systems=offsets", "quick": True}
    (failure,) = contactbench.check_neighbours(f, cases=["gas"], **options).failures
    assert len(failure.batch) == 1
    names = {"f": lambda *given: (given[1].shape, given[2].shape, given[4].tolist())}
    exec(failure.program().replace("print(", "(lambda *_, **__: 0)("), names)
    assert names["answer"] == ((1, 3, 3), (1, 3), [0, len(failure.system)])


def test_pairs_of_a_batch_are_shown_in_their_own_cells():
    cubes = tuple(system([[0, 0, 0]], [size] * 3, 5.0) for size in (9, 4))
    rows = np.array([[1, 1, 0, 0, 1], [0, 1, 0, 0, 0]])
    options = {"quick": True, "cases": ["batches"], "convention": "ase"}
    wrong = partial(mutants.batch, mistake="local numbers")
    (failure,) = contactbench.check_neighbours(CellList(), batch=wrong, **options).failures
    shown = replace(failure, batch=cubes, wrong=replace(failure.wrong, missing=rows))
    assert "missing: (1, 1), S = [0, 0, 1], distance 4.0\n" in str(shown)
    assert "missing: (0, 1), atoms of the systems 0 and 1\n" in str(shown)


def test_a_list_that_is_cut_at_its_capacity_is_found():
    def cut(positions, cell, pbc, cutoff, max_neighbours=10**6):
        return mutants.limited(positions, cell, pbc, cutoff, max_neighbours, cut=True)

    options = {"quick": True, "cases": ["capacity"], "convention": "ase"}
    found = contactbench.check_neighbours(mutants.limited, **options)
    assert found and found.systems == 2
    (failure,) = contactbench.check_neighbours(cut, **options).failures
    assert failure.given.note == "the capacity is exceeded by one"
    assert len(failure.wrong.missing) and "capacity" in failure.cause


def test_single_precision_is_judged_by_its_band():
    single = CellList("single precision")
    found = contactbench.check_neighbours(single, quick=True, division="tolerant")
    assert found and 0 < found.band and "rounding band up to" in str(found)
    for mistake in ("first images only", "capacity of 32", "sign of the volume"):
        case, _ = MISTAKES[mistake]
        assert not contactbench.check_neighbours(
            CellList(mistake), quick=True, division="tolerant", cases=[case]
        )
