"""`burnish mesh`: volume meshes, what is refused, and OpenFOAM's own view of them where it is installed."""
import json
import os
import re
import shutil
import subprocess
import time

import models
from runner import expect, expect_match
from scenarios import DOCS, json_result, scenario

FOAM = {**os.environ, "WM_PROJECT_DIR": "/usr/share/openfoam"}
COARSE = ["--cell", "0.125"]


def mesh(box, *args, code=0):
    return json_result(box, "mesh", *args, code=code)


def named_stl(names):
    """An ASCII STL of the unit cube, its facets dealt to solids of these names in turn, two by two."""
    lines = []
    cube = models.cube()
    for i, name in enumerate(names):
        lines.append(f"solid {name}")
        for t in cube[i * 12 // len(names):(i + 1) * 12 // len(names)]:
            lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {p[0]} {p[1]} {p[2]}" for p in t), "endloop", "endfacet"]
        lines.append(f"endsolid {name}")
    return ("\n".join(lines) + "\n").encode()


@scenario("mesh")
def a_cube_is_filled(box):
    result = mesh(box, "cube.stl", "-o", "case", *COARSE)
    m, q = result["mesh"], result["quality"]
    expect(result["output"] == {"file": "case", "format": "OpenFOAM case", "written": True}, f"{result['output']}")
    expect(q["ok"] and q["promise_holds"] and q["regions"] == m["regions_wanted"] == 1, f"{q['regions']} regions")
    expect(abs(m["volume"] - 1) < 0.02 and m["volume_wanted"] == 1, f"volume {m['volume']}")
    expect(sum(s["cells"] for s in m["shapes"].values()) == m["cells"], "cells by shape")
    expect(abs(sum(s["share_of_volume"] for s in m["shapes"].values()) - 1) < 1e-9, "shares of the volume")
    expect(sum(p["faces"] for p in m["patches"]) == m["faces"] - m["internal_faces"], "faces of patches")
    expect(m["surface_to_patches"]["max"] < 0.125, f"{m['surface_to_patches']}")
    expect((box.folder / "case/constant/polyMesh/faces").exists() or (box.folder / "case/constant/polyMesh/faces.gz").exists(), "no mesh")


@scenario("mesh")
def layers_stand_on_the_wall(box):
    result = mesh(box, "cube.stl", "-o", "case", "--outside", "--domain", "1", "--layers", "2", "--first", "0.15h", *COARSE)
    layers = result["mesh"]["layers"]
    expect(layers["count"] == 2 and layers["ratio"] == 1.2 and abs(layers["first"] - 0.15 * 0.125) < 1e-12, f"{layers}")
    expect(0 <= layers["covered"] <= 1 and layers["greatest_first"] < 1.5 * layers["first"], f"{layers}")
    expect(result["quality"]["ok"], "quality")
    expect(mesh(box, "cube.stl", "--dry-run", *COARSE)["mesh"]["layers"] is None, "layers nobody asked for")
    mesh(box, "cube.stl", "--dry-run", "--first", "0.1h", *COARSE, code=2)
    mesh(box, "cube.stl", "--dry-run", "--layers", "5", "--first", "1h", *COARSE, code=2)


@scenario("mesh")
def outside_is_the_rest_of_the_domain(box):
    result = mesh(box, "cube.stl", "--outside", "--domain", "-1,-1,-1,2,2,2", "-o", "x.vtu", *COARSE)
    m = result["mesh"]
    expect([p["name"] for p in m["patches"]][-6:] == ["xMin", "xMax", "yMin", "yMax", "zMin", "zMax"], f"{m['patches']}")
    low, high = m["box"]["lower"], m["box"]["upper"]
    expect(all(c <= -1 + 1e-9 for c in low) and all(c >= 2 - 1e-9 for c in high), f"{m['box']}")
    whole = (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2])
    expect(abs(m["volume_wanted"] - (whole - 1)) < 1e-9 and abs(m["volume"] / m["volume_wanted"] - 1) < 0.01, f"{m['volume']} of {m['volume_wanted']}")
    for domain in ("0.05", "0,0,0,1,1,1", "-1,-1,-1,0.5,2,2"):
        run = box.run(["mesh", "cube.stl", "--outside", "--domain", domain, "-o", "y.vtu", *COARSE])
        expect(run.code == 2, f"exit code {run.code} of {domain}")
        expect_match("cuts the model|is too near to the model", run.messages(), domain)
    box.expect_files(["x.vtu"])


