"""The functions `verify`, `check` and `recommend`."""

import signal

import numpy as np
import pytest

import contactbench


def row(n=4):
    """Discs of radius 1 whose neighbours touch in one point."""
    return np.column_stack([2.0 * np.arange(n), np.zeros(n)])


def test_the_right_list_is_the_same():
    for pairs in (
        [[0, 1], [1, 2], [3, 2]],
        {(1, 0), (2, 1), (2, 3)},
        np.array([[0, 1], [1, 2], [2, 3]]),
    ):
        found = contactbench.verify(row(), 1.0, pairs)
        assert found and found.same and (found.contacts, found.listed) == (3, 3)
        assert found.hint is None and found.causes is None and "the same" in str(found)
    empty = contactbench.verify(row(), 0.5, [])
    assert empty.same and empty.contacts == 0


def test_every_kind_of_error_is_told():
    listed = [[0, 1], [1, 0], [0, 3], [2, 2], [7, 1]]
    found = contactbench.verify(row(), 1.0, listed)
    assert not found
    errors = {"missed": 2, "spurious": 1, "duplicate": 1, "self_pairs": 1}
    assert {kind: found.errors[kind] for kind in errors} == errors
    assert found.errors["widest_false"] == 4.0
    assert found.missed.pairs.tolist() == [[1, 2], [2, 3]] and found.missed.depth.tolist() == [0, 0]
    assert found.spurious.pairs.tolist() == [[0, 3]] and found.spurious.depth.tolist() == [-4.0]
    assert found.unknown.tolist() == [[7, 1]] and len(found.missed) == 2
    assert "2 missed, 1 spurious, 1 duplicate, 1 self_pairs, 1 unknown" in str(found)
    assert len(contactbench.verify(row(), 1.0, listed, most=1).missed) == 1


def test_a_list_that_is_meant_otherwise_has_a_hint():
    x = np.random.default_rng(1).random((200, 3))
    pairs, _ = contactbench.contacts(x, 0.05)
    assert "numbers from 1" in contactbench.verify(x, 0.05, pairs + 1).hint
    assert contactbench.verify(x, 0.05, pairs + 1, base=1)
    both = np.vstack([pairs, pairs[:, ::-1]])
    assert "each pair taken once" in contactbench.verify(x, 0.05, both).hint
    assert contactbench.verify(x, 0.05, both, both_sides=True)
    half = contactbench.verify(x, 0.05, both[1:], both_sides=True)
    assert len(half.one_sided) == 1 and not half
    wide, _ = contactbench.contacts(x, 0.1)
    assert "(diameters taken for radii?)" in contactbench.verify(x, 0.05, wide).hint
    skin, _ = contactbench.contacts(x, 0.052)
    near = contactbench.verify(x, 0.05, skin, skin=0.004 + 1e-9)
    assert near and near.within_skin == len(skin) - len(pairs)


def test_boxes_are_compared_with_their_images():
    x, box = np.random.default_rng(2).random((100, 2)), [1.0, 1.0]
    pairs, images = contactbench.contacts(x, 0.05, box=box)
    assert images.any()
    assert contactbench.verify(x, 0.05, pairs, images, box=box)
    assert contactbench.verify(x, 0.05, pairs, box=box)
    turned = contactbench.verify(x, 0.05, pairs[:, ::-1], -images, box=box)
    assert turned
    through = images.any(axis=1)
    lost = contactbench.verify(x, 0.05, pairs[~through], images[~through], box=box)
    assert lost.errors["missed"] == through.sum() and lost.missed.images.any(axis=1).all()
    elsewhere = images.copy()
    elsewhere[0] += 1
    wrong = contactbench.verify(x, 0.05, pairs, elsewhere, box=box)
    assert (wrong.errors["missed"], wrong.errors["spurious"]) == (1, 1)
    with pytest.raises(ValueError, match="images are given without a box"):
        contactbench.verify(x, 0.05, pairs, images)
    with pytest.raises(ValueError, match="pairs but"):
        contactbench.verify(x, 0.05, pairs, images[1:], box=box)


def test_errors_are_told_apart_by_cause():
    # Touching discs, so far from the origin that f32 cannot represent their places.
    x = row(40) + [1e8, 0.0]
    pairs, _ = contactbench.contacts(x, 1.0, arithmetic="f32")
    found = contactbench.verify(x, 1.0, pairs, arithmetic="f32")
    assert found.same
    causes = {
        cause: errors["missed"] + errors["spurious"] for cause, errors in found.causes.items()
    }
    assert causes["representation"] > 0 and causes["predicate"] == causes["search"] == 0
    lacking = contactbench.verify(x, 1.0, pairs[1:], arithmetic="f32")
    assert lacking.causes["search"]["missed"] == 1 == lacking.errors["missed"]


