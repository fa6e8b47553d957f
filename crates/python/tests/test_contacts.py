"""Contacts, compared with tests of all pairs and with SciPy."""

import threading
import time
from pathlib import Path

import numpy as np
import pytest

import contactbench


def brute(x, r):
    """Test all pairs in f64; for scenes without near-tangent pairs."""
    r = np.broadcast_to(r, len(x))
    i, j = np.triu_indices(len(x), 1)
    near = ((x[i] - x[j]) ** 2).sum(axis=1) <= (r[i] + r[j]) ** 2
    return {(int(a), int(b)) for a, b in zip(i[near], j[near])}


def pairs_of(answer):
    pairs, images = answer
    assert pairs.dtype == np.uint32 and pairs.shape == (len(pairs), 2)
    assert (pairs[:, 0] <= pairs[:, 1]).all()
    rows = pairs if images is None else np.hstack([pairs.astype(np.int64), images])
    found = {tuple(map(int, row)) for row in rows}
    assert len(found) == len(pairs)
    return found


def images_of(x, r, vectors, periodic):
    """Find contacts in a box by testing all adjacent images."""
    r = np.broadcast_to(r, len(x))
    ranges = [range(-2, 3) if flag else range(1) for flag in periodic]
    found = set()
    for shift in np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, len(ranges)):
        distance = x[:, None] - x[None] - shift @ vectors
        touch = (distance**2).sum(axis=2) <= (r[:, None] + r[None]) ** 2
        for i, j in zip(*np.nonzero(touch)):
            first = next((s for s in shift if s), 0)
            if i < j or (i == j and first > 0):
                found.add((int(i), int(j), *map(int, shift)))
    return found


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("mixed", [False, True])
@pytest.mark.parametrize("detector", ["auto", *contactbench.DETECTORS])
def test_every_detector_finds_all_pairs(detector, dim, mixed):
    random = np.random.default_rng(1)
    x = random.random((300, dim))
    r = random.uniform(0.01, 0.06, 300) if mixed else 0.04
    assert pairs_of(contactbench.contacts(x, r, detector=detector)) == brute(x, r)


@pytest.mark.parametrize("arithmetic", ["exact", "exact-open", "f64", "f32", "textbook"])
def test_every_arithmetic_decides(arithmetic):
    x = np.random.default_rng(2).random((500, 3))
    assert pairs_of(contactbench.contacts(x, 0.05, arithmetic=arithmetic)) == brute(x, 0.05)


def test_contacts_are_decided_exactly():
    # In f64, 0.1 + 0.2 is an ulp above 0.3; the exact sum of the two doubles is not.
    x = [[0.0, 0.0], [0.1 + 0.2, 0.0]]
    r = [0.1, 0.2]
    assert len(contactbench.contacts(x, r)[0]) == 0
    assert len(contactbench.contacts(x, r, arithmetic="f64")[0]) == 1


def test_scipy_finds_the_same():
    spatial = pytest.importorskip("scipy.spatial")
    x = np.random.default_rng(3).random((20_000, 3)) * 20.0
    theirs = spatial.cKDTree(x).query_pairs(1.0)
    assert len(theirs) > 10_000
    assert pairs_of(contactbench.contacts(x, 0.5)) == theirs
    boxed = spatial.cKDTree(x, boxsize=20.0).query_pairs(1.0)
    pairs, images = contactbench.contacts(x, 0.5, box=[20.0] * 3)
    assert {tuple(map(int, pair)) for pair in pairs} == boxed
    assert images.any() and len(boxed) > len(theirs)


@pytest.mark.parametrize(
    "vectors, periodic",
    [
        (np.diag([1.0, 1.5]), [True, True]),
        (np.diag([1.0, 1.5]), [False, True]),
        (np.array([[1.0, 0.0], [0.5, 1.25]]), [True, True]),
        (np.diag([1.0, 1.25, 0.75]), [True, True, False]),
        (np.array([[1.0, 0.25, 0.0], [0.0, 1.0, 0.5], [0.25, 0.0, 1.0]]), [True, True, True]),
    ],
)
def test_boxes_may_be_open_and_skewed(vectors, periodic):
    random = np.random.default_rng(4)
    x = (random.random((60, len(vectors))) * 2.0 - 0.5) @ vectors
    r = random.uniform(0.02, 0.2, 60)
    box = contactbench.Box(vectors, periodic)
    assert pairs_of(contactbench.contacts(x, r, box=box)) == images_of(x, r, vectors, periodic)
    if all(periodic):
        answer = contactbench.contacts(x, r, box=vectors)
        assert pairs_of(answer) == images_of(x, r, vectors, periodic)
        assert answer[1].dtype == np.int32 and answer[1].shape == (len(answer[0]), len(vectors))


def test_a_sphere_meets_its_own_images():
    pairs, images = contactbench.contacts([[0.2, 0.3, 0.4]], 0.5, box=[1.0, 1.0, 1.0])
    assert pairs.tolist() == [[0, 0]] * 3
    assert sorted(images.tolist()) == [[0, 0, 1], [0, 1, 0], [1, 0, 0]]


