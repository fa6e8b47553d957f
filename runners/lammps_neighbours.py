"""The neighbour lists of LAMMPS and LIGGGHTS, in their process and timed by their own clock.

Arguments: `lammps` or `liggghts`; the style of `neighbor`, `bin` or `multi` (LAMMPS: one type for
each octave of radii); the skin in diameters of the largest particle; `newton` on or off.

The program gets the scene as a data file, and builds lists in every step while nothing moves. The
time is Neigh of its timing table, divided by the builds: binning, and a half list of the pairs
within the sum of the radii and the skin. It excludes the contact test of each step and the spatial
sort at the start. The pairs are the listed ones that pass its own test. That test uses < instead of
<=, so answers are wrong on lattices whose neighbours touch exactly.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from runner import Refusal, np, serve, unavailable

PROGRAMS = {"lammps": ["lmp", "lmp_mpi", "lmp_serial"], "liggghts": ["liggghts"]}
code, style, skin, newton = [*sys.argv[1:], *["lammps", "bin", "0.1", "on"][len(sys.argv) - 1 :]]
program = next(filter(None, map(shutil.which, PROGRAMS[code])), None)
if program is None:
    unavailable(code, f"apt-get install {code}", "it is not on the path")

# Commands that only one of the two has.
OWN = {
    "lammps": """
comm_modify vel yes
pair_style gran/hooke 1.0 NULL 0.0 NULL 0.0 1
""",
    "liggghts": """
communicate single vel yes
fix k1 all property/global kn peratomtypepair {types} {ones}
fix k2 all property/global kt peratomtypepair {types} {ones}
fix k3 all property/global gamman peratomtypepair {types} {ones}
fix k4 all property/global gammat peratomtypepair {types} {ones}
fix k5 all property/global coefficientFriction peratomtypepair {types} {ones}
pair_style gran model hooke/stiffness tangential no_history
""",
}
LIST = {
    "lammps": ("property/local patom1 patom2 cutoff radius", "c_list[1] c_list[2]"),
    "liggghts": ("pair/gran/local id", "c_list[1] c_list[2]"),
}
INPUT = """
units {units}
atom_style sphere
atom_modify map array
dimension {dim}
boundary f f {last}
newton {newton}
read_data scene.data
{own}
pair_coeff * *
neighbor {skin!r} {style}
{multi}
neigh_modify every 1 delay 0 check no
compute list all {compute}
run 1
run {builds}
print "timed above"
dump pairs all local 1 pairs.dump {columns}
run 0
"""


def write(scene, path):
    """Write the scene as a data file; return the number of types, one per octave of radii."""
    radii = np.full(scene.n, scene.radius) if scene.radii is None else scene.radii
    if not np.all(radii > 0.0):
        raise Refusal(f"{code} needs radii above 0")
    octaves = np.floor(np.log2(radii.max() / radii)).astype(int)
    _, types = np.unique(octaves if style == "multi" else 0 * octaves, return_inverse=True)
    points = scene.in_space()
    low, high = points.min(axis=0) - scene.reach, points.max(axis=0) + scene.reach
    with open(path, "w") as file:
        file.write(f"scene\n\n{scene.n} atoms\n{types.max() + 1} atom types\n\n")
        for axis, bounds in zip("xyz", zip(low.tolist(), high.tolist())):
            file.write("{!r} {!r} {axis}lo {axis}hi\n".format(*bounds, axis=axis))
        file.write("\nAtoms\n\n")
        rows = zip((types + 1).tolist(), (2.0 * radii).tolist(), points.tolist())
        for place, (kind, diameter, (x, y, z)) in enumerate(rows, 1):
            file.write(f"{place} {kind} {diameter!r} 1.0 {x!r} {y!r} {z!r}\n")
    return int(types.max()) + 1


def prepare(scene):
    if scene.n == 0:
        raise Refusal(f"{code} needs particles")
    folder = tempfile.TemporaryDirectory()
    place = pathlib.Path(folder.name)
    types = write(scene, place / "scene.data")
    compute, columns = LIST[code]
    ones = " ".join(["1.0"] * types * types)

    def run(builds):
        """Return the builds, their nanoseconds, 0 for the unknown first one, and the pairs."""
        text = INPUT.format(
            units={"lammps": "lj", "liggghts": "si"}[code], dim=scene.dim, last="fp"[scene.dim == 2],
            newton=newton, own=OWN[code].format(types=types, ones=ones), skin=float(skin) * scene.reach,
            style=style, multi="comm_modify mode multi vel yes" if style == "multi" else "",
            compute=compute, columns=columns, builds=builds,
        )
        (place / "in").write_text(text)
        ended = subprocess.run(
            [program, "-in", "in", "-log", "log"], cwd=place, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
        )
        log = (place / "log").read_text() if (place / "log").exists() else ""
        if ended.returncode:
            errors = re.findall(r"ERROR[^\n]*", log + ended.stdout)
            raise Refusal(f"{code} ended with {ended.returncode}: {(errors or ['no reason given'])[0]}")
        # The second of three runs. Some versions print the table instead of logging it.
        said = log if "Neigh" in log else ended.stdout
        times = re.findall(r"^Neigh +(?:\| \S+ +\| (\S+)|time \(%\) = (\S+))", said, re.MULTILINE)
        built = re.findall(r"Neighbor list builds = (\d+)", said)
        if len(times) < 2 or int(built[1]) != builds:
            raise RuntimeError(f"{code} did not report the time of {builds} builds")
        found = (place / "pairs.dump").read_text().rpartition("ITEM: ENTRIES")[2].partition("\n")[2]
        pairs = np.array(found.split(), "f8").astype(np.int64).reshape(-1, 2) - 1
        return builds, round(1e9 * float("".join(times[1]))), 0, pairs

    detect = lambda: run(1)[-1]
    # A build takes at least 50 ns per particle; this makes the sample long enough.
    detect.report = lambda least: run(max(5, 2 * least // (50 * scene.n)))
    detect.folder = folder
    return detect


def version():
    said = subprocess.run([program, "-h"], cwd=tempfile.gettempdir(), capture_output=True, text=True)
    return re.search(r"(?:Simulator - |\(Version )([^\n,]+)", said.stdout).group(1)


CLOCK = "its own timing table, Neigh over builds: bins and half list within reach and skin"
serve(f"{code}-{style}", version(), prepare, arithmetic="f64",
      build={"clock": CLOCK, "newton": newton, "skin": skin, "style": style})
