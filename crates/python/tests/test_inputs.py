"""Boxes and numbers as arguments."""

import numpy as np
import pytest

import contactbench

CORNER = [[0.0, 0.0], [0.9, 0.0], [0.0, 0.9]]


@pytest.mark.parametrize(
    "periodic, count",
    [
        (True, 3),
        ("true", 3),
        ("xy", 3),
        ([1, 1], 3),
        (np.array([True, True]), 3),
        ("x", 1),
        ("y", 1),
        ([True, False], 1),
        ((0, 1), 1),
        ("none", 0),
        ("false", 0),
        (False, 0),
        (0, 0),
        ([False, False], 0),
    ],
)
def test_a_box_is_periodic_as_it_says(periodic, count):
    box = contactbench.Box([1, 1], periodic)
    assert len(contactbench.contacts(CORNER, 0.1, box=box)[0]) == count


@pytest.mark.parametrize(
    "periodic",
    [None, "", "z", "xx", "yes", "TT", ["F", "F"], ["false", "true"], [2, 0], [True, None], 0.5],
)
def test_other_words_for_periodic_are_errors(periodic):
    with pytest.raises(ValueError, match="periodic of the box is"):
        contactbench.contacts(CORNER, 0.1, box=contactbench.Box([1, 1], periodic))


def test_discs_may_have_a_third_vector_of_zeros():
    expected = contactbench.contacts(CORNER, 0.1, box=[1, 1])[1].tolist()
    for edges, periodic in [([1, 1, 0], True), (np.diag([1, 1, 0]), [True, True, True])]:
        box = contactbench.Box(edges, periodic)
        assert contactbench.contacts(CORNER, 0.1, box=box)[1].tolist() == expected
    with pytest.raises(ValueError, match="along vector 3 is 0"):
        contactbench.contacts(np.zeros((2, 3)), 0.1, box=[1, 1, 0])


def test_boxes_are_values():
    one = contactbench.Box(np.ones(2))
    assert one == contactbench.Box([1, 1], "xy", [0, -0.0])
    assert one != contactbench.Box([1, 1], "x") and one != contactbench.Box([1, 1, 1])
    assert one != contactbench.Box([1, 2]) and one != 1
    assert len({one, contactbench.Box(np.eye(2)), contactbench.Box([2, 1])}) == 2


@pytest.mark.parametrize(
    "x, r, words",
    [
        (np.array([[2**53 + 1, 0], [2**53, 0]]), 0.0, "x has an integer beyond 2^53"),
        ([[0, 0]], 2**60, "r has an integer beyond 2^53"),
        (np.array([[0.1, 0]], dtype=np.longdouble) / 3, 1.0, "x has the type"),
        (np.array([[0j, 0]]), 1.0, "x has the type complex128"),
        ([["1", "2"]], 1.0, "x has the type <U1"),
        ([[0.0, 0.0]], "1", "r has the type <U1"),
        ([[0.0, 0.0]], None, "r is None"),
        (np.zeros((3, 50)), 1.0, "give x.T"),
        (None, 1.0, "x is None"),
        ([[0.0, None]], 1.0, "x has the type object"),
        (np.ma.array([[0.0, 0.0], [1.0, 0.0]], mask=[[0, 0], [1, 1]]), 1.0, "x has masked"),
        ([[0.0, 0.0]], np.ma.array([1.0], mask=[True]), "r has masked"),
    ],
)
def test_numbers_that_would_change_are_errors(x, r, words):
    if "has the type" in words and np.asarray(x).dtype == np.longdouble == np.float64:
        pytest.skip("a long double is a double here")
    with pytest.raises(ValueError) as error:
        contactbench.contacts(x, r)
    assert words in str(error.value)


def test_numbers_that_do_not_change_are_taken():
    whole = [[0, 0], [2**53, 0]]
    assert len(contactbench.contacts(whole, 2**52)[0]) == 1
    assert len(contactbench.contacts(np.array(whole, dtype=np.longdouble), 2**52)[0]) == 1
    assert len(contactbench.contacts(np.ma.array([[0.0, 0], [1, 0]]), 0.5)[0]) == 1
    assert len(contactbench.contacts([[0.0, 0], [1, 0]], np.array([0.5]))[0]) == 1
    pairs, images = contactbench.contacts([], 1, box=[1, 1])
    assert pairs.shape == (0, 2) and images.shape == (0, 2)


def test_the_result_of_contacts_is_no_list_of_pairs():
    with pytest.raises(ValueError, match="as contacts.. returns pairs and images"):
        contactbench.verify(CORNER, 0.5, contactbench.contacts(CORNER, 0.5))
