#!/usr/bin/env python3
"""Tests of the command line, with Python's standard library alone (the schemas: python3-jsonschema).

  tests/cli/run.py --program build/dev/bin/burnish [--group NAME] [--match TEXT]

A test is either a row of cases.py (these arguments, this exit code, these regular expressions) or a
function of scenarios.py. Every test has a fresh folder with the files of models.fixtures(). Exits 1 if
one fails.
"""
import argparse
import sys
import traceback
from pathlib import Path

sys.dont_write_bytecode = True  # the source tree stays as it is
import batch_scenarios  # noqa: F401  (adds to the groups of scenarios)
import cases
import completion_scenarios  # noqa: F401  (adds to the groups of scenarios)
import config_scenarios  # noqa: F401  (adds to the groups of scenarios)
import curvature_scenarios  # noqa: F401  (adds to the groups of scenarios)
import error_cases
import field_scenarios  # noqa: F401  (adds to the groups of scenarios)
import ic_scenarios  # noqa: F401  (adds to the groups of scenarios)
import inspection_scenarios  # noqa: F401  (adds to the groups of scenarios)
import mesh_scenarios  # noqa: F401  (adds to the groups of scenarios)
import runner
import scenarios
import smoothing_scenarios  # noqa: F401  (adds to the groups of scenarios)
import surface_scenarios  # noqa: F401
import volume_scenarios  # noqa: F401


def scenario_test(function):
    def run(program):
        with runner.Sandbox(program) as box:
            function(box)
    return run


def all_tests():
    """(group, name, function of the program's path), in order."""
    for group, rows in cases.GROUPS.items():
        for case in rows:
            yield group, case.name(), lambda program, case=case: runner.run_case(case, program)
    for group, functions in scenarios.GROUPS.items():
        for function in functions:
            yield group, function.__name__, scenario_test(function)
    for name, test in error_cases.tests():
        yield "errors", name, test


def passes(name, test, program):
    try:
        test(program)
    except runner.Failed as failure:
        print(f"FAILED  {name}\n        " + str(failure).replace("\n", "\n        "))
        return False
    except Exception:  # a bug of the test itself is to be seen with its place
        print(f"FAILED  {name}\n{traceback.format_exc()}")
        return False
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, required=True, help="the burnish to test")
    parser.add_argument("--group", help="run this group only")
    parser.add_argument("--match", default="", help="run only tests whose name holds this text")
    parser.add_argument("--list-groups", action="store_true")
    options = parser.parse_args()
    if options.list_groups:
        print("\n".join({**cases.GROUPS, **scenarios.GROUPS}))
        return 0
    program = options.program.resolve()
    chosen = [(name, test) for group, name, test in all_tests()
              if options.group in (None, group) and options.match in name]
    failed = sum(not passes(name, test, program) for name, test in chosen)
    print(f"{len(chosen) - failed} of {len(chosen)} passed")
    return 1 if failed or not chosen else 0


if __name__ == "__main__":
    sys.exit(main())