@scenario("mesh")
def solids_are_patches(box):
    box.write("named.stl", named_stl(["inlet left", "2nd{wall}", "same", "same"]))
    names = ["inlet_left", "_2nd_wall_", "same", "same_2"]
    result = mesh(box, "named.stl", "-o", "case", *COARSE, "--patch-type", "inlet_left=patch,same_2=symmetry")
    patches = result["mesh"]["patches"]
    expect([p["name"] for p in patches] == names, f"{patches}")
    expect([p["group"] for p in patches] == ["inlet left", "2nd{wall}", "same", "same"], f"{patches}")
    expect([p["type"] for p in patches] == ["patch", "wall", "wall", "symmetry"], f"{patches}")
    expect(all(p["faces"] > 0 and abs(p["area"] - 1.5) < 0.3 for p in patches), f"{patches}")
    one = mesh(box, "named.stl", "--dry-run", *COARSE, "--patches", "one")
    expect([p["name"] for p in one["mesh"]["patches"]] == ["surface"] and one["output"] is None, f"{one['mesh']['patches']}")
    run = box.run(["mesh", "named.stl", "-o", "other", *COARSE, "--patch-type", "inlet=patch"])
    expect(run.code == 2 and "its patches are inlet_left, _2nd_wall_, same, same_2" in run.messages(), run.messages())


@scenario("mesh")
def wrong_command_lines_are_told_apart(box):
    def refused(code, pattern, *args):
        run = box.run(["mesh", *args])
        expect(run.code == code, f"exit code {run.code} of {args}\n{run.messages()}")
        expect_match(pattern, run.messages(), f"{args}")
    refused(2, "no output is named", "cube.stl")
    refused(2, "names? the same file", "cube.stl", "-o", "case", "--report", "cube.stl")
    refused(2, "--cell and --cells exclude", "cube.stl", "-o", "case", "--cell", "1", "--cells", "1000")
    refused(2, "--domain is the box around", "cube.stl", "-o", "case", "--domain", "1")
    refused(2, "exclude each other", "cube.stl", "-o", "case", "--inside", "--outside")
    refused(2, "expected BOX:L", "cube.stl", "-o", "case", "--refine", "0,0,0,1,1,1")
    refused(2, "expected six numbers", "cube.stl", "-o", "case", "--refine", "0,0,0,1,1:0.1")
    refused(2, "lower corners first", "cube.stl", "-o", "case", "--outside", "--domain", "1,0,0,0,1,1")
    refused(2, "expected one of wall, patch, symmetry", "cube.stl", "-o", "case", "--patch-type", "a=inlet")
    refused(2, "has no polyhedra", "cube.stl", "-o", "x.msh", "--flavour", "polyhedral")
    refused(2, "--ascii is for an OpenFOAM case", "cube.stl", "-o", "x.vtu", "--ascii")
    refused(2, "--msh-version is for a .msh", "cube.stl", "-o", "x.vtu", "--msh-version", "2.2")
    refused(2, "the suffix does not say", "cube.stl", "-o", "x.stl")
    refused(2, "standard output", "cube.stl", "-o", "-")
    refused(2, "cube is to be of two types, patch and wall", "cube.stl", "-o", "case", "--patch-type", "cube=patch,cube=wall")
    refused(2, r"the box \(0, 0, 0\) to \(1, 1, 1\) is to have cells of 0.001", "cube.stl", "-o", "case", *COARSE, "--refine", "0,0,0,1,1,1:0.001")
    refused(6, r"cells of 0.001 takes about \S+ GB; the budget is 1 GB\n  hint: choose --cell 0.0\d+ or larger", "cube.stl", "-o", "case", "--cell", "0.001", "--memory", "1G")
    refused(4, "cube.stl", "cube.stl", "-o", "cube.stl/case")
    refused(3, "", "text.stl", "-o", "case")
    refused(5, "burnish: ", "triangle.stl", "-o", "case")
    refused(6, "need about .* GB; the budget is", "cube.stl", "-o", "case", "--cells", "20M", "--memory", "1G")
    box.expect_files([])
    failed = mesh(box, "triangle.stl", "-o", "case", code=5)
    expect(failed["mesh"] is None and failed["quality"] is None and failed["failure"]["code"] == "guarantee_unmet", f"{failed['failure']}")


