"""Calls that are refused, interrupted, forked, short of memory, or shared by threads."""

import copy
import os
import pickle
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import contactbench

CORNER = [[0.0, 0.0], [0.9, 0.0], [0.0, 0.9]]


@pytest.mark.parametrize(
    "ask",
    [
        lambda: contactbench.contacts(CORNER, 1, threads=-1),
        lambda: contactbench.Detector(memory_limit=-1),
        lambda: contactbench.Verlet(threads=-1),
        lambda: contactbench.verify(CORNER, 1, [], most=-1),
        lambda: contactbench.verify(CORNER, 1, [], base=2**70),
        lambda: contactbench.recommend(CORNER, 1, memory_limit=-1),
    ],
)
def test_numbers_out_of_range_are_value_errors(ask):
    with pytest.raises(ValueError, match="give a whole number from"):
        ask()


@pytest.mark.parametrize("name", ["nothing", "nbs-twin", "nsb"])
def test_controls_are_no_detectors(name):
    for ask in (contactbench.Detector, contactbench.Verlet):
        with pytest.raises(ValueError, match="there is no detector") as error:
            ask(name)
        assert "twin" not in str(error.value).replace(name, "")
        assert f"did you mean {name}" not in str(error.value)
        assert "nothing" not in str(error.value).replace(name, "")


def test_detectors_can_be_copied():
    detector = contactbench.Detector("nbs", "f64", 1, 1 << 20)
    verlet = contactbench.Verlet("nbs", skin=0.25)
    verlet.contacts(CORNER, 0.5)
    for again in (lambda it: pickle.loads(pickle.dumps(it)), copy.deepcopy, copy.copy):
        other = again(detector)
        assert (other.name, other.arithmetic, other.memory_limit) == ("nbs", "f64", 1 << 20)
        other = again(verlet)
        assert (other.name, other.steps) == (verlet.name, 0)
        assert len(other.contacts(CORNER, 0.5)[0]) == 2


def test_refusals_are_a_class():
    with pytest.raises(contactbench.Refused):
        contactbench.contacts([[0.0, 0.0], [1e300, 0.0]], 1.0, detector="cell-grid")
    with pytest.raises(contactbench.Refused, match="along its vector"):
        contactbench.contacts([[0.0, 0.0], [1e10, 0.0]], 1.0, box=[1.0, 1.0])
    assert issubclass(contactbench.Refused, ValueError)
    error = pickle.loads(pickle.dumps(contactbench.Refused("why")))
    assert isinstance(error, contactbench.Refused) and str(error) == "why"


def test_the_package_passes_its_own_check():
    for name in ("auto", "cell-grid"):
        own = lambda x, r: contactbench.contacts(x, r, detector=name)[0].astype(int)
        found = contactbench.check(own, seconds=2.0)
        assert found and found.cases > 20, str(found)


def test_a_check_that_compared_nothing_is_no_pass():
    def never(x, r):
        raise NotImplementedError("not yet")

    found = contactbench.check(never, seconds=0.5)
    assert not found and found.cases == 0 and not found.failures
    assert found.verdict == "nothing"
    assert "nothing was compared" in str(found)


def test_a_small_box_is_answered():
    """Two discs have 400,000 contacts; a detector that got all images would take an hour."""
    pairs, images = contactbench.contacts([[0.0, 0.0], [1.0, 1.0]], 0.5, box=[[1, 0], [1, 1e-5]])
    assert len(pairs) == pytest.approx(4e5, rel=1e-3) and len(images) == len(pairs)


def test_too_many_pairs_are_foreseen_in_a_box():
    random = np.random.default_rng(1)
    x = 21.5 * random.random((10_000, 3))
    for radius in (10.0, 50.0):
        with pytest.raises(MemoryError):
            contactbench.contacts(x, radius, box=[21.5] * 3)
    with pytest.raises(MemoryError, match="touches about"):
        contactbench.contacts(np.zeros((100_000, 3)), 1.0, box=[5.0] * 3)


INTERRUPTED = """
import os, signal, threading, time
import numpy as np
import contactbench
# Background jobs of a shell ignore the signal.
signal.signal(signal.SIGINT, signal.default_int_handler)
x = np.random.default_rng(1).random((400_000, 3))
detector = contactbench.Detector("direct")
busy = contactbench.Verlet("direct")
threading.Thread(target=busy.contacts, args=(x, 1e-4), daemon=True).start()
ask = {
    "contacts": lambda: contactbench.contacts(x, 1e-4, detector="direct"),
    "Detector": lambda: detector.contacts(x, 1e-4),
    "count": lambda: detector.count(x, 1e-4),
    "Verlet": lambda: contactbench.Verlet("direct").contacts(x, 1e-4),
    "forget": busy.forget,
    "verify": lambda: contactbench.verify(x, 0.006, []),
    "recommend": lambda: contactbench.recommend(x, 1e-4, seconds=100),
    "check": lambda: contactbench.check(
        lambda x, r: contactbench.contacts(x, r)[0].astype(int), seconds=100),
}
for name, ask in ask.items():
    at = []
    def send():
        at.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)
    timer = threading.Timer(0.3, send)
    timer.start()
    try:
        ask()
        print(name, "ended")
    except KeyboardInterrupt:
        print(name, "interrupted", time.perf_counter() - at[0])
assert len(detector.contacts([[0.0, 0.0], [1.0, 0.0]], 0.5)[0]) == 1
os._exit(0)
"""


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_every_long_call_can_be_interrupted():
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert len(lines) == 8 and all(" interrupted " in line for line in lines), done.stdout


