"""`burnish ic`: fields in OpenFOAM cases, and OpenFOAM's own view of them where it is installed."""
import importlib.machinery
import importlib.util
import re
from pathlib import Path

import models
from runner import expect, expect_match
from scenarios import json_result, scenario

HEADER = "FoamFile {{ version 2.0; format ascii; class {}; object {}; }}\n"
FIELD = HEADER.format("volScalarField", "f") + "dimensions [0 0 0 0 0 0 0];\ninternalField uniform 0;\nboundaryField { walls { type zeroGradient; } // kept\n }\n"


def write_case(box, n=4, side=2.0, name="case"):
    """A cube of n^3 cells from the origin on, with one patch."""
    folder = box.folder / name
    mesh = folder / "constant/polyMesh"
    mesh.mkdir(parents=True)
    (folder / "system").mkdir()
    (folder / "0").mkdir()

    def write(file, cls, text):
        (mesh / file).write_text(HEADER.format(cls, file) + text)

    def point(i, j, k):
        return i + (n + 1) * (j + (n + 1) * k)

    span = range(n + 1)
    points = [f"({i * side / n!r} {j * side / n!r} {k * side / n!r})" for k in span for j in span for i in span]
    inner, outer = [], []
    for k in range(n):
        for j in range(n):
            for i in range(n):
                cell = i + n * (j + n * k)
                for axis in range(3):
                    at = (i, j, k)
                    for up in (0, 1):
                        corners = []
                        for b, c in ((0, 0), (1, 0), (1, 1), (0, 1)):
                            p = list(at)
                            p[axis] += up
                            p[(axis + 1) % 3] += b
                            p[(axis + 2) % 3] += c
                            corners.append(point(*p))
                        corners = corners if up else corners[::-1]
                        if up and at[axis] + 1 < n:
                            inner.append((cell, cell + (1, n, n * n)[axis], corners))
                        elif up or at[axis] == 0:
                            outer.append((cell, None, corners))
    faces = inner + outer
    write("points", "vectorField", f"{len(points)}\n(\n" + "\n".join(points) + "\n)\n")
    write("faces", "faceList", f"{len(faces)}\n(\n" + "\n".join("4({} {} {} {})".format(*f[2]) for f in faces) + "\n)\n")
    write("owner", "labelList", f"{len(faces)}\n(\n" + "\n".join(str(f[0]) for f in faces) + "\n)\n")
    write("neighbour", "labelList", f"{len(inner)}\n(\n" + "\n".join(str(f[1]) for f in inner) + "\n)\n")
    write("boundary", "polyBoundaryMesh", f"1(walls {{ type wall; nFaces {len(outer)}; startFace {len(inner)}; }})\n")
    (folder / "system/controlDict").write_text(HEADER.format("dictionary", "controlDict") + "startFrom startTime; startTime 0;\n")
    return folder


def values(path):
    text = path.read_text()
    one = re.search(r"internalField\s+uniform\s+([^;\s]+)", text)
    if one:
        return [float(one[1])]
    begin = text.index("(", text.index("internalField")) + 1
    return [float(word) for word in text[begin:text.index(")", begin)].split()]


def ic(box, *args, code=0):
    return json_result(box, "ic", *args, code=code)


@scenario("ic")
def a_cube_fills_its_part_of_the_cells(box):
    folder = write_case(box)  # cells of side 0.5: the unit cube is eight of them
    result = ic(box, "cube.stl", "--case", "case", "--also-phi", "psi")
    alpha = values(folder / "0/alpha.water")
    expect(sorted(set(alpha)) == [0, 1] and sum(alpha) == 8, f"{sum(alpha)} full cells of {sorted(set(alpha))}")
    expect(result["alpha"]["volume"] == 1 and result["alpha"]["difference"] == 0 and result["solid"]["volume"] == 1, f"{result['alpha']}")
    psi = values(folder / "0/psi")
    expect(psi[0] == 0.25 and psi[3] == -0.75, f"psi {psi[:4]}")
    expect([f["written"] for f in result["fields"]] == [True, True], f"{result['fields']}")
    expect(result["mesh"]["cells"] == 64 and result["mesh"]["volume"] == 8, f"{result['mesh']}")


