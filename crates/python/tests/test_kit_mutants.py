"""Each mistake that authors of cell lists make is found, and its cause is named."""

import mutants
import pytest
from mutants import MISTAKES, CellList

import contactbench


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


@pytest.mark.parametrize(
    "mistake", ["mixed", "empty systems skipped", "local numbers", "first cell for all"]
)
def test_mistakes_of_batches_are_found(mistake):
    def wrong(*arguments):
        return mutants.batch(*arguments, mistake=mistake)

    options = {"convention": "ase", "cases": ["batches"]}
    assert contactbench.check_neighbours(CellList(), batch=mutants.batch, **options)
    (failure,) = contactbench.check_neighbours(CellList(), batch=wrong, **options).failures
    assert 1 < len(failure.batch) <= 3 and len(failure.system) <= 4
    assert failure.xyz().count("Lattice") == len(failure.batch)


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
