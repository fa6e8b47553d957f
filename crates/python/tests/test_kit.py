"""The kit for neighbour lists: truth, conventions, failures, and their reports."""

import itertools
import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as xml

import mutants
import numpy as np
import pytest

import contactbench
from contactbench.kit.__main__ import main
from contactbench.kit.cases import CASES
from contactbench.kit.checking import CUTOFFS, systems_of
from contactbench.kit.convention import Convention
from contactbench.kit.recognise import recognise
from contactbench.kit.systems import System, system
from contactbench.kit.truth import half_list, truth, undecided, vectors


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
            assert len(undecided(s)) == 0, f"{case.name}, {number}"
    assert len(undecided(system([[0, 0, 0], [0.1, 0.1, 0.1]], [9, 9, 9], np.sqrt(0.03)))) == 1


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


def test_failures_print_and_save_what_shows_them(tmp_path):
    found = contactbench.check_neighbours(mutants.wrong, cases=["half the cell"])
    (failure,) = found.failures
    assert found.verdict == "wrong" and found.cases == {"half the cell": "wrong"}
    assert len(failure.system) <= 2 < len(failure.given) and len(failure.wrong.missing)
    text = str(found)
    assert text.startswith("WRONG: CellList() in 1 of 1 hard cases\n")
    assert max(len(line) for line in text.splitlines() if "=" not in line) <= 80
    names = sorted(path.name for path in found.save(tmp_path))
    assert names == ["01-half-the-cell.py", "01-half-the-cell.xyz", "check.txt", "junit.xml"]
    suite = xml.fromstring((tmp_path / "junit.xml").read_text())
    assert suite.attrib["failures"] == "1" and failure.cause in suite.find("*/failure").text
    atoms, head, *rest = (tmp_path / "01-half-the-cell.xyz").read_text().splitlines()
    assert int(atoms) == len(rest) == len(failure.system) and "pbc=" in head

    # The program calls the function, and its comments are the rows that are expected.
    program = (tmp_path / "01-half-the-cell.py").read_text()
    program = program.replace("CellList()", "CellList('nearest image only')")
    names = {"print": lambda *arguments, sep: None}
    exec(program, names)
    comments = [line for line in program.splitlines() if line.startswith("# (")]
    assert len(names["answer"][0]) == len(comments) - len(failure.wrong.missing)


def refuses(*arguments):
    raise NotImplementedError("no lists today")


def raises(positions, cell, pbc, cutoff):
    if len(positions) > 40:
        raise RuntimeError("too many atoms")
    return mutants.right(positions, cell, pbc, cutoff)


def hangs(positions, cell, pbc, cutoff):
    while len(positions) > 40:
        pass
    return mutants.right(positions, cell, pbc, cutoff)


def test_what_is_not_answered_is_printed():
    found = contactbench.check_neighbours(refuses, convention="ase", cases=["gas", "ties"])
    assert not found and found.verdict == "nothing" and found.systems == 0
    assert found.refused == {"NotImplementedError: no lists today": 16}
    assert str(found).startswith("NOT CHECKED: ")
    found = contactbench.check_neighbours(mutants.right, convention="ase", seconds=0.0)
    assert not found and set(found.cases.values()) == {"not tried"}
    assert "not tried to the end, because the time was over: liquid" in str(found)
    found = contactbench.check_neighbours(raises, convention="ase", cases=["liquid"])
    assert "it raises RuntimeError: too many atoms" in str(found)
    assert len(found.failures[0].system) == 41
    declared = {"convention": "ase", "cases": ["liquid"], "refuses": (RuntimeError,)}
    assert contactbench.check_neighbours(raises, **declared).verdict == "nothing"
    found = contactbench.check_neighbours(
        hangs, convention="ase", cases=["liquid"], call_seconds=0.1
    )
    assert "liquid: no answer after 0.1 s, the limit call_seconds" in str(found)

    calls = []

    def late(*arguments):
        calls.append(0)
        if len(calls) == 1:
            hangs(*arguments)
        return mutants.right(*arguments)

    found = contactbench.check_neighbours(
        late, convention="ase", cases=["liquid"], call_seconds=0.1
    )
    assert "liquid: no answer after 0.1 s" in str(found)


