"""The memory of each library's neighbour list: ``python3 examples/liquid/memory.py``, on Linux.

The liquid is repeated 2 x 2 x 2 (32,000 atoms); atoms have 40 neighbours. The program prints bytes
per row of a list; a full list has two rows per pair. *list* are the bytes of the list, *peak* is
the most resident memory that the first long call adds, with its list. A call with 200 atoms comes
before it, so that no code is loaded later.
"""

import pathlib
import subprocess
import sys

import numpy as np

from contactbench.adapters import ADAPTERS, listed

HERE = pathlib.Path(__file__).parent


def resident(field):
    lines = pathlib.Path("/proc/self/status").read_text().splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith(field))


def sizes(answer):
    # The list of LAMMPS stays in its process, and is counted in the growth alone.
    if isinstance(answer, int):
        return 0
    parts = answer.values() if isinstance(answer, dict) else answer
    return sum(part.nbytes for part in parts if hasattr(part, "nbytes"))


def measure(name):
    header, *rows = (HERE / "liquid.xyz").read_text().splitlines()[1:]
    side = float(header.split('"')[1].split()[0])
    shifts = np.array(list(np.ndindex(2, 2, 2))) * side
    x = (np.loadtxt(rows) + shifts[:, None]).reshape(-1, 3)
    cutoff = (40 / (len(x) / (2 * side) ** 3 * 4 / 3 * np.pi)) ** (1 / 3)
    pbc = [True] * 3
    ADAPTERS[name].prepare(x[:200], np.eye(3) * 2 * side, pbc, cutoff)()
    search = ADAPTERS[name].prepare(x, np.eye(3) * 2 * side, pbc, cutoff)
    pathlib.Path("/proc/self/clear_refs").write_text("5")
    before = resident("VmRSS")
    answer = search()
    most = resident("VmHWM") - before
    pairs = len(listed(search, answer)[0])
    size = sizes(answer) / pairs
    print(f"| {name} | {ADAPTERS[name].version} | {pairs} | {size:.0f} | {most / pairs:.0f} |")


if len(sys.argv) > 1:
    measure(sys.argv[1])
else:
    print("| library | version | rows | list, bytes per row | peak, bytes per row |")
    print("|---|---|---:|---:|---:|", flush=True)
    for name, adapter in ADAPTERS.items():
        command = [sys.executable, __file__, name]
        ended = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
        reason = adapter.missing or (ended.stderr.strip().splitlines() or ["no message"])[-1]
        print(ended.stdout.strip() if not ended.returncode else f"| {name} | {reason} | | | |", flush=True)