@scenario("mesh")
def nothing_is_replaced_unasked(box):
    box.write("x.vtu", b"mine")
    run = box.run(["mesh", "cube.stl", "-o", "x.vtu", *COARSE])
    expect(run.code == 4 and box.read("x.vtu") == b"mine", run.messages())
    box.succeed(["mesh", "cube.stl", "-o", "x.vtu", *COARSE, "--overwrite"])
    expect(box.read("x.vtu") != b"mine", "x.vtu was not replaced")
    box.succeed(["mesh", "cube.stl", "-o", "case", *COARSE])
    faces = (box.folder / "case/constant/polyMesh/faces").read_bytes()
    run = box.run(["mesh", "cube.stl", "-o", "case", "--cell", "0.25"])
    expect(run.code == 4 and "has a mesh already" in run.messages(), run.messages())
    expect((box.folder / "case/constant/polyMesh/faces").read_bytes() == faces, "the mesh was touched")


@scenario("mesh")
def the_same_bytes_with_any_number_of_threads(box):
    found = set()
    for threads in ("1", "2", "7"):
        box.succeed(["mesh", "crossing.stl", "-o", "x.vtu", "--overwrite", "-q", "--threads", threads, *COARSE])
        found.add(box.read("x.vtu"))
    expect(len(found) == 1, f"{len(found)} different meshes")


@scenario("mesh")
def a_number_of_cells_is_met(box):
    for wanted in (30000, 60000):
        m = mesh(box, "cube.stl", "--dry-run", "--cells", str(wanted))["mesh"]
        expect(abs(m["cells"] / wanted - 1) < 0.2 and len(m["trials"]) <= 3 and m["trials"][-1]["cells"] == m["cells"], f"{m['cells']} of {wanted}: {m['trials']}")


@scenario("mesh")
def lengths_are_the_models_and_the_file_is_scaled(box):
    sizes = []
    for scale in ("1", "0.001"):
        result = mesh(box, "cube.stl", "-o", "x.su2", "--overwrite", *COARSE, "--scale", scale)
        expect(abs(result["mesh"]["box"]["diagonal"] - 3 ** 0.5) < 0.1, f"{result['mesh']['box']}")
        rows = box.read("x.su2").decode().split("NPOIN=")[1].splitlines()
        sizes.append(max(float(word) for row in rows[1:20] for word in row.split()[:3]))
    expect(abs(sizes[1] / sizes[0] - 0.001) < 1e-9, f"{sizes}")


@scenario("mesh")
def reports_are_one(box):
    run = box.run(["mesh", "hole.stl", "--dry-run", "--json", "-q", "--report", "r.json", "--quality", "q.json", "--refine", "0,0,0,0.5,0.5,0.5:0.0625", "--refine", "0.5,0.5,0.5,1,1,1:5%", *COARSE])
    expect(run.code == 0, run.messages())
    printed = json.loads(run.out)
    expect(printed == json.loads(box.read("r.json")) and printed["quality"] == json.loads(box.read("q.json")), "reports differ")
    box.expect_files(["q.json", "r.json"])