def test_arrays_of_any_layout_are_taken():
    x = np.random.default_rng(5).random((100, 3))
    expected = brute(x, 0.1)
    for same in (np.asfortranarray(x), np.repeat(x, 2, axis=0)[::2], x.tolist(), x.copy()):
        assert pairs_of(contactbench.contacts(same, 0.1)) == expected
    single = x.astype(np.float32)
    assert pairs_of(contactbench.contacts(single, 0.1)) == brute(single.astype(float), 0.1)
    assert pairs_of(contactbench.contacts(x, np.full(100, 0.1))) == expected
    whole = np.array([[0, 0], [1, 0], [3, 0]])
    assert pairs_of(contactbench.contacts(whole, 0.5)) == {(0, 1)}
    locked = x.copy()
    locked.flags.writeable = False
    assert pairs_of(contactbench.contacts(locked, 0.1)) == expected


def test_nothing_has_no_contacts():
    for none in ([], np.empty((0, 2)), np.empty((0, 3))):
        pairs, images = contactbench.contacts(none, 1.0)
        assert pairs.shape == (0, 2) and images is None
    pairs, images = contactbench.contacts(np.empty((0, 2)), 1.0, box=[1.0, 1.0])
    assert pairs.shape == (0, 2) and images.shape == (0, 2)


BAD = [
    (([1.0, 2.0], 1.0), "x has the shape [2]"),
    ((np.zeros((3, 4)), 1.0), "x has the shape [3, 4]"),
    ((np.zeros((3, 2)), [1.0, 2.0]), "3 centres but 2 radii"),
    ((np.zeros((3, 2)), np.ones((3, 1))), "r has the shape [3, 1]"),
    (([[0.0, np.nan]], 1.0), "particle 0: y is NaN"),
    (([[0.0, 0.0], [np.inf, 0.0]], 1.0), "particle 1: x is inf"),
    (([[0.0, 0.0]], -1.0), "the radius of all particles is -1"),
    (([[0.0, 0.0]] * 2, [1.0, -1.0]), "particle 1: the radius is -1"),
    (([["a", "b"]], 1.0), "x has the type <U1"),
]


@pytest.mark.parametrize("arguments, words", BAD)
def test_what_is_no_scene_is_an_error(arguments, words):
    for ask in (
        contactbench.contacts,
        contactbench.Detector().contacts,
        contactbench.Verlet().contacts,
    ):
        with pytest.raises(ValueError) as error:
            ask(*arguments)
        assert words in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    "options, words",
    [
        ({"detector": "nsb"}, "there is no detector 'nsb' (did you mean nbs?); the detectors are: direct"),
        ({"detector": "streamed-nbs:level=sse"}, "level cannot be 'sse'"),
        ({"arithmetic": "f16"}, "f16"),
        ({"threads": 0}, "threads is 0"),
        ({"threads": 2, "detector": "nbs"}, "nbs is sequential and cannot use 2 threads"),
        ({"box": [1.0]}, "the box has the shape (1,)"),
        ({"box": [1.0, 0.0]}, "the box enclose nothing"),
        ({"box": [1.0, np.nan]}, "the box has a number NaN"),
        ({"box": contactbench.Box([1.0, 1.0], [True])}, "periodic of the box has the shape (1,)"),
    ],
)
def test_wrong_options_are_errors(options, words):
    with pytest.raises(ValueError) as error:
        contactbench.contacts([[0.0, 0.0], [1.0, 0.0]], 0.5, **options)
    assert words in str(error.value)


def test_refusals_are_exceptions():
    # A grid cannot address this many cells.
    far = [[0.0, 0.0], [1e300, 0.0]]
    with pytest.raises(ValueError, match="a grid can address"):
        contactbench.contacts(far, 1.0, detector="cell-grid")
    assert pairs_of(contactbench.contacts(far, 1.0)) == set()
    with pytest.raises(MemoryError, match="nbs needs .* the limit is 1000 bytes"):
        contactbench.Detector("nbs", memory_limit=1000).contacts(np.random.rand(1000, 2), 1e-4)
    # 20,000 particles in one point have 2e8 pairs: 1.6 GB; the limit is 312 MiB.
    with pytest.raises(MemoryError, match="each of the 20000 particles touches about 19999 others"):
        contactbench.contacts(np.zeros((20_000, 3)), 1.0)


def test_pairs_keep_to_the_limit():
    # 51 particles form 50 pairs, the others none; there is room for 4,000 pairs.
    x = np.array([[k if k <= 50 else 10.0 * k, 0.0] for k in range(1000)])
    enough = contactbench.Detector("direct", memory_limit=400)
    assert len(enough.contacts(x, 0.5)[0]) == 50
    with pytest.raises(MemoryError, match="pairs"):
        contactbench.Detector("direct", memory_limit=392).contacts(x, 0.5)


