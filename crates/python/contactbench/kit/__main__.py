"""Checks a neighbour list from the command line: python -m contactbench.kit module:function."""

from __future__ import annotations

import argparse
import builtins
import faulthandler
import logging
import sys
import textwrap
from pathlib import Path

from . import asking
from .checking import check_neighbours, chosen_cases
from .naming import function_of

RIGHT, WRONG, NOT_CHECKED = 0, 1, 2


def parser() -> argparse.ArgumentParser:
    """Return the parser of arguments."""
    p = argparse.ArgumentParser(
        prog="python -m contactbench.kit",
        description="Compare a neighbour list with the exact truth on hard cases.",
        epilog="Exits with 0 if the list is right, 1 if it is wrong, 2 if it was not checked.",
    )
    p.add_argument(
        "function",
        nargs="?",
        help="module:function, f(positions, cell, pbc, cutoff) -> i, j, S; or an adapter",
    )
    p.add_argument("--quick", action="store_true", help="only the first systems of each case")
    p.add_argument("--convention", help="e.g. pairs=half,rule=<= (default: recognised)")
    p.add_argument("--tolerant", action="store_true", help="judge a list that computes in float32")
    p.add_argument(
        "--batch",
        nargs="?",
        const=True,
        help="module:function for several systems at once; no value: the function itself",
    )
    p.add_argument("--case", action="append", help="try only this case; may be repeated")
    p.add_argument("--cutoff", type=float, action="append", help="cutoff (default: 5 and 3)")
    p.add_argument("--seed", type=int, default=0, help="seed of the random systems (default: 0)")
    p.add_argument("--seconds", type=float, help="begin no system after this time")
    p.add_argument("--call-seconds", type=float, default=30.0, help="limit of a call (default: 30)")
    p.add_argument("--junit", help="write a JUnit report to this file")
    p.add_argument("--save", help="write failures to this folder, as .xyz and .py")
    p.add_argument("--refuses", help="builtin exception by which systems are declined")
    p.add_argument("--verbose", action="store_true", help="name each case before it begins")
    p.add_argument("--list", action="store_true", help="print the hard cases and end")
    return p


def _exception(name: str) -> type[Exception]:
    found = getattr(builtins, name, None)
    if not (isinstance(found, type) and issubclass(found, Exception)):
        raise ValueError(f"{name} is not a builtin exception; give one, such as ValueError")
    return found


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit code."""
    given = parser().parse_args(arguments)
    if given.list:
        for case in chosen_cases(batch=True):
            print(textwrap.fill(f"{case.name}: {case.reason}", 80, subsequent_indent="    "))
        return RIGHT
    if given.function is None:
        parser().print_usage(sys.stderr)
        return NOT_CHECKED
    try:
        folder = Path(given.junit).parent if given.junit else Path()
        if not folder.is_dir():
            raise ValueError(f"--junit: there is no folder {folder}; make it first")
        f, options = function_of(given.function)
        if given.convention:
            options["convention"] = given.convention
        if given.tolerant:
            options["division"] = "tolerant"
        if given.cutoff:
            options["cutoffs"] = given.cutoff
        if given.batch:
            options["batch"] = given.batch is True or function_of(given.batch)[0]
        if given.refuses:
            options["refuses"] = (NotImplementedError, _exception(given.refuses))
        if given.verbose:
            logging.basicConfig(level=logging.INFO, format="%(message)s")
        # A crash of a compiled list then prints where it was called, and a hang ends.
        faulthandler.enable()
        asking.END_PROCESS = True
        result = check_neighbours(
            f,
            quick=given.quick,
            cases=given.case,
            seed=given.seed,
            seconds=given.seconds,
            call_seconds=given.call_seconds,
            **options,
        )
    except ValueError as error:
        print(f"contactbench.kit: {error}", file=sys.stderr)
        return NOT_CHECKED
    finally:
        asking.END_PROCESS = False
    print(result)
    try:
        if given.save:
            result.save(given.save)
        if given.junit:
            Path(given.junit).write_text(result.junit(), encoding="utf-8")
    except OSError as error:
        print(f"contactbench.kit: the report cannot be written: {error}", file=sys.stderr)
        return NOT_CHECKED
    return {"right": RIGHT, "wrong": WRONG}.get(result.verdict, NOT_CHECKED)


if __name__ == "__main__":
    sys.exit(main())