@scenario("mesh")
def reports_may_lie_in_the_case(box):
    box.succeed(["mesh", "cube.stl", "-o", "runs/hh", "--report", "runs/hh/report.json", "--quality", "runs/hh/log/q.json", "-q", *COARSE])
    expect(json.loads(box.read("runs/hh/report.json"))["output"]["written"], "not written")
    expect(json.loads(box.read("runs/hh/log/q.json"))["ok"] and (box.folder / "runs/hh/constant/polyMesh/faces").exists(), "no mesh")
    # What fails before there is a report leaves no folders either.
    run = box.run(["mesh", "text.stl", "-o", "other/hh", "--report", "other/hh/report.json", *COARSE])
    expect(run.code == 3 and not (box.folder / "other").exists(), run.messages())


@scenario("mesh")
def sizes_begin_with_the_finest(box):
    m = mesh(box, "cube.stl", "--dry-run", "--refine", "0,0,0,0.3,0.3,0.3:0.25h", *COARSE)["mesh"]
    expect(m["cell"] == 0.125 and abs(m["finest_cell"] - 0.03125) < 1e-12, f"{m['cell']}, {m['finest_cell']}")
    expect(sum(m["cells_of_level"]) == m["cells"] and m["cells_of_level"][0] > 0, f"{m['cells_of_level']} of {m['cells']}")
    run = box.run(["mesh", "cube.stl", "--dry-run", "--refine", "3,3,3,4,4,4:0.25h", *COARSE])
    expect(run.code == 0, run.messages())
    expect_match(r"the box \(3, 3, 3\) to \(4, 4, 4\) .* lies beside what is meshed", run.messages(), "a box beside the model")


@scenario("mesh")
def an_interrupt_leaves_nothing(box):
    process = box.popen(["mesh", "crossing.stl", "-o", "case", "--cell", "0.008", "-q"])
    time.sleep(1.0)
    if process.poll() is None:
        process.terminate()
    process.communicate()
    expect(process.returncode in (0, 130), f"exit code {process.returncode}")
    left = [str(p.relative_to(box.folder)) for p in box.folder.rglob("*") if p.name.endswith(".tmp")]
    expect(not left, f"left behind: {left}")
    if process.returncode == 130:
        expect(not (box.folder / "case/constant/polyMesh/faces").exists(), "half a mesh")


def foam(box, *command):
    run = subprocess.run(command, cwd=box.folder, env=FOAM, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return run.returncode, run.stdout


@scenario("mesh")
def openfoam_agrees(box):
    if not shutil.which("checkMesh"):
        print("  skipped: no OpenFOAM (scripts/bootstrap peers)")
        return
    for i, (options, full) in enumerate(((["--inside"], True), (["--outside", "--domain", "1"], True), (["--flavour", "polyhedral"], False))):
        result = mesh(box, "crossing.stl", "-o", f"case{i}", "--cell", "0.1", *options)
        code, text = foam(box, "checkMesh", "-case", f"case{i}", *(["-allTopology", "-allGeometry"] if full else []))
        expect("Mesh OK" in text, f"{options}: {text[-3000:]}")
        expect(int(re.search(r"cells: +(\d+)", text)[1]) == result["mesh"]["cells"], "cells")
        worst = {c["name"]: c["worst"] for c in result["quality"]["checks"]}
        told = float(re.search(r"non-orthogonality Max: ([0-9.e+-]+)", text)[1])
        expect(abs(worst["non-orthogonality"] - told) < 1e-3 * max(1, told), f"non-orthogonality {worst['non-orthogonality']}, by checkMesh {told}")
    code, text = foam(box, "potentialFoam", "-case", "case1")
    expect(code == 0, text[-2000:])
    code, text = foam(box, "simpleFoam", "-case", "case1")
    expect(code == 0, text[-2000:])


@scenario("schemas")
def quality_alone_holds_to_its_part_of_the_schema(box):
    import jsonschema
    schema = json.loads((DOCS / "mesh.schema.json").read_text())
    box.succeed(["mesh", "cube.stl", "--dry-run", "-q", "--quality", "q.json", *COARSE])
    part = {"$schema": schema["$schema"], "$ref": "#/$defs/quality", "$defs": schema["$defs"]}
    errors = [e.message for e in jsonschema.Draft202012Validator(part).iter_errors(json.loads(box.read("q.json")))]
    expect(not errors, f"{errors}")
