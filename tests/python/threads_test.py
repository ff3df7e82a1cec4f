"""While the library works: other threads, progress, Ctrl-C."""
import os
import signal
import subprocess
import sys
import threading
import time

import burnish
import pytest
from conftest import sphere

SLOW = {"resolution": 160, "smooth": "2%", "mode": "volume"}


def test_other_threads_run_meanwhile():
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    start = time.monotonic()
    burnish.clean(*sphere(4), **SLOW)
    seconds, steps = time.monotonic() - start, counted[0]
    done.set()
    thread.join()
    # A thousand a second on an idle machine; none at all, but before and behind, if the lock were held.
    assert steps > 50 * seconds > 5


def test_two_runs_at_once_give_what_one_gives():
    expected = burnish.clean(*sphere(3), resolution=60).vertices.tobytes()
    results = []
    threads = [threading.Thread(target=lambda: results.append(burnish.clean(*sphere(3), resolution=60, progress=lambda *_: None).vertices.tobytes())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [expected] * 4


def test_progress_is_told():
    told = []
    burnish.clean(*sphere(4), progress=lambda stage, fraction: told.append((stage, fraction)), **SLOW)
    stages = list(dict.fromkeys(stage for stage, _ in told))
    assert stages[0] == "welding" and "smoothing" in stages and stages.index("inspecting") < stages.index("smoothing")
    assert all(0 <= fraction <= 1 for _, fraction in told)


def test_what_progress_raises_comes_through():
    class Enough(Exception):
        pass

    def stop(stage, fraction):
        raise Enough(stage)

    for function in (lambda **o: burnish.clean(*sphere(4), **SLOW, **o), lambda **o: burnish.check(*sphere(4), **o)):
        with pytest.raises(Enough, match="welding"):
            function(progress=stop)


def test_progress_may_call_the_library(cube):
    volumes = []
    burnish.clean(*sphere(3), resolution=40, progress=lambda *_: volumes.append(burnish.check(*cube).defects["volume"]))
    assert volumes and set(volumes) == {1.0}


CALLS = {
    "clean": "burnish.clean(v, f, resolution=500, smooth='2%', mode='volume', memory='20G')",
    "delaunay": "burnish.clean(v, f, resolution=300, surface='delaunay', memory='20G')",
    "signed_distance": "burnish.signed_distance(v, f, np.random.default_rng(1).uniform(-1, 1, (4_000_000, 3)))",
    "compare": "burnish.compare((v, f), (v * 1.01, f), samples=4_000_000, exact=True)",
    "check": "[burnish.check(v, f) for _ in range(1000)]",
}


def seconds_of(pid):
    """Of CPU, so far."""
    with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("threads", [None, 1])
def test_ctrl_c_stops_soon(call, threads):
    text = CALLS[call] if threads is None or call == "check" else CALLS[call][:-1] + f", threads={threads})"
    code = f"""
import sys, time; sys.path[:0] = {sys.path!r}
import burnish, numpy as np
from conftest import sphere
v, f = sphere(6)
print('ready', flush=True)
try:
    {text}
    print('finished')
except KeyboardInterrupt:
    print('interrupted')
"""
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "ready\n"
    time.sleep(2)
    before = seconds_of(process.pid)
    os.kill(process.pid, signal.SIGINT)
    rest = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    # Of CPU, so that it holds on a busy machine too. The calls would take from 20 to 70 more; in the worst moment they look after one.
    processors = threads or len(os.sched_getaffinity(0))
    assert rest == "interrupted\n" and usage.ru_utime + usage.ru_stime - before < 4 * processors
