"""Each adapter of a library on simple hard cases, and programs that adapters call."""

import pathlib
import re

import numpy as np
import pytest

from contactbench import check_neighbours
from contactbench.adapters import ADAPTERS, external
from contactbench.kit.naming import function_of

CASES = [
    "liquid", "no atoms", "one atom", "no periodic axis", "slabs", "wires", "skewed cells",
    "rotated cells", "left-handed cells", "cutoff beyond the cell", "outside the cell",
    "two atoms at one place", "ties",
]  # fmt: skip
# A case with atoms outside the cell, in which pairs are missed without an error.
WRONG = {"mdtraj": {"outside the cell"}}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", ADAPTERS)
def test_a_library_passes_the_check(name):
    adapter = ADAPTERS[name]
    if adapter.missing:
        pytest.skip(adapter.missing)
    if adapter.command == "cargo" and not [*external.CACHE.glob("list-rs-*")]:
        pytest.skip("its program is not compiled, which takes minutes; call the adapter once")
    _, options = function_of(name)
    check = check_neighbours(adapter, cases=CASES, quick=True, **options)
    wrong = {case for case, state in check.cases.items() if state == "wrong"}
    assert check.systems and wrong == WRONG.get(name, set()), str(check)


def test_a_program_that_fails_reports_its_last_line():
    failing = external.program(["sh", "-c", "cat > /dev/null; echo no memory >&2; exit 3"])
    with pytest.raises(RuntimeError, match="sh ended with the status 3: no memory"):
        failing(np.zeros((2, 3)), np.eye(3), [True] * 3, 1.0)


def test_a_program_reads_all_digits():
    echo = "read n c p; read x; printf '%s\\n' 0 1 0 0 0; [ \"$n$c$x\" = 20.10.30000000000000004 ]"
    cell = np.eye(3) * (0.1 + 0.2)
    answer = external.program(["bash", "-c", echo])(np.zeros((2, 3)), cell, [0] * 3, 0.1)
    assert [part.tolist() for part in answer] == [[0], [1], [[0, 0, 0]]]


def test_the_page_prints_what_it_shows(capsys):
    if ADAPTERS["vesin"].missing:
        pytest.skip(ADAPTERS["vesin"].missing)
    page = (pathlib.Path(__file__).parents[3] / "docs" / "NEIGHBOURS.md").read_text()
    blocks = re.findall(r"^```(python|text)\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    assert [kind for kind, _ in blocks] == ["text", "python", "text", "python", "text"]
    names = {}
    for (_, code), (_, shown) in zip(blocks[1::2], blocks[2::2], strict=True):
        exec(compile(code, "NEIGHBOURS.md", "exec"), names)
        printed = capsys.readouterr().out
        # The numbers change with each new case.
        verdict, printed = (re.sub(r"\d+", "#", text) for text in (shown, printed))
        assert printed.startswith(verdict.splitlines()[0])


def test_a_program_that_shows_a_failure_calls_the_adapter(capsys):
    if ADAPTERS["scipy"].missing:
        pytest.skip(ADAPTERS["scipy"].missing)
    check = check_neighbours(ADAPTERS["scipy"], convention="pairs=half", cases=["ties"], quick=True)
    program = check.failures[0].program()
    exec(compile(program, "program", "exec"), {})
    assert "from contactbench.adapters import ADAPTERS" in program
    assert capsys.readouterr().out.count("\n") >= 3


@pytest.mark.parametrize("name", [name for name, a in ADAPTERS.items() if a.batches])
def test_batches_of_an_adapter_are_right(name):
    if ADAPTERS[name].missing or name == "nvalchemi":
        pytest.skip(ADAPTERS[name].missing or "its cell list of batches raises an exception")
    _, options = function_of(name)
    check = check_neighbours(ADAPTERS[name], cases=["batches"], quick=True, **options)
    assert check and check.systems == 17 and check.convention.systems == "offsets", str(check)
