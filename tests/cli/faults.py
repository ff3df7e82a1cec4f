"""Faults of the system that a run meets: functions that fail (faults.cpp, loaded before all libraries), and a user who may not write."""
import atexit
import functools
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import runner

NOBODY = 65534


@functools.cache
def library():
    """The compiled faults.cpp."""
    compiler = os.environ.get("CXX") or shutil.which("c++") or shutil.which("g++") or shutil.which("clang++")
    runner.expect(compiler, "no C++ compiler is there to compile tests/cli/faults.cpp")
    folder = tempfile.mkdtemp(prefix="burnish-faults-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    source, target = Path(__file__).with_name("faults.cpp"), Path(folder, "faults.so")
    done = subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-o", str(target), str(source), "-ldl"], capture_output=True, check=False)
    runner.expect(done.returncode == 0, f"tests/cli/faults.cpp does not compile:\n{done.stderr.decode('utf-8', 'replace')}")
    return target


def environment(fault, file=""):
    """In which the function `fault` fails; reading: that of files whose paths hold `file`."""
    return {"LD_PRELOAD": str(library()), "FAULT": fault, "FAULT_FILE": file}


def as_nobody(command):
    """The line of a shell that runs the program by a user who is not root."""
    return f"setpriv --reuid={NOBODY} --regid={NOBODY} --clear-groups ./the-program {command}" if os.geteuid() == 0 else f"./the-program {command}"


def let_nobody_in(box):
    """The folder and a copy of the program, for `as_nobody`."""
    box.folder.chmod(0o777)
    shutil.copy(box.program, box.folder / "the-program")
