"""Curvatures of shapes whose curvature is known, as the program reports and VTK reads them; fields from ACCEPTED cells."""
import json
import math
import signal
import subprocess
import time
from pathlib import Path

import models
from field_scenarios import distance_to_unit_cube, read_field
from runner import expect, expect_match
from scenarios import QUICK, expect_valid, scenario

READ_SURFACE = """if True:
    import json, sys
    from vtkmodules import vtkCommonCore
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(sys.argv[1])
    reader.Update()
    surface = reader.GetOutput()
    arrays = surface.GetPointData()
    values = lambda a: [a.GetTuple(i) if a.GetNumberOfComponents() > 1 else a.GetTuple1(i) for i in range(a.GetNumberOfTuples())]
    result = {arrays.GetArrayName(i): values(arrays.GetArray(i)) for i in range(arrays.GetNumberOfArrays())}
    result["points"] = [surface.GetPoint(p) for p in range(surface.GetNumberOfPoints())]
    result["facets"] = surface.GetNumberOfPolys()
    print(json.dumps(result))"""


def read_surface(path):
    """What VTK reads of a .vtp; None without VTK."""
    result = subprocess.run(["/usr/bin/python3", "-c", READ_SURFACE, path], capture_output=True, timeout=240)
    if b"No module named 'vtkmodules'" in result.stderr or not Path("/usr/bin/python3").exists():
        print("  skipped: no VTK (scripts/bootstrap picture)")
        return None
    expect(result.returncode == 0 and not result.stderr, result.stderr.decode())
    return json.loads(result.stdout)


