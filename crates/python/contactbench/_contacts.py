"""Contacts of one scene, or of many."""

from __future__ import annotations

from typing import Any, TypeAlias, overload

import numpy as np
import numpy.typing as npt

from . import _contactbench as native
from ._boxes import BoxLike, arrays, count, limit

Pairs: TypeAlias = npt.NDArray[np.uint32]
Images: TypeAlias = npt.NDArray[np.int32]


def _threads(threads: int) -> int:
    return count(threads, "threads", 1, 1024)


def _named(detector: str) -> str:
    return native.DEFAULT if detector == "auto" else detector


@overload
def contacts(
    x: npt.ArrayLike,
    r: npt.ArrayLike,
    box: None = None,
    detector: str = "auto",
    arithmetic: str = "exact",
    threads: int = 1,
) -> tuple[Pairs, None]: ...
@overload
def contacts(
    x: npt.ArrayLike,
    r: npt.ArrayLike,
    box: BoxLike,
    detector: str = "auto",
    arithmetic: str = "exact",
    threads: int = 1,
) -> tuple[Pairs, Images]: ...
@overload
def contacts(
    x: npt.ArrayLike,
    r: npt.ArrayLike,
    box: BoxLike | None,
    detector: str = "auto",
    arithmetic: str = "exact",
    threads: int = 1,
) -> tuple[Pairs, Images | None]: ...
def contacts(
    x: npt.ArrayLike,
    r: npt.ArrayLike,
    box: BoxLike | None = None,
    detector: str = "auto",
    arithmetic: str = "exact",
    threads: int = 1,
) -> tuple[Pairs, Images | None]:
    """The pairs of particles that touch or overlap: |xi - xj| <= ri + rj.

    Parameters
    ----------
    x : array_like, shape (N, 2) or (N, 3)
        Centres of discs or spheres. Read in place if it is contiguous and of float64.
    r : float or array_like, shape (N,)
        One radius for all, or one for each, in the unit of `x`.
    box : array_like, shape (D,) or (D, D), or Box, optional
        Lengths of the box, or its D vectors as rows, along all of which the scene repeats; a `Box`
        where it is open along some. Particles may be outside of it. Without a box, space is open.
    detector : str
        One of `DETECTORS`, with parameters as in ``"streamed-nbs:level=avx2"``; ``"auto"`` is the one
        that ``contactbench detect`` takes, `streamed-nbs`. Only time and memory depend on it.
    arithmetic : {"exact", "f64", "f32", "f32-cell", "textbook"}
        How contacts are decided: by the exact sign for the numbers given, or rounded.
    threads : int
        For the detectors that can use several: `streamed-nbs` (from 30,000 particles on),
        `cell-grid` and `direct`.

    Returns
    -------
    pairs : ndarray of uint32, shape (M, 2)
        Rows of `x`, the smaller first; each pair once, in no particular order. In a box a pair stands
        there once for each image that touches, and a particle may touch its own.
    images : ndarray of int32, shape (M, D), or None
        Particle i touches the image of j at ``x[j] + images[k] @ vectors``; 0 where the box is open.
        None without a box. These are the shifts ``S`` of ASE and matscipy: the distance vector is
        ``x[j] - x[i] + S @ cell``. A list there has each pair from both sides; with a cutoff of
        2 r it is this one (``cutoff`` is a distance between centres, r = cutoff / 2), but for pairs
        at exactly the cutoff, which touch here (<=). Images are numbered below 2^29: a particle
        farther from its box is a `ValueError`.

    Raises
    ------
    ValueError
        Shapes that do not fit, numbers that are not finite or that float64 would round, masked
        numbers, negative radii, a box that encloses nothing, an unknown detector.
    Refused
        The detector cannot answer for this scene; a `ValueError`, too.
    KeyboardInterrupt
        Ctrl-C ends the call at once.
    MemoryError
        Arrays or pairs would take more than 16 KiB for each particle (at least 256 MiB, at most 4
        GiB or a quarter of the machine's memory). Radii in another unit than the centres are the
        usual reason. A `Detector` takes a limit of its own.

    Examples
    --------
    >>> import contactbench
    >>> pairs, images = contactbench.contacts([[0.25, 0.5], [3.75, 0.5]], 0.25, box=[4.0, 1.0])
    >>> pairs.tolist(), images.tolist()
    ([[0, 1]], [[-1, 0]])
    """
    centres, radii, edges = arrays(x, r, box)
    most = native.limit_for(len(centres)) if centres.ndim == 2 else None
    search = native.Search(_named(detector), False, arithmetic, _threads(threads), most)
    return search.contacts(centres, radii, edges)


