"""Rows that provoke messages of docs/errors.md: options that exclude each other, outputs that cannot be, results and their warnings (see error_cases.py)."""
import os
import re

import models
from ic_scenarios import write_case
from provoked import MESH, Provoked, line, model, nrrd

HUGE = models.write_obj([tuple(tuple(c * 1e39 for c in p) for p in f) for f in models.cube()])


def zipped(path):
    """A gzip file in its place, which is cut off behind the header."""
    path.unlink()
    path.with_name(path.name + ".gz").write_bytes(b"\x1f\x8b\x08\0\0\0\0\0\0\3\xab")


def noisy(box):
    box.succeed(["example", "sphere", "--noise", "0.5", "-q", "-o", "n.stl"])


def turned_over(box):
    """A case whose points are mirrored."""
    path = box.folder / "case" / MESH / "points"
    path.write_text(re.sub(r"\((\S+) (\S+) (\S+)\)", r"(-\1 \2 \3)", path.read_text()))


ROWS = [
    # Options that exclude each other.
    line("--snapshots and -o - exclude each other", "cube.stl -o - --smooth 0.1 --snapshots 2"),
    Provoked("--mode reinit smooths everything: it excludes --region and --curvature-radius", "cube.stl -o x.stl --smooth 0.1 --mode reinit --region r.txt", 2, {"r.txt": b"sphere 0 0 0 1\n"}),
    line("--surface delaunay makes closed surfaces: there are no openings to keep", "cube.stl -o x.stl --surface delaunay --keep-openings"),
    Provoked("{} {}: expected a name such as alpha.water", "ic cube.stl --case case --field a/b", 2),
    line("no case: --case names the folder of one", "ic cube.stl"),
    Provoked("--field and --also-phi name the same field {}", "ic cube.stl --case case --field a --also-phi a", 2),
    Provoked("expected NAME=V, found '{}'", "ic cube.stl --case case --patch-value walls", 2),
    line("--cell and --cells exclude each other", "mesh cube.stl -o m --cell 0.1 --cells 1000"),
    line("--inside and --outside exclude each other", "mesh cube.stl -o m --inside --outside"),
    line("--domain is the box around the model", "mesh cube.stl -o m --domain 20"),
    line("a mesh cannot go to standard output", "mesh cube.stl -o -"),
    line("--msh-version is for a .msh file", "mesh cube.stl -o m.vtu --msh-version 2.2"),
    line("{}: the format has no polyhedra", "mesh cube.stl -o m.su2 --flavour polyhedral"),
    # Inputs.
    model("holds no facets ({}{})", "m.stl", "solid x\nendsolid x\n"),
    Provoked("{}: byte {}: the gzip file is broken or cut off", "ic cube.stl --case case", 3, before=lambda box: zipped(box.folder / "case" / MESH / "points")),
    line("is not an OpenFOAM case: neither system/controlDict nor constant/ is there", "ic cube.stl --case folder", 3),
    # Outputs.
    Provoked("is a folder", "example sphere -o d.stl", 4, before=lambda box: (box.folder / "d.stl").mkdir()),
    Provoked("is not a regular file", "example sphere -o d.stl --overwrite", 4, before=lambda box: os.mkfifo(box.folder / "d.stl")),
    Provoked("{}: exists: the case has a mesh already", "mesh cube.stl -o case --cell 0.3", 4, mesh=None, before=write_case),
    model("{}: the point ({}, {}, {}) is beyond the range of float32", "m.obj", HUGE, 4, options="--method local"),
    # Results.
    line("{} cells need about {} GB; the budget is {} GB", "mesh cube.stl -o m --cells 4000M --memory 1G", 6),
    line("edges of {} make about {} facets, which need {} GB; the budget is {} GB", "cube.stl -o x.stl --edge 0.0001 --memory 100M --cell 0.1", 6),
    # Warnings.
    line("redistancing was not steady after {} steps: the last one's changes were {} of it", "field cube.stl -o x.vti --redistance pde-weno5 --cell 0.1 --samples 8", 0),
    line("closing the {} open loops added {} % to the area; if the model is meant to be open there, 'burnish IN -o OUT' cleans it with --keep-openings, or gives it a thickness with --thicken T", "open.stl -o x.stl", 0, files={"open.stl": models.binary_stl([f for f in models.cube() if any(p[2] < 1 for p in f)])}),
    line("the domain is near the model: cells larger than {} have no room there, and with these there are more than {}", "mesh cube.stl -o m --outside --domain -0.3,-0.3,-0.3,1.3,1.3,1.3 --cells 100", 0),
    line("layers of {} cells height: checkMesh -allGeometry takes cells flatter than {} for badly shaped; they will be missing in places", "mesh cube.stl -o m --cell 0.2 --layers 2 --first 0.0005", 0),
    Provoked("{} of the input's components ({} of area) are not in the result, being thinner than a cell or smaller than the smoothing length; the largest is at ({}, {}, {})",
             "m.stl -o x.stl --method levelset --cell 0.1", 0, {"m.stl": models.binary_stl(models.cube() + [tuple(tuple(c * 0.01 + 1.5 for c in p) for p in f) for f in models.cube()])}),
    Provoked("{} facets ({} of area) bound sheets or walls thinner than a cell of {} and are not in the result; choose a smaller --cell if they matter",
             "m.stl -o x.stl --method levelset --cell 0.1", 0, {"m.stl": models.binary_stl(models.cube() + [((2, 0, 0), (3, 0, 0), (3, 1, 0)), ((2, 0, 0), (3, 1, 0), (2, 1, 0))])}),
    Provoked("parts of the surface with {} of area ({} %) are not in the mesh, being thinner than a cell; the largest is at {}, {} cells off: a smaller --cell keeps more",
             "mesh m.stl -o m --cell 0.2", 0, {"m.stl": models.binary_stl(models.cube() + [tuple((p[0] + 2, p[1], p[2] * 0.02) for p in f) for f in models.cube()])}),
    Provoked("the model is {} times as large as the mesh: {}{}{}", "ic m.stl --case case", 0, {"m.stl": models.binary_stl([tuple(tuple(c * 1000 - 1 for c in p) for p in f) for f in models.cube()])}),
    line("{} is for an OpenFOAM case", "mesh cube.stl -o m.vtu --ascii"),
    Provoked("the result is {} from the repaired surface, and --deviation allows {}", "n.stl -o x.stl --smooth 0.5 --mode mcf --free-volume --deviation 0.01 --resolution 12", 5, before=noisy),
    nrrd("a level set with cells of {}, the least of the spacings {}, {}, {}, takes at least {} GB; the budget is {} GB", ("spacings: 1 1 1", "spacings: 1 1 10000"), code=6,
         command="v.nrrd --iso 9.5 -o x.stl --memory 10M"),
    nrrd("the solid runs off the volume at {} of its border voxels, and was closed there", code=0),
    line("the surface is made of flat facets, {} cells per mean edge: its curvature sits on their edges; --smooth L, with L of a few edges ({}), gives that of the shape they stand for",
         "curvature cube.stl -o x.vtp --cell 0.05", 0),
    line("the integral of k1 k2 is {}, and {} for any surface like this one: edges or details are not resolved; choose a smaller --cell, or smooth them", "curvature cube.stl -o x.vtp --cell 0.05", 0),
    line("for so few facets, creases below {} degrees were given up", "example.stl -o x.stl --facets 8", 0, before=lambda box: box.succeed(["example", "vase", "-q", "-o", "example.stl"])),
    Provoked("none of the model's volume is in the mesh, though their boxes meet: all fractions are 0", "ic m.stl --case case", 0,
             {"m.stl": models.binary_stl([tuple(tuple(c * 0.01 - 0.5 for c in p) for p in f) for f in models.cube()] + [tuple(tuple(c * 0.01 + 3 for c in p) for p in f) for f in models.cube()])}),
    Provoked("the mesh has {} connected regions, and {} would be right: {}; a smaller --cell resolves more", "mesh m.stl -o m --cell 0.3", 0,
             {"m.stl": models.binary_stl(models.cube() + models.cube(offset=(1.1, 0, 0)))}),
    Provoked("no solid: nothing of the input bounds a volume that cells of this size can hold", "m.stl -o x.stl --method levelset --cell 0.3", 5,
             {"m.stl": models.binary_stl([tuple((p[0], p[1], p[2] * 0.001) for p in f) for f in models.cube()])}),
    Provoked("parts of the input with {} of area are not in the result; the largest is at ({}, {}, {}): {}", "m.stl -o x.stl --method levelset --cell 0.2", 0,
             {"m.stl": models.binary_stl(models.cube() + [tuple((p[0] * 0.05 + 0.5, p[1] * 0.05 + 0.5, p[2] + 0.9) for p in f) for f in models.cube()])}),
    Provoked("{} of {} cells have no volume, or a negative one: checkMesh tells which; their fractions are of no value", "ic cube.stl --case case", 0, before=turned_over),
    line("with other facets the surface is no valid solid once it is written", "n.stl -o x.stl --facets 4", 5, before=noisy),
    line("the Delaunay surface could not be made, and the octree's is the result: {}", "n.stl -o x.stl --method levelset --resolution 48 --adapt 2h", 0, before=noisy),
    line("{} % of the {} no curvature: edges and corners, or details of the size of a cell", "curvature cube.stl -o x.vtp --cell 0.05 --at vertices", 0),
    line("{} % of the {} no curvature: edges and corners, or details of the size of a cell", "curvature n.stl -o x.vtp --resolution 12", 0, before=noisy),
    line("the mesh's volume is {} % off what is to be meshed: the cell is large for this model", "mesh n.stl -o m --cell 0.7", 0, before=noisy),
    line("smoothing changed the volume by {} %: {}", "cube.stl -o x.stl --smooth 3 --mode mcf --resolution 16", 5),
]