@pytest.mark.parametrize(
    "pairs, options, words",
    [
        ([[0, 1, 2]], {}, "pairs has the shape (1, 3)"),
        ([[0.0, 1.0]], {}, "type float64"),
        ([[0, 1]], {"skin": -1.0}, "skin is -1"),
        ([[0, 1]], {"threads": 0}, "threads is 0"),
        ([[0, 1]], {"arithmetic": "f16"}, "f16"),
        (np.array([[0, 2**63]], dtype=np.uint64), {}, "beyond int64"),
    ],
)
def test_what_is_no_list_is_an_error(pairs, options, words):
    with pytest.raises(ValueError) as error:
        contactbench.verify(row(), 1.0, pairs, **options)
    assert words in str(error.value)


def brute(x, r, touch=np.less_equal):
    i, j = np.triu_indices(len(x), 1)
    near = touch(((x[i] - x[j]) ** 2).sum(axis=1), (r[i] + r[j]) ** 2)
    return np.column_stack([i[near], j[near]])


def test_a_detector_that_is_right_passes():
    def exact(x, r):
        return contactbench.contacts(x, r, detector="kd-tree")[0]

    found = contactbench.check(exact, seconds=1.0)
    assert found and found.cases > 20 and not found.failures, str(found)
    assert any("open scenes" in why for why in found.refused)


def test_a_detector_that_is_wrong_is_shown_a_small_scene():
    found = contactbench.check(lambda x, r: brute(x, r, np.less), name="strict")
    (failure,) = found.failures
    assert not found and failure.x.shape[0] == 2 and failure.r.shape == (2,)
    assert "1 missed" in failure.wrong and len(failure.given[0]) >= 2
    assert len(contactbench.contacts(failure.x, failure.r)[0]) == 1
    assert len(brute(failure.x, failure.r, np.less)) == 0
    # Hard cases or random bytes reveal the rounding.
    rounded = contactbench.check(brute)
    assert not rounded and len(rounded.failures[0].x) == 2, str(rounded)


def test_detectors_that_break_are_findings():
    def raises(x, r):
        1 // (len(x) - 17)
        return brute(x, r)

    (failure,) = contactbench.check(raises).failures
    assert "it raises ZeroDivisionError" in failure.wrong and len(failure.x) == 17

    def beyond(x, r):
        return [[0, len(x)]]

    (failure,) = contactbench.check(beyond).failures
    assert "it reports the pair 0,0 in a scene of 0 particles" in failure.found

    def refuses(x, r):
        raise NotImplementedError("no scenes today")

    found = contactbench.check(refuses, seconds=0.0)
    assert not found and found.cases == 0 and any("no scenes today" in why for why in found.refused)


def test_a_check_can_be_interrupted():
    def interrupted(x, r):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        contactbench.check(interrupted)
    # The call ends at once, whatever process sent the signal.
    calls = []

    def signalled(x, r):
        calls.append(len(x))
        if len(calls) == 3:
            signal.raise_signal(signal.SIGINT)
        return contactbench.contacts(x, r, detector="kd-tree")[0]

    with pytest.raises(KeyboardInterrupt):
        contactbench.check(signalled)
    assert len(calls) == 3
    # Ctrl-C also works while a scene is reduced: here in the second last call.
    calls = []

    def counted(x, r):
        calls.append(len(x))
        return brute(x, r, np.less)

    assert not contactbench.check(counted)
    last = len(calls) - 1
    calls.clear()

    def later(x, r):
        if len(calls) == last - 1:
            raise KeyboardInterrupt
        return counted(x, r)

    with pytest.raises(KeyboardInterrupt):
        contactbench.check(later)


def test_a_detector_is_recommended():
    x = np.random.default_rng(3).random((2000, 3)) * 10.0
    said = contactbench.recommend(x, 0.5, seconds=1.0)
    assert said.use in contactbench.DETECTORS and said.because.startswith(said.use)
    by_name = {each["detector"]: each for each in said.detectors}
    assert set(contactbench.DETECTORS) <= set(by_name)
    assert by_name[said.use]["outcome"] == "ok"
    assert by_name[said.use]["ns_per_particle"]["median"] > 0
    assert by_name[said.use]["peak_bytes"] > 0
    assert str(said).startswith("use ")
    with pytest.raises(ValueError, match="there is nothing to recommend"):
        contactbench.recommend(np.empty((0, 2)), 1.0)
    with pytest.raises(ValueError, match="seconds is 0"):
        contactbench.recommend(x, 0.5, seconds=0.0)