def grid_of(point, n, m):
    """Triangles of a closed grid of n x m points."""
    triangles = []
    for i in range(n):
        for j in range(m):
            a, b, c, d = (point((i + di) % n, (j + dj) % m) for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
            triangles += [(a, b, c), (a, c, d)]
    return triangles


def torus(n=120, m=48, large=1.0, small=0.4):
    def point(i, j):
        u, v = 2 * math.pi * i / n, 2 * math.pi * j / m
        r = large + small * math.cos(v)
        return r * math.cos(u), r * math.sin(u), small * math.sin(v)
    return grid_of(point, n, m)


def sphere(n=24, radius=2.0):
    """A cube's grid, its points moved to the sphere: facets of about one size."""
    triangles = []
    def point(axis, sign, i, j):
        p = [0.0, 0.0, 0.0]
        p[axis] = float(sign)
        p[(axis + 1) % 3], p[(axis + 2) % 3] = (math.tan((2 * k / n - 1) * math.pi / 4) for k in (i, j))
        length = math.sqrt(sum(c * c for c in p))
        return tuple(radius * c / length for c in p)
    for axis in range(3):
        for sign in (-1, 1):
            for i in range(n):
                for j in range(n):
                    a, b, c, d = (point(axis, sign, i + di, j + dj) for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
                    triangles += [(a, b, c), (a, c, d)] if sign > 0 else [(a, c, b), (a, d, c)]
    return triangles


def curvature_of(box, *arguments):
    result = json.loads(box.succeed(["curvature", *arguments, "--json", "-q"]).out)
    expect_valid("curvature.schema.json", result)
    return result


@scenario("curvature")
def a_ball_has_the_curvature_of_a_ball(box):
    box.write("ball.stl", models.binary_stl(sphere()))
    for options in ([], ["--order", "2"], ["--order", "6"], ["--at", "vertices"]):
        result = curvature_of(box, "ball.stl", "--smooth", "0.8", "--cell", "0.06", "--check", "500", *options)
        found = result["curvature"]
        samples = "vertices" in options
        expect(found["determined"] == found["points"] and found["euler_characteristic"] == (None if samples else 2), f"{options}: {found}")
        for key, exact, within in (("mean", 0.5, 0.01), ("k1", 0.5, 0.02), ("k2", 0.5, 0.02), ("gaussian", 0.25, 0.02)):
            for which in ("p1", "p50", "p99", "mean"):
                expect(abs(found[key][which] / exact - 1) < within, f"{options}: {key} {which} {found[key][which]}")
        if not samples:
            expect(abs(found["gaussian_integral"] / (4 * math.pi) - 1) < 0.01, f"{options}: integral {found['gaussian_integral']}")
            expect(abs(found["mean_integral"] / (8 * math.pi) - 1) < 0.01, f"{options}: integral {found['mean_integral']}")
        expect(abs(found["smallest_convex"]["radius"] / 2 - 1) < 0.05 and found["smallest_concave"] is None, f"{options}: radii")
        at = found["smallest_convex"]["position"]
        expect(abs(math.hypot(*at) - 2) < 0.02, f"{options}: {at} is not on the ball")
        check = result["check"]
        expect(check["points"] == 500 and check["max"] < 0.02 and abs(check["rms_curvature"] / 0.5 - 1) < 0.01, f"{options}: check {check}")


@scenario("curvature")
def a_torus_has_the_curvature_of_a_torus(box):
    box.write("torus.stl", models.binary_stl(torus()))
    result = curvature_of(box, "torus.stl", "--smooth", "0.25", "--cell", "0.025", "-o", "t.vtp")
    found = result["curvature"]
    expect(found["euler_characteristic"] == 0 and abs(found["gaussian_integral"]) < 0.02, f"Gauss-Bonnet: {found['gaussian_integral']}")
    expect(abs(found["mean_integral"] / (2 * math.pi ** 2) - 1) < 0.005, f"integral of the mean curvature: {found['mean_integral']}")
    expect(abs(found["smallest_convex"]["radius"] / 0.4 - 1) < 0.05, "tube")
    expect(abs(found["smallest_concave"]["radius"] / 0.6 - 1) < 0.05, "hole")
    read = read_surface(box.folder / "t.vtp")
    if read is None:
        return
    arrays = {"mean_curvature", "gaussian_curvature", "k1", "k2", "direction1", "direction2", "normal", "converged"}
    expect(set(read) == arrays | {"points", "facets"}, f"arrays: {set(read)}")
    expect(len(read["points"]) == found["points"] and read["facets"] == found["facets"], "sizes")
    worst = 0
    for p, mean, k1, k2, d1, normal in zip(*(read[a] for a in ("points", "mean_curvature", "k1", "k2", "direction1", "normal"))):
        around = math.hypot(p[0], p[1])
        out = ((around - 1) * p[0] / around, (around - 1) * p[1] / around, p[2])
        size = math.hypot(*out)
        worst = max(worst, abs(k1 - 1 / 0.4), abs(k2 - (1 - 1 / around) / 0.4))
        expect(abs(mean - (k1 + k2) / 2) < 1e-12, "mean")
        expect(sum(a * b for a, b in zip(normal, out)) / size > 0.995, f"normal {normal} at {p}")
        # The larger curvature is that of the tube, across the circle.
        expect(abs(-p[1] * d1[0] + p[0] * d1[1]) / around < 0.05, f"direction {d1} at {p}")
    expect(worst < 0.12, f"k1 or k2 off by {worst}")


@scenario("curvature")
def the_inputs_vertices_are_where_they_were(box):
    box.write("torus.stl", models.binary_stl(torus(60, 24)))
    result = curvature_of(box, "torus.stl", "--at", "vertices", "--smooth", "0.4", "--cell", "0.05", "-o", "v.vtp")
    expect(result["curvature"]["points"] == 60 * 24 and result["curvature"]["facets"] == 2 * 60 * 24, "sizes")
    read = read_surface(box.folder / "v.vtp")
    if read is None:
        return
    corners = {tuple(models.struct.unpack("<3f", models.struct.pack("<3f", *p))) for t in torus(60, 24) for p in t}
    for p in read["points"]:
        expect(tuple(p) in corners or any(math.dist(p, c) < 1e-6 for c in corners), f"{p} is no vertex")


def shifted(triangles, x):
    return [tuple((p[0] + x, p[1], p[2]) for p in t) for t in triangles]


@scenario("curvature")
def vertices_are_samples_without_integrals(box):
    box.succeed(["example", "sphere", "-q", "-o", "sphere.stl"])
    result = curvature_of(box, "sphere.stl", "--smooth", "2%", "--resolution", "80", "--at", "vertices", "-o", "v.vtp")
    found = result["curvature"]
    for key in ("determined_area", "mean_integral", "gaussian_integral", "euler_characteristic"):
        expect(found[key] is None, f"{key}: {found[key]}")
    expect(not [w for w in result["warnings"] if "integral" in w], f"{result['warnings']}")
    run = box.succeed(["curvature", "sphere.stl", "--smooth", "2%", "--resolution", "80", "--at", "vertices"])
    expect("integral" not in run.text() + run.messages(), run.text())
    expect_match(r"averages are of points, all weighing the same", run.text(), "summary")
    read = read_surface(box.folder / "v.vtp")
    if read is None:
        return
    values = sorted(k for k, c in zip(read["gaussian_curvature"], read["converged"]) if c)
    expect(abs(sum(values) / len(values) - found["gaussian"]["mean"]) < 1e-9, "the average is not that of the points")
    expect(values[(len(values) - 1) // 2] == found["gaussian"]["p50"], "the median is not that of the points")


@scenario("curvature")
def vertices_find_the_surface_that_smoothing_moved(box):
    box.succeed(["example", "knot", "-q", "-o", "knot.stl"])
    found = curvature_of(box, "knot.stl", "--smooth", "10%", "--at", "vertices")["curvature"]
    expect(found["determined"] == found["points"], f"{found['points'] - found['determined']} are undetermined")
    # Balls stay balls, of the volume that is reported; the small one's radius shrinks by more than two cells.
    box.write("two.stl", models.binary_stl(sphere(24, 2.0) + shifted(sphere(12, 1.0), 5)))
    result = curvature_of(box, "two.stl", "--smooth", "1.8", "--cell", "0.05", "--at", "vertices")
    found, volume = result["curvature"], result["smoothing"]["volume_after"]
    expect(found["determined"] == found["points"] == 6 * 24 ** 2 + 2 + 6 * 12 ** 2 + 2, f"{found}")
    mean = found["mean"]
    large, small = 1 / mean["p50"], 1 / mean["p95"]
    expect(small < 1 - 2 * 0.08, f"radii {large}, {small}")
    expect(abs(4 / 3 * math.pi * (large ** 3 + small ** 3) / volume - 1) < 0.005, f"radii {large}, {small}: not {volume}")
    expect(abs(mean["p1"] * large - 1) < 0.01 and abs(mean["p99"] * small - 1) < 0.01, f"no balls: {mean}")


@scenario("curvature")
def lost_components_are_told(box):
    box.write("lost.stl", models.binary_stl(sphere(24, 1.0) + shifted(sphere(8, 0.02), 1.6)))
    for at in ("surface", "vertices"):
        lost = curvature_of(box, "lost.stl", "--resolution", "40", "--at", at)["warnings"]
        expect_match(r"1 of the input's components \(0\.00\d+ of area\) are not in the surface.*at \(1\.[56]", "\n".join(lost), f"warnings at {at}")
    both = curvature_of(box, "lost.stl", "--cell", "0.01")
    expect(both["curvature"]["euler_characteristic"] == 4 and not [w for w in both["warnings"] if "components" in w], f"{both}")
    # The vertices of what smoothing took away are told apart from those at kinks.
    box.write("away.stl", models.binary_stl(sphere(24, 1.0) + shifted(sphere(8, 0.05), 1.6)))
    away = curvature_of(box, "away.stl", "--smooth", "0.3", "--resolution", "100", "--at", "vertices")
    expect(away["curvature"]["points"] - away["curvature"]["determined"] == 6 * 8 ** 2 + 2, f"{away['curvature']}")
    expect_match(r"smoothing moved the surface away from 386 of 3844 points", "\n".join(away["warnings"]), "warnings")
    expect(not [w for w in away["warnings"] if "edges and corners" in w], f"{away['warnings']}")
    box.write("most.stl", models.binary_stl(sphere(4, 1.0) + shifted(sphere(60, 0.02), 1.6)))
    run = box.succeed(["curvature", "most.stl", "--smooth", "0.3", "--resolution", "60", "--at", "vertices"])
    expect_match(r"^undetermined +21602 \(100 %\)$", run.text(), "summary")


@scenario("curvature")
def no_other_order_is_suggested(box):
    run = box.run(["curvature", "cube.stl", "--order", "3"])
    expect(run.code == 2 and "expected one of 2, 4, 6" in run.messages() and "did you mean" not in run.messages(), run.messages())


@scenario("curvature")
def edges_of_a_cube_are_told(box):
    run = box.succeed(["curvature", "cube.stl", "--cell", "0.05", "-o", "c.ply"])
    expect_match(r"flat facets, 2\d(\.\d)? cells per mean edge", run.messages(), "warning")
    expect_match(r"the integral of k1 k2 is .*, and 12\.57 for any surface like this one", run.messages(), "warning")
    expect_match(r"^undetermined +[1-9]", run.text(), "summary")
    for line in run.text().splitlines():
        expect(len(line) <= 80, f"{len(line)} columns: {line}")
    header = box.read("c.ply").split(b"end_header")[0]
    for words in (b"property double quality", b"property double nx", b"property double direction1_x", b"property uchar red", b"comment colours quality from"):
        expect(words in header, f"no {words} in {header}")
    expect(b"nan" not in header, "header")
    expect(box.run(["compare", "cube.stl", "c.ply", "--max", "0.05"]).code == 0, "the surface is not the cube's")
    found = curvature_of(box, "cube.stl", "--cell", "0.05")["curvature"]
    expect(abs(found["mean"]["p50"]) < 1e-3 and found["determined_area"] < found["area"], f"{found}")
    expect(found["k1"]["p99"] > 0.5 / 0.05, "an edge rounded in a cell or two")


@scenario("curvature")
def methods_and_failures_hold_to_the_schema(box):
    nodal = curvature_of(box, "crossing.stl", "--method", "nodal", *QUICK)["curvature"]
    expect(nodal["k1"] is None and nodal["gaussian"] is None and nodal["smallest_convex"] is None, "nodal curvatures have a mean only")
    curvature_of(box, "crossing.stl", "--at", "vertices", "-o", "v.ply", *QUICK)
    failed = box.run(["curvature", "triangle.stl", "--json", "-q"])
    expect(failed.code == 5, f"exit code {failed.code}")
    expect_valid("curvature.schema.json", json.loads(failed.out))


@scenario("curvature")
def curvatures_are_the_same_bytes_on_any_number_of_threads(box):
    for suffix in ("vtp", "ply"):
        for threads in "12":
            box.succeed(["curvature", "crossing.stl", "-q", "--smooth", "4h", "-o", f"{threads}.{suffix}", "--threads", threads, *QUICK])
        expect(box.read(f"1.{suffix}") == box.read(f"2.{suffix}"), f"{suffix} differs")


@scenario("curvature")
def overwrite_replaces_curvatures(box):
    box.write("c.vtp", b"old")
    expect(box.run(["curvature", "cube.stl", "-q", "-o", "c.vtp", *QUICK]).code == 4, "overwritten")
    expect(box.read("c.vtp") == b"old", "touched")
    box.succeed(["curvature", "cube.stl", "-q", "-o", "c.vtp", "--overwrite", *QUICK])
    expect(box.read("c.vtp").startswith(b"<?xml"), "not replaced")


@scenario("curvature")
def render_draws_curvatures(box):
    script = Path(__file__).resolve().parents[2] / "scripts" / "render"
    box.succeed(["curvature", "cube.stl", "-o", "c.vtp", "-q", *QUICK])
    command = [script, "c.vtp", "-o", "c.png", "--color", "mean_curvature", "--size", "300x200"]
    result = subprocess.run(command, cwd=box.folder, capture_output=True, timeout=240)
    if result.returncode and (b"bootstrap" in result.stderr or b"No module named" in result.stderr):
        print("  skipped: no VTK or no display (scripts/bootstrap picture)")
        return
    expect(result.returncode == 0, result.stderr.decode())
    expect(box.read("c.png")[16:24] == (300).to_bytes(4, "big") + (200).to_bytes(4, "big"), "no PNG of that size")
    wrong = subprocess.run([*command[:4], "--color", "k3"], cwd=box.folder, capture_output=True, timeout=240)
    expect(wrong.returncode != 0 and b"there are: mean_curvature" in wrong.stderr, wrong.stderr.decode())


# --- fields from ACCEPTED cells -----------------------------------------------------------------------

def touches_surface(bounds, around):
    """Whether the box, widened, meets the unit cube's surface."""
    low, high = [b - around for b in bounds[0:6:2]], [b + around for b in bounds[1:6:2]]
    outer = all(l <= 1 and h >= 0 for l, h in zip(low, high))
    inner = all(l > 0 and h < 1 for l, h in zip(low, high))
    return outer and not inner


# The largest error up to twice the cube's side, in cells. (On the domain's upper walls, where no nodes are, a file has values of the last ones.)
FAR_ERROR = {"closest": 0.75, "fmm": 0.75, "pde-weno5": 0.3, "pde-first": 1.6}


@scenario("redistance")
def fields_follow_from_accepted_cells(box):
    for method, allowed in FAR_ERROR.items():
        for accepted in ("cells", "band"):
            name = f"{method}.{accepted}.vtu"
            options = ["--redistance", method, "--accepted", accepted, "--verify-exact", "400", "--octree", "cells", "--cell", "0.1"]
            report = json.loads(box.succeed(["field", "cube.stl", "-o", name, "--json", "-q", *options]).out)
            expect_valid("field.schema.json", report)
            told, cell = report["redistancing"], report["options"]["cell"]
            expect(told["method"] == method and told["accepted"] == accepted, f"{told}")
            expect((told["steps"] > 0) == method.startswith("pde"), f"steps {told['steps']}")
            expect(report["options"]["band"] == (3.5 if accepted == "cells" else 3), f"band {report['options']['band']}")
            expect(report["verification"]["passed"], f"{name}: {report['verification']}")
            read = read_field(box.folder / name)
            if read is None:
                return
            marks = read["cells"]["accepted"]
            if accepted == "cells":
                finest = [(b, m) for b, m in zip(read["bounds"], marks) if b[1] - b[0] < 1.5 * cell]
                expect(sum(marks) == told["cells_accepted"], f"{sum(marks)} marks of {told['cells_accepted']}")
                expect(sum(touches_surface(b, 0) for b, _ in finest) == told["cells_cut"], f"cells cut: {told['cells_cut']}")
                # Some cells of the ring lie within rounding of the edge of their neighbour.
                for b, mark in finest:
                    expect(not mark or touches_surface(b, 1.001 * cell), f"{b} is marked")
            exact = [distance_to_unit_cube(at) for at in read["at"]]
            worst = max(abs(phi - d) for d, phi in zip(exact, read["phi"]) if d > -2) / cell
            expect(worst < allowed, f"{name}: off by {worst} cells")


@scenario("redistance")
def fields_from_accepted_cells_do_not_depend_on_threads(box):
    for method in FAR_ERROR:
        for threads in "12":
            box.succeed(["field", "crossing.stl", "-q", "-o", f"{threads}.vtu", "--overwrite", "--threads", threads, "--redistance", method, "--resolution", "16"])
        expect(box.read("1.vtu") == box.read("2.vtu"), f"{method} differs")


@scenario("redistance")
def several_levels_meet_at_accepted_cells(box):
    options = ["--redistance", "fmm", "--adapt", "0.5h", "--cell-max", "4h", "--cell", "0.02", "--verify-exact", "400", "--json", "-q"]
    report = json.loads(box.succeed(["field", "cube.stl", *options]).out)
    expect(report["options"]["band"] == 7 and report["verification"]["passed"], f"{report['verification']}")
    expect(len([level for level in report["grid"]["by_level"] if level["near_blocks"]]) > 1, "one level only")


@scenario("redistance")
def a_pde_over_a_large_domain_can_be_stopped(box):
    process = box.popen(["field", "cube.stl", "--resolution", "100", "--redistance", "pde-weno5"])
    time.sleep(3)  # by then it takes steps
    start = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    expect(process.returncode == 130, f"exit code {process.returncode}\n{err.decode()}")
    expect(time.monotonic() - start < 10, "it took long")


@scenario("redistance")
def the_flow_takes_any_method(box):
    volumes = {}
    for method in FAR_ERROR:
        report = json.loads(box.succeed(["cube.stl", "-o", "x.stl", "--overwrite", "--json", "-q", "--smooth", "6h", "--redistance", method, *QUICK]).out)
        expect_valid("report.schema.json", report)
        expect(report["smoothing"]["redistance"] == method and report["output"]["verified"], f"{method}: {report['smoothing']}")
        volumes[method] = report["smoothing"]["volume_after"]
    expect(max(volumes.values()) - min(volumes.values()) < 1e-4, f"volumes {volumes}")
    run = box.succeed(["cube.stl", "-o", "y.stl", "--redistance", "fmm"])
    expect_match(r"--redistance: has no effect without --smooth", run.messages(), "warning")
