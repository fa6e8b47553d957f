"""Lists of pairs of other codes, held to the truth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _contactbench as native
from ._boxes import BoxLike, arrays, count, limit, whole


@dataclass(frozen=True)
class Pairs:
    """Pairs that are wrong, the worst first.

    Attributes
    ----------
    pairs : ndarray of uint32, shape (K, 2)
        Rows of `x`, the smaller first.
    images : ndarray of int32, shape (K, D), or None
        In a box, the image of the second; as in `contacts`.
    depth : ndarray of float64, shape (K,)
        The overlap in mean radii of the two; negative where they are apart.
    """

    pairs: npt.NDArray[np.uint32]
    images: npt.NDArray[np.int32] | None
    depth: npt.NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.pairs)


@dataclass(frozen=True)
class Verification:
    """A list of pairs against the truth. It is true where they are the same.

    Attributes
    ----------
    same : bool
        No pair is missed, spurious, repeated, of a particle with itself, unknown or one-sided.
    contacts : int
        Pairs that touch.
    listed : int
        Pairs of the list.
    errors : dict
        ``missed``, ``spurious``, ``duplicate`` and ``self_pairs``: numbers of pairs;
        ``deepest_miss`` and ``widest_false``: the largest overlap missed and the widest gap listed,
        in mean radii.
    missed, spurious : Pairs
        Pairs that touch and are not listed, and the other way round, `most` of them.
    unknown : ndarray of int64, shape (K, 2)
        Pairs of the list that name no particle.
    one_sided : ndarray of int64, shape (K, 2)
        With ``both_sides``: pairs that stand there once.
    within_skin : int
        Listed pairs that do not touch and are within the skin.
    hint : str or None
        How the list may be meant, so that it agrees: numbers from 1, diameters for radii, ...
    causes : dict or None
        Where `arithmetic` rounds: the errors against the exact truth by cause, as dictionaries like
        `errors`. ``representation``: storing the scene in the arithmetic's numbers; ``predicate``:
        its contact test; ``search``: the list, against all pairs that this test accepts.
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
    """Holds a list of pairs to the truth, which is found by testing all pairs, or, of many particles,
    by detectors that agree.

    Parameters
    ----------
    x, r, box
        The scene, as in `contacts`.
    pairs : array_like of int, shape (M, 2), or set of pairs
        In any order of pairs and in pairs.
    images : array_like of int, shape (M, D), optional
        In a box, the image of the second particle, as `contacts` gives it. Without them, pairs are
        compared.
    arithmetic : str
        How contacts are decided. The default is the exact sign for the numbers given; with the
        arithmetic of the code that made the list, errors are against what that should find, and
        `Verification.causes` says what rounding costs.
    base : int
        The number that the list has for the first row of `x`.
    both_sides : bool
        The list has each pair twice, as i,j and as j,i.
    skin : float
        Pairs that are apart by no more than this length may be listed.
    most : int
        Keep so many missed and spurious pairs.
    threads : int
        For finding the truth.
    memory_limit : int, optional
        Bytes for a list of pairs; as in `contacts` if none is given.

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
            raise ValueError("images are given, and no box: give box, or leave them out")
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
