"""Find known defects of released neighbour lists again, and show that the repaired ones pass.

    cd crates/python && python -m defects [NAME ...] [--full] [--python FOLDER]

`defects.toml` names for each defect the release that has it, the release that repairs it, the
thread that reports it, and the hard case of `contactbench.check_neighbours` that finds it. `uv run`
makes an environment for each release; interpreters from 3.7 to 3.12 and a C compiler are needed.
Without `uv`, `--python FOLDER` runs `FOLDER/LIBRARY-VERSION/bin/python`.

The program prints a Markdown table: `s` is the time of the hard cases, in their order, up to the
first that fails. It fails if a defect is not found in the bad release, or if an alarm sounds in the
good one. NAME selects libraries. `--full` tries all systems of each hard case in good releases.
Adapters decline systems outside the documented domain of a library. Some lists are slow when called
for many small systems; `cases` restricts the hard cases for them.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
from contactbench import check_neighbours
from contactbench.kit.checking import chosen_cases

HERE = Path(__file__).parent


class Release:
    """A neighbour list of one release, as a function that asks another process."""

    def __init__(self, defect: dict[str, Any], version: str, folder: Path | None) -> None:
        package = defect.get("package", defect["library"])
        good = defect if version == defect["bad"] else defect | {
            name: defect[f"good_{name}"] for name in ("python", "needs") if f"good_{name}" in defect
        }  # fmt: skip
        needs = [f"{package}=={version}", *good.get("needs", ["numpy"])]
        self.__name__ = f"{defect['library']} {version}"
        self.command = ["uv", "run", "--quiet", "--no-project", "--isolated"]
        self.command += ["--python", good.get("python", "3.11")]
        self.command += [word for need in needs for word in ("--with", need)] + ["python"]
        if folder:
            self.command = [str(folder / f"{defect['library']}-{version}" / "bin" / "python")]
        self.command += [str(HERE / "adapters.py")]
        self.command += [defect.get("adapter", defect["library"])]
        self.process: subprocess.Popen[str] | None = None

    def __call__(self, positions: Any, cell: Any, pbc: Any, cutoff: float) -> tuple[Any, ...]:
        if self.process is None or self.process.poll() is not None:
            self.process = subprocess.Popen(
                self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL, text=True,
            )  # fmt: skip
        assert self.process.stdin and self.process.stdout
        given = {
            "positions": np.asarray(positions).tolist(), "cell": np.asarray(cell).tolist(),
            "pbc": [bool(p) for p in pbc], "cutoff": cutoff, "dtype": str(positions.dtype),
        }  # fmt: skip
        try:
            self.process.stdin.write(json.dumps(given) + "\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            pass
        try:
            line = self.process.stdout.readline()
        except BaseException:  # An answer that is late must not be read as the next one.
            self.close()
            raise
        if not line:
            raise RuntimeError(f"the process ended with status {self.process.wait()}")
        answer = json.loads(line)
        if "refused" in answer:
            raise NotImplementedError(answer["refused"])
        if "error" in answer:
            raise RuntimeError(answer["error"])
        i, j, *shifts = answer["pairs"]
        return np.array(i, int), np.array(j, int), *(np.array(s).reshape(-1, 3) for s in shifts)

    def close(self) -> None:
        if self.process is not None:
            self.process.kill()
            self.process.wait()


def check(release: Release, defect: dict[str, Any], cases: list[str], quick: bool) -> Any:
    return check_neighbours(
        release, quick=quick, cases=cases, convention=defect.get("convention", "ase"),
        division=defect.get("division", "exact"), name=release.__name__, call_seconds=300.0,
    )  # fmt: skip


def seconds_until_found(release: Release, defect: dict[str, Any]) -> float:
    """Return the time of the hard cases, in their order, up to the first that fails."""
    started = time.monotonic()
    for case in chosen_cases(defect.get("cases")):
        if check(release, defect, [case.name], True).failures:
            break
    return time.monotonic() - started


def examine(defect: dict[str, Any], full: bool, folder: Path | None) -> tuple[str, list[str]]:
    """Return a row of the table and the complaints."""
    complaints = []
    every = [case.name for case in chosen_cases(defect.get("cases"))]
    bad = Release(defect, defect["bad"], folder)
    try:
        check(bad, defect, every[:1], True)  # Start the process.
        seconds = seconds_until_found(bad, defect)
        found = check(bad, defect, [defect["case"]], False)
    finally:
        bad.close()
    wrong = "not found"
    if found.failures:
        wrong = f"{found.failures[0].wrong} ({len(found.failures[0].system)} atoms)"
    else:
        complaints.append(f"{bad.__name__}: {defect['case']!r} does not find the defect\n{found}")
    right = "none yet"
    if "good" in defect:
        good = Release(defect, defect["good"], folder)
        try:
            result = check(good, defect, every, not full)
        finally:
            good.close()
        right = f"{defect['good']} ({result.systems} systems)"
        if not result:
            complaints.append(f"{good.__name__}: an alarm\n{result}")
    threads = ", ".join(f"[{n}]({url})" for n, url in enumerate(defect["threads"], 1))
    row = [
        f"{defect['library']} {defect['bad']}", defect["what"], threads, defect["case"], wrong,
        f"{seconds:.1f}", right,
    ]  # fmt: skip
    return "| " + " | ".join(row) + " |", complaints


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m defects", description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="libraries; by default all")
    parser.add_argument("--full", action="store_true", help="try all systems in good releases")
    parser.add_argument("--python", type=Path, metavar="FOLDER", help="environments of releases")
    options = parser.parse_args()
    table = tomllib.loads((HERE / "defects.toml").read_text())["defect"]
    chosen = [d for d in table if not options.names or d["library"] in options.names]
    if not chosen:
        parser.error(f"no such library; give {', '.join(sorted({d['library'] for d in table}))}")
    print("| release | defect | threads | hard case | found | s | right in |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    complaints = []
    for defect in chosen:
        row, more = examine(defect, options.full, options.python)
        print(row, flush=True)
        complaints += more
    print(*complaints, sep="\n\n", file=sys.stderr)
    return bool(complaints)


if __name__ == "__main__":
    sys.exit(main())
