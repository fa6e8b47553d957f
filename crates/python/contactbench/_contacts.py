"""Contacts of scenes and of moving particles."""

from __future__ import annotations

from typing import Any, TypeAlias, overload

import numpy as np
import numpy.typing as npt

from . import _contactbench as native
from ._boxes import BoxLike, arrays, count, limit

Pairs: TypeAlias = npt.NDArray[np.uint32]
Images: TypeAlias = npt.NDArray[np.int32]


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
def contacts(
    x: npt.ArrayLike,
    r: npt.ArrayLike,
    box: BoxLike | None = None,
    detector: str = "auto",
    arithmetic: str = "exact",
    threads: int = 1,
) -> tuple[Pairs, Images | None]:
    """Find the pairs of particles that touch or overlap: |xi - xj| <= ri + rj.

    Parameters
    ----------
    x : array_like, shape (N, 2) or (N, 3)
        Centres of discs or spheres. Contiguous arrays of float64 are not copied.
    r : float or array_like, shape (N,)
        One radius for all particles, or one for each, in the unit of `x`.
    box : array_like, shape (D,) or (D, D), or Box, optional
        A periodic box: its lengths, or its D vectors as rows. Use a `Box` if it is periodic along
        some vectors only. Particles may lie outside the box. Without a box, space is open.
    detector : str
        One of `DETECTORS`, with parameters as in ``"streamed-nbs:level=avx2"``; ``"auto"`` is
        `streamed-nbs`, the default of ``contactbench detect``. Only time and memory depend on it.
    arithmetic : {"exact", "exact-open", "f64", "f32", "textbook"}
        How contacts are decided: exactly for the given numbers, exactly with < instead of <=, or by
        a rounded test.
    threads : int
        Number of threads. Only `streamed-nbs` (from 30,000 particles on), `cell-grid` and `direct`
        can use several.

    Returns
    -------
    pairs : ndarray of uint32, shape (M, 2)
        Rows of `x`, the smaller first; each pair once, in no particular order. In a box, a pair
        occurs once for each image that touches, and a particle may touch its own images.
    images : ndarray of int32, shape (M, D), or None
        Particle i touches the image of j at ``x[j] + images[k] @ vectors``; 0 along open
        directions. None without a box. These are the shifts ``S`` of ASE and matscipy: the distance
        vector is ``x[j] - x[i] + S @ cell``. Their lists contain each pair from both sides. For one radius r
        and ``cutoff`` = 2 r (a distance between centres), the pairs are the same, except pairs at
        exactly the cutoff, which touch here. Images must be below 2^29 in magnitude; particles
        farther from their box raise a `ValueError`.

    Raises
    ------
    ValueError
        Shapes do not fit; a number is not finite, masked, or would be rounded by float64; a radius
        is negative; the box has no volume; or the detector is unknown.
    Refused
        The detector cannot answer for this scene. A `ValueError`.
    KeyboardInterrupt
        Ctrl-C ends the call at once.
    MemoryError
        Arrays or pairs would need more than 16 KiB per particle (at least 256 MiB, at most 4 GiB or
        a quarter of the machine's memory). The usual reason is radii in another unit than the
        centres. A `Detector` accepts another limit.

    Examples
    --------
    >>> import contactbench
    >>> pairs, images = contactbench.contacts([[0.25, 0.5], [3.75, 0.5]], 0.25, box=[4.0, 1.0])
    >>> pairs.tolist(), images.tolist()
    ([[0, 1]], [[-1, 0]])
    """
    centres, radii, edges = arrays(x, r, box)
    most = native.limit_for(len(centres)) if centres.ndim == 2 else None
    search = native.Search(_named(detector), False, arithmetic, count(threads, "threads"), most)
    return search.contacts(centres, radii, edges)


