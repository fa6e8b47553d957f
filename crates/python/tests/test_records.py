"""Records as data frames, and generated scenes."""

import gzip
import pathlib
import shutil

import numpy as np
import pytest

import contactbench

RESULTS = pathlib.Path(__file__).parents[3] / "results" / "reference-motion" / "motion"


@pytest.mark.parametrize("library", ["pandas", "polars"])
def test_a_record_is_a_frame_with_types(library):
    pytest.importorskip(library)
    frame = contactbench.load(RESULTS, library)
    lines = gzip.open(RESULTS / "samples.jsonl.gz", "rt").read().splitlines()
    assert len(frame) == len(lines)
    kinds = {name: str(kind).lower() for name, kind in zip(frame.columns, frame.dtypes)}
    assert kinds["n"] == kinds["time_ns"] == kinds["contact_test"] == "int64"
    assert kinds["coordination"] == kinds["deepest_miss"] == "float64"
    assert kinds["detector"] == kinds["outcome"] == "string"
    assert "search_missed" in frame.columns and "skin" in frame.columns
    timed = [line for line in lines if '"pass":"time"' in line]
    assert frame["time_ns"].count() == sum('"time_ns":null' not in line for line in timed)
    assert len(set(frame["contender"])) > 5


def test_the_provenance_goes_with_it():
    runs = contactbench.provenance(RESULTS)
    assert len(runs) == len(list(RESULTS.glob("provenance*.json"))) > 1
    assert all(run["revision"] and run["machine"] for run in runs)
    pytest.importorskip("pandas")
    frame = contactbench.load(RESULTS / "samples.jsonl.gz", "pandas")
    assert frame.attrs["provenance"] == runs


def test_what_is_no_record_is_an_error(tmp_path):
    with pytest.raises(ValueError, match="cannot read the record"):
        contactbench.load(tmp_path)
    with pytest.raises(ValueError, match="library is 'numpy'"):
        contactbench.load(RESULTS, "numpy")
    copy = tmp_path / "samples.jsonl"
    shutil.copytree(RESULTS, tmp_path, dirs_exist_ok=True)
    packed = tmp_path / "samples.jsonl.gz"
    text = gzip.open(packed, "rt").read()
    packed.unlink()
    copy.write_text(text.replace('"n":', '"n":1', 1))
    with pytest.raises(ValueError, match="samples.jsonl:1"):
        contactbench.load(tmp_path)
    copy.write_text(text[:-10])
    with pytest.warns(UserWarning, match="is torn"):
        whole = contactbench.load(tmp_path)
    assert len(whole) == text.count("\n") - 1


def test_generators_give_arrays():
    x, r, box = contactbench.scene("packed:dim=3,n=200,seed=1")
    assert x.shape == (200, 3) and r == 0.5 and box is None
    x, r, box = contactbench.scene("loose:dim=2,n=50,seed=2,size-ratio=3,periodic=true")
    assert x.shape == (50, 2) and r.shape == (50,) and isinstance(box, contactbench.Box)
    pairs, images = contactbench.contacts(x, r, box=box)
    assert images.shape == (len(pairs), 2)
    assert np.shape(contactbench.scene("packed:n=0")[0]) == (0, 2)
    with pytest.raises(ValueError, match="pakced"):
        contactbench.scene("pakced:n=10")
