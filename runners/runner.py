"""The runner protocol (docs/PROTOCOL.md), for libraries with a Python interface.

A library is a function that is given a scene and returns a function without arguments: one
detection, from raw coordinates to the array of pairs. That array is one of shape (pairs, 2) or two
of indices; i and j of a pair stand in any order, each pair once. A detection that keeps more than
buffers for the next one has an attribute `reset`, a function that drops it: a sample is passes over
the trajectory, and each pass begins with a reset. One whose time another program takes has an
attribute `report`, a function that is given the least nanoseconds of a sample and returns detections,
their nanoseconds, those of the first (or 0) and the pairs; `build` of `serve` then names that clock. These runners take scenes at rest, trajectories
of one frame, and say so (`at_rest`): of a motion they are given one frame after the other.

In a box that repeats (`serve(..., boxes=True)`) a detection returns three arrays, i, j and the images
S, (contacts, dim): i touches the image of j at x_j + S @ vectors. A library that names no images
returns two, and the nearest image of each pair is taken for it, outside the clock.
"""

import json
import os
import platform
import sys
import time

# One thread: no pool of threads of its own, whatever a library finds.
for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"


# What a library prints on standard output, from C too, goes to standard error: replies have a
# descriptor of their own.
sys.stdout.flush()
channel = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)


def say(reply, **fields):
    channel.write(json.dumps({"reply": reply, **fields}) + "\n")
    channel.flush()


def unavailable(library, install, error):
    """The first line of a runner whose library is missing, and its last."""
    say("unavailable", reason=f"{library} cannot be loaded ({error}): {install}")
    sys.exit(0)


try:
    import numpy as np
except ImportError as error:
    unavailable("numpy", "pip install numpy", error)


class Refusal(Exception):
    """The library will not work on this scene: one sentence."""


class Box:
    """The vectors of a box that repeats (dim, dim), one per row, whether it does along each of them,
    and its corner. Vectors along which it does not are at right angles to the others, and so long
    that the box holds all centres with more than the reach to spare."""

    def __init__(self, centres, reach, vectors, periodic, origin):
        self.vectors, self.periodic = np.array(vectors), np.array(periodic)
        self.origin = np.array(origin)
        if self.periodic.all() or not len(centres):
            return
        # Directions at right angles to all periodic vectors: the axes themselves, if they are.
        free = np.flatnonzero(~self.periodic)
        axes = np.eye(len(vectors))[free]
        if np.any(axes @ self.vectors[self.periodic].T):
            axes = np.linalg.svd(self.vectors[self.periodic])[2][len(vectors) - len(free) :]
        for row, axis in zip(free, axes):
            along = centres @ axis
            low, high = along.min(), along.max()
            self.vectors[row] = axis * (high - low + 4.0 * reach)
            self.origin += axis * (low - 2.0 * reach - self.origin @ axis)

    def edges(self):
        """Its edges, if it is not tilted."""
        if np.count_nonzero(self.vectors - np.diag(np.diag(self.vectors))):
            raise Refusal("the library knows no tilted boxes")
        return np.diag(self.vectors)

    def holds(self, reach):
        """A refusal unless faces are at least twice the reach apart, as libraries want it that know
        of each pair the nearest image only."""
        heights = 1.0 / np.linalg.norm(np.linalg.inv(self.vectors), axis=0)
        if np.float32(2.0 * reach) >= np.float32(heights.min()):
            raise Refusal("the library wants boxes of more than twice the distance")

    def wrapped(self, centres):
        """Centres in the box, from its corner, and the whole numbers of vectors they were moved by."""
        places = centres - self.origin
        moved = np.where(self.periodic, np.floor(places @ np.linalg.inv(self.vectors)), 0.0)
        return places - moved @ self.vectors, moved.astype(np.int64)

    def nearest(self, centres, i, j):
        """Of each pair the image of j that is nearest to i, but for tilted boxes smaller than twice
        the distance."""
        apart = (centres[i] - centres[j]) @ np.linalg.inv(self.vectors)
        return np.where(self.periodic, np.rint(apart), 0.0).astype(np.int64)


class Scene:
    """Centres (n, dim), the radius of all or None, radii (n,), and the largest distance at which two
    particles touch; and the box in which they repeat, or None."""

    def __init__(self, path, dim, n, radius, box=None):
        data = np.load(path)
        if data.shape != (n, dim + (radius is None)):
            raise ValueError(f"{path} has the shape {data.shape}, not {n} particles in {dim}D")
        self.dim, self.n, self.radius = dim, n, radius
        self.centres = np.ascontiguousarray(data[:, :dim])
        self.radii = np.ascontiguousarray(data[:, dim]) if radius is None else None
        self.reach = 2.0 * (radius if radius is not None else float(self.radii.max(initial=0.0)))
        self.box = box and Box(self.centres, self.reach, **box)

    def in_space(self):
        """The centres with z = 0 in 2D, for libraries that know only space; made once, outside the
        clock."""
        return np.pad(self.centres, ((0, 0), (0, 3 - self.dim)))

    def touching(self, i, j, images=None):
        """Of candidates, those that touch by radii: only for scenes with different ones."""
        difference = self.centres[i] - self.centres[j]
        if self.box:
            images = self.box.nearest(self.centres, i, j) if images is None else images
            difference -= images @ self.box.vectors
        sums = self.radii[i] + self.radii[j]
        keep = np.einsum("ij,ij->i", difference, difference) <= sums * sums
        return (i[keep], j[keep]) if images is None else (i[keep], j[keep], images[keep])

    def columns(self, found):
        """Pairs as two arrays of 64 bits, in a box with a third of their images."""
        i, j, *images = (found[:, 0], found[:, 1]) if isinstance(found, np.ndarray) else found
        if self.box:
            images = images or [self.box.nearest(self.centres, i, j)]
        return [i.astype(np.uint64), j.astype(np.uint64), *(image.astype(np.int64) for image in images)]


