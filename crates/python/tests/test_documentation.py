"""Docstrings have examples that run, and all parameters are documented and typed."""

import doctest
import importlib
import inspect
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


def test_everything_is_documented_and_typed():
    for name in contactbench.__all__:
        thing = getattr(contactbench, name)
        if not callable(thing):
            continue
        assert inspect.getdoc(thing), name
        # Python has no signature for the arguments of ValueError.
        if inspect.isclass(thing) and issubclass(thing, Exception):
            continue
        signature = inspect.signature(thing)
        for parameter in signature.parameters.values():
            assert parameter.annotation is not parameter.empty, f"{name}: {parameter}"
            if inspect.isfunction(thing):
                assert parameter.name in inspect.getdoc(thing), f"{name}: {parameter}"


def test_the_version_is_that_of_the_program():
    root = pathlib.Path(__file__).parents[3]
    # Crates have the version of the workspace.
    version = re.search(r'^version = "(.*)"', (root / "Cargo.toml").read_text(), re.MULTILINE)
    assert version[1] == contactbench.__version__
