"""Compares pair lists of other codes with the truth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _contactbench as native
from ._boxes import BoxLike, arrays, count, limit, whole


@dataclass(frozen=True)
class Pairs:
    """Wrong pairs, the worst first.

    Attributes
    ----------
    pairs : ndarray of uint32, shape (K, 2)
        Rows of `x`, the smaller first.
    images : ndarray of int32, shape (K, D), or None
        In a box, the image of the second particle, as in `contacts`.
    depth : ndarray of float64, shape (K,)
        Overlap in mean radii of the two particles; negative if they are apart.
    """

    pairs: npt.NDArray[np.uint32]
    images: npt.NDArray[np.int32] | None
    depth: npt.NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.pairs)


@dataclass(frozen=True)
class Verification:
    """A list of pairs compared with the truth. It is true if both are equal.

    Attributes
    ----------
    same : bool
        Whether no pair is missed, spurious, repeated, of a particle with itself, unknown or
        one-sided.
    contacts : int
        Number of pairs that touch.
    listed : int
        Number of pairs in the list.
    errors : dict
        Numbers of pairs: ``missed``, ``spurious``, ``duplicate`` and ``self_pairs``. In mean radii:
        ``deepest_miss``, the largest missed overlap, and ``widest_false``, the largest listed gap.
    missed, spurious : Pairs
        Touching pairs that are not listed, and listed pairs that do not touch; at most `most`.
    unknown : ndarray of int64, shape (K, 2)
        Listed pairs with a number that no particle has.
    one_sided : ndarray of int64, shape (K, 2)
        Pairs that are listed once although ``both_sides`` was given.
    within_skin : int
        Number of listed pairs with a gap of at most the skin.
    hint : str or None
        A reading of the list that would agree: numbers from 1, diameters for radii, ...
    causes : dict or None
        If `arithmetic` rounds, the errors against the exact truth by cause, each a dictionary like
        `errors`. ``representation``: storing the scene in the arithmetic's numbers; ``predicate``:
        its contact test; ``search``: the list, compared with all pairs that this test accepts.
    """

    same: bool
    contacts: int
    listed: int
    errors: dict[str, Any]
    missed: Pairs
    spurious: Pairs
    unknown: npt.NDArray[np.int64]
    one_sided: npt.NDArray[np.int64]
    within_skin: int
    hint: str | None
    causes: dict[str, dict[str, Any]] | None

    def __bool__(self) -> bool:
        return self.same

    def __str__(self) -> str:
        if self.same:
            return f"the same: {self.contacts} touching pairs"
        counts = {**self.errors, "unknown": len(self.unknown), "from one side": len(self.one_sided)}
        del counts["deepest_miss"], counts["widest_false"]
        said = ", ".join(f"{count} {kind}" for kind, count in counts.items() if count)
        hint = f"\nhint: {self.hint}" if self.hint else ""
        return f"{self.listed} pairs against {self.contacts} that touch: {said}{hint}"


def verify(
    x: npt.ArrayLike,
    r: npt.ArrayLike,
    pairs: object,
    images: npt.ArrayLike | None = None,
    *,
    box: BoxLike | None = None,
    arithmetic: str = "exact",
    base: int = 0,
    both_sides: bool = False,
    skin: float = 0.0,
    most: int = 100,
    threads: int = 1,
    memory_limit: int | None = None,
) -> Verification:
    """Compare a list of pairs with the truth. The truth comes from testing all pairs or, for many
    particles, from detectors that agree.

    Parameters
    ----------
    x, r, box
        The scene, as in `contacts`.
    pairs : array_like of int, shape (M, 2), or set of pairs
        The pairs, and the particles of each pair, may have any order.
    images : array_like of int, shape (M, D), optional
        In a box, the image of the second particle, as returned by `contacts`. Without images, only
        the pairs are compared.
    arithmetic : str
        How contacts are decided; by default exactly. If you give the arithmetic of the code that
        made the list, errors are relative to its test, and `Verification.causes` shows the cost of
        rounding.
    base : int
        The number of the first row of `x` in the list.
    both_sides : bool
        Whether the list has each pair twice, as i,j and as j,i.
    skin : float
        Pairs with a gap of at most this length may be listed.
    most : int
        Number of missed and of spurious pairs to keep.
    threads : int
        Number of threads for the truth.
    memory_limit : int, optional
        Limit in bytes for a list of pairs. The default is that of `contacts`.

    Raises
    ------
    ValueError, MemoryError
        As `contacts`.

    Examples
    --------
    >>> import contactbench
    >>> x = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]
    >>> found = contactbench.verify(x, 0.5, [[0, 1], [0, 2]])
    >>> found.same, found.missed.pairs.tolist(), found.spurious.pairs.tolist()
    (False, [[1, 2]], [[0, 2]])
    """
    centres, radii, edges = arrays(x, r, box)
    listed = whole(pairs, "pairs", 2)
    shifts = None
    if images is not None:
        if edges is None:
            raise ValueError("images are given without a box: give box, or leave them out")
        shifts = whole(images, "images", centres.shape[1], np.int32)
        if len(shifts) != len(listed):
            raise ValueError(f"{len(listed)} pairs but {len(shifts)} images; give one for each")
    found = native.verify(
        centres, radii, listed, shifts, edges, arithmetic, count(base, "base", -(2**62), 2**62),
        both_sides, skin, count(most, "most"), count(threads, "threads", 1, 1024),
        limit(memory_limit),
    )  # fmt: skip
    found["missed"], found["spurious"] = Pairs(*found["missed"]), Pairs(*found["spurious"])
    return Verification(**found)