def test_a_long_call_in_the_main_thread_reads_a_copy():
    x = np.random.default_rng(1).random((20_000, 3)) * 28.0
    expected = len(contactbench.contacts(x, 0.5)[0])
    timer = threading.Timer(0.5, x.fill, [1.0])
    timer.start()
    pairs, _ = contactbench.contacts(x, 0.5, detector="direct")
    timer.join()
    assert len(pairs) == expected


LIMITED = """
import resource, sys
import numpy as np
import contactbench
n = 400_000
x = np.random.default_rng(1).random((n, 3)) * 74.0
r = np.full(n, 0.5)
box = np.full(3, 74.0)
contactbench.contacts(x[:1000], 0.5)
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
room = int(sys.argv[1]) << 20
resource.setrlimit(resource.RLIMIT_AS, (used + room, used + room))
calls = {
    "contacts": lambda: contactbench.contacts(x, r),
    "box": lambda: contactbench.contacts(x, r, box=box),
    "nbs": lambda: contactbench.contacts(x, r, detector="nbs"),
    "kd-tree": lambda: contactbench.contacts(x, r, detector="kd-tree"),
    "threads": lambda: contactbench.contacts(x, r, threads=2),
    "verlet": lambda: contactbench.Verlet().contacts(x, r),
    "verify": lambda: contactbench.verify(x, r, []),
}
for name, call in calls.items():
    print(name, flush=True)
    try:
        call()
    except MemoryError:
        pass
print("well")
"""


@pytest.mark.skipif(sys.platform != "linux", reason="limits of Linux")
@pytest.mark.parametrize("room", [1, 3, 5, 10, 20, 40, 80])
def test_too_little_memory_is_an_exception(room):
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, str(room)], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0 and done.stdout.endswith("well\n"), done.stdout + done.stderr


SMALL = """
import resource, sys
import numpy as np
import contactbench
contactbench.contacts(np.zeros((2, 3)), 0.5)
x, box = np.random.default_rng(1).random((int(sys.argv[1]), 3)) * 8.0, [8.0] * 3
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + (1 << 20), used + (1 << 20)))
print(len(contactbench.contacts(x, float(sys.argv[2]), box=box)[0]))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="limits of Linux")
@pytest.mark.parametrize("n, radius, done", [(50, 2.5, True), (3000, 0.01, False), (9, 99, False)])
def test_a_small_box_needs_no_thread(n, radius, done):
    """The stack of a thread does not fit into the memory."""
    command = [sys.executable, "-c", SMALL, str(n), str(radius)]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert (ended.returncode == 0) == done, ended.stderr
    assert done or "a thread could not be started" in ended.stderr


FORKED = """
import os, sys, threading, time
import numpy as np
import contactbench
x = np.random.default_rng(1).random((1000, 2))
kind = sys.argv[1]
if kind == "threads":
    detector = contactbench.Detector(threads=2)
    detector.contacts(x, 0.01)
elif kind == "idle":
    detector = contactbench.Detector()
    detector.contacts(x, 0.01)
else:
    detector = contactbench.Detector("direct")
    large = np.random.default_rng(1).random((60_000, 3))
    threading.Thread(target=lambda: detector.contacts(large, 1e-4)).start()
    time.sleep(0.2)
child = os.fork()
if child == 0:
    try:
        detector.contacts(x, 0.01)
        code = 0
    except RuntimeError as error:
        code = 7 if "forked" in str(error) else 8
    os._exit(code)
for _ in range(600):
    done, status = os.waitpid(child, os.WNOHANG)
    if done:
        break
    time.sleep(0.1)
else:
    os.kill(child, 9)
    os.waitpid(child, 0)
    status = 99 << 8
print(os.waitstatus_to_exitcode(status))
os._exit(0)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks")
@pytest.mark.parametrize("kind, code", [("threads", 7), ("busy", 7), ("idle", 0)])
def test_a_forked_process_gets_an_error_or_an_answer(kind, code):
    done = subprocess.run(
        [sys.executable, "-c", FORKED, kind], capture_output=True, text=True, timeout=200
    )
    assert done.stdout.strip() == str(code), done.stdout + done.stderr


def test_arrays_that_change_are_no_panic(capfd):
    x = np.random.default_rng(1).random((20_000, 2))
    end = threading.Event()

    def write():
        while not end.is_set():
            x[:] = 1.0 - x

    writer = threading.Thread(target=write)
    writer.start()
    detector = contactbench.Detector()
    try:
        for _ in range(30):
            try:
                detector.contacts(x, 0.002)
            except RuntimeError as error:
                assert "written to by another thread" in str(error)
    finally:
        end.set()
        writer.join()
    assert "panicked" not in capfd.readouterr().err


TYPED = Path(__file__).with_name("typed.py")


@pytest.mark.parametrize("tool", [["mypy", "--strict"], ["pyright"]])
def test_types_hold(tool, tmp_path):
    found = subprocess.run(
        [sys.executable, "-m", tool[0], "--version"], capture_output=True, text=True
    )
    if found.returncode != 0:
        pytest.skip(f"{tool[0]} is not installed")
    # Pyright looks for packages beside the python on the path, which may be another.
    pyright = tool[0] == "pyright"
    place = ["--pythonpath", sys.executable] if pyright else ["--cache-dir", str(tmp_path)]
    done = subprocess.run(
        [sys.executable, "-m", *tool, *place, str(TYPED)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
