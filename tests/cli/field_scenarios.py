"""What `burnish field` writes, as VTK reads it, and what is drawn of it."""
import gzip
import json
import math
import re
import struct
import subprocess
from pathlib import Path

import models
from runner import expect
from scenarios import DOCS, QUICK, scenario

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


READ_IMAGE = """if True:
    import json, sys
    from vtkmodules import vtkCommonCore
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader
    from vtkmodules.vtkIOImage import vtkNrrdReader
    reader = vtkNrrdReader() if sys.argv[1].endswith(".nrrd") else vtkXMLImageDataReader()
    reader.SetFileName(sys.argv[1])
    reader.Update()
    image = reader.GetOutput()
    phi = image.GetPointData().GetScalars()
    print(json.dumps({"nodes": image.GetDimensions(), "origin": image.GetOrigin(), "spacing": image.GetSpacing(),
                      "phi": [phi.GetTuple1(i) for i in range(phi.GetNumberOfTuples())]}))"""


def read_nrrd(data):
    """By the format's own description: a head of lines, an empty line, a gzip stream."""
    head, body = data.split(b"\n\n", 1)
    fields = dict(line.split(": ", 1) for line in head.decode().splitlines()[1:])
    expect(fields["type"] == "float" and fields["endian"] == "little" and fields["encoding"] == "gzip", f"{fields}")
    vectors = [[float(c) for c in v.strip("()").split(",")] for v in fields["space directions"].split()]
    nodes = [int(n) for n in fields["sizes"].split()]
    values = struct.unpack(f"<{nodes[0] * nodes[1] * nodes[2]}f", gzip.decompress(body))
    return {"nodes": nodes, "origin": [float(c) for c in fields["space origin"].strip("()").split(",")], "spacing": [vectors[a][a] for a in range(3)], "phi": values}


def run_vtk(script, *arguments, cwd=None):
    """What a script of Debian's Python printed; None without VTK."""
    result = subprocess.run(["/usr/bin/python3", "-c", script, *map(str, arguments)], capture_output=True, timeout=240, cwd=cwd)
    if b"No module named 'vtk" in result.stderr:
        print("  skipped: no VTK (scripts/bootstrap picture)")
        return None
    expect(result.returncode == 0 and not result.stderr, result.stderr.decode())
    return result.stdout


def expect_distances_to_the_cube(read, cell, limit=None):
    i = 0
    for z in range(read["nodes"][2]):
        for y in range(read["nodes"][1]):
            for x in range(read["nodes"][0]):
                at = [o + s * n for o, s, n in zip(read["origin"], read["spacing"], (x, y, z))]
                exact = distance_to_unit_cube(at)
                if limit:
                    exact = max(-limit, min(limit, exact))
                allowed = 1e-7 if abs(exact) < 3 * cell else 0.0102 * abs(exact)
                expect(abs(read["phi"][i] - exact) <= allowed, f"phi {read['phi'][i]} at {at}, expected {exact}")
                i += 1
    expect(i == len(read["phi"]), f"{len(read['phi'])} values")


@scenario("field")
def uniform_grids_have_the_distance(box):
    for suffix in ("vti", "nrrd"):
        for options, nodes, limit in ((["--samples", "23"], [23] * 3, None), (["--spacing", "0.125", "--box", "-0.5,0.25,0,2,1,1"], [21, 7, 9], None),
                                      (["--samples", "23", "--narrow-band", "0.1"], [23] * 3, 0.1)):
            name = f"f.{suffix}"
            report = json.loads(box.succeed(["field", "cube.stl", "-o", name, "--overwrite", "--json", "-q", "--cell", "0.05", *options]).out)
            out = run_vtk(READ_IMAGE, box.folder / name)
            read = read_nrrd(box.read(name)) if suffix == "nrrd" else None
            if out is not None:
                by_vtk = json.loads(out)
                expect(read is None or list(read["phi"]) == by_vtk["phi"], "VTK reads other values")
                read = by_vtk
            if read is None:
                continue
            expect(list(read["nodes"]) == nodes == report["output"]["samples"], f"{name}: {read['nodes']} nodes")
            expect(abs(read["spacing"][0] - report["output"]["spacing"]) < 1e-12, f"{name}: spacing {read['spacing']}")
            expect_distances_to_the_cube(read, 0.05, limit)


