"""The runner protocol (docs/PROTOCOL.md), for libraries with a Python interface.

Write a function that takes a scene and returns a function without arguments. The latter is one
detection, from raw coordinates to the pairs. It returns an array of shape (pairs, 2), or two arrays
of indices, with each pair once, and i and j in any order. It may have three attributes:

* `reset`, if a detection keeps more than buffers for the next one: a function that drops the rest.
  A sample is a number of passes over the trajectory, and each begins with a reset.
* `finish`, if the library's answer has another form: a function that turns it into pairs, after the
  clock has stopped.
* `report`, if another program takes the time: a function that takes the least nanoseconds of a
  sample and returns the number of detections, their nanoseconds, those of the first (or 0), and the
  pairs. `build` of `serve` then names that clock.

These runners support trajectories of one frame only (`at_rest`); contactbench sends them the frames
of a motion one by one.

In a periodic box (`serve(..., boxes=True)`) a detection returns three arrays: i, j, and the images
S of shape (contacts, dim). Particle i touches the image of j at x_j + S @ vectors. If a library
returns no images, the nearest image of each pair is added after the clock has stopped.
"""

import json
import os
import platform
import sys
import time

# Keep libraries from starting threads.
for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"


# Replies have a descriptor of their own; whatever a library prints, also from C, goes to standard
# error.
sys.stdout.flush()
channel = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)


def say(reply, **fields):
    channel.write(json.dumps({"reply": reply, **fields}) + "\n")
    channel.flush()


def unavailable(library, install, error):
    """Reply that the library is missing, and end the runner."""
    say("unavailable", reason=f"{library} cannot be loaded ({error}): {install}")
    sys.exit(0)


try:
    import numpy as np
except ImportError as error:
    unavailable("numpy", "pip install numpy", error)


class Refusal(Exception):
    """Raise this if the library does not support the scene; the text is one sentence."""


class Box:
    """A periodic box: its vectors (dim, dim), one per row, its periodic flags, and its corner. Open
    vectors are replaced by vectors at right angles to the periodic ones, so long that the box holds
    all centres with more than the reach to spare."""

    def __init__(self, centres, reach, vectors, periodic, origin):
        self.vectors, self.periodic = np.array(vectors), np.array(periodic)
        self.origin = np.array(origin)
        if self.periodic.all() or not len(centres):
            return
        # Directions at right angles to all periodic vectors; axes if possible.
        free = np.flatnonzero(~self.periodic)
        axes = np.eye(len(vectors))[free]
        if np.any(axes @ self.vectors[self.periodic].T):
            axes = np.linalg.svd(self.vectors[self.periodic])[2][len(vectors) - len(free) :]
        for row, axis in zip(free, axes):
            along = centres @ axis
            low, high = along.min(), along.max()
            self.vectors[row] = axis * (high - low + 4.0 * reach)
            self.origin += axis * (low - 2.0 * reach - self.origin @ axis)

    def nearest(self, centres, i, j):
        """Return the image of j nearest to i for each pair; may fail in tilted boxes smaller than
        twice the distance."""
        apart = (centres[i] - centres[j]) @ np.linalg.inv(self.vectors)
        return np.where(self.periodic, np.rint(apart), 0.0).astype(np.int64)


class Scene:
    """Centres (n, dim); the common radius or None; radii (n,) or None; `reach`, the largest
    distance at which two particles touch; and the periodic box or None."""

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
        """Return the centres, with z = 0 in 2D, for libraries that support only 3D."""
        return np.pad(self.centres, ((0, 0), (0, 3 - self.dim)))

    def touching(self, i, j, images=None):
        """Return the candidates that touch, for scenes with different radii."""
        difference = self.centres[i] - self.centres[j]
        if self.box:
            images = self.box.nearest(self.centres, i, j) if images is None else images
            difference -= images @ self.box.vectors
        sums = self.radii[i] + self.radii[j]
        keep = np.einsum("ij,ij->i", difference, difference) <= sums * sums
        return (i[keep], j[keep]) if images is None else (i[keep], j[keep], images[keep])

    def columns(self, found):
        """Return pairs as two arrays of 64-bit integers, and in a box their images as a third."""
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
    """Return the number and the fingerprint of contacts."""
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
    """Return three columns of S in canonical form: of (i, j, S) and (j, i, -S) the one with i < j;
    if i = j, the one whose first nonzero number is positive."""
    images = np.pad(images, ((0, 0), (0, 3 - images.shape[1])))
    first = images[np.arange(len(images)), (images != 0).argmax(axis=1)]
    turn = (j < i) | ((i == j) & (first < 0))
    return np.where(turn[:, None], -images, images).T


def timed(detect, passes):
    """Return the nanoseconds of this many passes, and the pairs of the last."""
    reset = getattr(detect, "reset", None)
    start = time.perf_counter_ns()
    for _ in range(passes):
        if reset:
            reset()
        pairs = detect()
    elapsed = time.perf_counter_ns() - start
    finish = getattr(detect, "finish", None)
    return elapsed, finish(pairs) if finish else pairs


def at_rest(frames, dim, n, radius, box, boxes):
    """Load the scene of a trajectory with one frame."""
    if len(frames) != 1:
        raise Refusal(f"this runner supports trajectories of one frame; this one has {len(frames)}")
    if box and not boxes:
        raise Refusal("this runner does not support periodic boxes")
    return Scene(frames[0], dim, n, radius, box)


def serve(name, version, prepare, arithmetic="exact", boxes=False, build=None):
    """Answer requests until `quit`. The clock does not include `prepare(scene)`, which is for work
    that does not depend on coordinates, and for conversions. `build` lists what else affects
    times."""
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
                # A disturbed calibration may yield too few detections.
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
