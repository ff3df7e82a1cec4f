"""Runs the program in a folder of its own and judges what came out."""
import os
import re
import shlex
import signal
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import models

NOTHING = r"\A\Z"


class Failed(Exception):
    """What was expected, and what came instead."""


@dataclass
class Case:
    """This command, this exit code, these regular expressions on the two streams."""
    command: str                 # as in a shell, without the program
    code: int = 0
    out: str = NOTHING
    err: str = None              # None: anything
    stdin: bytes = b""
    env: dict = field(default_factory=dict)
    makes: list = field(default_factory=list)  # the files, and no others, that stand there afterwards

    def name(self):
        return f"burnish {self.command}"


@dataclass
class Result:
    code: int
    out: bytes
    err: bytes

    def text(self):
        return self.out.decode("utf-8", "replace")

    def messages(self):
        return self.err.decode("utf-8", "replace")


def start_fresh():
    """In the child: signals as a terminal would have them, whatever the test runner's are."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGPIPE):
        signal.signal(number, signal.SIG_DFL)


class Sandbox:
    """A temporary folder with the fixtures in it, and the program under test."""

    def __init__(self, program):
        self.program = str(program)
        self.scope = tempfile.TemporaryDirectory(prefix="burnish-cli-")
        self.folder = Path(self.scope.name)
        self.fixtures = models.fixtures()
        for name, data in self.fixtures.items():
            (self.folder / name).write_bytes(data)
        (self.folder / "folder").mkdir()
        self.processes = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in self.processes:
            if process.poll() is None:  # a test that failed half-way
                process.kill()
                process.communicate()
        self.scope.cleanup()

    def popen(self, args, env=None, **options):
        environment = {k: v for k, v in os.environ.items() if not k.startswith("LC_") and k != "LANG"}
        options.setdefault("stdin", subprocess.DEVNULL)
        options.setdefault("stdout", subprocess.PIPE)
        options.setdefault("stderr", subprocess.PIPE)
        options.setdefault("preexec_fn", start_fresh)
        self.processes.append(subprocess.Popen([self.program, *args], cwd=self.folder,
                                               env={**environment, **(env or {})}, **options))
        return self.processes[-1]

    def run(self, args, stdin=b"", env=None, timeout=240):
        process = self.popen(args, env, stdin=subprocess.PIPE)
        try:
            out, err = process.communicate(stdin, timeout=timeout)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            raise Failed(f"no end after {timeout} s: {args}") from None
        return Result(process.returncode, out, err)

    def succeed(self, args, **options):
        """Runs and demands exit code 0."""
        result = self.run(args, **options)
        expect(result.code == 0, f"exit code {result.code} of {args}\n{result.messages()}")
        return result

    def read(self, name):
        path = self.folder / name
        expect(path.exists(), f"{name} was not written")
        return path.read_bytes()

    def write(self, name, data):
        (self.folder / name).write_bytes(data)

    def new_files(self):
        return sorted({e.name for e in self.folder.iterdir()} - {*self.fixtures, "folder"})

    def expect_files(self, names):
        expect(self.new_files() == sorted(names), f"files made: {self.new_files()}, expected {sorted(names)}")

    def expect_fixtures_untouched(self):
        for name, data in self.fixtures.items():
            expect(self.read(name) == data, f"{name} was changed")


def expect(condition, complaint):
    if not condition:
        raise Failed(complaint)


def expect_match(pattern, text, what):
    if pattern is not None and not re.search(pattern, text, re.MULTILINE):
        raise Failed(f"{what} does not match {pattern!r}:\n{text}")


def run_case(case, program):
    with Sandbox(program) as box:
        result = box.run(shlex.split(case.command), case.stdin, case.env)
        expect(result.code == case.code,
               f"exit code {result.code}, expected {case.code}\n{result.messages()}{result.text()}")
        expect_match(case.out, result.text(), "standard output")
        expect_match(case.err, result.messages(), "standard error")
        box.expect_files(case.makes)
        box.expect_fixtures_untouched()
