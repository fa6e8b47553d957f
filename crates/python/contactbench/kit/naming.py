"""Finds functions by name, for the command line and pytest."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Callable
from typing import Any


def function_of(text: str) -> tuple[Callable[..., Any], dict[str, Any]]:
    """Return the function ``module:name``, or an adapter by its name, and options for it.

    Raises a ValueError if there is none.
    """
    module, colon, name = text.partition(":")
    if not colon:
        return _adapter(text)
    if os.getcwd() not in sys.path:
        sys.path.insert(0, os.getcwd())
    try:
        found: Any = importlib.import_module(module)
        for part in name.split("."):
            found = getattr(found, part)
    except (Exception, SystemExit) as error:
        raise ValueError(f"{text} cannot be imported: {type(error).__name__}: {error}") from None
    if not callable(found):
        raise ValueError(f"{text} is not a function")
    return found, {"name": text}


def _adapter(name: str) -> tuple[Callable[..., Any], dict[str, Any]]:
    try:
        adapters: Any = importlib.import_module("contactbench.adapters").ADAPTERS
    except ImportError:
        adapters = {}
    if name not in adapters:
        known = f", or an adapter: {', '.join(adapters)}" if adapters else ""
        raise ValueError(f"{name!r} is not a function; give module:function{known}")
    adapter = adapters[name]
    if adapter.missing:
        raise ValueError(f"{name} is unavailable: {adapter.missing}")
    options = {
        "name": f'contactbench.adapters:ADAPTERS["{name}"]',
        "convention": adapter.convention,
        "division": adapter.division,
    }
    if adapter.batches:
        options.update(batch=adapter.batch, convention=f"{adapter.convention},systems=offsets")
    return adapter, options