class Detector:
    """A detector that keeps its buffers: a call for a scene like the one before allocates its answer
    and nothing else.

    It may be used by several threads; one waits for the other. It can be pickled and copied, with
    buffers of its own. A process forked while it works, or after it has started threads, must make
    its own: a RuntimeError says so.

    Parameters
    ----------
    detector, arithmetic, threads
        As in `contacts`.
    memory_limit : int, optional
        Bytes for its arrays, and as many for the pairs; without it 4 GiB, or a quarter of the
        machine's memory if that is less.

    Examples
    --------
    >>> import contactbench
    >>> detector = contactbench.Detector()
    >>> for gap in (0.25, 0.0):
    ...     pairs, _ = detector.contacts([[0.0, 0.0], [1.0 + gap, 0.0]], 0.5)
    ...     print(len(pairs))
    0
    1
    """

    def __init__(
        self,
        detector: str = "auto",
        arithmetic: str = "exact",
        threads: int = 1,
        memory_limit: int | None = None,
    ) -> None:
        self._native = native.Search(
            _named(detector), False, arithmetic, _threads(threads), limit(memory_limit)
        )

    def __reduce__(self) -> tuple[Any, ...]:
        """A copy, or what is unpickled, has buffers of its own."""
        return type(self), (self.name, self.arithmetic, self.threads, self.memory_limit)

    @property
    def name(self) -> str:
        """The detector, with the parameters that are not its defaults."""
        return self._native.name

    @property
    def arithmetic(self) -> str:
        """How contacts are decided."""
        return self._native.arithmetic

    @property
    def threads(self) -> int:
        """Threads that it may use."""
        return self._native.threads

    @property
    def memory_limit(self) -> int:
        """Bytes for its arrays, and as many for pairs."""
        return self._native.memory_limit

    @overload
    def contacts(
        self, x: npt.ArrayLike, r: npt.ArrayLike, box: None = None
    ) -> tuple[Pairs, None]: ...
    @overload
    def contacts(
        self, x: npt.ArrayLike, r: npt.ArrayLike, box: BoxLike
    ) -> tuple[Pairs, Images]: ...
    @overload
    def contacts(
        self, x: npt.ArrayLike, r: npt.ArrayLike, box: BoxLike | None
    ) -> tuple[Pairs, Images | None]: ...
    def contacts(
        self, x: npt.ArrayLike, r: npt.ArrayLike, box: BoxLike | None = None
    ) -> tuple[Pairs, Images | None]:
        """The pairs that touch; see the function `contacts`."""
        return self._native.contacts(*arrays(x, r, box))

    def count(
        self, x: npt.ArrayLike, r: npt.ArrayLike, box: BoxLike | None = None
    ) -> dict[str, int]:
        """How often each elementary operation happens, which is the same on every machine.

        Returns
        -------
        dict of str to int
            By the name that it has in records (``contactbench.load``), such as ``"contact_test"``;
            without operations that do not happen.
        """
        return self._native.count(*arrays(x, r, box))

    def __repr__(self) -> str:
        return f"Detector({self.name!r}, arithmetic={self.arithmetic!r}, threads={self.threads})"


