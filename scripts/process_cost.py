"""What a process costs, for scripts that compare programs."""
import os
import subprocess
import sys
import time


def measured(command, env=None, allowed=(0,)):
    """(seconds of CPU, seconds of wall, peak MB, standard output) of a process; ends the script if its exit code is none of those that are allowed."""
    command = [str(word) for word in command]
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, env=env, text=True)
    out = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in allowed:
        sys.exit(f"{os.path.basename(sys.argv[0])}: {' '.join(command)}: exit code {process.returncode}")
    return usage.ru_utime + usage.ru_stime, wall, usage.ru_maxrss / 1024, out
