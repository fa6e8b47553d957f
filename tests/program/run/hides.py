import json, os, sys, time
def say(**reply): print(json.dumps(reply), flush=True)
def note():
    with open("pids", "a") as f: f.write(f"{os.getpid()}\n")
def hide():
    # A session of its own, and a parent that ends at once.
    there, here = os.pipe()
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            note()
            os.write(here, b"x")
            time.sleep(600)
        os._exit(0)
    os.wait()
    os.read(there, 1)
BEFORE
say(reply="hello", protocol=4, detector="hides", arithmetic="f64")
for line in sys.stdin:
    asked = json.loads(line)["request"]
    if asked == "load":
        hide()
        say(reply="loaded")
    elif asked == "sample":
        start = time.perf_counter_ns()
        time.sleep(0.003)
        took = time.perf_counter_ns() - start
        say(reply="sample", time_ns=took, calls=1, elapsed_ns=took, contacts=0, digest="0x" + 16 * "0")
    elif asked == "quit":
        break
    else:
        say(reply="unsupported")