class Verlet:
    """The contacts of particles that move, frame after frame, by a list of pairs that are nearly in
    touch, which is built again only when some have moved too far (a Verlet list).

    Answers are those of `contacts` in every frame, if the rule is safe. The number of particles, the
    radii and the box may change from frame to frame; the list is then built again where it must be.

    Parameters
    ----------
    detector : str
        Builds the list; as in `contacts`.
    skin : float or "auto"
        Pairs whose surfaces are up to `skin` diameters of the largest particle apart are listed.
        ``"auto"`` finds the skin that makes steps cheap, while they go on.
    rule : str
        When the list is built again. Safe are ``"top-two"``: when the two particles that have gone
        farthest have together gone the skin; ``"half-skin"``: when one has gone half of it;
        ``"summed"``: when the longest ways of all frames add up to half of it. Not safe are
        ``"every-K"``, and ``"lammps-DELAY-EVERY-yes"`` as in LAMMPS's `neigh_modify`.
    arithmetic, threads, memory_limit
        As in `Detector`. In a box a list decides in exact arithmetic alone.

    Examples
    --------
    Two discs that come nearer; the list serves all frames:

    >>> import contactbench
    >>> verlet = contactbench.Verlet(skin=0.4)
    >>> [len(verlet.contacts([[0.0, 0.0], [1.25 - 0.125 * k, 0.0]], 0.5)[0]) for k in range(3)]
    [0, 0, 1]
    >>> verlet.steps, verlet.builds
    (3, 1)
    """

    def __init__(
        self,
        detector: str = "auto",
        skin: float | str = "auto",
        rule: str = "top-two",
        arithmetic: str = "exact",
        threads: int = 1,
        memory_limit: int | None = None,
    ) -> None:
        tracker = f"verlet({_named(detector)},rule={rule},skin={skin})"
        self._asked = (detector, skin, rule, arithmetic, threads, memory_limit)
        self._native = native.Search(
            tracker, True, arithmetic, _threads(threads), limit(memory_limit)
        )

    def __reduce__(self) -> tuple[Any, ...]:
        """A copy, or what is unpickled, has no list: its next frame is the first."""
        return type(self), self._asked

    @property
    def name(self) -> str:
        """The list, as ``contactbench track`` writes it."""
        return self._native.name

    @property
    def steps(self) -> int:
        """Frames so far."""
        return self._native.done[0]

    @property
    def builds(self) -> int:
        """Frames in which the list was built, so far."""
        return self._native.done[1]

    @property
    def dangerous(self) -> int:
        """Builds that LAMMPS would call dangerous, so far."""
        return self._native.done[2]

    @property
    def listed(self) -> int:
        """Pairs looked at in the last frame."""
        return self._native.done[3]

    @property
    def built(self) -> bool:
        """Whether the list was built in the last frame."""
        return self._native.done[4]

    @overload
    def contacts(
        self, x: npt.ArrayLike, r: npt.ArrayLike, box: None = None
    ) -> tuple[Pairs, None]: ...
    @overload
    def contacts(
        self, x: npt.ArrayLike, r: npt.ArrayLike, box: BoxLike
    ) -> tuple[Pairs, Images]: ...
    @overload
    def contacts(
        self, x: npt.ArrayLike, r: npt.ArrayLike, box: BoxLike | None
    ) -> tuple[Pairs, Images | None]: ...
    def contacts(
        self, x: npt.ArrayLike, r: npt.ArrayLike, box: BoxLike | None = None
    ) -> tuple[Pairs, Images | None]:
        """The pairs that touch in the next frame; see the function `contacts`."""
        return self._native.contacts(*arrays(x, r, box))

    def forget(self) -> None:
        """Takes the next frame as the first."""
        self._native.forget()

    def __repr__(self) -> str:
        return f"<{self.name}: {self.builds} builds in {self.steps} frames>"
