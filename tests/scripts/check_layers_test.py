"""check_layers finds each kind of violation, names its place, and is content without any."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "check_layers"


class CheckLayers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.write("docs/theory.md", "**[T-DIST-1]** The distance.\n")
        self.write("include/burnish/surface/inspect.h", '#include "burnish/core/vec.h"\n// [T-DIST-1]\n')
        self.write("include/burnish/pipeline/check.h", '#include "burnish/surface/inspect.h"\n')

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def check(self):
        return subprocess.run([sys.executable, SCRIPT, "--root", self.root], capture_output=True, text=True)

    def assert_found(self, *expected):
        result = self.check()
        self.assertEqual(result.stdout.splitlines(), list(expected))
        self.assertEqual(result.returncode, 1 if expected else 0)

    def test_allowed_includes(self):
        self.write("src/levelset/sign.cpp", '#include "burnish/octree/octree.h"\n#include <vector>\n// [T-DIST-1]\n')
        self.write("src/io/stl.cpp", '#include "burnish/surface/triangle_soup.h"\n#include <fstream>\n')
        self.write("src/cli/main.cpp", '#include "burnish/surface/inspect.h"\n#include <iostream>\n')
        self.write("src/core/parallel.cpp", "#include <tbb/parallel_for.h>\n")
        self.assert_found()

    def test_include_against_the_direction(self):
        self.write("src/octree/grow.cpp", '\n#include "burnish/levelset/sign.h"\n')
        self.write("src/surface/weld.cpp", '#include "burnish/io/mesh_io.h"\n')
        self.write("src/io/stl.cpp", '#include "burnish/surface/weld.h"\n')
        self.write("src/pipeline/clean.cpp", '#include "burnish/cli/help.h"\n')
        self.write("src/cli/main.cpp", '#include "burnish/octree/octree.h"\n')
        self.assert_found("src/cli/main.cpp:1: cli may not include octree/octree.h",
                          "src/io/stl.cpp:1: io may not include surface/weld.h",
                          "src/octree/grow.cpp:2: octree may not include levelset/sign.h",
                          "src/pipeline/clean.cpp:1: pipeline may not include cli/help.h",
                          "src/surface/weld.cpp:1: surface may not include io/mesh_io.h")

    def test_private_headers_have_layers_too(self):
        self.write("src/levelset/stencil_detail.h", "")
        self.write("src/octree/a.cpp", '#include "../levelset/stencil_detail.h"\n')
        self.write("src/octree/b.cpp", '#include "levelset/stencil_detail.h"\n')
        self.assert_found("src/octree/a.cpp:1: octree may not include levelset/stencil_detail.h",
                          "src/octree/b.cpp:1: octree may not include levelset/stencil_detail.h")

    def test_python_sees_options_and_no_command(self):
        self.write("src/cli/clean_options.h", "\n")
        self.write("src/cli/console.h", "\n")
        self.write("include/burnish/surface/weld.h", "\n")
        self.write("include/burnish/surface/remesh.h", "\n")
        self.write("src/python/run.cpp", '#include "burnish/surface/weld.h"\n#include "cli/clean_options.h"\n#include "cli/console.h"\n#include "burnish/surface/remesh.h"\n')
        self.write("src/pipeline/clean.cpp", '#include "python/run.h"\n')
        self.write("src/python/run.h", "\n")
        self.assert_found("src/pipeline/clean.cpp:1: pipeline may not include python/run.h",
                          "src/python/run.cpp:3: python may not include cli/console.h",
                          "src/python/run.cpp:4: python may not include surface/remesh.h")

    def test_foreign_headers(self):
        self.write("include/burnish/octree/octree.h", "#include <CGAL/Bbox_3.h>\n#include <fmt/core.h>\nCGAL::Bbox_3 b;\n")
        self.write("src/octree/octree.cpp", "#include <tbb/parallel_for.h>\n#include <iostream>\n")
        only = "only the standard library, Eigen and burnish/"
        self.assert_found("include/burnish/octree/octree.h:1: a public header includes <CGAL/Bbox_3.h>",
                          f"include/burnish/octree/octree.h:2: a public header includes <fmt/core.h>: {only}",
                          "include/burnish/octree/octree.h:3: a type of CGAL in a public header",
                          "src/octree/octree.cpp:1: only src/core/parallel.cpp includes TBB",
                          "src/octree/octree.cpp:2: octree may not include <iostream>: only io and cli touch streams")

    def test_sizes_and_tags(self):
        self.write("include/burnish/core/long.h", "\n" * 250)
        self.write("src/core/long.cpp", "\n" * 500)
        self.write("src/core/fits.cpp", "\n" * 499)
        self.write("src/levelset/sign.cpp", "// [T-DIST-1], [T-SIGN-9]\n")
        self.assert_found("include/burnish/core/long.h:250: 250 lines; below 250 is the limit",
                          "src/core/long.cpp:500: 500 lines; below 500 is the limit",
                          "src/levelset/sign.cpp:1: [T-SIGN-9] is not in docs/theory.md")

    def test_definitions_of_tags(self):
        self.write("docs/theory.md", "**[T-DIST-1]** As in [T-SIGN-2].\n\n**[T-SIGN-1]** Sides.\n**[T-DIST-1]** Again.\n")
        self.write("tests/unit/sign_test.cpp", "// [T-SIGN-1]\n")
        self.write("src/levelset/sign.cpp", "// [T-SIGN-2]\n")
        self.assert_found("src/levelset/sign.cpp:1: [T-SIGN-2] is not in docs/theory.md",
                          "docs/theory.md:3: [T-SIGN-1] is cited by no source",
                          "docs/theory.md:4: [T-DIST-1] is defined twice")

    def test_nothing_to_check_is_a_failure(self):
        with tempfile.TemporaryDirectory() as empty:
            self.root = Path(empty)
            self.assertEqual(self.check().returncode, 1)


if __name__ == "__main__":
    unittest.main()