class _Search:
    """What detectors and trackers share."""

    _native: native.Search

    @property
    def name(self) -> str:
        """The detector, with parameters that differ from its defaults, or the tracker."""
        return self._native.name

    @property
    def arithmetic(self) -> str:
        """How contacts are decided."""
        return self._native.arithmetic

    @property
    def threads(self) -> int:
        """Number of threads."""
        return self._native.threads

    @property
    def memory_limit(self) -> int:
        """Limit in bytes for the arrays, and again for the pairs."""
        return self._native.memory_limit

    @overload
    def contacts(
        self, x: npt.ArrayLike, r: npt.ArrayLike, box: None = None
    ) -> tuple[Pairs, None]: ...
    @overload
    def contacts(
        self, x: npt.ArrayLike, r: npt.ArrayLike, box: BoxLike
    ) -> tuple[Pairs, Images]: ...
    def contacts(
        self, x: npt.ArrayLike, r: npt.ArrayLike, box: BoxLike | None = None
    ) -> tuple[Pairs, Images | None]:
        """Find the pairs that touch, in a scene or the next frame; see the function `contacts`."""
        return self._native.contacts(*arrays(x, r, box))


class Detector(_Search):
    """A detector that keeps its buffers: a call for a scene like the one before allocates only its
    answer.

    Several threads may use it; each waits for the others. Copies and unpickled detectors have their
    own buffers. A process that was forked during a call, or after the detector started threads,
    must create a new one; the old one raises a RuntimeError.

    Parameters
    ----------
    detector, arithmetic, threads
        As in `contacts`.
    memory_limit : int, optional
        Limit in bytes for the arrays, and again for the pairs. By default 4 GiB, or a quarter of
        the machine's memory if that is less.

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
            _named(detector), False, arithmetic, count(threads, "threads"), limit(memory_limit)
        )

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies and unpickled detectors have their own buffers."""
        return type(self), (self.name, self.arithmetic, self.threads, self.memory_limit)

    def count(
        self, x: npt.ArrayLike, r: npt.ArrayLike, box: BoxLike | None = None
    ) -> dict[str, int]:
        """Count the elementary operations of a detection, which are the same on every machine.

        Returns
        -------
        dict of str to int
            Number of each operation by its name in records (``contactbench.load``), such as
            ``"contact_test"``. Operations that do not occur are absent.
        """
        return self._native.count(*arrays(x, r, box))

    def __repr__(self) -> str:
        return f"Detector({self.name!r}, arithmetic={self.arithmetic!r}, threads={self.threads})"


class Verlet(_Search):
    """A tracker of moving particles. It keeps a list of near pairs (a Verlet list), and rebuilds it
    only if particles have moved too far.

    If the rule is safe, every frame has the contacts that `contacts` finds. The number of
    particles, the radii and the box may change between frames; the list is then rebuilt if
    necessary.

    Parameters
    ----------
    detector : str
        The detector that builds the list; as in `contacts`.
    skin : float or "auto"
        The largest gap between listed particles, in diameters of the largest particle. ``"auto"``
        adjusts the skin during the steps, to make them fast.
    rule : str
        The condition for a rebuild. Safe rules: ``"top-two"``, the two largest displacements add up
        to the skin; ``"half-skin"``, one displacement reaches half of it; ``"summed"``, the largest
        displacements of all frames add up to half of it. Unsafe rules: ``"every-K"``, and
        ``"lammps-DELAY-EVERY-yes"`` as in LAMMPS's `neigh_modify`.
    arithmetic, threads, memory_limit
        As in `Detector`. A list in a box supports only exact arithmetic.

    Examples
    --------
    Two discs approach each other; one list serves all frames:

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
            tracker, True, arithmetic, count(threads, "threads"), limit(memory_limit)
        )

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies and unpickled trackers have no list: their next frame is the first."""
        return type(self), self._asked

    @property
    def steps(self) -> int:
        """Number of frames so far."""
        return self._native.done[0]

    @property
    def builds(self) -> int:
        """Number of frames so far in which the list was built."""
        return self._native.done[1]

    @property
    def dangerous(self) -> int:
        """Number of builds so far that LAMMPS would call dangerous."""
        return self._native.done[2]

    @property
    def listed(self) -> int:
        """Number of listed pairs in the last frame."""
        return self._native.done[3]

    @property
    def built(self) -> bool:
        """Whether the list was built in the last frame."""
        return self._native.done[4]

    def forget(self) -> None:
        """Make the next frame count as the first."""
        self._native.forget()

    def __repr__(self) -> str:
        return f"<{self.name}: {self.builds} builds in {self.steps} frames>"