def test_detectors_keep_nothing_of_the_call_before():
    random = np.random.default_rng(6)
    detector = contactbench.Detector("streamed-nbs", threads=2)
    assert (detector.name, detector.arithmetic, detector.threads) == ("streamed-nbs", "exact", 2)
    for n, dim in [(500, 2), (40, 3), (0, 2), (800, 3), (500, 2)]:
        x, r = random.random((n, dim)), random.uniform(0.01, 0.05, n)
        assert pairs_of(detector.contacts(x, r)) == brute(x, r)
        box = pairs_of(detector.contacts(x, r, box=np.ones(dim)))
        assert len(box) >= len(brute(x, r))
    # Later calls do not change earlier answers.
    x = random.random((100, 2))
    first, _ = detector.contacts(x, 0.05)
    kept = first.copy()
    detector.contacts(random.random((100, 2)), 0.05)
    assert (first == kept).all() and first.flags.writeable


def test_threads_find_the_same_and_share_a_detector():
    x = np.random.default_rng(7).random((40_000, 3)) * 25.0
    expected = pairs_of(contactbench.contacts(x, 0.5))
    assert pairs_of(contactbench.contacts(x, 0.5, threads=2)) == expected
    detector, answers = contactbench.Detector(), []
    ask = lambda: answers.append(pairs_of(detector.contacts(x, 0.5)))
    threads = [threading.Thread(target=ask) for _ in range(3)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert answers == [expected] * 3


def test_the_lock_is_released():
    """Another thread runs during a detection."""
    x = np.random.default_rng(8).random((10_000, 3))
    done, times, ask = threading.Event(), [], contactbench.Detector("direct")

    def count():
        while not done.is_set():
            times.append(time.perf_counter())
            time.sleep(0.0)

    thread = threading.Thread(target=count)
    thread.start()
    begun = time.perf_counter()
    ask.contacts(x, 0.001)
    took = time.perf_counter() - begun
    done.set()
    thread.join()
    assert any(begun + 0.25 * took < at < begun + 0.75 * took for at in times)


def test_operations_are_counted():
    x = np.random.default_rng(9).random((100, 2))
    counts = contactbench.Detector("direct").count(x, 0.01)
    assert counts == {"contact_test": 4950}
    boxed = contactbench.Detector("nbs").count(x, 0.01, box=[1.0, 1.0])
    assert boxed["ghost_made"] > 0


@pytest.mark.parametrize("rule", ["top-two", "half-skin", "summed"])
@pytest.mark.parametrize("boxed", [False, True])
def test_kept_lists_miss_nothing(rule, boxed):
    random = np.random.default_rng(10)
    x, r = random.random((200, 3)), random.uniform(0.02, 0.08, 200)
    way = random.normal(0.0, 0.002, x.shape)
    box = np.ones(3) if boxed else None
    verlet = contactbench.Verlet("nbs", skin=0.2, rule=rule)
    for frame in range(12):
        found = verlet.contacts(x, r, box=box)
        assert pairs_of(found) == pairs_of(contactbench.contacts(x, r, box=box)), frame
        x = x + way
    assert verlet.steps == 12 and 1 < verlet.builds < 12
    assert verlet.listed > len(found[0])
    verlet.forget()
    verlet.contacts(x, r, box=box)
    assert verlet.built
    assert verlet.name == f"verlet(nbs,rule={rule},skin=0.2)" and "13 frames" in repr(verlet)


@pytest.mark.parametrize(
    "options, words",
    [
        ({"skin": -1.0}, "skin cannot be '-1.0'"),
        ({"skin": "thick"}, "skin cannot be 'thick'"),
        ({"rule": "sometimes"}, "rule cannot be 'sometimes'"),
        ({"detector": "nsb"}, "there is no detector 'nsb'"),
        ({"threads": 3, "detector": "nbs"}, "nbs is sequential"),
    ],
)
def test_wrong_lists_are_errors(options, words):
    with pytest.raises(ValueError) as error:
        contactbench.Verlet(**options)
    assert words in str(error.value)


def test_a_list_in_a_box_does_not_round():
    with pytest.raises(ValueError, match="exact arithmetic, not in f64"):
        contactbench.Verlet(arithmetic="f64").contacts([[0.0, 0.0]], 0.1, box=[1.0, 1.0])


def flags_at(address):
    """Return the flags of the mapping that holds an address (Linux), or none."""
    here = False
    for line in Path("/proc/self/smaps").read_text().splitlines():
        name, _, rest = line.partition(" ")
        if name.endswith(":"):
            if here and name == "VmFlags:":
                return rest.split()
        else:
            begin, end = (int(bound, 16) for bound in name.split("-"))
            here = begin <= address < end
    return []


@pytest.mark.skipif(
    not Path("/sys/kernel/mm/transparent_hugepage").is_dir(), reason="no large pages to ask for"
)
@pytest.mark.parametrize("kept", [False, True])
def test_for_a_large_answer_large_pages_are_asked_for(kept):
    x = np.random.default_rng(3).random((200_000, 2))
    ask = contactbench.Detector().contacts if kept else contactbench.contacts
    pairs, _ = ask(x, 0.002)
    assert pairs.nbytes > 1 << 22
    assert "hg" in flags_at(pairs.ctypes.data + pairs.nbytes // 2)