@scenario("field")
def narrow_bands_have_cells_near_the_surface_only(box):
    box.succeed(["field", "cube.stl", "-o", "all.vtu", "-q", "--cell", "0.05"])
    box.succeed(["field", "cube.stl", "-o", "band.vtu", "-q", "--cell", "0.05", "--narrow-band", "2h", "--data", "phi,mean_curvature,sign_confidence", "--cell-centred"])
    everything, band = read_field(box.folder / "all.vtu"), read_field(box.folder / "band.vtu")
    if everything is None:
        return
    expect(set(everything["cells"]) == {"phi", "level", "inside", "block", "facet", "mean_curvature", "sign_confidence"}, f"arrays {set(everything['cells'])}")
    expect(set(band["cells"]) == {"phi", "mean_curvature", "sign_confidence"} and band["at"] == [], f"arrays {set(band['cells'])}")
    expected = [b for b, phi in zip(everything["bounds"], everything["cells"]["phi"]) if abs(phi) <= 2 * 0.05]
    expect(band["bounds"] == expected, f"{len(band['bounds'])} cells, expected {len(expected)}")
    expect(set(band["cells"]["sign_confidence"]) == {1}, "a closed cube is certain")
    # A face is flat, away from the edges.
    flat = [k for b, k in zip(band["bounds"], band["cells"]["mean_curvature"]) if all(0.3 < c < 0.7 for c in b[0:4]) and not math.isnan(k)]
    expect(len(flat) > 50 and max(abs(k) for k in flat) < 1e-3, f"{len(flat)} cells of a face, curvatures up to {max(map(abs, flat), default=0)}")


@scenario("field")
def smoothed_fields_have_the_smoothed_surface(box):
    for suffix in ("vtu", "htg", "vti"):
        box.succeed(["field", "cube.stl", "-o", f"f.{suffix}", "-q", "--cell", "0.05", "--smooth", "0.5", "--mode", "mcf", "--free-volume"])
    read = read_field(box.folder / "f.vtu")
    if read is None:
        return
    expect("facet" not in read["cells"], "a smoothed surface has no facets")
    # Corners are rounded, so the distance there is less; in the middle of faces the surface stays.
    for at, phi in zip(read["at"], read["phi"]):
        exact = distance_to_unit_cube(at)
        expect(phi <= exact + 0.01 or exact < 0, f"phi {phi} at {at} of {exact}")
        if sum(abs(c - 0.5) < 0.1 for c in at) == 2 and exact > -1:
            expect(abs(phi - exact) < 0.03, f"phi {phi} at {at} of {exact}")
    corner = min(zip(read["at"], read["phi"]), key=lambda q: sum(abs(c - 0.99) for c in q[0]))
    expect(corner[1] < -0.03, f"phi {corner[1]} at the corner")


@scenario("field")
def documented_lines_run(box):
    """The lines for VTK's Python in docs/formats.md."""
    for suffix in ("vtu", "htg", "vti", "nrrd"):
        box.succeed(["field", "cube.stl", "-o", f"part.{suffix}", "-q", "--cell", "0.1"])
    page = (DOCS / "formats.md").read_text()
    blocks = [b for b in re.findall(r"```python\n(.*?)```", page, re.S) if "vtk" in b]
    expect(len(blocks) >= 3, f"{len(blocks)} blocks")
    for block in blocks:
        if run_vtk(block, cwd=box.folder) is None:
            return


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
    for suffix, options in (("vtu", []), ("htg", []), ("vtu", ["--adapt", "0.1h"]), ("htg", ["--cell-octree"]), ("vti", []), ("nrrd", ["--adapt", "0.1h"]),
                            ("vti", ["--smooth", "3h", "--mode", "volume"])):
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
