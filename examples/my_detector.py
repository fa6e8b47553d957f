"""A contact detector in Python as a runner (docs/PROTOCOL.md); needs the standard library only.
contactbench check --runner "python3 examples/my_detector.py"
"""
import json, os, struct, sys, time


def detect(centres, radii):
    """Find the pairs that touch, by sorting along x. Put your own detector here."""
    # Exceeds the largest sum of radii by more than rounding and underflow in the test below.
    reach = 2 * max(radii, default=0.0) * (1 + 1e-14) + 1e-150
    order = sorted(range(len(centres)), key=lambda i: centres[i][0])
    pairs = []
    for k, i in enumerate(order):
        for j in order[k + 1:]:
            if centres[j][0] - centres[i][0] > reach:
                break
            # The test of the arithmetic f64, which sums the squares axis by axis.
            square, total = 0.0, radii[i] + radii[j]
            for x, y in zip(centres[i], centres[j]):
                square += (x - y) * (x - y)
            if square <= total * total:
                pairs.append((i, j))
    return pairs


def load(frames, dim, n, radius):
    """Read centres and radii: an npy header, its length in bytes 8 and 9, and rows of doubles."""
    with open(frames[0], "rb") as file:
        file.seek(10 + struct.unpack("<8sH", file.read(10))[1])
        columns = dim + (radius is None)
        numbers = struct.unpack(f"<{n * columns}d", file.read())
    rows = [numbers[k:k + columns] for k in range(0, n * columns, columns)]
    return [row[:dim] for row in rows], [row[dim] if radius is None else radius for row in rows]


def digest(pairs):
    """Return the number of pairs, and a fingerprint that does not depend on their order."""
    total, mask = 0, 2**64 - 1
    for i, j in pairs:
        z = ((min(i, j) << 32 | max(i, j)) + 0x9E3779B97F4A7C15) & mask
        z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9 & mask
        z = (z ^ z >> 27) * 0x94D049BB133111EB & mask
        total += z ^ z >> 31
    return {"contacts": len(pairs), "digest": f"0x{total & mask:016x}"}


def answer(scene, request, path=None, min_ns=1, **load_fields):
    if request == "load" and "box" in load_fields:
        return {"reply": "refused", "reason": "this detector supports open space only, and the scene has a periodic box"}
    if request == "load":
        scene[:] = load(*(load_fields[key] for key in ("frames", "dim", "n", "radius")))
        return {"reply": "loaded"}
    if request == "sample":  # detections keep no state, so there is nothing to reset
        pairs, calls, start = detect(*scene), 0, time.perf_counter_ns()  # one warm-up
        while calls == 0 or time.perf_counter_ns() - start < min_ns:
            pairs, calls = detect(*scene), calls + 1
        elapsed = time.perf_counter_ns() - start
        return {"reply": "sample", "time_ns": round(elapsed / calls), "calls": calls, "elapsed_ns": elapsed, **digest(pairs)}
    if request == "pairs":
        pairs = detect(*scene)
        header = "{'descr': '<u4', 'fortran_order': False, 'shape': (%d, 2), }\n" % len(pairs)
        with open(path, "wb") as file:
            file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode())
            file.write(struct.pack(f"<{2 * len(pairs)}I", *(k for pair in pairs for k in pair)))
        return {"reply": "pairs", "contacts": len(pairs)}
    return {"reply": "unsupported"}


scene, channel, _ = [], os.fdopen(os.dup(1), "w"), os.dup2(2, 1)  # libraries print to standard error
print(json.dumps({"reply": "hello", "protocol": 4, "detector": "my-detector", "arithmetic": "f64", "at_rest": True}), file=channel, flush=True)
for line in sys.stdin:
    try:
        asked = json.loads(line)
        if asked["request"] == "quit":
            break
        reply = answer(scene, **asked)
    except Exception as error:
        reply = {"reply": "error", "reason": f"{type(error).__name__}: {error}"}
    print(json.dumps(reply), file=channel, flush=True)
