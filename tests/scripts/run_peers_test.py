#!/usr/bin/env python3
"""Tests scripts/run_peers without running anything that is measured: the tables it prints of lines made up, how it
reads what programs write, and what it tells them."""
import array
import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "run_peers"
sys.path.insert(0, str(SCRIPT.parent))
sys.dont_write_bytecode = True
import flow_peers  # noqa: E402  (of the scripts)


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


CHECK_MESH = """
    cells:            24286
   *Number of regions: 2
    Mesh non-orthogonality Max: 68.2 average: 22.1
 ***High aspect ratio cells found, Max aspect ratio: 1200, number of cells 3
    Max skewness = 1.01 OK.
    Min volume = 2.9e-05. Max volume = 0.018. Total volume = 20.2340025825.  Cell volumes OK.
 *There are 5 faces with concave angles between consecutive edges.
Failed 1 mesh checks.
"""
BOX = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1), (1, 1, 1)]
BOX_FACETS = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2),
              (1, 3, 7), (1, 7, 5)]


def box(lower, upper, inwards=False):
    """Facets of a box, nine numbers each."""
    points = [[(lower, upper)[c][axis] for axis, c in enumerate(corner)] for corner in BOX]
    return [sum((points[i] for i in (reversed(facet) if inwards else facet)), []) for facet in BOX_FACETS]


def ascii_stl(name, facets):
    text = "".join("facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {f[i]} {f[i + 1]} {f[i + 2]}\n" for i in (0, 3, 6))
                   + "endloop\nendfacet\n" for f in facets)
    return f"solid {name}\n{text}endsolid {name}\n"


