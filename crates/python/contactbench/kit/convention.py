"""Conventions of neighbour lists: how an answer is meant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args, get_type_hints

import numpy as np

from .systems import Doubles, Rows, System
from .truth import canonical, half_list, tolerant_list

#: Shift of a pair whose vector fits no periodic image.
ASTRAY = 2**40


@dataclass(frozen=True)
class Convention:
    """How a neighbour list takes its cell and means its answer. The default is that of ASE.

    Attributes
    ----------
    pairs : str
        ``full`` (each pair from both sides) or ``half``.
    rule : str
        ``<`` or ``<=``: whether a pair at exactly the cutoff is a neighbour.
    base : int
        The number of the first atom, 0 or 1.
    shifts : str
        The third part of an answer: ``S``, ``vectors`` (distance vectors), or ``none``.
    sign : int
        1 if the distance vector is ``x[j] - x[i] + S @ cell``; -1 if shifts or vectors are those
        of the pair (j, i).
    wrapped : bool
        Whether S counts from atoms that were moved into the cell.
    cell : str
        ``rows`` or ``columns``: the vectors of the cell in the matrix that is passed.
    self_images : bool
        Whether pairs of an atom with its own images are listed.
    self_pairs : bool
        Whether each atom is listed as its own neighbour, with S = 0.
    nearest : bool
        Whether a pair is listed once, for all of its images (without shifts only).
    padding : bool
        Whether rows whose numbers are not those of atoms fill up the answer.
    layout : str
        ``flat`` (``i, j, S``), ``rows`` (pairs of shape (M, 2), S), ``columns`` (pairs of shape
        (2, M), S), or ``matrix`` (neighbours of shape (N, K) with padding, S of shape (N, K, 3)).
    systems : str
        How a function for batches takes its systems: ``index`` (for each atom the number of its
        system) or ``offsets`` (the first atom of each system, then the number of atoms).
    """

    pairs: Literal["full", "half"] = "full"
    rule: Literal["<", "<="] = "<"
    base: Literal[0, 1] = 0
    shifts: Literal["S", "vectors", "none"] = "S"
    sign: Literal[1, -1] = 1
    wrapped: bool = False
    cell: Literal["rows", "columns"] = "rows"
    self_images: bool = True
    self_pairs: bool = False
    nearest: bool = False
    padding: bool = False
    layout: Literal["flat", "rows", "columns", "matrix"] = "flat"
    systems: Literal["index", "offsets"] = "index"

    @classmethod
    def parse(cls, text: str) -> Convention:
        """Read ``pairs=half,rule=<=,base=1``; fields left out are those of ASE (also ``ase``)."""
        choices = {
            name: (True, False) if kind is bool else get_args(kind)
            for name, kind in get_type_hints(cls).items()
        }
        chosen: dict[str, Any] = {}
        for part in text.split(","):
            name, _, value = part.strip().partition("=")
            if name in ("", "ase"):
                continue
            if name not in choices:
                raise ValueError(
                    f"a convention has no field {name!r}; its fields are {', '.join(choices)}"
                )
            known = {str(choice).lower(): choice for choice in choices[name]}
            # The shifts S are the only choice with a capital letter.
            if value.lower() not in known:
                raise ValueError(
                    f"{name} of the convention is {value!r}; give one of {', '.join(known)}"
                )
            chosen[name] = known[value.lower()]
        return cls(**chosen)

    def __str__(self) -> str:
        third = {
            ("S", 1): "D = x[j] - x[i] + S @ cell",
            ("S", -1): "D = x[j] - x[i] - S @ cell",
            ("vectors", 1): "vectors x[j] - x[i]",
            ("vectors", -1): "vectors x[i] - x[j]",
        }.get((self.shifts, self.sign), "no shifts")
        words = [
            f"{self.pairs} list",
            f"d {self.rule} cutoff",
            f"atoms from {self.base}",
            third + (" of wrapped atoms" if self.wrapped else ""),
            f"cell in {self.cell}",
        ]
        words += [] if self.self_images else ["without own images"]
        words += ["with (i, i)"] if self.self_pairs else []
        words += ["one entry for all images"] if self.nearest else []
        words += ["padded"] if self.padding else []
        words += [] if self.layout == "flat" else [f"pairs as {self.layout}"]
        words += ["systems by offsets"] if self.systems == "offsets" else []
        return ", ".join(words)


ASE = Convention()


class Malformed(ValueError):
    """An answer that is no list of pairs."""


def _integers(value: Any, name: str) -> Rows:
    try:
        array = np.asarray(value)
    except ValueError:
        raise Malformed(f"{name} is no array: its rows differ in length") from None
    if array.size == 0:
        return array.astype(np.int64)
    if array.dtype.kind not in "iu":
        raise Malformed(f"{name} has the type {array.dtype}, not whole numbers")
    return array.astype(np.int64)


def parts(answer: Any, system: System, convention: Convention) -> tuple[Rows, Rows, Any]:
    """Return i, j and the third part of an answer, flat."""
    if (
        convention.layout != "flat"
        and convention.shifts == "none"
        and not isinstance(answer, tuple)
    ):
        answer = (answer,)
    if not isinstance(answer, (tuple, list)):
        raise Malformed(f"the answer is a {type(answer).__name__}, not a tuple of arrays")
    given = list(answer)
    third = given[-1] if given and convention.shifts != "none" else None
    if convention.layout == "flat":
        if len(given) != (2 if third is None else 3):
            raise Malformed(f"the answer has {len(given)} parts")
        i, j = _integers(given[0], "i"), _integers(given[1], "j")
    else:
        pairs = _integers(given[0], "pairs")
        if convention.layout == "matrix":
            if pairs.ndim != 2 or len(pairs) != len(system):
                raise Malformed(f"the matrix has the shape {pairs.shape}, not (N, K)")
            j = pairs.ravel()
            i = np.repeat(np.arange(len(system)) + convention.base, pairs.shape[1])
            third = third if third is None else np.reshape(third, (-1, 3))
        else:
            pairs = pairs if convention.layout == "columns" else pairs.T
            if pairs.size == 0:
                pairs = pairs.reshape(2, 0)
            if pairs.ndim != 2 or len(pairs) != 2:
                raise Malformed(f"pairs have the shape {np.shape(given[0])}")
            i, j = pairs
    if i.ndim != 1 or i.shape != j.shape:
        raise Malformed(f"i has the shape {i.shape}, j has {j.shape}")
    if third is not None:
        try:
            third = np.asarray(third)
        except ValueError:
            raise Malformed("the third part is no array: its rows differ in length") from None
        if third.size == 0 and len(i) == 0:
            third = third.reshape(0, 3)
        if third.shape != (len(i), 3):
            raise Malformed(f"the third part has the shape {third.shape}, not ({len(i)}, 3)")
    return i, j, third


def read(answer: Any, system: System, convention: Convention) -> Rows:
    """Return an answer as rows (i, j, S) in the convention of ASE; without shifts, S is 0."""
    i, j, third = parts(answer, system, convention)
    i, j = i - convention.base, j - convention.base
    known = (i >= 0) & (j >= 0) & (i < len(system)) & (j < len(system))
    if not known.all():
        if not (convention.padding or convention.layout == "matrix"):
            at = int(np.argmin(known))
            raise Malformed(
                f"row {at} is the pair ({i[at] + convention.base}, {j[at] + convention.base}), "
                f"but there are {len(system)} atoms"
            )
        i, j = i[known], j[known]
        third = third if third is None else third[known]
    rows = np.zeros((len(i), 5), dtype=np.int64)
    rows[:, 0], rows[:, 1] = i, j
    if third is None or len(i) == 0:
        return rows
    if convention.shifts == "vectors":
        rows[:, 2:] = _shifts_of(np.asarray(third, float) * convention.sign, system, rows)
        return rows
    whole = third.dtype.kind in "iu" or (np.isfinite(third) & (third == np.round(third))).all()
    if not whole:
        raise Malformed(f"S has the type {third.dtype} and numbers that are not whole")
    rows[:, 2:] = third.astype(np.int64) * convention.sign
    if convention.wrapped:
        boxes = system.boxes()
        rows[:, 2:] += boxes[i] - boxes[j]
    return rows


def _shifts_of(given: Doubles, system: System, rows: Rows) -> Rows:
    """Return the shifts of distance vectors; `ASTRAY` if a vector fits no image."""
    cell, x = system.full_cell(), system.positions
    rest = given - (x[rows[:, 1]] - x[rows[:, 0]])
    shifts = np.round(np.linalg.solve(cell.T, rest.T).T) * np.array(system.pbc)
    scale = system.cutoff + np.abs(x).max(initial=0.0) + np.abs(cell).max()
    fits = np.abs(rest - shifts @ cell).max(axis=1) <= 1e-5 * scale
    return np.where(fits[:, None], shifts, ASTRAY).astype(np.int64)


def expected(
    system: System, convention: Convention, tolerant: bool, either: Rows | None = None
) -> tuple[Rows, Rows, float]:
    """Return the rows that an answer must hold, those that it may hold too, and the band.

    Pairs of the half list `either` are among those that it may hold.
    """
    width = 0.0
    if tolerant:
        rows, must, width = tolerant_list(system)
        needed, optional = rows[must], rows[~must]
    else:
        needed = half_list(system, convention.rule)
        optional = needed[:0]
        if either is not None:
            free = (needed[:, None] == either).all(axis=2).any(axis=1)
            needed, optional = needed[~free], either
    return (
        expected_rows(needed, system, convention),
        expected_rows(optional, system, convention, own=False),
        width,
    )


def expected_rows(half: Rows, system: System, convention: Convention, own: bool = True) -> Rows:
    """Return the rows of a half list as a convention lists them, in the form of `comparable`."""
    if not convention.self_images:
        half = half[half[:, 0] != half[:, 1]]
    if convention.nearest:
        half = np.unique(half * np.array([1, 1, 0, 0, 0]), axis=0)
        half = half[half[:, 0] != half[:, 1]]
    rows = half
    if convention.pairs == "full":
        rows = np.vstack([half, np.hstack([half[:, [1, 0]], -half[:, 2:]])])
    if own and convention.self_pairs:
        each = np.arange(len(system))[:, None] * np.array([[1, 1, 0, 0, 0]])
        rows = np.vstack([rows, each])
    return comparable(rows, system, convention)


def comparable(rows: Rows, system: System, convention: Convention) -> Rows:
    """Return rows in the form in which answers and truth are compared."""
    if convention.shifts == "none" or (convention.wrapped and on_faces(system)):
        # Which box holds an atom on a face depends on rounding.
        rows = rows * np.array([1, 1, 0, 0, 0])
    return canonical(rows) if convention.pairs == "half" else rows


def on_faces(system: System) -> bool:
    """Return whether an atom is so close to a face that rounding chooses its box."""
    fractional = system.fractional()[:, np.array(system.pbc)]
    size = np.abs(fractional).max(initial=1.0)
    near = 1e-6 if system.dtype == "float32" else 1e-9
    return bool((np.abs(fractional - np.round(fractional)) <= near * size).any())
