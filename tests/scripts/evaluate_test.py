"""evaluate judges a make-believe program: each kind of misbehaviour is caught and named."""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "evaluate"

# Does what the content of the input file tells it to; `check` believes files that say "valid".
PROGRAM = """#!{python}
import json, os, sys, time
if sys.argv[1] == "check":
    valid = open(sys.argv[-1]).read() == "valid"
    print(json.dumps({{"open_edges": 0 if valid else 3}}))
    sys.exit(0 if valid else 1)
if sys.argv[1] == "--help":
    print("--keep-openings")
    sys.exit(0)
what = open(sys.argv[1]).read()
output, report = sys.argv[sys.argv.index("-o") + 1], sys.argv[sys.argv.index("--report") + 1]
def write(text, rms=0.05, volume=1.0, far=1.0, cell=2.0, **more):
    open(output, "w").write(text)
    side = {{"rms": rms * 2, "max": far}}
    json.dump({{"output": {{"verified": True}}, "options": {{"cell": cell}},
               "before": {{"facets": 12, "area": 10.0, "box": {{"diagonal": 1000.0}}}},
               "after": {{"facets": 34, "volume": volume}},
               "deviation": {{"output_to_input": side, "input_to_output": side}}, **more}}, open(report, "w"))
if what == "good": write("valid")
if what == "far": write("valid", rms=0.2)
if what == "shrunk": write("valid", volume=0.9)
if what == "moved": write("valid", method="local", cell=None)
if what == "mended": write("valid", rms=0, far=0, method="local", cell=None)
if what == "far_off": write("valid", rms=6, far=9)
if what == "loses": write("valid", far=9)
if what == "admits": write("valid", far=9, losses={{"count": 1, "largest": [{{"area": 0.02, "reason": "thin"}}]}})
if what == "drops": write("valid", far=9, losses={{"count": 1, "largest": [{{"area": 5, "reason": "thin"}}]}})
if what == "closes": write("valid")
if what == "warns": write("valid", warnings=["capped"])
if what == "sheet" and "--keep-openings" in sys.argv: write("sheet")
elif what in ("sheet", "refuses"): print("burnish: bounds no solid", file=sys.stderr); sys.exit(5)
if what == "riddle": write("riddle")
if what == "closes": print("reading 0.00 s", file=sys.stderr)
if what == "lies": write("broken")
if what == "silent": sys.exit(5)
if what == "keeps": write("valid"); print("burnish: no", file=sys.stderr); sys.exit(5)
if what == "crashes": os.abort()
if what == "bug": sys.exit(70)
if what == "hangs": time.sleep(60)
if what == "litters": write("valid"); open(os.path.join(os.path.dirname(output), ".a.tmp"), "w")
"""


# Believes outputs that say "valid" and "sheet", and finds everything one unit away.
JUDGE = """#!{python}
import json, sys
text = open(sys.argv[2]).read()
if text == "riddle": sys.exit("cannot tell")
side = {{"rms": 1.0, "max": 1.0, "far_share": 0.25}}
print(json.dumps({{"input": {{"diagonal": 50.0, "area": 10.0}},
                  "output": {{"valid": text == "valid", "valid_sheet": text == "sheet", "volume": 3.0,
                             "open_edges": 0 if text == "valid" else 4}},
                  "input_to_output": side, "output_to_input": side}}))
"""


