"""Docstrings have examples that run."""

import doctest
import importlib
import pathlib
import pkgutil
import re

import pytest

import contactbench

MODULES = [name for _, name, _ in pkgutil.iter_modules(contactbench.__path__)]


@pytest.mark.parametrize("name", [name for name in MODULES if name != "_contactbench"])
def test_examples_say_what_they_print(name):
    module = importlib.import_module(f"contactbench.{name}")
    assert doctest.testmod(module).failed == 0


def test_the_first_example():
    result = doctest.testmod(contactbench)
    assert result.attempted > 0 and result.failed == 0


def test_the_version_is_that_of_the_program():
    root = pathlib.Path(__file__).parents[3]
    # Crates have the version of the workspace.
    version = re.search(r'^version = "(.*)"', (root / "Cargo.toml").read_text(), re.MULTILINE)
    assert version[1] == contactbench.__version__
