"""Verdicts of the kit: what is compared, what is refused, and what counts as a failure."""

import itertools
import time
from dataclasses import replace

import mutants
import numpy as np
import pytest
from mutants import CellList

import contactbench
from contactbench.kit.__main__ import main
from contactbench.kit.asking import Asker
from contactbench.kit.cases import CASES
from contactbench.kit.checking import CUTOFFS, systems_of
from contactbench.kit.systems import OPEN, Refusal, System, system
from contactbench.kit.truth import band, half_list, tolerant_list, undecided, widest_band


def check(f, *cases, **options):
    return contactbench.check_neighbours(f, cases=cases or None, **{"convention": "ase", **options})


def one_row(x, cell, pbc, cutoff):
    """A list that is right, except for one row where rounding decides some pair."""
    i, j, S = mutants.right(x, cell, pbc, cutoff)
    short = len(undecided(System(x, cell, tuple(pbc), cutoff))) > 0
    return (i[:1], j[:1], S[:1]) if short else (i, j, S)


def test_a_pair_near_a_tie_excuses_no_other_pair():
    assert check(mutants.right, "ties", cutoffs=[0.3])
    (failure,) = check(one_row, "ties", cutoffs=[0.3]).failures
    assert len(failure.found.missing)


def test_pairs_near_a_tie_may_be_listed_or_not():
    x = [[0, 0, 0], [0.1, 0.1, 0.1], [0, 0, 0.01]]
    s = system(x, [9, 9, 9], np.sqrt(0.03), OPEN)
    assert len(undecided(s)) == 1

    def listed(*pairs):
        i, j = np.array([*pairs, *(pair[::-1] for pair in pairs)]).T
        return Asker(lambda *_: (i, j, np.zeros((len(i), 3), int))).wrong(s)

    assert listed((0, 2), (1, 2)) is None and listed((0, 1), (0, 2), (1, 2)) is None
    assert listed((0, 1), (0, 2)).missing.tolist() == [[1, 2, 0, 0, 0], [2, 1, 0, 0, 0]]


def test_a_check_that_was_cut_short_is_not_right():
    found = check(mutants.right, seconds=0.05)
    assert not found and found.verdict == "nothing" and "not tried" in found.cases.values()
    assert str(found).startswith("NOT CHECKED: CellList(), because the time was over")
    assert main(["mutants:right", "--seconds", "0.05", "--convention", "ase"]) == 2


def single(x, cell, pbc, cutoff):
    d = np.float32(x[:, None]) - np.float32(x)
    i, j = np.nonzero(((d * d).sum(axis=2) < np.float32(cutoff) ** 2) & ~np.eye(len(x), dtype=bool))
    return i, j, np.zeros((len(i), 3), int)


def test_the_band_holds_pairs_beyond_the_cutoff():
    x = 2.0**20 + np.array([[0.065, 0, 0], [5.06, 0, 0]])
    x[:, 1:] = 0
    s = system(x, [9, 9, 9], 4.98, OPEN)
    assert len(half_list(s)) == 0 and len(single(x, None, None, 4.98)[0]) in (0, 2)
    assert Asker(lambda *_: ([0, 1], [1, 0], np.zeros((2, 3), int)), tolerant=True).wrong(s) is None
    s = system(x, [9, 9, 9], 4.9, OPEN)
    assert Asker(single, tolerant=True).wrong(s) is None


def test_the_widest_band_is_a_bound():
    for case in CASES:
        for s in systems_of(case, CUTOFFS, True, 0):
            if len(s) < 300 and widest_band(s) < s.cutoff:
                rows = half_list(s, "<=", s.cutoff + widest_band(s))
                assert band(s, rows).max(initial=0) <= widest_band(s), case.name
    with pytest.raises(Refusal, match="rounds positions by more than the cutoff"):
        tolerant_list(system(np.full((2, 3), 2.0**40), [9, 9, 9], 1))


def last(lines):
    """Run a program without the line that prints."""
    names = {}
    exec("\n".join(line for line in lines if "print(" not in line), names)
    return names


