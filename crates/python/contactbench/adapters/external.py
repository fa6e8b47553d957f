"""Neighbour lists in any language, as programs.

A program reads a system from standard input, all numbers separated by blanks or newlines:

    N cutoff px py pz           px is 1 if the first vector is periodic, else 0
    a1 a2 a3 b1 b2 b3 c1 c2 c3  the vectors of the cell, zero if open and without extent
    x y z                       N times, with 17 digits

It writes a line ``i j S1 S2 S3`` for each pair of its list, with atoms numbered from 0 and
``D = x[j] - x[i] + S @ cell``. A status other than 0 is an error; the last line of standard error
is its message. `program` turns a command into a function. Examples are list.cpp and
the source in zelll_rust.py.
"""

import os
import subprocess
from pathlib import Path
from zlib import crc32

import numpy as np

FOLDER = Path(__file__).parent
CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "contactbench" / "lists"


def program(command, timeout=60.0):
    """Return a function (positions, cell, pbc, cutoff) -> i, j, S that starts a program."""

    def neighbour_list(positions, cell, pbc, cutoff):
        x = np.asarray(positions, float)
        flags = " ".join(str(int(p)) for p in pbc)
        numbers = np.concatenate([np.asarray(cell, float).ravel(), x.ravel()])
        text = f"{len(x)} {cutoff!r} {flags}\n" + "\n".join(map(repr, numbers.tolist())) + "\n"
        ended = subprocess.run(
            command, input=text, capture_output=True, text=True, timeout=timeout, check=False
        )
        if ended.returncode:
            message = (ended.stderr.strip().splitlines() or ["it wrote no message"])[-1]
            raise RuntimeError(f"{command[0]} ended with the status {ended.returncode}: {message}")
        found = np.array(ended.stdout.split(), np.int64).reshape(-1, 5)
        return found[:, 0], found[:, 1], found[:, 2:]

    return neighbour_list


def compiled(source, command):
    """Return the path of a program, compiled if its source or the command has changed."""
    CACHE.mkdir(parents=True, exist_ok=True)
    # The command names the library, which may move with its environment.
    path = CACHE / f"{source.name.replace('.', '-')}-{crc32(' '.join(command).encode()):08x}"
    if not path.exists() or path.stat().st_mtime < source.stat().st_mtime:
        made = subprocess.run(
            [*command, "-o", str(path)], cwd=CACHE, capture_output=True, text=True, check=False
        )
        if made.returncode:
            raise RuntimeError(f"{source.name} could not be compiled: {made.stderr.strip()[-300:]}")
    return path
