"""What `burnish field` writes, as VTK reads it, and what is drawn of it."""
import json
import subprocess
from pathlib import Path

import models
from runner import expect
from scenarios import QUICK, scenario

READ_FIELD = """if True:
    import json, sys
    from vtkmodules import vtkCommonCore
    from vtkmodules.vtkFiltersHyperTree import vtkHyperTreeGridToUnstructuredGrid
    from vtkmodules.vtkIOXML import vtkXMLHyperTreeGridReader, vtkXMLUnstructuredGridReader
    from vtkmodules.vtkCommonDataModel import vtkHyperTreeGridNonOrientedGeometryCursor
    path = sys.argv[1]
    result = {}
    if path.endswith(".htg"):
        reader = vtkXMLHyperTreeGridReader()
        reader.SetFileName(path)
        reader.Update()
        tree = reader.GetOutput()
        arrays = tree.GetCellData()
        result["octants"], result["leaves"] = tree.GetNumberOfVertices(), tree.GetNumberOfLeaves()
        convert = vtkHyperTreeGridToUnstructuredGrid()
        convert.SetInputConnection(reader.GetOutputPort())
        convert.Update()
        grid = convert.GetOutput()
    else:
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(path)
        reader.Update()
        grid = reader.GetOutput()
    values = lambda a: [a.GetTuple1(i) for i in range(a.GetNumberOfTuples())]
    cells = grid.GetCellData()
    result["points"] = grid.GetNumberOfPoints()
    result["types"] = sorted({grid.GetCellType(c) for c in range(grid.GetNumberOfCells())})
    result["bounds"] = [grid.GetCell(c).GetBounds() for c in range(grid.GetNumberOfCells())]
    result["cells"] = {cells.GetArrayName(i): values(cells.GetArray(i)) for i in range(cells.GetNumberOfArrays())}
    phi = grid.GetPointData().GetArray("phi")
    result["at"] = [grid.GetPoint(p) for p in range(grid.GetNumberOfPoints())] if phi else []
    result["phi"] = values(phi) if phi else []
    print(json.dumps(result))"""


def read_field(path):
    """What VTK reads of a .vtu or .htg; None without VTK."""
    result = subprocess.run(["/usr/bin/python3", "-c", READ_FIELD, path], capture_output=True, timeout=240)
    if b"No module named 'vtkmodules'" in result.stderr or not Path("/usr/bin/python3").exists():
        print("  skipped: no VTK (scripts/bootstrap picture)")
        return None
    expect(result.returncode == 0 and not result.stderr, result.stderr.decode())
    return json.loads(result.stdout)


def distance_to_unit_cube(p):
    """Positive inside."""
    q = [abs(c - 0.5) - 0.5 for c in p]
    return -sum(max(c, 0) ** 2 for c in q) ** 0.5 - min(0, max(q))


def expect_cells_of_a_cube(read, report, rounding):
    """Boxes tile a cube; sides follow from levels, phi is the distance at the centre, sides agree with it."""
    bounds, cells, cell = read["bounds"], read["cells"], report["options"]["cell"]
    expect(len(bounds) == report["output"]["cell_count"], f"{len(bounds)} cells")
    lower, upper = ([f(b[i + s] for b in bounds) for i in (0, 2, 4)] for f, s in ((min, 0), (max, 1)))
    domain = [b - a for a, b in zip(lower, upper)]
    expect(max(domain) - min(domain) < rounding, f"domain {domain}")
    sides = [b[1] - b[0] for b in bounds]
    expect(abs(sum(s ** 3 for s in sides) / domain[0] ** 3 - 1) < 10 * rounding, "the cells do not tile the domain")
    for b, side, level, phi, inside in zip(bounds, sides, cells["level"], cells["phi"], cells["inside"]):
        expect(abs(side / cell - 2 ** level) < 1e-5, f"level {level}, side {side}")
        exact = distance_to_unit_cube([(b[i] + b[i + 1]) / 2 for i in (0, 2, 4)])
        # Of a small cell, the mean of its corners: off the distance where that has a kink.
        allowed = 0.5 * cell if level == 0 else 1e-6
        expect(abs(phi - exact) < allowed, f"phi {phi} at {b}, expected {exact}")
        expect(inside == (phi >= 0), f"inside {inside}, phi {phi}")


