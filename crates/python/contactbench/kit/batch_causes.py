"""Names the mistake that explains all wrong pairs of a batch."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from .asking import CHANGES
from .batches import Batch, BatchAsker, across
from .causes import cause_of
from .compare import Difference, difference
from .convention import Convention, comparable, expected_rows
from .systems import Refusal, Rows
from .truth import half_list


def cause_of_batch(asker: BatchAsker, answers: list[tuple[Batch, Difference]]) -> str | None:
    """Return the likely mistake, or None if no known mistake explains all answers.

    If the smallest failing batch has one system, the mistake is sought among those of single
    systems.
    """
    batch, wrong = answers[-1]
    if len(batch) == 1:
        single = replace(asker.asker, f=asker.f, batched=True)
        try:
            again = single.wrong(batch[0])
        except Refusal:
            return None
        return cause_of(single, [(batch[0], again)]) if again is not None else None
    others = [set(_causes(asker, *answer)) for answer in answers[:-1]]
    found = _causes(asker, batch, wrong)
    return next((text for text in found if all(text in other for other in others)), None)


def _causes(asker: BatchAsker, batch: Batch, wrong: Difference) -> Iterator[str]:
    """Return the mistakes that explain an answer, the likeliest first."""
    convention = asker.asker.convention
    if not wrong.text:
        listed = _comparable(wrong.answer, batch, convention)
        for text, rows in _predictions(batch, convention):
            if difference(listed, rows, rows[:0], listed) is None:
                yield text
        if across(batch, wrong):
            yield "pairs of atoms of different systems are listed"
    if wrong.text.startswith(CHANGES):
        return
    remedies = {
        "right without empty systems": tuple(system for system in batch if len(system)),
        "right if all systems have the same cell and axes: the cell of another system is used": (
            tuple(replace(system, cell=batch[0].cell, pbc=batch[0].pbc) for system in batch)
        ),
    }
    for text, mended in remedies.items():
        if mended and _given(mended) != _given(batch) and not asker.fails(mended):
            yield text
    if not any(asker.fails((system,)) for system in batch):
        yield "right if each system is a batch of its own"


def _given(batch: Batch) -> list[tuple[object, ...]]:
    return [(len(system), system.cell.tobytes(), system.pbc) for system in batch]


def _predictions(batch: Batch, convention: Convention) -> Iterator[tuple[str, Rows]]:
    """Return what lists with one mistake would hold, in the form of `_comparable`."""
    sizes = np.array([len(system) for system in batch])
    starts, n = np.cumsum(sizes) - sizes, len(batch)

    def meant(systems: Batch, first: Rows = starts) -> Rows:
        rows = [np.empty((0, 5), dtype=np.int64)]
        for system, start in zip(systems, first, strict=False):
            half = half_list(system, convention.rule)
            own = expected_rows(half, system, convention)
            rows.append(own + np.array([start, start, 0, 0, 0]))
        return _comparable(np.vstack(rows), batch, convention)

    yield "the numbers of atoms begin at 0 in each system", meant(batch, np.zeros_like(starts))
    filled = sizes > 0
    k = np.arange(n)
    if not filled.all():
        at = int(np.argmin(filled))
        yield "systems after an empty one are left out", meant(batch[:at])
        count = int(filled.sum())
        yield "empty systems are not counted: the last systems are left out", meant(batch[:count])
    rank = np.maximum(np.cumsum(filled) - 1, 0)
    numbers = {
        "systems after an empty one get the cell of another": rank,
        "all systems get the cell of the first": 0 * k,
        "all systems get the cell of the last": 0 * k + n - 1,
        "systems get the cell of the system before": (k - 1) % n,
        "systems get the cell of the system after": (k + 1) % n,
    }
    for text, which in numbers.items():
        for what, names in (
            ("cell", ("cell",)),
            ("axes", ("pbc",)),
            ("cell and axes", ("cell", "pbc")),
        ):
            taken = [{name: getattr(batch[at], name) for name in names} for at in which]
            mixed = tuple(replace(s, **new) for s, new in zip(batch, taken, strict=True))
            if all(system.modest() for system in mixed if len(system)):
                yield text.replace("cell", what), meant(mixed)
    yield "the last system is left out", meant(batch[:-1])
    yield "only the first system is searched", meant(batch[:1])


def _comparable(rows: Rows, batch: Batch, convention: Convention) -> Rows:
    """Return rows without the shifts that depend on the cell of a system."""
    if convention.shifts != "S" or convention.wrapped:
        rows = rows * np.array([1, 1, 0, 0, 0])
    return comparable(rows, batch[0], replace(convention, wrapped=False))