class FlowMeshes(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def problem(self, side="inside"):
        return flow_peers.Problem("ball", self.folder / "ball.stl", side, 0.25, [0, 0, 0], [4, 2, 1], 1.0, [2, 1, 0.5])

    def test_programs_of_a_case_stand_together_and_a_failed_check_is_named(self):
        made = {"kind": "cfd", "threads": 0, "cells": 1234.0, "cpu_seconds": 2.0, "peak_mb": 30.0, "finest": 0.5,
                "hexahedra": 0.8, "non_orthogonality": 60.0, "mean_non_orthogonality": 11.0, "skewness": 0.9, "regions": 1.0,
                "volume_error": -0.001, "distance_max": 0.4, "distance_rms": 0.02, "passes": True, "fails": []}
        _, rows = table_of([{**made, "case": "ball", "program": "gmsh", "passes": False, "fails": ["Concave cells"]},
                            {**made, "case": "knot", "program": "burnish"},
                            {**made, "case": "ball", "program": "burnish"}], "cfd")
        self.assertEqual([row[:2] for row in rows[2:]], [["ball", "burnish"], ["ball", "gmsh"], ["knot", "burnish"]])
        self.assertEqual(rows[2][2:], ["1,234", "50%", "80%", "2", "30", "617", "60 / 11", "0.9", "1", "-0.10 %",
                                       "0.40 / 0.020", "Mesh OK"])
        self.assertEqual(rows[3][-1], "**fails**: Concave cells")

    def test_leaks_and_failures_show(self):
        leaked = {"kind": "cfd", "case": "ball", "threads": 0, "cpu_seconds": 2.0, "peak_mb": 30.0, "program": "snappyHexMesh",
                  "cells": 10.0, "passes": True, "fails": [], "volume_error": 8.0}
        _, rows = table_of([leaked, {"kind": "cfd", "case": "ball", "threads": 0, "program": "gmsh", "error": "gmsh: no"}], "cfd")
        self.assertIn("**9 times**", rows[2])
        self.assertEqual(rows[3][2], "**none**: gmsh: no")

    def test_the_log_of_check_mesh_is_read(self):
        found = flow_peers.checked(CHECK_MESH)
        self.assertEqual(found, {"cells": 24286, "regions": 2, "skewness": 1.01, "non_orthogonality": 68.2,
                                 "mean_non_orthogonality": 22.1, "mesh_volume": 20.2340025825, "passes": False,
                                 "fails": ["High aspect ratio cells found, Max aspect ratio: 1200, number of cells 3"]})
        self.assertTrue(flow_peers.checked("\nMesh OK.\n")["passes"])

    def test_why_a_program_stopped_is_in_its_own_words(self):
        self.assertEqual(flow_peers.reason("--> FOAM FATAL ERROR: \nNo mesh in point (1  2)\n\n    From f"), "No mesh in point (1 2)")
        self.assertEqual(flow_peers.reason("Info    : a\nError   : PLC Error\nError   : ---"), "PLC Error")
        self.assertEqual(flow_peers.reason(""), "no word")

    def test_a_program_is_stopped_at_its_limit_and_its_exit_code_told(self):
        late = flow_peers.step([sys.executable, "-c", "while True: pass"], self.folder, 1)
        self.assertIn("stopped after 1 CPU s", late["error"])
        failed = flow_peers.run([(True, [sys.executable, "-c", "raise SystemExit('burnish: thin')"]),
                                 (True, [sys.executable, "-c", "open('second', 'w')"])], self.folder, 60)
        self.assertRegex(failed["error"], r"exit code 1: thin")
        self.assertFalse((self.folder / "second").exists())

    def test_fields_are_read_binary_text_and_uniform(self):
        values = array.array("d", [0.5, 3.0, 0.125])
        head = b"FoamFile { format %s; }\ninternalField nonuniform List<scalar> \n3\n("
        path = self.folder / "field"
        path.write_bytes(head % b"binary" + values.tobytes() + b");\nboundaryField {}")
        self.assertEqual(list(flow_peers.field_of(path)), list(values))
        path.write_bytes(head % b"ascii" + b"0.5\n3\n0.125\n);\nboundaryField {}")
        self.assertEqual(flow_peers.field_of(path), list(values))
        path.write_bytes(b"FoamFile { format binary; }\ninternalField uniform 3;")
        self.assertEqual(flow_peers.field_of(path), [3.0])

    def test_shares_are_of_cells_and_of_volume(self):
        self.assertEqual(flow_peers.shares([1, 1, 8, 6], [3, 0, 3, 7], 1), {"finest": 0.5, "hexahedra": 9 / 16})
        self.assertEqual(flow_peers.shares([1, 1], [3], 1), {"finest": 1.0, "hexahedra": 1.0})

    def test_walls_enclose_the_solid_whatever_the_domain(self):
        text = ascii_stl("xMin", box((-9, -9, -9), (9, 9, 9))) + ascii_stl("wall", box((5, 5, 5), (7, 6, 6.5), inwards=True))
        path = self.folder / "patch.stl"
        path.write_text("".join(flow_peers.without_domain(text.splitlines(keepends=True))), encoding="utf-8")
        self.assertAlmostEqual(flow_peers.enclosed(path), -3)

    def test_a_point_inside_is_in_no_cavity(self):
        x, y, z = flow_peers.point_inside(box((0, 0, 0), (8, 2.1, 2)) + box((1, 0.2, 0.2), (7, 1.8, 1.9), inwards=True))
        self.assertTrue(0 < x < 8 and 0 < y < 2.1 and 0 < z < 2)
        self.assertFalse(1 <= x <= 7 and 0.2 <= y <= 1.8 and 0.2 <= z <= 1.9)
        self.assertIsNone(flow_peers.point_inside(box((0, 0, 0), (1, 1, 2))[:2]))

    def test_the_background_of_cubes_holds_the_domain(self):
        for side in ("inside", "outside"):
            problem = self.problem(side)
            text, corner = flow_peers.block_mesh(problem)
            counts = [int(count) for count in re.search(r"\((\d+) (\d+) (\d+)\) simple", text).groups()]
            for low, high, start, count in zip(*problem.domain(), corner, counts):
                self.assertLess(start, low)
                self.assertGreaterEqual(start + count * flow_peers.COARSEST * problem.cell, high)

    def test_the_box_of_gmsh_is_made_of_closed_loops(self):
        text = flow_peers.gmsh_script(self.problem("outside"))
        ends = {int(line): (int(a), int(b)) for line, a, b in re.findall(r"Line\(l \+ (\d+)\) = \{p \+ (\d+), p \+ (\d+)\}", text)}
        loops = re.findall(r"Curve Loop\(1000000 \+ \d+\) = \{([^}]*)\}", text)
        self.assertEqual((len(ends), len(loops)), (12, 6))
        for loop in loops:
            sides = [ends[int(n)][::-1] if sign else ends[int(n)] for sign, n in re.findall(r"(-?)\(?l \+ (\d+)", loop)]
            self.assertEqual([b for _, b in sides], [a for a, _ in sides[1:] + sides[:1]])


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
