"""Prints the lines covered in each folder of a gcovr summary, and judges the library's.

  scripts/coverage_table.py SUMMARY.json [--fail-under PERCENT]

The library is src and include without src/cli. Exits 1 if it is below PERCENT.
"""
import argparse
import json
import sys
from collections import defaultdict


def folder_of(filename):
    """src/levelset/smooth/x.cpp -> src/levelset; include/burnish/core/x.h -> include/core."""
    parts = filename.split("/")
    return f"include/{parts[2]}" if parts[0] == "include" else "/".join(parts[:2])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("summary")
    parser.add_argument("--fail-under", type=float, default=0)
    arguments = parser.parse_args()
    with open(arguments.summary, encoding="utf-8") as file:
        files = json.load(file)["files"]
    lines = defaultdict(lambda: [0, 0])
    for entry in files:
        for name in (folder_of(entry["filename"]), "program" if entry["filename"].startswith("src/cli/") else "library"):
            lines[name][0] += entry["line_covered"]
            lines[name][1] += entry["line_total"]
    totals = {name: lines.pop(name) for name in ("program", "library") if name in lines}
    for name, (covered, total) in sorted(lines.items()) + list(totals.items()):
        print(f"{name:<20}{covered:>8} of {total:>6} lines {100 * covered / max(total, 1):>6.1f} %")
    worst = sorted((e for e in files if e["line_total"] >= 10), key=lambda e: e["line_covered"] / e["line_total"])[:10]
    print("least covered: " + ", ".join(f"{e['filename']} {100 * e['line_covered'] / e['line_total']:.0f} %" for e in worst))
    covered, total = totals["library"]
    return 0 if 100 * covered >= arguments.fail_under * total else 1


if __name__ == "__main__":
    sys.exit(main())