def splitmix64(x):
    z = x + np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def digest(i, j, images=None):
    """Number and fingerprint of contacts; outside the clock."""
    with np.errstate(over="ignore"):
        hashes = splitmix64(np.minimum(i, j) << np.uint64(32) | np.maximum(i, j))
        if images is not None:
            x, y, z = named(i, j, images)
            word = np.uint64(0xFFFFFFFF)
            x, y, z = (part.astype(np.uint64) & word for part in (x, y, z))
            through = splitmix64(splitmix64(hashes ^ (x << np.uint64(32) | y)) ^ z)
            hashes = np.where(images.any(axis=1), through, hashes)
        total = int(hashes.sum(dtype=np.uint64))
    return {"contacts": len(i), "digest": f"{total:#018x}"}


def named(i, j, images):
    """Three columns of S as the contact is named: of (i, j, S) and (j, i, -S) the one with i < j, and
    of a particle with itself the one whose first number that is not 0 is positive."""
    images = np.pad(images, ((0, 0), (0, 3 - images.shape[1])))
    first = images[np.arange(len(images)), (images != 0).argmax(axis=1)]
    turn = (j < i) | ((i == j) & (first < 0))
    return np.where(turn[:, None], -images, images).T


def timed(detect, passes):
    """Nanoseconds of so many passes, and the pairs of the last."""
    reset = getattr(detect, "reset", None)
    start = time.perf_counter_ns()
    for _ in range(passes):
        if reset:
            reset()
        pairs = detect()
    return time.perf_counter_ns() - start, pairs


def at_rest(frames, dim, n, radius, box, boxes):
    """The scene of a trajectory of one frame."""
    if len(frames) != 1:
        raise Refusal(f"this runner takes scenes at rest, trajectories of one frame; this one has {len(frames)}")
    if box and not boxes:
        raise Refusal("this runner knows no boxes that repeat")
    return Scene(frames[0], dim, n, radius, box)


def serve(name, version, prepare, arithmetic="exact", boxes=False, build=None):
    """Answers requests until `quit`. `prepare(scene)` is outside the clock: for what does not depend
    on coordinates, and for conversions. `build` says what else may change the times."""
    build = {"python": platform.python_version(), "numpy": np.__version__, **(build or {})}
    say("hello", protocol=4, detector=name, arithmetic=arithmetic, version=version, build=build, at_rest=True)
    scene, detect, calls = None, None, None
    for line in sys.stdin:
        request = json.loads(line)
        asked = request.get("request")
        try:
            if asked == "quit":
                return
            if asked == "load":
                detect, calls = None, None
                scene = at_rest(*(request.get(key) for key in ("frames", "dim", "n", "radius", "box")), boxes)
                detect = prepare(scene)
                say("loaded")
            elif asked in ("count", "memory"):
                say("unsupported")
            elif detect is None:
                say("error", reason="no scene is loaded; send load first")
            elif asked == "sample" and hasattr(detect, "report"):
                calls, elapsed, first, pairs = detect.report(request["min_ns"])
                each = (elapsed + calls // 2) // calls
                first = {"first_ns": first} if first else {}
                say("sample", time_ns=each, calls=calls, elapsed_ns=elapsed, **first, **digest(*scene.columns(pairs)))
            elif asked == "sample":
                first = max(timed(detect, 1)[0], 1)
                fresh = calls is None
                if fresh:
                    calls, least = 1, request["min_ns"]
                    while (elapsed := timed(detect, calls)[0]) < least:
                        calls = max(calls + 1, min(10 * calls, least * calls * 9 // (8 * max(elapsed, 1))))
                elapsed, pairs = timed(detect, calls)
                # What disturbed the calibration made the detections too few.
                while fresh and elapsed < least // 2:
                    calls = min(10 * calls, max(calls + 1, least * calls // max(elapsed, 1)))
                    elapsed, pairs = timed(detect, calls)
                each = (elapsed + calls // 2) // calls
                say("sample", time_ns=each, calls=calls, elapsed_ns=elapsed, step_ns=[each], first_ns=first, **digest(*scene.columns(pairs)))
            elif asked == "pairs":
                i, j, *images = scene.columns(timed(detect, 1)[1])
                pairs = np.column_stack([i, j, *images]).astype("<i4" if scene.box else "<u4")
                with open(request["path"], "wb") as file:
                    np.lib.format.write_array(file, pairs, version=(1, 0))
                say("pairs", contacts=len(pairs))
            else:
                say("error", reason=f"there is no request '{asked}'")
        except Refusal as refusal:
            say("refused", reason=str(refusal))
        except MemoryError:
            raise
        except Exception as error:
            say("error", reason=f"{type(error).__name__}: {error}".replace("\n", " "))