@scenario("field")
def vtk_reads_the_cells(box):
    for octree in ("blocks", "near"):
        for suffix in ("vtu", "htg"):
            name = f"{octree}.{suffix}"
            report = json.loads(box.succeed(["field", "cube.stl", "-o", name, "--octree", octree, "--json", "-q", "--cell", "0.1"]).out)
            read = read_field(box.folder / name)
            if read is None:
                return
            expect(read["types"] == [11], f"{name}: cells of types {read['types']}")
            # VTK's conversion of a tree to cells rounds coordinates to float32.
            expect_cells_of_a_cube(read, report, 1e-6 if suffix == "htg" else 1e-12)
            if suffix == "htg":
                expect(read["leaves"] == report["output"]["cell_count"], f"{name}: {read['leaves']} leaves")
                expect(read["octants"] == report["output"]["octant_count"], f"{name}: {read['octants']} octants")
            else:
                expect(read["points"] == report["output"]["point_count"], f"{name}: {read['points']} points")
                expect(len(set(map(tuple, read["at"]))) == read["points"], f"{name}: points stand there twice")
                expect(sorted(set(read["cells"]["block"])) == list(range(report["grid"]["blocks"])), f"{name}: blocks")
                for at, phi in zip(read["at"], read["phi"]):
                    exact = distance_to_unit_cube(at)
                    expect(abs(exact) > 0.3 or abs(phi - exact) < 1e-7, f"{name}: phi {phi} at {at}, expected {exact}")


@scenario("field")
def vtk_reads_cells_of_several_levels(box):
    for suffix in ("vtu", "htg"):
        options = ["--adapt", "0.5h", "--cell-max", "4h", "--cell", "0.02", "--json", "-q"]
        report = json.loads(box.succeed(["field", "cube.stl", "-o", f"f.{suffix}", *options]).out)
        near = [level["near_blocks"] for level in report["grid"]["by_level"]]
        expect(near[0] > 0 and sum(near[1:]) > 0, f"blocks near the surface are of one level: {near}")
        read = read_field(box.folder / f"f.{suffix}")
        if read is None:
            return
        expect(len(read["bounds"]) == report["output"]["cell_count"] == report["grid"]["blocks"] + 511 * sum(near), f"{suffix}: cells")
        cell, cells = report["options"]["cell"], read["cells"]
        domain = max(b[1] for b in read["bounds"]) - min(b[0] for b in read["bounds"])
        expect(abs(sum((b[1] - b[0]) ** 3 for b in read["bounds"]) / domain ** 3 - 1) < 1e-5, "the cells do not tile the domain")
        for b, level, phi in zip(read["bounds"], cells["level"], cells["phi"]):
            side = b[1] - b[0]
            expect(abs(side / cell - 2 ** level) < 1e-3, f"level {level}, side {side}")
            exact = distance_to_unit_cube([(b[i] + b[i + 1]) / 2 for i in (0, 2, 4)])
            # Of a cell the mean of its corners, where hanging ones are interpolated; of a block its middle node.
            expect(abs(exact) > 3 * side or abs(phi - exact) < 0.5 * side + 1e-6, f"phi {phi} at {b}, expected {exact}")
        for at, phi in zip(read["at"], read["phi"]):
            exact = distance_to_unit_cube(at)
            # Off by the tolerance at most where a node is exact or hangs beside a coarser leaf.
            expect(abs(exact) > 2 * cell or abs(phi - exact) < cell, f"phi {phi} at {at}, expected {exact}")


@scenario("field")
def vtk_reads_an_octree_of_cells(box):
    for suffix in ("vtu", "htg"):
        report = json.loads(box.succeed(["field", "cube.stl", "--cell-octree", "-o", f"c.{suffix}", "--max-face-cut", "2", "--resolution", "64", "--json", "-q"]).out)
        read = read_field(box.folder / f"c.{suffix}")
        if read is None:
            return
        cells, bounds = read["cells"], read["bounds"]
        expect(set(cells) == {"level", "facets", "facets_cut"}, f"arrays {set(cells)}")
        expect(len(bounds) == report["cells"]["count"], f"{len(bounds)} cells")
        expect(sum(cells["facets"]) == 12, f"{sum(cells['facets'])} facets")
        expect(sum(n > 0 for n in cells["facets_cut"]) == report["cells"]["cut"], "cells cut")
        for b, level, cut in zip(bounds, cells["level"], cells["facets_cut"]):
            expect(abs((b[1] - b[0]) / report["options"]["cell"] - 2 ** level) < 1e-4, f"level {level} of {b}")
            expect(cut <= 2 or level == 0, f"{cut} facets in a cell of level {level}")
            # A cell is cut exactly where it meets a side of the cube.
            inner, outer = (all(test(b[i], b[i + 1]) for i in (0, 2, 4)) for test in (lambda p, q: p > 0 and q < 1, lambda p, q: p <= 1 and q >= 0))
            expect((cut > 0) == (outer and not inner), f"{cut} facets cut {b}")


