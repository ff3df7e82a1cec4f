#!/usr/bin/env python3
"""Tests scripts/run_peers without running anything that is measured: the tables it prints of lines made up."""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "run_peers"


def line(program, threads, cpu, **more):
    return {"kind": "band", "case": "ball@diagonal/64", "program": program, "threads": threads, "facets": 1200,
            "active": 2_000_000, "cpu_seconds": cpu, "wall_seconds": cpu / threads, "ns_per_active": 500 * cpu,
            "peak_mb": 100 * threads, **more}


def table_of(lines, command="band"):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "peers.jsonl"
        path.write_text("".join(json.dumps(each) + "\n" for each in lines), encoding="utf-8")
        done = subprocess.run([sys.executable, SCRIPT, command, "--table", "-o", path], text=True, capture_output=True)
    rows = [[cell.strip() for cell in row.strip("| \n").split(" | ")] for row in done.stdout.splitlines()]
    return done.returncode, rows


class Table(unittest.TestCase):
    def test_ratios_are_ours_over_theirs(self):
        code, rows = table_of([line("burnish", 1, 1.0), line("burnish", 2, 1.2), line("openvdb", 1, 4.0),
                               line("openvdb", 2, 4.8), line("cgal", 1, 9.0)])
        self.assertEqual(code, 0)
        row = rows[2]
        self.assertEqual(row[:7], ["ball@diagonal/64", "1,200", "2", "1 / 1.2", "4 / 4.8", "0.25 / 0.25", "9"])
        self.assertEqual(row[7:], ["500", "2000", "200", "200", "1.67 x", "1.67 x"])

    def test_the_newest_line_of_a_program_counts(self):
        _, rows = table_of([line("burnish", 1, 1.0), line("openvdb", 1, 4.0), line("burnish", 1, 2.0)])
        self.assertEqual(rows[2][5], "0.50")

    def test_lines_of_other_kinds_are_left_out(self):
        _, rows = table_of([line("burnish", 1, 1.0), line("burnish", 1, 7.0, kind="cfd")])
        self.assertEqual(len(rows), 3)
        self.assertTrue(rows[2][3].startswith("1"))

    def test_a_failure_is_told_in_the_row(self):
        _, rows = table_of([{"kind": "band", "case": "ball@diagonal/64", "program": "burnish", "threads": 1,
                             "error": "out of memory"}])
        self.assertIn("burnish: out of memory", rows[2])


class FlowMeshes(unittest.TestCase):
    def test_a_failed_check_is_named(self):
        made = {"kind": "cfd", "program": "burnish", "threads": 0, "cells": 1234.0, "cpu_seconds": 2.0, "peak_mb": 30.0,
                "non_orthogonality": 60.0, "mean_non_orthogonality": 11.0, "skewness": 0.9, "regions": 1.0}
        _, rows = table_of([{**made, "case": "ball", "passes": True, "fails": []},
                            {**made, "case": "knot", "passes": False, "fails": ["Concave cells"]}], "cfd")
        self.assertEqual(rows[2], ["ball", "1,234", "2", "30", "60 / 11", "0.9", "1", "Mesh OK"])
        self.assertEqual(rows[3][-1], "**fails**: Concave cells")


class Usage(unittest.TestCase):
    def test_no_measurements_yet(self):
        done = subprocess.run([sys.executable, SCRIPT, "band", "--table", "-o", "/nonexistent/peers.jsonl"], text=True,
                              capture_output=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("nothing has been measured", done.stderr)

    def test_a_command_is_needed(self):
        self.assertEqual(subprocess.run([sys.executable, SCRIPT], capture_output=True).returncode, 2)


if __name__ == "__main__":
    unittest.main()