def test_a_recognised_convention_is_no_surprise():
    def turned(*arguments):
        i, j, shifts = mutants.right(*arguments)
        return i, j, -shifts

    found = contactbench.check_neighbours(turned, cases=["liquid"])
    assert found and "If you meant the convention of ASE, give" in str(found)
    assert not contactbench.check_neighbours(turned, convention="ase", cases=["liquid"])
    found = contactbench.check_neighbours(mutants.right, cases=["liquid"])
    assert found and "If you meant" not in str(found)
    line = refuses.__code__.co_firstlineno + 1
    found = contactbench.check_neighbours(refuses, refuses=(), cases=["liquid"])
    assert f"(test_kit.py, line {line})" in found.trouble
    found = contactbench.check_neighbours(lambda *arguments: None)
    assert "a NoneType, not a tuple of arrays; return three arrays" in found.trouble


def run(*arguments):
    here = Path(__file__).parent
    environment = {**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    return subprocess.run(
        [sys.executable, "-m", *arguments],
        cwd=here,
        env=environment,
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize("source", ["def f(:", "raise OSError('no library')", "raise SystemExit"])
def test_a_module_that_cannot_be_imported_is_not_checked(source, tmp_path, monkeypatch, capsys):
    (tmp_path / "broken.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    assert main(["broken:f"]) == 2
    assert "broken:f cannot be imported: " in capsys.readouterr().err


def test_the_command_line_has_exit_codes(tmp_path):
    report = str(tmp_path / "junit.xml")
    quick = ["--quick", "--case", "half the cell", "--case", "gas", "--junit", report]
    for name, code, word in (("right", 0, "RIGHT"), ("wrong", 1, "WRONG"), ("none", 2, "")):
        done = run("contactbench.kit", f"mutants:{name}", *quick)
        assert (done.returncode, done.stdout[: len(word)]) == (code, word), done.stderr
        assert code == 2 or xml.parse(report).getroot().attrib["tests"] == "2"
    assert "cannot be imported" in done.stderr
    assert main(["--list"]) == 0 and main([]) == 2
    assert main(["test_kit:raises", "--case", "liquid"]) == 1
    assert main(["test_kit:raises", "--case", "liquid", "--refuses", "RuntimeError"]) == 2
    assert main(["test_kit:refuses", "--case", "gas"]) == 2
    assert main(["test_kit:refuses", "--refuses", "Mistake"]) == 2
    only = ["--case", "batches", "--quick"]
    assert main(["mutants:by_offsets", "--batch", *only]) == 0
    assert main(["mutants:right", "--batch", "mutants:by_offsets", *only]) == 0
    assert main(["mutants:right", "--batch", "mutants:mixed", *only]) == 1


def test_pytest_has_one_test_for_each_hard_case(tmp_path):
    options = ["pytest", "-p", "contactbench.kit.plugin", "-q", "--rootdir", str(tmp_path),
               "-p", "no:cacheprovider", "-k", "neighbours or half", str(tmp_path)]  # fmt: skip
    (tmp_path / "test_fixture.py").write_text(
        "import mutants\n"
        "def test_neighbours(contactbench_neighbours):\n"
        "    assert contactbench_neighbours(mutants.right, cases=['gas'])\n"
    )
    done = run(*options, "--contactbench-neighbours", "mutants:right", "--contactbench-quick")
    assert "2 passed" in done.stdout, done.stdout + done.stderr
    assert "convention, recognised: full list, d < cutoff" in done.stdout
    # Without a reporter, as in the workers of pytest-xdist, nothing is printed.
    loud = [option for option in options if option != "-q"]
    silent = run(*loud, "-p", "no:terminal", "--contactbench-neighbours", "mutants:right")
    assert silent.returncode == 0, silent.stderr
    done = run(*options, "--contactbench-neighbours", "mutants:wrong", "--contactbench-quick")
    assert "1 failed, 1 passed" in done.stdout and "only the nearest image" in done.stdout
    assert run(*options, "--contactbench-neighbours", "mutants:none").returncode == 4
    options[options.index("-k") + 1] = "batches"
    for f, batch, words in (
        ("mutants:right", "mutants:by_offsets", "1 passed"),
        ("mutants:by_offsets", "mutants:by_offsets", "1 passed"),
        ("mutants:right", "mutants:mixed", "different systems are listed"),
    ):
        given = ("--contactbench-neighbours", f, "--contactbench-batch", batch)
        done = run(*options, "--contactbench-quick", *given)
        assert words in done.stdout, done.stdout + done.stderr
