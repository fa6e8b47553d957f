"""Boxes that repeat, and the arrays of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from ._contactbench import Doubles, Edges


@dataclass(frozen=True)
class Box:
    """A box in which a scene repeats.

    Parameters
    ----------
    edges : array_like, shape (D,) or (D, D)
        Lengths along the axes; or D vectors, one per row, of any direction.
    periodic : sequence of D bool, or bool
        Along which of them the scene repeats. The others decide nothing.
    origin : array_like, shape (D,), optional
        The corner from which the vectors start. It decides no exact contact.

    Examples
    --------
    A channel that repeats along x:

    >>> import contactbench
    >>> box = contactbench.Box([4.0, 1.0], periodic=[True, False])
    >>> pairs, images = contactbench.contacts([[0.25, 0.5], [3.75, 0.5]], 0.25, box=box)
    >>> pairs.tolist(), images.tolist()
    ([[0, 1]], [[-1, 0]])
    """

    edges: npt.ArrayLike
    periodic: Sequence[bool] | bool = True
    origin: npt.ArrayLike | None = None


BoxLike: TypeAlias = "Box | npt.ArrayLike"


def edges_of(box: BoxLike | None, dim: int) -> Edges | None:
    """A box as three vectors, flags, and a corner; for `dim` dimensions."""
    if box is None:
        return None
    box = box if isinstance(box, Box) else Box(box)
    edges = np.asarray(box.edges, dtype=np.float64)
    if edges.shape == (dim,):
        edges = np.diag(edges)
    if edges.shape != (dim, dim):
        raise ValueError(
            f"the box has the shape {edges.shape}; in {dim} dimensions it is {dim} lengths, or "
            f"{dim} rows of {dim} numbers"
        )
    flags = np.broadcast_to(np.asarray(box.periodic, dtype=bool), np.shape(box.periodic) or (dim,))
    origin = np.zeros(dim) if box.origin is None else np.asarray(box.origin, dtype=np.float64)
    for name, array in (("periodic", flags), ("origin", origin)):
        if array.shape != (dim,):
            raise ValueError(f"{name} of the box has the shape {array.shape}; give {dim} of them")
    vectors = np.eye(3)
    vectors[:dim, :dim] = edges
    more = 3 - dim
    return vectors.tolist(), flags.tolist() + [False] * more, origin.tolist() + [0.0] * more


def arrays(
    x: npt.ArrayLike, r: npt.ArrayLike, box: BoxLike | None
) -> tuple[Doubles, Doubles, Edges | None]:
    """What native functions take; copies only what is not contiguous, aligned and of this type."""
    centres = np.require(x, np.float64, ["C", "A"])
    if centres.size == 0 and centres.ndim < 2:
        centres = centres.reshape(0, 3)
    radii = np.require(r, np.float64, ["C", "A"])
    dim = centres.shape[-1] if centres.ndim == 2 else 0
    return centres, radii, edges_of(box, dim) if dim in (2, 3) else None


def whole(pairs: object, name: str, width: int, kind: type = np.int64) -> npt.NDArray[Any]:
    """Rows of `width` whole numbers."""
    rows = list(pairs) if isinstance(pairs, (set, frozenset)) else pairs
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