@scenario("ic")
def nothing_is_replaced_unasked(box):
    folder = write_case(box)
    (folder / "0/alpha.water").write_text(FIELD)
    run = box.run(["ic", "cube.stl", "--case", "case"])
    expect(run.code == 4 and "--overwrite" in run.messages(), run.messages())
    for options in (["--dry-run"], ["--overwrite", "--patch-value", "wall=1"], ["--overwrite", "--field", "U"]):
        (folder / "0/U").write_text(FIELD.replace("volScalarField", "volVectorField"))
        box.run(["ic", "cube.stl", "--case", "case", *options])
        expect((folder / "0/alpha.water").read_text() == FIELD, f"{options}: touched")
        expect(sorted(p.name for p in (folder / "0").iterdir()) == ["U", "alpha.water"], f"{options}: {list((folder / '0').iterdir())}")
    box.succeed(["ic", "cube.stl", "--case", "case", "--overwrite"])
    text = (folder / "0/alpha.water").read_text()
    expect("walls { type zeroGradient; } // kept" in text and text.startswith(FIELD[:FIELD.index("internalField")]), text[:300])
    expect(sum(values(folder / "0/alpha.water")) == 8, "cells")


@scenario("ic")
def bad_cases_are_told_apart(box):
    def refused(code, pattern, *args):
        run = box.run(["ic", *args])
        expect(run.code == code, f"exit code {run.code} of {args}\n{run.messages()}")
        expect_match(pattern, run.messages(), f"{args}")
    refused(2, "--case names the folder", "cube.stl")
    refused(3, "no such folder", "cube.stl", "--case", "nowhere")
    refused(3, "neither system/controlDict nor constant/", "cube.stl", "--case", "folder")
    folder = write_case(box)
    far = models.binary_stl(models.cube(offset=(5, 0, 0)))
    box.write("far.stl", far)
    refused(5, r"do not overlap: the model is in \(5, 0, 0\) to \(6, 1, 1\), the mesh in \(0, 0, 0\) to \(2, 2, 2\)", "far.stl", "--case", "case")
    box.write("mm.stl", models.binary_stl([tuple(tuple(1000 * c for c in p) for p in t) for t in models.cube(offset=(0.2, 0.2, 0.2))]))
    refused(5, "--scale 0.001 would fit", "mm.stl", "--case", "case")
    refused(5, "burnish: ", "triangle.stl", "--case", "case")
    refused(2, "its patches are walls", "cube.stl", "--case", "case", "--patch-value", "inlet=1")
    refused(2, "expected NAME=V", "cube.stl", "--case", "case", "--patch-value", "inlet")
    refused(2, "expected a name such as alpha.water", "cube.stl", "--case", "case", "--field", "../x")
    refused(2, "name the same field", "cube.stl", "--case", "case", "--also-phi", "alpha.water")
    expect(list((folder / "0").iterdir()) == [], "files were made")
    failed = ic(box, "triangle.stl", "--case", "case", code=5)
    expect(failed["alpha"] is None and failed["failure"]["code"] == "guarantee_unmet", f"{failed['failure']}")
    scaled = ic(box, "mm.stl", "--case", "case", "--scale", "0.001")
    expect(abs(scaled["alpha"]["volume"] - 1) < 1e-6 and scaled["alpha"]["mixed_cells"] > 0, f"{scaled['alpha']}")
    faces = folder / "constant/polyMesh/faces"
    text = faces.read_text()
    faces.write_text(text.replace("4(", "4(999999 ", 1))
    refused(3, r"faces: line 4: point 999999 does not exist: there are 125", "cube.stl", "--case", "case", "--overwrite")
    for file in (folder / "constant/polyMesh").iterdir():
        target = folder / "processor0/constant/polyMesh" / file.name
        target.parent.mkdir(parents=True, exist_ok=True)
        file.rename(target)
    refused(3, "decomposed.*processor0", "cube.stl", "--case", "case", "--overwrite")


