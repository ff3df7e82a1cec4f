#!/usr/bin/env python3
"""denoise_table measures make-believe denoisers on tiny models: a torus and an open strip of it.

  denoise_table_test.py BURNISH      (the program that measures)
"""
import importlib.machinery
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "denoise_table"
PYTHON = "/usr/bin/python3" if os.access("/usr/bin/python3", os.X_OK) else sys.executable  # Debian's own sees Debian's numpy
BURNISH = sys.argv.pop(1) if len(sys.argv) > 1 and os.access(sys.argv[1], os.X_OK) else ""

try:
    import numpy
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader("denoise_table", str(SCRIPT))
    table = importlib.util.module_from_spec(importlib.util.spec_from_loader("denoise_table", loader))
    loader.exec_module(table)
except ImportError:
    numpy = None

# A denoiser that knows the truth: it finds it by the name of its input.
ORACLE = """import shutil, sys
source, target = sys.argv[1:3]
shutil.copy(source.replace("_noisy", "_gt"), target)
"""
MESHLABSERVER = """#!/bin/sh
test "$5" = -s && grep -q FilterScript "$6" && cp "$2" "$4"
"""
DOC = "before\n<!-- denoise_table: pairs -->\nold\n<!-- /denoise_table -->\nbetween\n<!-- denoise_table: scans -->\nkept\n<!-- /denoise_table -->\n"


def torus(n=60, m=30, radius=0.4, around=None):
    """Corners of a torus about z; of the first `around` of n steps about it only, if that is given."""
    def at(i, j):
        u, v = 2 * numpy.pi * (i % n) / n, 2 * numpy.pi * (j % m) / m
        return [(1 + radius * numpy.cos(v)) * numpy.cos(u), (1 + radius * numpy.cos(v)) * numpy.sin(u), radius * numpy.sin(v)]
    facets = []
    for i in range(n if around is None else around):
        for j in range(m):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            facets += [[a, b, c], [a, c, d]]
    return numpy.array(facets)


@unittest.skipIf(numpy is None, "there is no numpy (Debian: python3-numpy)")
class Scratch(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)

    def stl(self, name, corners):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        table.write_stl(path, corners)
        return path


