"""The runner protocol, version 2 (docs/PROTOCOL.md), for libraries with a Python interface.

A library is a function that is given a scene and returns a function without arguments: one
detection, from raw coordinates to the array of pairs. That array is one of shape (pairs, 2) or two
of indices; i and j of a pair stand in any order, each pair once. A detection that keeps more than
buffers for the next one has an attribute `reset`, a function that drops it: a sample is passes over
the trajectory, and each pass begins with a reset. These runners take scenes at rest, trajectories
of one frame.
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


class Scene:
    """Centres (n, dim), the radius of all or None, radii (n,), and the largest distance at which two
    particles touch."""

    def __init__(self, path, dim, n, radius):
        data = np.load(path)
        if data.shape != (n, dim + (radius is None)):
            raise ValueError(f"{path} has the shape {data.shape}, not {n} particles in {dim}D")
        self.dim, self.n, self.radius = dim, n, radius
        self.centres = np.ascontiguousarray(data[:, :dim])
        self.radii = np.ascontiguousarray(data[:, dim]) if radius is None else None
        self.reach = 2.0 * (radius if radius is not None else float(self.radii.max(initial=0.0)))

    def in_space(self):
        """The centres with z = 0 in 2D, for libraries that know only space; made once, outside the
        clock."""
        return np.pad(self.centres, ((0, 0), (0, 3 - self.dim)))

    def touching(self, i, j):
        """Of candidates, those that touch by radii: only for scenes with different ones."""
        difference = self.centres[i] - self.centres[j]
        sums = self.radii[i] + self.radii[j]
        keep = np.einsum("ij,ij->i", difference, difference) <= sums * sums
        return i[keep], j[keep]


def columns(pairs):
    """Pairs as two arrays of 64 bits."""
    i, j = (pairs[:, 0], pairs[:, 1]) if isinstance(pairs, np.ndarray) else pairs
    return i.astype(np.uint64), j.astype(np.uint64)


def digest(pairs):
    """Number and fingerprint of pairs; outside the clock."""
    i, j = columns(pairs)
    with np.errstate(over="ignore"):
        z = (np.minimum(i, j) << np.uint64(32) | np.maximum(i, j)) + np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        total = int((z ^ (z >> np.uint64(31))).sum(dtype=np.uint64))
    return {"contacts": len(i), "digest": f"{total:#018x}"}


def timed(detect, passes):
    """Nanoseconds of so many passes, and the pairs of the last."""
    reset = getattr(detect, "reset", None)
    start = time.perf_counter_ns()
    for _ in range(passes):
        if reset:
            reset()
        pairs = detect()
    return time.perf_counter_ns() - start, pairs


def at_rest(frames, dim, n, radius):
    """The scene of a trajectory of one frame."""
    if len(frames) != 1:
        raise Refusal(f"this runner takes scenes at rest, trajectories of one frame; this one has {len(frames)}")
    return Scene(frames[0], dim, n, radius)


def serve(name, version, prepare, arithmetic="exact"):
    """Answers requests until `quit`. `prepare(scene)` is outside the clock: for what does not depend
    on coordinates, and for conversions."""
    build = {"python": platform.python_version(), "numpy": np.__version__}
    say("hello", protocol=2, detector=name, arithmetic=arithmetic, version=version, build=build)
    detect, calls = None, None
    for line in sys.stdin:
        request = json.loads(line)
        asked = request.get("request")
        try:
            if asked == "quit":
                return
            if asked == "load":
                detect, calls = None, None
                detect = prepare(at_rest(*(request[key] for key in ("frames", "dim", "n", "radius"))))
                say("loaded")
            elif asked in ("count", "memory"):
                say("unsupported")
            elif detect is None:
                say("error", reason="no scene is loaded; send load first")
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
                say("sample", time_ns=each, calls=calls, elapsed_ns=elapsed, step_ns=[each], first_ns=first, **digest(pairs))
            elif asked == "pairs":
                pairs = np.stack(columns(timed(detect, 1)[1]), axis=1).astype("<u4")
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
