"""The notebooks run, and their assertions hold."""

import pathlib

import pytest

EXAMPLES = pathlib.Path(__file__).parents[1] / "examples"


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.ipynb")), ids=lambda path: path.name)
def test_a_notebook_runs(path):
    nbformat = pytest.importorskip("nbformat", reason="notebooks are not run without nbclient")
    nbclient = pytest.importorskip("nbclient", reason="notebooks are not run without nbclient")
    pytest.importorskip("ipykernel", reason="notebooks are not run without ipykernel")
    pytest.importorskip("matplotlib", reason="notebooks are not run without matplotlib")
    notebook = nbformat.read(path, as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), (
        "it is committed without outputs"
    )
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