class Meshes(Scratch):
    def test_noise_is_along_normals_and_of_the_size_asked_for(self):
        clean, noisy = self.stl("clean.stl", torus(120, 60)), self.root / "noisy.stl"
        sigma = table.with_noise(clean, 0.2, noisy)
        self.assertAlmostEqual(sigma, 0.2 * table.mean_edge(table.read_stl(clean)), places=12)
        # The height over a torus of radii 1 and 0.4 is the distance from its circle less 0.4.
        points = table.weld(table.read_stl(noisy))[0]
        height = numpy.hypot(numpy.hypot(points[:, 0], points[:, 1]) - 1, points[:, 2]) - 0.4
        self.assertEqual(len(points), 120 * 60)
        self.assertAlmostEqual(height.std() / sigma, 1, delta=0.03)  # 1 / sqrt(2 n) is 0.008
        before = noisy.read_bytes()
        table.with_noise(clean, 0.2, noisy)
        self.assertEqual(noisy.read_bytes(), before)

    def test_damage_is_what_it_says(self):
        clean = self.stl("clean.stl", torus(120, 60))
        corners = table.read_stl(clean)
        damaged = {}
        for damage in table.DAMAGE:
            table.with_damage(clean, damage, self.root / f"{damage}.stl")
            damaged[damage] = table.read_stl(self.root / f"{damage}.stl")
        self.assertAlmostEqual(len(damaged["deleted"]) / len(corners), 0.95, delta=0.01)
        turned = (table.normals_2a(damaged["flipped"]) * table.normals_2a(corners)).sum(axis=1) < 0
        self.assertAlmostEqual(turned.mean(), 0.10, delta=0.01)
        off = (damaged["unwelded"] - corners).std() / table.mean_edge(corners)
        self.assertAlmostEqual(off, 0.02, delta=0.001)
        self.assertEqual(len(table.weld(damaged["unwelded"])[0]), 3 * len(corners))

    def test_roughness_is_off_the_mean_normal_of_a_cube_and_does_not_depend_on_the_facets(self):
        fold = numpy.array([[(0, 0, 0), (0, 1, 0), (-1, 0, 0)], [(0, 0, 0), (0, 0, 1), (0, 1, 0)]], float)
        self.assertAlmostEqual(table.roughness(self.stl("fold.stl", fold), 10), 45, places=9)
        self.assertAlmostEqual(table.roughness(self.stl("fold.stl", fold), 0.1), 0, places=9)  # each facet has a cube of its own
        coarse, fine = (table.roughness(self.stl("torus.stl", torus(n, n // 2)), 0.1) for n in (120, 240))
        self.assertAlmostEqual(fine / coarse, 1, delta=0.1)

    def test_what_is_open(self):
        self.assertFalse(table.is_open(self.stl("a.stl", torus())))
        self.assertTrue(table.is_open(self.stl("b.stl", torus(around=20))))

    def test_a_block_of_a_document_is_replaced_and_nothing_else(self):
        doc = self.root / "doc.md"
        doc.write_text(DOC)
        for _ in range(2):
            table.rewrite_block(doc, "pairs", "new\ntext")
            self.assertEqual(doc.read_text(), DOC.replace("old", "new\ntext"))


@unittest.skipIf(not BURNISH, "no program to measure with was named")
class Tables(Scratch):
    def setUp(self):
        super().setUp()
        (self.root / "data").mkdir()
        (self.root / "data" / "MANIFEST.tsv").write_text("name\tclass\n")
        for name, truth in (("guided_block04", torus()), ("tgv_kinect_pyramid", torus(around=20))):
            clean = self.stl(f"data/b_scan_noise/{name}_gt.stl", truth)
            table.with_noise(clean, 0.3, self.root / f"data/b_scan_noise/{name}_noisy.stl")
            for peer, level in (("bnf", 0.1), ("gnf", 0.05)):
                (self.root / "data/denoise/peers").mkdir(parents=True, exist_ok=True)
                table.with_noise(clean, level, self.root / f"data/denoise/peers/{name}-{peer}.stl")
        (self.root / "oracle.py").write_text(ORACLE)

    def run_script(self, *options, command="cp {in} {out}", **environment):
        lines = self.root / "rows.jsonl"
        done = subprocess.run([PYTHON, SCRIPT, self.root / "data", "--burnish", BURNISH, "--work", self.root / "work", "--jsonl", lines, "--samples", "2000",
                               *(["--command", command] if command else []), *options], text=True, capture_output=True,
                              env={**os.environ, **environment})
        rows = [json.loads(line) for line in lines.read_text().splitlines()] if lines.exists() else []
        return done, rows

    def test_a_denoiser_that_does_nothing_misses_every_bar_but_the_volume(self):
        done, rows = self.run_script()
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual([row["name"] for row in rows], ["guided_block04", "tgv_kinect_pyramid"])
        for row in rows:
            self.assertEqual(row["ours"]["angle"], row["noisy"]["angle"])
            self.assertGreater(row["noisy"]["rms"], row["bnf"]["rms"])
            self.assertGreater(row["bnf"]["angle"], row["gnf"]["angle"])
        self.assertEqual(rows[0]["bars"], [["angle", False], ["angle one way", False], ["rms", False], ["volume", True]])
        self.assertEqual(rows[1]["bars"], [["angle", False], ["angle one way", False], ["rms", False]])
        self.assertIsNone(rows[1]["ours"]["drift"])
        self.assertIn("| tgv_kinect_pyramid (open) |", done.stdout)
        self.assertIn("Bars met: angle 0 of 2, angle one way 0 of 2, rms 0 of 2, volume 1 of 1; all of a row's: 0 of 2.", done.stdout)
        self.assertIn("guided_nicolo02 is left out", done.stderr)

    def test_an_oracle_meets_angle_and_rms_and_is_judged_by_the_input_volume(self):
        done, rows = self.run_script(command=f"{PYTHON} {self.root / 'oracle.py'} {{in}} {{out}}")
        for row in rows:
            self.assertLess(row["ours"]["rms"], 1e-12)
            self.assertEqual(dict(row["bars"])["angle"], True)
        drift = rows[0]["ours"]["input_drift"]
        self.assertAlmostEqual(drift, -100 * rows[0]["noisy"]["drift"] / (100 + rows[0]["noisy"]["drift"]), places=9)
        self.assertEqual(dict(rows[0]["bars"])["volume"], abs(drift) <= 0.1)
        self.assertEqual(done.returncode, 0 if abs(drift) <= 0.1 else 1)

    def test_others_can_be_measured_alone(self):
        done, rows = self.run_script("--no-run", "--only", "block")
        self.assertEqual((done.returncode, rows[0]["bars"]), (0, []))
        self.assertIn(" | - | - | - | - |", done.stdout)
        self.assertIn("Nothing of ours was run.", done.stdout)

    def test_a_failure_stands_in_the_row(self):
        done, rows = self.run_script("--only", "block", command=f"{PYTHON} -c 'import sys; sys.exit(\"no luck\")' {{in}} {{out}}")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(rows[0]["bars"], [["a result", False]])
        self.assertIn("| exit 1: no luck |", done.stdout)

    def test_results_without_facets_are_none_and_no_path_gets_into_a_document(self):
        done, rows = self.run_script("--only", "block", command="sh -c 'head -c 84 /dev/zero > {out}'")
        self.assertEqual(rows[0]["bars"], [["a result", False]])
        self.assertIn("| holds no facets (binary STL) |", done.stdout)
        self.assertNotIn(str(self.root), done.stdout)

    def test_the_program_gets_the_preset_and_keeps_openings_of_open_truths(self):
        fake = self.root / "fake"
        fake.write_text(f"#!/bin/sh\necho \"$@\" >> {self.root}/calls\ncp \"$1\" \"$3\"\n")
        fake.chmod(0o755)
        self.run_script("--burnish", fake, "--measure", BURNISH, "--preset", "--smooth 7", "--floor", "--", "--cell", "3", command=None)
        calls = [line.split()[3:] for line in (self.root / "calls").read_text().splitlines()]
        self.assertEqual(calls, [["--overwrite", "--smooth", "7", "--cell", "3"], ["--overwrite", "--method", "levelset", "--cell", "3"],
                                 ["--overwrite", "--smooth", "7", "--keep-openings", "--cell", "3"],
                                 ["--overwrite", "--method", "levelset", "--keep-openings", "--cell", "3"]])

    def test_other_sections(self):
        self.stl("data/common/spot.stl", torus())
        shutil.copy(self.root / "data/b_scan_noise/guided_block04_noisy.stl", self.root / "data/b_scan_noise/guided_real_iron.stl")
        doc = self.root / "doc.md"
        doc.write_text(DOC)
        done, rows = self.run_script("--sections", "dirty,made,clean,scans", "--doc", doc)
        self.assertEqual(done.returncode, 0, done.stderr)
        by_section = {}
        for row in rows:
            by_section.setdefault(row["section"], []).append(row)
        self.assertEqual([len(by_section[s]) for s in ("dirty", "made", "clean", "scans")], [6, 4, 2, 1])
        for row in by_section["made"]:
            self.assertLess(row["from_input"]["max"], 1e-5)
            self.assertTrue(2 < row["from_truth"] < 5, row["from_truth"])
        self.assertLess(by_section["clean"][0]["ours"]["rms"], 1e-12)
        before, after = by_section["scans"][0]["roughness"]
        self.assertEqual(before, after)
        self.assertIn("| guided_real_iron |", doc.read_text())
        self.assertIn("old", doc.read_text())

    def test_peers_with_one_setting_and_the_best_of_some(self):
        programs = self.root / "bin"
        programs.mkdir()
        (programs / "meshlabserver").write_text(MESHLABSERVER)
        vdb = programs / "openvdb_smooth"  # as good as the bars' second best, but only with 30 steps
        vdb.write_text(f"#!/bin/sh\ncase \"$*\" in *'--iterations 30'*) cp {self.root}/data/denoise/peers/guided_block04-gnf.stl \"$2\";; "
                       "*) cp \"$1\" \"$2\";; esac\n")
        for file in programs.iterdir():
            file.chmod(0o755)
        options = ("--peers", "--openvdb", vdb, "--only", "block")
        environment = {"PATH": f"{programs}:{os.environ['PATH']}", "DISPLAY": ":0"}
        done, rows = self.run_script(*options, **environment)
        lines = [line.split(" | ") for line in done.stdout.splitlines() if "MeshLab" in line or "OpenVDB" in line or "best of" in line]
        self.assertEqual(len(lines), 2 * (len(table.MESHLAB) + len(table.OPENVDB)))
        curvature = next(i for i, line in enumerate(lines) if "mean curvature" in line[0])
        self.assertEqual(lines[curvature][3].strip(" |"), table.short(rows[0]["noisy"]))
        self.assertEqual(lines[curvature + 1][3].strip(" |"), f"{table.short(rows[0]['gnf'])} (30 steps, 0.5 edges)")
        shutil.rmtree(programs)  # nothing is run twice
        (programs).mkdir()
        vdb.touch()
        again, _ = self.run_script(*options, **{**environment, "PATH": os.environ["PATH"]})
        self.assertIn("| OpenVDB mean curvature |", again.stdout)


class Usage(unittest.TestCase):
    @unittest.skipIf(numpy is None, "there is no numpy (Debian: python3-numpy)")
    def test_without_data_it_is_skipped(self):
        done = subprocess.run([PYTHON, SCRIPT, "/nonexistent"], text=True, capture_output=True)
        self.assertEqual((done.returncode, done.stdout.split(":")[0]), (0, "skipped"))

    @unittest.skipIf(numpy is None, "there is no numpy (Debian: python3-numpy)")
    def test_sections_have_names(self):
        done = subprocess.run([PYTHON, SCRIPT, "--sections", "pears"], text=True, capture_output=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("no such section: pears", done.stderr)


if __name__ == "__main__":
    unittest.main()
