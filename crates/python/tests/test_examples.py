"""The notebooks and examples run, and their assertions hold."""

import pathlib
import runpy

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


def test_other_libraries_read_other_files(tmp_path):
    meshio = pytest.importorskip("meshio")
    io = pytest.importorskip("ase.io")
    ase = pytest.importorskip("ase")
    x = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [9.5, 0.0, 0.0]]
    examples = runpy.run_path(str(EXAMPLES.parents[2] / "examples" / "any_file.py"))
    mesh = meshio.Mesh(x, [("vertex", [[0], [1], [2]])], point_data={"radius": [0.5, 0.5, 0.5]})
    mesh.write(tmp_path / "x.vtu")
    assert examples["with_meshio"](tmp_path / "x.vtu")[0].tolist() == [[0, 1]]
    io.write(tmp_path / "x.cif", ase.Atoms("C3", x, cell=[10, 10, 10], pbc=True))
    assert examples["with_ase"](tmp_path / "x.cif", 0.5)[0].tolist() == [[0, 1], [0, 2]]
