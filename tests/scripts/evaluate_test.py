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
what = open(sys.argv[1]).read()
output, report = sys.argv[sys.argv.index("-o") + 1], sys.argv[sys.argv.index("--report") + 1]
def write(text, rms=0.05, volume=1.0):
    open(output, "w").write(text)
    side = {{"rms": rms * 2, "max": 1.0}}
    json.dump({{"output": {{"verified": True}}, "options": {{"cell": 2.0}}, "before": {{"facets": 12}},
               "after": {{"facets": 34, "volume": volume}},
               "deviation": {{"output_to_input": side, "input_to_output": side}}}}, open(report, "w"))
if what == "good": write("valid")
if what == "far": write("valid", rms=0.2)
if what == "shrunk": write("valid", volume=0.9)
if what == "lies": write("broken")
if what == "silent": sys.exit(5)
if what == "refuses": print("burnish: bounds no solid", file=sys.stderr); sys.exit(5)
if what == "keeps": write("valid"); print("burnish: no", file=sys.stderr); sys.exit(5)
if what == "crashes": os.abort()
if what == "bug": sys.exit(70)
if what == "hangs": time.sleep(60)
if what == "litters": write("valid"); open(os.path.join(os.path.dirname(output), ".a.tmp"), "w")
"""


class Evaluate(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.program = self.root / "burnish"
        self.program.write_text(PROGRAM.format(python=sys.executable))
        self.program.chmod(0o755)

    def evaluate(self, *models):
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
                              lines, "-j", "4"], capture_output=True, text=True)
        results = [json.loads(line) for line in lines.read_text().splitlines()]
        return run.returncode, run.stdout + run.stderr, {r["name"]: r for r in results}

    def test_good_runs_meet_every_bar(self):
        code, text, results = self.evaluate(("good", "valid solid", "1.001"), ("refuses", "sheet", ""))
        self.assertEqual(code, 0, text)
        self.assertEqual(results["good"]["verdict"], "valid")
        self.assertAlmostEqual(results["good"]["out_in_rms"], 0.05)
        self.assertAlmostEqual(results["good"]["volume_ratio"], 1 / 1.001)
        self.assertIn("refuses: sheet: exit 5: burnish: bounds no solid", text)
        self.assertNotIn("MISSED", text)

    def test_each_misbehaviour_has_its_verdict(self):
        expected = {"lies": "untruthful", "keeps": "untruthful", "silent": "untruthful", "litters": "untruthful",
                    "crashes": "crash", "bug": "crash", "hangs": "hang", "refuses": "refused"}
        code, text, results = self.evaluate(*((name, "solid", "") for name in expected))
        self.assertEqual(code, 1)
        self.assertEqual({name: r["verdict"] for name, r in results.items()}, expected)
        self.assertIn("exit 0, but the written file is not valid: 3 open_edges", text)
        self.assertIn("MISSED valid among solids: 0 of 8", text)

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
