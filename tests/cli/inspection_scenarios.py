"""3MF files by the rules of the core specification, wall thickness, alignment: as the program writes and tells them."""
import io
import json
import math
import xml.etree.ElementTree as ElementTree
import zipfile
from collections import Counter

import models
from runner import expect, expect_match
from scenarios import expect_valid, json_result, scenario

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
PACKAGE = "{http://schemas.openxmlformats.org/package/2006/"


def has_3mf(box):
    return "without lib3mf" not in box.run(["cube.stl", "-o", "probe.3mf", "-q"]).messages()


def expect_core_rules(data):
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        expect(archive.testzip() is None, "a checksum is wrong")
        parts = {name: ElementTree.fromstring(archive.read(name)) for name in archive.namelist()}
    types = {e.get("Extension"): e.get("ContentType") for e in parts["[Content_Types].xml"].iter(PACKAGE + "content-types}Default")}
    expect(types.get("model") == "application/vnd.ms-package.3dmanufacturing-3dmodel+xml", f"{types}")
    expect(types.get("rels") == "application/vnd.openxmlformats-package.relationships+xml", f"{types}")
    relations = list(parts["_rels/.rels"].iter(PACKAGE + "relationships}Relationship"))
    starts = [r.get("Target") for r in relations if r.get("Type") == "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"]
    expect(len(starts) == 1 and starts[0][1:] in parts, f"{starts} of {list(parts)}")
    model = parts[starts[0][1:]]
    ids = [e.get("id") for e in model.find(CORE + "resources")]
    expect(len(ids) == len(set(ids)) and all(int(i) > 0 for i in ids), f"ids {ids}")
    items = [e.get("objectid") for e in model.find(CORE + "build")]
    expect(items and set(items) <= set(ids), f"items {items} of {ids}")
    for mesh in model.iter(CORE + "mesh"):
        count = len(mesh.find(CORE + "vertices"))
        edges = Counter()
        for t in mesh.find(CORE + "triangles"):
            v = [int(t.get(k)) for k in ("v1", "v2", "v3")]
            expect(len(set(v)) == 3 and 0 <= min(v) and max(v) < count, f"triangle {v} of {count} vertices")
            edges.update((v[i], v[(i + 1) % 3]) for i in range(3))
        expect(all(n == 1 and edges[b, a] == 1 for (a, b), n in list(edges.items())), "not manifold and oriented")
    return model


@scenario("inspection")
def a_3mf_holds_to_the_core_specification(box):
    if not has_3mf(box):
        return
    for name, unit, written in (("cube.stl", "in", "inch"), ("hole.stl", "mm", "millimeter"), ("crossing.stl", "um", "micron")):
        box.succeed([name, "-o", "x.3mf", "--overwrite", "-q", "--units", unit])
        expect(expect_core_rules(box.read("x.3mf")).get("unit") == written, f"{name}: not in {written}")


@scenario("inspection")
def to_3mf_and_back(box):
    if not has_3mf(box):
        return
    box.succeed(["cube.stl", "-o", "x.3mf", "-q"])
    box.succeed(["x.3mf", "-o", "y.stl", "-q"])
    points = lambda data: sorted(sorted(t[i:i + 3] for i in (0, 3, 6)) for t in models.read_binary_stl(data))
    expect(points(box.read("y.stl")) == points(box.read("cube.stl")), "another cube")
    expect_match(r"\Ax\.3mf \(3MF, in mm\)\n", box.succeed(["check", "x.3mf"]).text(), "the first line")
    run = box.succeed(["check", "x.3mf", "--units", "in"])
    expect_match(r"warning: x\.3mf: the file says that its unit is mm, --units says in", run.messages(), "warning")


@scenario("inspection")
def thickness_of_a_cube(box):
    data = json_result(box, "check", "cube.stl", "--thickness")["thickness"]
    expect(abs(data["minimum"] - 1) < 1e-6, f"{data}")
    json_result(box, "check", "cube.stl", "--min-thickness", "0.9")
    thin = json_result(box, "check", "cube.stl", "--min-thickness", "1.1", code=1)["thickness"]
    expect(len(thin["places"]) > 0, f"{thin}")
    run = box.run(["check", "hole.stl", "--thickness"])
    expect(run.code == 1, f"exit code {run.code}")
    for threads in (1, 2):
        box.succeed(["check", "cube.stl", "--output-thickness", f"{threads}.ply", "--threads", str(threads), "-q"])
    expect(box.read("1.ply") == box.read("2.ply"), "other bytes on another number of threads")


def turned_wedge():
    """A tetrahedron without symmetry, and the same turned about z and shifted."""
    corners = [(0, 0, 0), (3, 0, 0), (0, 2, 0), (0.5, 0.25, 1)]
    facets = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    c, s = math.cos(1.1), math.sin(1.1)
    moved = [(c * x - s * y + 5, s * x + c * y - 2, z + 7) for x, y, z in corners]
    return ([tuple(p[i] for i in f) for f in facets] for p in (corners, moved))


@scenario("inspection")
def a_turned_part_is_laid_back(box):
    a, b = turned_wedge()
    box.write("a.stl", models.binary_stl(a))
    box.write("b.stl", models.binary_stl(b))
    far = box.run(["compare", "a.stl", "b.stl", "--max", "1%", "-q"])
    expect(far.code == 1, f"exit code {far.code} without --align")
    result = json_result(box, "compare", "a.stl", "b.stl", "--max", "0.001%", "--align", "--aligned", "c.stl")
    aligned = result["alignment"]
    expect(aligned["converged"] and aligned["free_motions"] == 0 and aligned["rms_after"] < 1e-5, f"{aligned}")
    expected = [c for t in b for p in t for c in p]
    found = [c for t in models.read_binary_stl(box.read("c.stl")) for c in t]
    expect(max(abs(x - y) for x, y in zip(found, expected)) < 1e-5, f"{found}")
    run = box.run(["compare", "a.stl", "b.stl", "--aligned", "c.stl"])
    expect(run.code == 4, f"exit code {run.code} over a file that exists")
