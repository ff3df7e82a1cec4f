"""The judge of scripts/evaluate tells shapes apart whose verdict is known; its program is the argument."""
import json
import math
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

JUDGE = sys.argv.pop(1)
QUADS = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def cube(low=(0, 0, 0), size=1):
    """Twelve outward facets of a cube, as triples of points."""
    corners = [tuple(low[k] + size * (i >> k & 1) for k in range(3)) for i in range(8)]
    return [tuple(corners[i] for i in facet) for a, b, c, d in QUADS for facet in ((a, b, c), (a, c, d))]


def turned(facets):
    return [(a, c, b) for a, b, c in facets]


def binary(facets, header=b"", count=None, behind=b""):
    records = (struct.pack("<12fH", 0, 0, 0, *(x for point in facet for x in point), 0) for facet in facets)
    count = struct.pack("<I", len(facets) if count is None else count)
    return header.ljust(80, b" ") + count + b"".join(records) + behind


def ascii(facets, end="\n", case=str):
    lines = ["solid a b"]
    for facet in facets:
        corners = ("vertex %g %g %g" % point for point in facet)
        lines += ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
    return case(end.join([*lines, "endsolid a b", ""])).encode()


class Judge(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)

    def run_judge(self, *arguments):
        return subprocess.run([JUDGE, *map(str, arguments)], capture_output=True, text=True)

    def judge(self, output, source=None, *options):
        """What the judge says of the facets (or bytes) `output`, made from `source` or itself."""
        files = []
        for name, content in (("in.stl", source or output), ("out.stl", output)):
            files.append(self.root / name)
            files[-1].write_bytes(content if isinstance(content, bytes) else binary(content))
        run = self.run_judge(*files, *options)
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(run.stdout)

    def assert_output(self, output, **expected):
        found = self.judge(output)["output"]
        self.assertEqual({key: found[key] for key in expected}, expected)

    def test_cube_is_valid(self):
        self.assert_output(cube(size=2), valid=True, closed=True, two_manifold=True, oriented=True,
                           self_intersections=0, bounds_volume=True, volume=8, area=24, valid_sheet=False, open_edges=0, open_loops=0,
                           facets=12, points=8, components=1)

    def test_missing_facet_makes_a_sheet(self):
        self.assert_output(cube()[1:], valid=False, closed=False, two_manifold=False, oriented=True,
                           bounds_volume=False, valid_sheet=True, open_edges=3, open_loops=1)

    def test_overlapping_cubes_intersect(self):
        found = self.judge(cube() + cube((0.5, 0.4, 0.3)))["output"]
        self.assertGreater(found["self_intersections"], 0)
        self.assertEqual((found["two_manifold"], found["bounds_volume"], found["valid"]), (True, False, False))

    def test_nesting_needs_alternating_orientation(self):
        inner = cube((0.25, 0.25, 0.25), 0.5)
        self.assert_output(cube() + inner, self_intersections=0, bounds_volume=False, valid=False, components=2)
        self.assert_output(cube() + turned(inner), self_intersections=0, bounds_volume=True, valid=True, volume=0.875)

    def test_inside_out_is_not_valid(self):
        self.assert_output(turned(cube()), closed=True, oriented=True, volume=-1, valid=False)

    def test_flipped_facet_is_misoriented(self):
        facets = cube()
        self.assert_output(turned(facets[:1]) + facets[1:], oriented=False, misoriented_edges=3, closed=True,
                           two_manifold=True, self_intersections=0, valid=False)

    def test_touching_cubes_are_not_manifold(self):
        self.assert_output(cube() + cube((1, 1, 1)), non_manifold_points=1, two_manifold=False, valid=False)
        self.assert_output(cube() + cube((1, 1, 0)), non_manifold_edges=1, two_manifold=False, valid=False)

    def test_facets_without_area_are_not_valid(self):
        a, b, c = cube()[0]
        middle = tuple((p + q) / 2 for p, q in zip(a, b))
        split = [(a, middle, c), (middle, b, c), (a, b, middle), *cube()[1:]]
        self.assert_output(split, two_manifold=True, valid=False)
        self.assert_output([*cube(), (a, a, b)], two_manifold=False, repeating_facets=1, valid=False)

    def test_distances_go_both_ways(self):
        found = self.judge(cube(), cube() + cube((5, 0, 0)), "--cell", "0.5")
        there, back = found["input_to_output"], found["output_to_input"]
        self.assertEqual((back["rms"], back["max"], back["far_share"]), (0, 0, 0))
        self.assertAlmostEqual(there["max"], 5, places=9)  # from the far cube's far side
        self.assertAlmostEqual(there["far_share"], 0.5, places=3)
        # Squared distances of the far cube: 4^2 and 5^2 on two faces, 61/3 on the mean of the other four.
        self.assertAlmostEqual(there["rms"], math.sqrt((16 + 25 + 4 * 61 / 3) / 12), places=2)
        self.assertAlmostEqual(there["max_percent"], 100 * 5 / math.sqrt(38), places=6)
        self.assertEqual((found["input"]["components"], found["output"]["components"]), (2, 1))

    def test_any_stl_is_read(self):
        facets = cube()
        for content in (ascii(facets), ascii(facets, "\r"), ascii(facets, "\r\n", str.upper),
                        binary(facets, b"solid x"), binary(facets, count=0), binary(facets, count=7), binary(facets, count=4000),
                        binary(facets, behind=b"abc")):
            found = self.judge(facets, content)
            self.assertEqual((found["input"]["facets"], found["output_to_input"]["max"]), (12, 0), content[:90])

    def test_what_cannot_be_read_is_said(self):
        found = self.judge(cube(), b"solid nothing\nendsolid\n")
        self.assertEqual((found["input"]["facets"], found["input_to_output"]["rms"]), (0, None))
        found = self.judge(cube(), ascii([*cube(), ((0, 0, 0), (1, 0, 0), (math.nan, 0, 0))]))
        self.assertEqual((found["input"]["facets"], found["input"]["facets_left_out"]), (12, 1))
        self.assertEqual(self.run_judge(self.root / "in.stl", self.root / "missing.stl").returncode, 1)
        self.assertEqual(self.run_judge(self.root / "in.stl").returncode, 2)


if __name__ == "__main__":
    unittest.main()
