"""Records of experiments as frames; scenes of generators."""

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
    """The record of a result folder, one row for each measurement.

    Columns are those of docs/RECORD.md: what was measured, on what, with what (parameters of scenes
    and detectors have columns of their own, ``-`` written ``_``), and the numbers under the names
    that expressions and `summary.csv` have for them. Absent values are missing values. The record is
    held to what docs/RECORD.md promises before it is read.

    Parameters
    ----------
    folder : path
        A result folder, or the `samples.jsonl` (or `samples.jsonl.gz`) in one.
    library : {"pandas", "polars"}, optional
        By default pandas if it is installed, else polars.

    Returns
    -------
    pandas.DataFrame or polars.DataFrame
        With nullable types. A frame of pandas has the provenance in ``attrs["provenance"]``; of
        polars, whose frames have no such place, `provenance` gives it.

    Raises
    ------
    ValueError
        A folder without a record, or whose record is damaged, with every fault by its line.
    ImportError
        Neither pandas nor polars is installed.

    Warns
    -----
    UserWarning
        A last line that a killed run left half written is left out.
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
    """Where the record of a result folder is from: command, revision, compiler, machine, load.

    Parameters
    ----------
    folder : path
        A result folder, or the `samples.jsonl` (or `samples.jsonl.gz`) in one.

    Returns
    -------
    list of dict
        What provenance.json says, and those of resumed runs and of merged parts.
    """
    return [json.loads(text) for text in native.load(os.fspath(folder))[2]]


def scene(
    text: str,
) -> tuple[npt.NDArray[np.float64], float | npt.NDArray[np.float64], Box | None]:
    """A scene of one of the generators, as ``contactbench list scenes`` names them.

    Parameters
    ----------
    text : str
        A generator with parameters, as in ``"packed:dim=3,n=1000,seed=1"``; or a hard case, as in
        ``"hard:case=..."``.

    Returns
    -------
    x : ndarray of float64, shape (N, D)
    r : float or ndarray of float64, shape (N,)
    box : Box or None
        The same for the same text on every machine.

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
