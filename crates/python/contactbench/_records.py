"""Records as data frames, and generated scenes."""

from __future__ import annotations

import importlib.util
import json
import os
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _contactbench as native
from ._boxes import Box

if TYPE_CHECKING:
    import pandas
    import polars

_PANDAS = {"text": "string", "whole": "Int64", "number": "Float64", "flag": "boolean"}


def load(
    folder: str | os.PathLike[str], library: str | None = None
) -> pandas.DataFrame | polars.DataFrame:
    """Load the record of a result folder, one row per measurement.

    docs/RECORD.md describes the columns: subject, scene, their parameters (one column each, ``-``
    written ``_``), and the numbers, which have the names of expressions and `summary.csv`. Absent
    values are missing values. A record that violates docs/RECORD.md is refused.

    Parameters
    ----------
    folder : path
        A result folder, or the `samples.jsonl` (or `samples.jsonl.gz`) in one.
    library : {"pandas", "polars"}, optional
        The default is pandas if it is installed, else polars.

    Returns
    -------
    pandas.DataFrame or polars.DataFrame
        Columns have nullable types. A pandas frame has the provenance in ``attrs["provenance"]``;
        for polars use `provenance`.

    Raises
    ------
    ValueError
        The folder has no record, or a damaged one; every fault is listed with its line.
    ImportError
        Neither pandas nor polars is installed.

    Warns
    -----
    UserWarning
        A killed run left an incomplete last line, which is skipped.
    """
    names = [library] if library else ["pandas", "polars"]
    unknown = set(names) - {"pandas", "polars"}
    if unknown:
        raise ValueError(f"library is {library!r}; it must be 'pandas' or 'polars'")
    there = [name for name in names if importlib.util.find_spec(name)]
    if not there:
        raise ImportError(f"{' or '.join(names)} is needed: pip install {names[0]}")
    columns, said, sources = native.load(os.fspath(folder))
    for sentence in said:
        warnings.warn(sentence, stacklevel=2)
    if there[0] == "pandas":
        import pandas as pd

        frame = pd.DataFrame(
            {name: pd.array(values, dtype=_PANDAS[kind]) for name, kind, values in columns}
        )
        frame.attrs["provenance"] = [json.loads(text) for text in sources]
        return frame
    import polars as pl

    kinds = {"text": pl.String, "whole": pl.Int64, "number": pl.Float64, "flag": pl.Boolean}
    return pl.DataFrame(
        [pl.Series(name, values, dtype=kinds[kind]) for name, kind, values in columns]
    )


def provenance(folder: str | os.PathLike[str]) -> list[dict[str, Any]]:
    """Return the provenance of a result folder: command, revision, compiler, machine, load.

    Parameters
    ----------
    folder : path
        A result folder, or the `samples.jsonl` (or `samples.jsonl.gz`) in one.

    Returns
    -------
    list of dict
        The contents of provenance.json, and those of resumed runs and of merged parts.
    """
    return [json.loads(text) for text in native.load(os.fspath(folder))[2]]


def scene(
    text: str,
) -> tuple[npt.NDArray[np.float64], float | npt.NDArray[np.float64], Box | None]:
    """Make a scene with one of the generators of ``contactbench list scenes``.

    Parameters
    ----------
    text : str
        A generator with parameters, as in ``"packed:dim=3,n=1000,seed=1"``, or a hard case, as in
        ``"hard:case=..."``.

    Returns
    -------
    x : ndarray of float64, shape (N, D)
    r : float or ndarray of float64, shape (N,)
    box : Box or None
        The box, if the scene is periodic. Equal texts make equal scenes on every machine.

    Examples
    --------
    >>> import contactbench
    >>> x, r, box = contactbench.scene("pack-a:n=100")
    >>> len(x), r, box
    (100, 0.5, None)
    """
    (x, r, uniform), edges = native.scene(text)
    box = None
    if edges is not None:
        dim = x.shape[1]
        vectors, flags, origin = edges
        box = Box(np.array(vectors)[:dim, :dim], flags[:dim], origin[:dim])
    return x, r if uniform is None else uniform, box