@scenario("ic")
def the_same_bytes_with_any_number_of_threads(box):
    folder = write_case(box, n=12)
    box.write("ball.stl", models.binary_stl(ball()))
    bytes_of = set()
    for threads in ("1", "2", "7"):
        for method in ("exact", "linear", "curved"):
            box.succeed(["ic", "ball.stl", "--case", "case", "--overwrite", "-q", "--method", method, "--threads", threads, "--also-phi", f"psi-{method}"])
            bytes_of.add((method, (folder / "0/alpha.water").read_bytes(), (folder / f"0/psi-{method}").read_bytes()))
    expect(len(bytes_of) == 3, f"{len(bytes_of)} different results of 3 methods")


def table():
    """scripts/two_phase_table as a module."""
    path = Path(__file__).resolve().parents[2] / "scripts/two_phase_table"
    loader = importlib.machinery.SourceFileLoader("two_phase_table", str(path))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("two_phase_table", loader))
    loader.exec_module(module)
    return module


def ball():
    points, faces = table().ball(3)
    return [tuple(tuple(0.97 + 0.55 * c for c in points[i]) for i in f) for f in faces]


@scenario("ic")
def openfoam_measures_the_same_volume(box):
    module = table()
    if not module.has_foam():
        print("  skipped: no OpenFOAM (scripts/bootstrap peers)")
        return
    for mesh in ("hex", "octree", "tets"):
        rows = module.measure(box.program, box.folder / f"case-{mesh}", "ball", mesh, 3, methods=("exact",), peers=False)
        if rows[0][1] is None:
            print(f"  {mesh}: {rows[0][0]}")
            continue
        expect(abs(rows[0][1]) < 1e-12, f"{mesh}: volume off by {rows[0][1]}")
        expect(rows[0][2] == 0 and rows[0][3] == 1, f"{mesh}: alpha {rows[0][2:]}")


@scenario("ic")
def openfoam_reads_the_same_values(box):
    """Written in binary, and by OpenFOAM again as text with all digits: bit by bit what is written as text."""
    module = table()
    if not module.has_foam():
        print("  skipped: no OpenFOAM (scripts/bootstrap peers)")
        return
    box.write("ball.stl", models.binary_stl([tuple(tuple(0.5 * c for c in p) for p in t) for t in ball()]))
    read = []
    for binary in (False, True):
        case = module.Case(box.folder / f"binary-{binary}", 10, binary=binary)
        case.run("blockMesh")
        box.succeed(["ic", "ball.stl", "--case", case.path.name, "--also-phi", "psi", "--invert", "-q"])
        if binary:
            expect(b"format      binary" in (case.path / "0/psi").read_bytes(), "psi is text")
            control = case.path / "system/controlDict"
            control.write_text(control.read_text().replace("writeFormat binary", "writeFormat ascii"))
            case.run("foamFormatConvert", "-time", "0")
        read.append((values(case.path / "0/alpha.water"), values(case.path / "0/psi")))
    expect(len(read[0][0]) == len(read[0][1]) == 1000 and read[0] == read[1], "values differ")


@scenario("ic")
def solvers_start_from_it(box):
    module = table()
    if not module.has_foam():
        print("  skipped: no OpenFOAM (scripts/bootstrap peers)")
        return
    for solver in ("interFoam", "interIsoFoam"):
        code, change, least, most = module.run_solver(box.program, box.folder / solver, "ball", "hex", 3, solver)
        expect(code == 0 and abs(change) < 1e-10, f"{solver}: exit code {code}, volume changed by {change}")
        expect(least > -1e-6 and most < 1 + 1e-6, f"{solver}: alpha from {least} to {most}")
