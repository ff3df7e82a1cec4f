#!/usr/bin/env python3
"""scripts/check_errors: the project's own tree passes, and each kind of violation is told with what to do."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True  # the source tree stays as it is
sys.path.insert(0, str(ROOT / "tests" / "cli"))
import error_cases  # noqa: E402  (its folder has to be on the path)
import named_tests  # noqa: E402

ROW = "| 3 | `` {}: no {} in the file `` | a cause | a way out |\n"
SOURCE = 'throw Error(ErrorCode::unreadable_input, fmt::format("{}: no {:.3g} " "in the file", path, x), "hint");\n'


def check(source=SOURCE, catalogue=ROW):
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        (root / "src/io").mkdir(parents=True)
        (root / "docs").mkdir()
        (root / "src/io/a.cpp").write_text(source)
        (root / "docs/errors.md").write_text(catalogue)
        done = subprocess.run([sys.executable, ROOT / "scripts/check_errors", "--root", root], capture_output=True, text=True)
        return done.returncode, done.stdout


class CheckErrors(unittest.TestCase):
    def test_the_project_passes(self):
        done = subprocess.run([sys.executable, ROOT / "scripts/check_errors"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_what_is_listed_passes(self):
        self.assertEqual(check(), (0, "1 messages, all listed in docs/errors.md\n"))

    def test_a_new_message_is_told_with_its_row(self):
        code, out = check(catalogue="")
        self.assertEqual(code, 1)
        self.assertIn("src/io/a.cpp:1: not in docs/errors.md", out)
        self.assertIn("| 3 | `` {}: no {} in the file `` | what causes it | what the user can do |", out)
        self.assertIn("tests/cli/error_cases.py", out)

    def test_a_message_that_is_gone_is_told(self):
        code, out = check(source="")
        self.assertEqual((code, out.split(":")[:2]), (1, ["docs/errors.md", "1"]))
        self.assertIn("no source prints this any more", out)

    def test_another_exit_code_is_told(self):
        code, out = check(source=SOURCE.replace("unreadable_input", "usage"))
        self.assertEqual(code, 1)
        self.assertIn("ends with 2, but docs/errors.md:1 says 3", out)

    def test_both_branches_of_a_choice_and_warnings_are_read(self):
        code, out = check('warnings.push_back(is_a ? "the first text" : "the " + name + " second text");\n', "")
        self.assertIn("`` the first text ``", out)
        self.assertIn("| - | `` the {} second text ``", out)

    def test_notes_that_become_warnings_are_read(self):
        self.assertIn("| - | `` {} cells are left out ``", check('result_.notes.push_back(fmt::format("{} cells are left out", n));\n', "")[1])

    def test_comments_are_not_read(self):
        self.assertEqual(check(SOURCE + '// throw Error(ErrorCode::usage, "no such thing at all");\n')[0], 0)

    def test_a_row_needs_cause_and_way_out(self):
        code, out = check(catalogue=ROW.replace("a cause", " "))
        self.assertIn("needs a cause and a way out", out)


class EveryRowIsProvoked(unittest.TestCase):
    """What tests/cli/error_cases.py looks at (cli.errors runs it on the program)."""
    ROWS = [("3", "no {} in the file", 7, True), ("-", "left out {}", 8, True)]

    def test_a_row_that_nothing_printed_is_told(self):
        self.assertEqual(list(error_cases.unprovoked(self.ROWS, [(3, "burnish: a.stl: no facets in the file")])), [("-", "left out {}", 8)])

    def test_another_exit_code_does_not_count(self):
        left = list(error_cases.unprovoked(self.ROWS, [(2, "no facets in the file"), (0, "left out 3")]))
        self.assertEqual(left, [("3", "no {} in the file", 7)])

    def test_a_named_test_has_to_hold_a_piece_that_is_of_no_other_message(self):
        for body, fine in (('expect("no 12 in the file")', True), ('expect("in the file of")', False), ('expect("out of the blue")', False), ('expect("in")', False)):
            self.assertEqual(bool(named_tests.asserts(body, "no {} in the file", {"a word in the file of"})), fine, body)

    def test_errors_without_a_hint_are_told(self):
        self.assertTrue(error_cases.lacks_hint(3, "burnish: a.stl: is empty (0 bytes)\n"))
        self.assertFalse(error_cases.lacks_hint(3, "burnish: a.stl: is empty (0 bytes)\n  hint: export it again\n"))
        self.assertFalse(error_cases.lacks_hint(0, "burnish: warning: a.stl: left out 3\n"))


if __name__ == "__main__":
    unittest.main()
