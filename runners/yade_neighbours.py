"""The sweep and prune of YADE (InsertionSortCollider), in its process and timed by its own clock.

Nothing moves, and `verletDist` is 0, so the collider runs in every step. It makes a box for each
particle, sorts the box ends along three axes by insertion (they are already sorted), and keeps the
pairs whose boxes overlap. The time is that of `O.timingEnabled` for the collider, divided by its
steps. `first_ns` is its first step, which sorts unsorted ends. The contact test of InteractionLoop
is not included. The pairs are the real interactions.
"""

import json
import pathlib
import sys

if "O" in globals():
    # YADE also runs this file.
    place, builds = pathlib.Path(sys.argv[1]), int(sys.argv[2])
    for line in (place / "scene.txt").read_text().splitlines():
        x, y, z, radius = map(float, line.split())
        O.bodies.append(sphere((x, y, z), radius))
    collider = InsertionSortCollider([Bo1_Sphere_Aabb()], verletDist=0)
    contacts = InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom()],
        [Ip2_FrictMat_FrictMat_FrictPhys()],
        [Law2_ScGeom_FrictPhys_CundallStrack()],
    )
    O.engines = [ForceResetter(), collider, contacts]
    O.dt = 1e-9
    O.timingEnabled = True
    O.run(1, wait=True)
    first = collider.execTime
    collider.execTime, collider.execCount = 0, 0
    O.run(builds, wait=True)
    pairs = [(it.id1, it.id2) for it in O.interactions if it.isReal]
    said = {"first": first, "elapsed": collider.execTime, "builds": collider.execCount, "pairs": pairs}
    (place / "report.json").write_text(json.dumps(said))
    sys.exit()

import re
import shutil
import subprocess
import tempfile

from runner import Refusal, np, serve, unavailable

program = shutil.which("yade")
if program is None:
    unavailable("yade", "apt-get install yade", "it is not on the path")
# Python adds particles to YADE one by one; a million would take minutes.
MOST = 200_000


def prepare(scene):
    if not 0 < scene.n <= MOST:
        raise Refusal(f"the scene has {scene.n} particles; this runner supports 1 to {MOST} in YADE")
    folder = tempfile.TemporaryDirectory()
    place = pathlib.Path(folder.name)
    radii = np.full(scene.n, scene.radius) if scene.radii is None else scene.radii
    np.savetxt(place / "scene.txt", np.column_stack([scene.in_space(), radii]), fmt="%.17g")

    def run(builds):
        """Return the detections, their nanoseconds, those of the first, and the pairs."""
        (place / "report.json").unlink(missing_ok=True)
        ended = subprocess.run(
            [program, "-x", "-n", "-j1", __file__, str(place), str(builds)], stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
        )
        if not (place / "report.json").exists():
            raise RuntimeError(f"yade ended with {ended.returncode}: {ended.stdout[-300:]}")
        said = json.loads((place / "report.json").read_text())
        return said["builds"], said["elapsed"], said["first"], np.array(said["pairs"], int).reshape(-1, 2)

    detect = lambda: run(1)[-1]
    detect.report = lambda least: run(max(5, 2 * least // (50 * scene.n)))
    detect.folder = folder
    return detect


said = subprocess.run([program, "--version"], capture_output=True, text=True)
serve(
    "yade-collider", re.search(r"ersion:? (\S+)", said.stdout + said.stderr).group(1), prepare, arithmetic="f64",
    build={"clock": "its own O.timing: boxes and insertion sorts of the collider, at rest and sorted already"},
)
