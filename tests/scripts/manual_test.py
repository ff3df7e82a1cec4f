#!/usr/bin/env python3
"""The commands of the documentation run as they stand: every ```sh block of the pages below, in one folder for each section.

  tests/scripts/manual_test.py BURNISH

A line with `# exit N` has to end with N, all others with 0.
"""
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = ["docs/manual.md"]
BLOCK = re.compile(r"^```sh\n(.*?)^```$", re.S | re.M)


def sections(text):
    """(title, its blocks) of each section."""
    parts = re.split(r"^## (.*)$", text, flags=re.M)
    return [(title, BLOCK.findall(body)) for title, body in zip(parts[1::2], parts[2::2])]


def run_section(blocks, environment):
    with tempfile.TemporaryDirectory() as folder:
        for line in (line for block in blocks for line in block.splitlines() if line.strip()):
            wanted = int(match[1]) if (match := re.search(r"# exit (\d+)", line)) else 0
            done = subprocess.run(["bash", "-c", line], cwd=folder, env=environment, capture_output=True, text=True)
            if done.returncode != wanted:
                yield f"{line}\n  exit code {done.returncode}, expected {wanted}\n{done.stderr}"


def main():
    program = Path(sys.argv[1]).resolve()
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "burnish").symlink_to(program)
        environment = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"}
        for page in PAGES:
            ran = 0
            for title, blocks in sections((ROOT / page).read_text(encoding="utf-8")):
                ran += sum(len(block.splitlines()) for block in blocks)
                for complaint in run_section(blocks, environment):
                    failed += 1
                    print(f"FAILED {page}: {title}\n{complaint}")
            print(f"{page}: {ran} commands")
            failed += ran == 0
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
