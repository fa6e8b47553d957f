"""Each adapter of a library, on small systems, against all pairs of all images in fractions."""

import itertools
import pathlib
import re
from fractions import Fraction

import numpy as np
import pytest

from contactbench import check_neighbours
from contactbench.adapters import ADAPTERS, external
from contactbench.kit.naming import function_of

SKEWED = [[5, 0, 0], [1.5, 5, 0], [-1, 2, 6]]
ROTATED = [[5, 1, 0.5], [1.5, 5, -0.3], [-1, 2, 6]]
LEFT = [[0, 5, 0], [5, 0, 0], [0, 0, 6]]
random = np.random.default_rng(1).random((40, 3))
lattice = np.array(list(itertools.product(range(4), repeat=3)), float)

# Positions, cell, periodic axes, cutoff.
SYSTEMS = {
    "open": (random * 4, np.zeros((3, 3)), "", 1.3),
    "periodic": (random * 5, np.eye(3) * 5, "xyz", 1.7),
    "atoms outside": (random * 20 - 10, np.eye(3) * 5, "xyz", 1.7),
    "smaller than the cutoff": (random[:5] * 2, np.eye(3) * 2, "xyz", 3.1),
    "slab": (random * 5, np.diag([5, 5, 9]), "xy", 1.7),
    "wire": (random * 5, np.diag([9, 5, 9]), "y", 1.7),
    "skewed": (random @ SKEWED, SKEWED, "xyz", 1.7),
    "rotated": (random @ ROTATED, ROTATED, "xyz", 1.7),
    "left-handed": (random @ LEFT, LEFT, "xyz", 1.7),
    "two at one place": ([[1, 1, 1], [1, 1, 1], [2, 1, 1]], np.eye(3) * 4, "xyz", 1.5),
    "one atom": ([[0, 0, 0]], np.eye(3), "xyz", 1.5),
    "no atoms": (np.zeros((0, 3)), np.eye(3), "xyz", 0.4),
    "periodic lattice of ties": (lattice, np.eye(3) * 4, "xyz", 1.0),
    "open lattice of ties": (lattice, np.zeros((3, 3)), "", 1.0),
}
# Atoms outside the cell: pairs are missed, and no error is reported.
WRONG = {("mdtraj", "atoms outside")}


def all_pairs(x, cell, pbc, cutoff, rule):
    """The full list, decided in fractions."""
    cell = np.where(pbc[:, None], cell, 0.0)
    exact = np.vectorize(lambda value: Fraction(float(value)), otypes=[object])
    far = [range(0, 1)] * 3
    if pbc.any() and len(x):
        inverse = np.linalg.pinv(cell)
        most = np.ptp(x @ inverse, axis=0) + cutoff * np.linalg.norm(inverse, axis=0) + 1
        far = [range(-int(m), int(m) + 1) if p else range(1) for m, p in zip(most, pbc)]
    found = set()
    for S in itertools.product(*far):
        near = ((x[None] - x[:, None] + S @ cell) ** 2).sum(axis=2) < 1.01 * cutoff**2
        for i, j in np.argwhere(near):
            d = exact(x[j]) - exact(x[i]) + np.array(S, object) @ exact(cell)
            over = d @ d - Fraction(cutoff) ** 2
            if (i != j or any(S)) and (over < 0 or rule == "<=" and over == 0):
                found.add((int(i), int(j), *S))
    return found


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("name", ADAPTERS)
def test_a_library_lists_all_pairs(name, system):
    adapter = ADAPTERS[name]
    if adapter.missing:
        pytest.skip(adapter.missing)
    if adapter.command == "cargo" and not [*external.CACHE.glob("list-rs-*")]:
        pytest.skip("its program is not compiled, which takes minutes; call the adapter once")
    if "ties" in system and adapter.division == "tolerant":
        pytest.skip("rounding decides ties")
    x, cell, axes, cutoff = SYSTEMS[system]
    x, cell, pbc = np.array(x, float), np.array(cell, float), np.array([a in axes for a in "xyz"])
    try:
        i, j, S = adapter(x, cell, pbc, cutoff)
    except NotImplementedError as refusal:
        pytest.skip(str(refusal))
    assert i.shape == j.shape and S.shape == (len(i), 3)
    rows = [tuple(map(int, row)) for row in np.column_stack([i, j, S])]
    if adapter.half:
        rows += [(j, i, -a, -b, -c) for i, j, a, b, c in rows]
    expected = all_pairs(x, cell, pbc, cutoff, adapter.rule)
    if not adapter.self_images:
        expected = {row for row in expected if row[0] != row[1]}
    right = len(rows) == len(set(rows)) and set(rows) == expected
    assert right == ((name, system) not in WRONG), (
        f"missing {sorted(expected - set(rows))[:5]}, extra {sorted(set(rows) - expected)[:5]}, "
        f"{len(rows) - len(set(rows))} repeated"
    )


def test_a_program_that_fails_reports_its_last_line():
    failing = external.program(["sh", "-c", "cat > /dev/null; echo no memory >&2; exit 3"])
    with pytest.raises(RuntimeError, match="sh ended with the status 3: no memory"):
        failing(lattice, np.eye(3), [True] * 3, 1.0)


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