def test_programs_pass_the_capacity_by_its_keyword():
    (failure,) = check(cut, "capacity").failures
    assert f", max_neighbours={failure.system.capacity})" in failure.program()
    assert len(last(failure.program().splitlines())["answer"][0])


def cut(positions, cell, pbc, cutoff, skin=0.0, *, max_neighbours=10**6):
    return mutants.limited(positions, cell, pbc, cutoff, max_neighbours, cut=True)


@pytest.mark.parametrize("memory", ["F", "strided"])
def test_programs_keep_the_layout_in_memory(memory):
    (failure,) = check(fortran if memory == "F" else strided, "memory layouts").failures
    assert failure.system.memory == memory
    given = failure.system.given()[0]
    x = last(failure.program().splitlines())["positions"]
    assert x.strides == given.strides and np.array_equal(x, given)


def test_programs_repeat_calls():
    (failure,) = check(CellList("every ninth call"), "ten calls").failures
    assert failure.system.calls == 1 or "for _ in range(10):" in failure.program()
    ten = replace(failure, system=replace(failure.system, calls=10), function="m:CellList()")
    assert "for _ in range(10):\n    answer = CellList()(" in ten.program()


def strided(positions, cell, pbc, cutoff):
    bad = not (positions.flags.c_contiguous or positions.flags.f_contiguous)
    i, j, S = mutants.right(positions, cell, pbc, cutoff)
    return (i[:-1], j[:-1], S[:-1]) if bad else (i, j, S)


def fortran(positions, cell, pbc, cutoff):
    bad = not positions.flags.c_contiguous and positions.flags.f_contiguous
    i, j, S = mutants.right(positions, cell, pbc, cutoff)
    return (i[:-1], j[:-1], S[:-1]) if bad else (i, j, S)


def test_a_cause_of_the_given_system_alone_is_not_printed():
    # The pairs of atom 0 are missing. In the given system they are those through faces.
    def bad(x, cell, pbc, cutoff):
        i, j, S = mutants.right(x, cell, pbc, cutoff)
        through = S.any(axis=1) if len(x) > 20 else np.ones(len(i), bool)
        return i[~through], j[~through], S[~through]

    (failure,) = check(bad, "liquid").failures
    assert failure.cause is None, failure.cause


class Panic(BaseException):
    """Like the exception of a panic in Rust."""


@pytest.mark.parametrize("error", [SystemExit(3), Panic("index out of bounds")])
def test_exceptions_that_end_programs_are_failures(error):
    def ends(x, cell, pbc, cutoff):
        if len(x) > 10:
            raise error
        return mutants.right(x, cell, pbc, cutoff)

    (failure,) = check(ends, "liquid").failures
    assert failure.wrong.text == f"it raises {type(error).__name__}: {error}"

    def always(*arguments):
        raise error

    assert "it raises" in contactbench.check_neighbours(always).trouble
    (failure,) = check(mutants.right, "batches", batch=always).failures
    assert "it raises" in failure.wrong.text
    assert check(ends, "liquid", refuses=(SystemExit, Panic)).verdict == "nothing"


def test_an_interrupt_ends_the_check():
    def interrupted(*arguments):
        raise KeyboardInterrupt

    for convention in ("ase", None):
        with pytest.raises(KeyboardInterrupt):
            check(interrupted, "liquid", convention=convention)


@pytest.mark.parametrize(
    "answer",
    [
        ([[0], [1, 2]], [0], [[0, 0, 0]]),
        ([0], [1], [[0, 0], [0]]),
        ([0], [1], [["a", "b", "c"]]),
        ([0], [1], [[np.nan, 0, 0]]),
        ([0], [1], [[np.inf, 0, 0]]),
        ([0], [1], [[None, 0, 0]]),
        (),
        None,
        5,
    ],
)
def test_answers_that_are_no_lists_are_failures(answer):
    for convention in (None, "ase", "shifts=vectors", "layout=matrix", "layout=rows,shifts=none"):
        found = check(lambda *_: answer, "liquid", convention=convention)
        assert found.trouble or found.failures


