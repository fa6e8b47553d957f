# pyright: strict
"""A program that mypy and pyright check; it does not run."""

import numpy as np
import numpy.typing as npt

import contactbench


def of_atoms(cell: npt.NDArray[np.float64], pbc: npt.NDArray[np.bool_]) -> contactbench.Box:
    return contactbench.Box(cell, periodic=pbc)


def boxed(x: npt.NDArray[np.float64], box: contactbench.Box) -> npt.NDArray[np.int32]:
    pairs, images = contactbench.contacts(x, 0.5, box=box)
    more = contactbench.Detector().contacts(x, 0.5, box)[1]
    kept = contactbench.Verlet(skin=0.3).contacts(x, 0.5, box=[1.0, 1.0, 1.0])[1]
    return images[pairs[:, 0] < 3] + more[:1] + kept[:1]


def in_the_open(x: npt.NDArray[np.float64]) -> None:
    pairs, images = contactbench.contacts(x, 0.5)
    nothing: None = images
    print(pairs.shape, nothing)


def judged(x: npt.NDArray[np.float64], box: contactbench.Box | None) -> bool:
    pairs, images = contactbench.contacts(x, 0.5, box)
    found = contactbench.verify(x, 0.5, pairs, images, box=box, arithmetic="f64")
    try:
        print(contactbench.recommend(x, 0.5, seconds=1.0).use)
    except contactbench.Refused as refused:
        print(refused)
    return bool(found) and bool(contactbench.check(lambda x, r: [], seconds=0.1))


def listed(x: npt.NDArray[np.float64]) -> bool:
    convention = contactbench.Convention(pairs="half", rule="<=")
    found = contactbench.check_neighbours(lambda *given: ([], [], []), convention=convention)
    return bool(found) and not [failure.system.positions for failure in found.failures]


words = [contactbench.Box([1.0, 1.0], "xy"), contactbench.Box([1, 1], [True, False])]