@scenario("field")
def cells_name_the_facet_they_are_near_to(box):
    box.succeed(["field", "cube.stl", "-o", "f.vtu", "-q", "--cell", "0.1"])
    read = read_field(box.folder / "f.vtu")
    if read is None:
        return
    sides = models.cube()
    expect(set(read["cells"]["facet"]) == set(range(12)), f"facets {set(read['cells']['facet'])}")
    for b, facet, phi in zip(read["bounds"], read["cells"]["facet"], read["cells"]["phi"]):
        corner = b[0:6:2]
        triangle = sides[int(facet)]
        axis = next(a for a in range(3) if len({p[a] for p in triangle}) == 1)
        # Outside over the face itself, its plane's distance is the distance.
        over = all(0 < corner[a] < 1 for a in range(3) if a != axis)
        if over and b[1] - b[0] < 0.15:
            expect(abs(abs(corner[axis] - triangle[0][axis]) - abs(distance_to_unit_cube(corner))) < 1e-6, f"facet {facet} at {corner}")


@scenario("field")
def render_octree_draws_a_section(box):
    script = Path(__file__).resolve().parents[2] / "scripts" / "render_octree"
    for suffix, color, options in (("vtu", "level", []), ("htg", "phi", ["--adapt", "0.2h"]), ("vtu", "level", ["--cell-octree"])):
        box.succeed(["field", "cube.stl", "-o", f"f.{suffix}", "-q", "--cell", "0.1", "--overwrite", *options])
        command = [script, f"f.{suffix}", "-o", f"{suffix}.png", "--slice", "y=0.4", "--surface", "cube.stl", "--color", color, "--size", "500x300"]
        result = subprocess.run(command, cwd=box.folder, capture_output=True, timeout=240)
        if result.returncode and (b"bootstrap" in result.stderr or b"No module named" in result.stderr):
            print("  skipped: no VTK or no display (scripts/bootstrap picture)")
            return
        expect(result.returncode == 0, result.stderr.decode())
        png = box.read(f"{suffix}.png")
        expect(png[:8] == b"\x89PNG\r\n\x1a\n" and png[16:24] == (500).to_bytes(4, "big") + (300).to_bytes(4, "big"), "no PNG of that size")


@scenario("field")
def fields_do_not_depend_on_threads(box):
    for suffix, options in (("vtu", []), ("htg", []), ("vtu", ["--adapt", "0.1h"]), ("htg", ["--cell-octree"])):
        for threads in "12":
            box.succeed(["field", "crossing.stl", "-q", "-o", f"{threads}.{suffix}", "--overwrite", "--threads", threads, *QUICK, *options])
        expect(box.read(f"1.{suffix}") == box.read(f"2.{suffix}"), f"{suffix} differs, {options}")


@scenario("field")
def a_larger_model_has_the_same_field(box):
    box.write("large.stl", models.binary_stl([tuple(tuple(1024 * c for c in p) for p in t) for t in models.cube()]))
    reports = [json.loads(box.succeed(["field", name, "--json", "-q", "--verify-exact", "200", *QUICK]).out) for name in ("cube.stl", "large.stl")]
    expect(reports[0]["grid"] == reports[1]["grid"], "another octree")
    expect(reports[0]["volume"]["level_set"] * 1024 ** 3 == reports[1]["volume"]["level_set"], "another volume")
    errors = [r["verification"]["stored"] for r in reports]
    expect(errors[0]["max"] * 1024 == errors[1]["max"] and errors[0]["exceeded"] == 0, f"{errors}")