@pytest.mark.parametrize(
    "options, words",
    [
        ({"cases": ["melt"]}, "there is no case 'melt'; the cases are: liquid"),
        ({"division": "f32"}, "division is 'f32'"),
        ({"cutoffs": [0.0]}, "cutoffs are"),
        ({"convention": "order=2"}, "no field 'order'"),
        ({"seed": -1}, "seed is -1; give a whole number of at least 0"),
        ({"convention": "base=x"}, "base of the convention is 'x'; give one of 0, 1"),
        ({"call_seconds": 0}, "call_seconds is 0; give a number above 0"),
        ({"seconds": np.nan}, "seconds is nan; give a number of at least 0"),
        ({"cutoffs": ["wide"]}, "cutoffs are .*; give a sequence of numbers"),
    ],
)
def test_wrong_options_are_refused(options, words):
    with pytest.raises(ValueError, match=words):
        contactbench.check_neighbours(mutants.right, **{"cases": ["gas"], **options})


def test_reports_need_a_folder(tmp_path, capfd):
    arguments = ["mutants:right", "--case", "gas", "--convention", "ase"]
    assert main([*arguments, "--junit", str(tmp_path / "missing" / "junit.xml")]) == 2
    assert "there is no folder" in capfd.readouterr().err
    (tmp_path / "file").write_text("")
    assert main([*arguments, "--save", str(tmp_path / "file")]) == 2
    assert "the report cannot be written" in capfd.readouterr().err


def test_the_form_of_batches_is_recognised_beside_a_declared_convention():
    for options in ({"f": mutants.right, "batch": mutants.by_offsets},
                    {"f": mutants.by_offsets, "batch": True}):  # fmt: skip
        result = contactbench.check_neighbours(**options, convention="ase", cases=["batches"], quick=True)
        assert result and result.convention.systems == "offsets"
        result = contactbench.check_neighbours(**options, cases=["batches"], quick=True)
        assert result and "convention='ase'" not in str(result)


def test_a_shortcut_for_one_system_does_not_hide_the_form_of_batches():
    def short(positions, cells, pbcs, cutoff, offsets):
        if len(cells) == 1:
            return mutants.right(positions, cells[0], pbcs[0], cutoff)
        return mutants.by_offsets(positions, cells, pbcs, cutoff, offsets)

    assert contactbench.check_neighbours(short, batch=True, cases=["batches", "gas"], quick=True)


@pytest.mark.parametrize("case", ["zero vectors of open axes", "batches"])
def test_a_call_that_hangs_is_wrong_where_an_error_would_be_a_refusal(case):
    def hangs(positions, cell, pbc, cutoff):
        if not cell.any():
            time.sleep(1.0)
        return mutants.right(positions, cell, pbc, cutoff)

    def together(positions, cells, pbcs, cutoff, systems):
        if not cells.any(axis=(1, 2)).all():
            time.sleep(1.0)
        return mutants.batch(positions, cells, pbcs, cutoff, systems)

    result = contactbench.check_neighbours(hangs, batch=together, convention="ase", cases=[case],
                              call_seconds=0.2)  # fmt: skip
    assert not result and "no answer after 0.2 s" in str(result)
    assert "Hang" not in str(result) and result.failures[0].cause is None


def test_an_answer_that_changes_from_call_to_call_is_printed():
    calls = itertools.count()

    def flaky(positions, cells, pbcs, cutoff, systems):
        i, j, S = mutants.batch(positions, cells, pbcs, cutoff, systems)
        keep = len(i) if next(calls) % 3 else 0
        return i[:keep], j[:keep], S[:keep]

    def single(positions, cell, pbc, cutoff):
        systems = np.zeros(len(positions), dtype=int)
        return flaky(positions, cell[None], pbc[None], cutoff, systems)

    for f, batch in ((mutants.right, flaky), (single, None)):
        options = {"batch": batch, "convention": "ase,systems=index", "quick": True}
        assert "WRONG" in str(contactbench.check_neighbours(f, **options))
