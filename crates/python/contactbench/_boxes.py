"""Periodic boxes, and checks of arguments."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, SupportsIndex, TypeAlias

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from ._contactbench import Doubles, Edges

#: Integers up to this magnitude are exact in float64.
_EXACT = 2**53


@dataclass(frozen=True, eq=False)
class Box:
    """A periodic box. Two boxes are equal if their vectors, flags and corners are.

    Parameters
    ----------
    edges : array_like, shape (D,) or (D, D)
        Lengths along the axes, or D vectors of any direction, one per row. In 2D a third length or
        vector of zeros is allowed.
    periodic : bool, str, or sequence of D bool
        The periodic vectors: a bool for all; axes as on the command line (``"xy"``, ``"true"``,
        ``"none"``, ``"false"``); or one bool (or 0 or 1) per vector, as in ``atoms.pbc``. The other
        vectors do not affect contacts.
    origin : array_like, shape (D,), optional
        The corner from which the vectors start. It does not affect exact contacts.

    Examples
    --------
    A channel that is periodic along x:

    >>> import contactbench
    >>> box = contactbench.Box([4.0, 1.0], periodic="x")
    >>> box == contactbench.Box([4.0, 1.0], periodic=[True, False])
    True
    >>> pairs, images = contactbench.contacts([[0.25, 0.5], [3.75, 0.5]], 0.25, box=box)
    >>> pairs.tolist(), images.tolist()
    ([[0, 1]], [[-1, 0]])
    """

    edges: npt.ArrayLike
    periodic: Sequence[bool] | npt.NDArray[np.bool_] | bool | str = True
    origin: npt.ArrayLike | None = None

    def _dim(self) -> int:
        shape = np.shape(self.edges)
        return shape[0] if shape and shape[0] in (2, 3) else 3

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Box):
            return NotImplemented
        return self._dim() == other._dim() and edges_of(self, self._dim()) == edges_of(
            other, other._dim()
        )

    def __hash__(self) -> int:
        return hash(repr(edges_of(self, self._dim())))


BoxLike: TypeAlias = "Box | npt.ArrayLike"


def numbers(value: object, name: str) -> Doubles:
    """Convert to float64 without rounding; raise a ValueError if that is impossible."""
    if value is None:
        raise ValueError(f"{name} is None; give numbers")
    if np.ma.is_masked(value):
        raise ValueError(
            f"{name} has masked numbers, which would be taken for data; leave their particles out"
        )
    array = np.asarray(value)
    if array.dtype.kind not in "iuf":
        raise ValueError(
            f"{name} has the type {array.dtype}; give real numbers, as with .astype(float)"
        )
    if array.dtype.kind in "iu" and array.size and (array.max() > _EXACT or array.min() < -_EXACT):
        raise ValueError(
            f"{name} has an integer beyond 2^53, which float64 would round; give smaller ones"
        )
    doubles = np.require(array, np.float64, ["C", "A"])
    if array.dtype.kind == "f" and array.dtype.itemsize > 8:
        if not np.array_equal(doubles, array, equal_nan=True):
            raise ValueError(
                f"{name} has the type {array.dtype}, and float64 would round it; round it yourself "
                "with .astype(float)"
            )
    return doubles


def count(value: SupportsIndex, name: str, least: int = 0, most: int = 2**63 - 1) -> int:
    """Check that a whole number is within bounds."""
    number = operator.index(value)
    if not least <= number <= most:
        raise ValueError(f"{name} is {number}; give a whole number from {least} to {most}")
    return number


def limit(value: SupportsIndex | None) -> int | None:
    """Check a limit in bytes, or None."""
    return None if value is None else count(value, "memory_limit")


def _flags(periodic: object, dim: int) -> list[bool]:
    """Return for each vector whether the box is periodic along it."""
    words = "give a bool, one for each vector, or the axes, as in 'xy', or 'true' or 'none'"
    if isinstance(periodic, str):
        axes = {"true": "xyz"[:dim], "none": "", "false": ""}.get(periodic, periodic or "?")
        if len(set(axes)) != len(axes) or not set(axes) <= set("xyz"[:dim]):
            raise ValueError(f"periodic of the box is {periodic!r} in {dim} dimensions; {words}")
        return [axis in axes for axis in "xyz"[:dim]]
    flags = np.asarray(periodic)
    if flags.dtype.kind not in "biu" or (flags != flags.astype(bool)).any():
        raise ValueError(f"periodic of the box is {periodic!r}; {words}")
    if flags.shape == ():
        flags = np.broadcast_to(flags, (dim,))
    if flags.shape != (dim,):
        raise ValueError(
            f"periodic of the box has the shape {flags.shape}; {words}, in {dim} dimensions"
        )
    return [bool(flag) for flag in flags]


def edges_of(box: BoxLike | None, dim: int) -> Edges | None:
    """Return a box in `dim` dimensions as three vectors, flags, and a corner."""
    if box is None:
        return None
    box = box if isinstance(box, Box) else Box(box)
    edges = numbers(box.edges, "box")
    periodic: Any = box.periodic
    if dim == 2 and edges.shape in ((3,), (3, 3)):
        third = edges[2:] if edges.ndim == 1 else np.concatenate([edges[2], edges[:, 2]])
        if not third.any():
            edges = edges[:2] if edges.ndim == 1 else edges[:2, :2]
            if not isinstance(periodic, str) and np.shape(periodic) == (3,):
                periodic = periodic[:2]
    if edges.shape == (dim,):
        edges = np.diag(edges)
    if edges.shape != (dim, dim):
        raise ValueError(
            f"the box has the shape {edges.shape}; in {dim} dimensions it is {dim} lengths, or "
            f"{dim} rows of {dim} numbers"
        )
    flags = _flags(periodic, dim)
    origin = np.zeros(dim)
    if box.origin is not None:
        origin = numbers(box.origin, "origin of the box") + 0.0
    if origin.shape != (dim,):
        raise ValueError(f"origin of the box has the shape {origin.shape}; give {dim} numbers")
    vectors = np.eye(3)
    vectors[:dim, :dim] = edges + 0.0  # no -0.0, so that equal boxes have one hash
    more = 3 - dim
    return vectors.tolist(), flags + [False] * more, origin.tolist() + [0.0] * more


def arrays(
    x: npt.ArrayLike, r: npt.ArrayLike, box: BoxLike | None
) -> tuple[Doubles, Doubles, Edges | None]:
    """Return the arguments of native functions; copies arrays only if necessary."""
    centres, radii = numbers(x, "x"), numbers(r, "r")
    if centres.size == 0 and centres.ndim < 2:
        edges = box.edges if isinstance(box, Box) else box
        flat = edges is not None and np.shape(edges)[:1] == (2,)
        centres = centres.reshape(0, 2 if flat else 3)
    dim = centres.shape[-1] if centres.ndim == 2 else 0
    return centres, radii, edges_of(box, dim) if dim in (2, 3) else None


def whole(pairs: object, name: str, width: int, kind: type = np.int64) -> npt.NDArray[Any]:
    """Convert to rows of `width` whole numbers."""
    rows = list(pairs) if isinstance(pairs, (set, frozenset)) else pairs
    if np.ma.is_masked(rows):
        raise ValueError(f"{name} has masked numbers; leave their rows out")
    if isinstance(rows, tuple) and len(rows) == 2 and np.ndim(rows[0]) == 2:
        raise ValueError(f"{name} has two parts, as contacts() returns pairs and images; give one")
    array = np.asarray(rows)
    if array.size == 0:
        return np.empty((0, width), dtype=kind)
    if array.ndim != 2 or array.shape[1] != width or array.dtype.kind not in "iu":
        raise ValueError(
            f"{name} has the shape {array.shape} and the type {array.dtype}; give M rows of {width} "
            "whole numbers"
        )
    limits = np.iinfo(kind)
    if array.min() < limits.min or array.max() > limits.max:
        raise ValueError(f"{name} has a number beyond {np.dtype(kind).name}")
    return np.require(array, kind, ["C", "A"])
