"""The C interface of vesin, called from C++ (list.cpp): needs a C++ compiler and the package vesin,
which has the header and the library."""

from importlib.util import find_spec
from pathlib import Path

from .external import FOLDER, compiled, program


def prepare(positions, cell, pbc, cutoff):
    vesin = Path(find_spec("vesin").origin).parent
    source, library = FOLDER / "list.cpp", str(vesin / "lib")
    flags = ["-O2", f"-I{vesin / 'include'}", f"-L{library}", f"-Wl,-rpath,{library}"]
    path = compiled(source, ["c++", *flags, str(source), "-lvesin"])
    return lambda: program([str(path)])(positions, cell, pbc, cutoff)