class Evaluate(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.program, self.judge = self.root / "burnish", self.root / "judge"
        for file, text in ((self.program, PROGRAM), (self.judge, JUDGE)):
            file.write_text(text.format(python=sys.executable))
            file.chmod(0o755)

    def evaluate(self, *models, options=("--judge", "none"), path=None):
        """Runs the script over models (content, expect, volume_ref); returns exit code, text, results."""
        data = self.root / "data"
        (data / "a").mkdir(parents=True)
        rows = ["name\tclass\texpect\tvolume_ref"]
        for content, expect, volume in models:
            (data / "a" / f"{content}.stl").write_text(content)
            rows.append(f"{content}\ta\t{expect}\t{volume}")
        (data / "MANIFEST.tsv").write_text("\n".join(rows) + "\n")
        lines = self.root / "results.jsonl"
        run = subprocess.run([sys.executable, SCRIPT, data, "--program", self.program, "--timeout", "5", "--jsonl",
                              lines, "-j", "4", *options], capture_output=True, text=True,
                             env={**os.environ, "PATH": path or os.environ["PATH"]})
        results = [json.loads(line) for line in lines.read_text().splitlines()]
        return run.returncode, run.stdout + run.stderr, {r["name"]: r for r in results}

    def test_good_runs_meet_every_bar(self):
        code, text, results = self.evaluate(("good", "valid solid", "1.001"), ("refuses", "unclear", ""))
        self.assertEqual(code, 0, text)
        self.assertEqual(results["good"]["verdict"], "valid")
        self.assertAlmostEqual(results["good"]["out_in_rms"], 0.05)
        self.assertAlmostEqual(results["good"]["volume_ratio"], 1 / 1.001)
        self.assertIn("refuses: unclear: exit 5: burnish: bounds no solid", text)
        self.assertNotIn("MISSED", text)

    def test_each_misbehaviour_has_its_verdict(self):
        expected = {"lies": "untruthful", "keeps": "untruthful", "silent": "untruthful", "litters": "untruthful",
                    "crashes": "crash", "bug": "crash", "hangs": "hang", "refuses": "refused"}
        code, text, results = self.evaluate(*((name, "solid", "") for name in expected))
        self.assertEqual(code, 1)
        self.assertEqual({name: r["verdict"] for name, r in results.items()}, expected)
        self.assertIn("exit 0, but the written file is not valid: 3 open_edges", text)
        self.assertIn("MISSED valid among solids: 0 of 8", text)

    def test_the_judge_has_the_last_word(self):
        options = ("--judge", self.judge)
        _, text, results = self.evaluate(("good", "solid", "3.1"), ("lies", "solid", ""), options=options)
        self.assertIn("judged by burnish_judge", text)
        self.assertIn("exit 0, but the written file is not valid: 4 open_edges", text)
        self.assertAlmostEqual(results["good"]["out_in_rms"], 0.5)  # cells
        self.assertAlmostEqual(results["good"]["out_in_rms_percent"], 2)
        self.assertAlmostEqual(results["good"]["volume_ratio"], 3 / 3.1)
        self.assertEqual(results["good"]["not_usable_because"], ["input -> output rms 2.00 % of the diagonal"])
        self.assertIn("good (solid, levelset): input -> output rms 2.00 % of the diagonal", text)

    def test_a_missing_judge_is_said(self):
        _, text, results = self.evaluate(("good", "solid", ""), options=("--judge", self.root / "nobody"))
        self.assertIn("no judge: the judgement is the program's own", text)
        self.assertEqual(results["good"]["verdict"], "valid")

    def test_no_judgement_is_no_accusation(self):
        _, text, results = self.evaluate(("riddle", "solid", ""), options=("--judge", self.judge))
        self.assertEqual(results["riddle"]["verdict"], "unjudged")
        self.assertEqual(results["riddle"]["failures"], ["the judge failed: cannot tell"])
        self.assertIn("MISSED results without a judgement: 1", text)

    def test_usable_is_more_than_valid(self):
        _, text, results = self.evaluate(("far_off", "solid", ""), ("shrunk", "solid", "1.3"), ("lies", "solid", ""),
                                         ("good", "solid", "1.1"))
        usable = {name: (r["verdict"] == "valid", r["usable"]) for name, r in results.items()}
        self.assertEqual(usable, {"far_off": (True, False), "shrunk": (True, False), "lies": (False, False),
                                  "good": (True, True)})
        self.assertEqual(results["far_off"]["not_usable_because"], ["input -> output rms 1.20 % of the diagonal"])
        self.assertEqual(results["shrunk"]["not_usable_because"], ["volume ratio 0.6923"])
        self.assertIn("MISSED usable among solids: 1 of 4", text)

    def test_losses_are_listed_or_missed(self):
        _, text, results = self.evaluate(("loses", "solid", ""), ("admits", "solid", ""))
        self.assertIn("MISSED within 1.5 cells of their input, or lost parts listed: 1 of 2", text)
        self.assertIn("loses: none listed, and yet up to 4.5 cells", text)
        self.assertIn("admits: 1 listed, 0.2 % of the area lost, 0 % inside the solid: thin", text)
        self.assertIn("met    area of listed parts, mean over the solids, < 0.5 %: 0.100 %", text)

    def test_listed_losses_are_bounded(self):
        _, text, results = self.evaluate(("drops", "solid", ""), ("good", "solid", ""))
        self.assertAlmostEqual(results["drops"]["listed_loss"], 0.5)
        self.assertIn("MISSED area of listed parts, mean over the solids, < 0.5 %: 25.000 %", text)

    def test_the_local_gear_changes_nothing(self):
        _, text, results = self.evaluate(("moved", "valid solid", ""), ("mended", "valid solid", ""))
        self.assertEqual(results["mended"]["quality_failures"], [])
        self.assertEqual(results["moved"]["quality_failures"], ["out_in_max_percent 0.1 % > 1e-07"])
        self.assertAlmostEqual(results["moved"]["out_in_max"], 1)  # thousandths of the diagonal
        self.assertIn("CPU where the local gear served (2 of 2", text)

    def test_sheets_are_told_of_and_kept(self):
        _, text, results = self.evaluate(("closes", "sheet", ""), ("warns", "sheet", ""), ("sheet", "sheet", ""),
                                         ("refuses", "sheet", ""), options=("--judge", self.judge))
        self.assertIn("MISSED sheets refused, or closed with a warning: 3 of 4", text)
        self.assertEqual(results["closes"]["failures"], ["a sheet was closed without a warning"])
        self.assertEqual({name: r["keep_openings"]["kept"] for name, r in results.items()},
                         {"closes": True, "warns": True, "sheet": True, "refuses": False})
        self.assertIn("MISSED sheets kept by --keep-openings: 3 of 4", text)
        self.assertIn("      capped", text)

    def test_peers_run_beside(self):
        peer = self.root / "admesh"
        peer.write_text(f"#!{sys.executable}\nimport sys\nopen(sys.argv[2].split('=')[1], 'w').write('broken')\n")
        peer.chmod(0o755)
        _, text, results = self.evaluate(("good", "solid", ""), options=("--judge", self.judge, "--peers"),
                                         path=f"{self.root}:{os.environ['PATH']}")
        self.assertIn("not valid: 4 open_edges", results["good"]["peers"]["admesh"]["not_usable_because"])
        self.assertRegex(text, r"admesh +valid 0 of 1")
        self.assertRegex(text, r"burnish +valid 1 of 1")

    def test_quality_is_asked_of_valid_solids_only(self):
        _, text, results = self.evaluate(("far", "valid solid", ""), ("shrunk", "valid solid", "1"), ("good", "solid", "9"))
        self.assertEqual(results["far"]["quality_failures"], ["out_in_rms 0.2 cells > 0.1"])
        self.assertEqual(results["shrunk"]["quality_failures"], ["volume ratio 0.9"])
        self.assertEqual(results["good"]["quality_failures"], [])
        self.assertIn("0 of 2", text)

    def test_without_data_it_says_skipped(self):
        environment = {**os.environ, "BURNISH_SHARED_DATA": str(self.root / "nothing")}
        run = subprocess.run([sys.executable, SCRIPT], capture_output=True, text=True, env=environment)
        self.assertEqual(run.returncode, 0)
        self.assertTrue(run.stdout.startswith("skipped"))


if __name__ == "__main__":
    unittest.main()
