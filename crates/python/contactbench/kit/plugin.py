"""A plugin for pytest: one test for each hard case, and a fixture.

``pytest --contactbench-neighbours module:function`` adds a test for each hard case to those that
are collected. The fixture `contactbench_neighbours` is `check_neighbours`, which fails the test if
the list is wrong.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from .result import NeighbourCheck


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options."""
    group = parser.getgroup("contactbench", "neighbour lists")
    group.addoption(
        "--contactbench-neighbours",
        metavar="MODULE:FUNCTION",
        help="hold this neighbour list to the exact truth, one test for each hard case",
    )
    group.addoption("--contactbench-convention", help="its convention (default: recognised)")
    group.addoption(
        "--contactbench-batch",
        metavar="MODULE:FUNCTION",
        help="hold this list of several systems to the truth too; it may be the same function",
    )
    group.addoption("--contactbench-quick", action="store_true", help="few systems of each case")


class Wrong(Exception):
    """A wrong neighbour list; its text is the report."""


class CaseItem(pytest.Item):
    """A hard case."""

    def __init__(self, *, options: dict[str, Any], **more: Any) -> None:
        super().__init__(**more)
        self.options = options

    def runtest(self) -> None:
        """Try the systems of the case."""
        from .checking import check_neighbours

        result = check_neighbours(cases=[self.name], **self.options)
        if result.verdict == "wrong":
            raise Wrong(str(result))
        if not result:
            pytest.skip("; ".join(result.refused) or "no system was answered")

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Return the report without a traceback."""
        if isinstance(excinfo.value, Wrong):
            return str(excinfo.value)
        return super().repr_failure(excinfo)

    def reportinfo(self) -> tuple[str, None, str]:
        """Return the names of the test."""
        return "contactbench", None, f"neighbours: {self.name}"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(
    session: pytest.Session, config: pytest.Config, items: list[pytest.Item]
) -> None:
    """Add a test for each hard case."""
    text = config.getoption("--contactbench-neighbours")
    if not text:
        return
    from .asking import Asker
    from .checking import chosen_cases, declared_convention, recognised_convention
    from .naming import function_of

    try:
        f, options = function_of(text)
        together = config.getoption("--contactbench-batch")
        if together:
            options["batch"] = together == text or function_of(together)[0]
        declared = config.getoption("--contactbench-convention") or options.get("convention")
        batch = options.get("batch")
        asker, batch = Asker(f, batched=batch is True), f if batch is True else batch
        convention = declared_convention(asker, declared, batch) if declared else None
    except ValueError as error:
        raise pytest.UsageError(str(error)) from None
    options.update(f=f, quick=config.getoption("--contactbench-quick"))
    if convention is None:
        found = recognised_convention(asker, batch)
        convention = None if found.trouble else found.convention
        reporter = config.pluginmanager.get_plugin("terminalreporter")
        if reporter is not None and convention is not None:
            reporter.write_line(f"convention, recognised: {convention}")
    options["convention"] = convention
    # If no convention fits, one test reports it.
    for case in chosen_cases(batch=bool(batch))[: None if convention else 1]:
        name, nodeid = case.name, f"contactbench::{case.name}"
        items.append(CaseItem.from_parent(session, name=name, nodeid=nodeid, options=options))


@pytest.fixture
def contactbench_neighbours() -> Callable[..., NeighbourCheck]:
    """`check_neighbours`, which fails the test if the list is wrong or was not checked."""
    from .checking import check_neighbours

    def check(f: Callable[..., Any], **options: Any) -> NeighbourCheck:
        result = check_neighbours(f, **options)
        if not result:
            pytest.fail(str(result), pytrace=False)
        return result

    return check
