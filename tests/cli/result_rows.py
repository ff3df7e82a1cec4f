"""Rows that provoke messages of docs/errors.md: what depends on the geometry of a result, and on memory while it is made (see error_cases.py)."""
import math

import models
from provoked import Provoked, line, nrrd


def made(shape, name, *options):
    """What makes an example."""
    return lambda box: box.succeed(["example", shape, *options, "-q", "-o", name])


def boxes(*sizes):
    """Unit cubes scaled by `sizes` and moved: ((size, size, size), (x, y, z))."""
    return models.binary_stl([tuple(tuple(s * c + o for s, c, o in zip(size, p, at)) for p in f) for size, at in sizes for f in models.cube()])


def turned_box(size, at, turn):
    """A unit cube about the origin, turned about z and x by `turn`, then scaled and moved."""
    (cos_z, sin_z), (cos_x, sin_x) = ((math.cos(angle), math.sin(angle)) for angle in turn)

    def moved(p):
        x, y, z = (c - 0.5 for c in p)
        x, y = x * cos_z - y * sin_z, x * sin_z + y * cos_z
        y, z = y * cos_x - z * sin_x, y * sin_x + z * cos_x
        return tuple(s * c + o for s, c, o in zip(size, (x, y, z), at))

    return [tuple(moved(p) for p in f) for f in models.cube()]


ENDLESS = "--memory 9000000G"
FAR = 39000  # where float32 has steps of 0.04 cells


def far_sphere(box):
    """One with holes, where float32 has steps of 0.02 cells."""
    made("sphere", "s.stl", "--holes", "6", "--seed", "21")(box)
    triangles = models.as_points(models.read_binary_stl(box.read("s.stl")))
    box.write("m.obj", models.write_obj([tuple(tuple(c + 30000 for c in p) for p in f) for f in triangles]))


def speck_between_cubes(cell, node):
    """A cube of 0.0025 cells around `node`, a node of the lattice that has three coordinates alike, and two cubes about it."""
    middle = [node - part * cell for part in (0.371029, 0.412937, 0.297183)]  # by which make_frame moves the lattice
    side = 0.0025 * cell
    whole = (((1, 1, 1), [c - 1.5 for c in middle]), ((1, 1, 1), [c + 0.5 for c in middle]), ((side, side, side), [node - side / 2] * 3))
    return models.write_obj([tuple(tuple(s * c + o for s, c, o in zip(size, p, at)) for p in f) for size, at in whole for f in models.cube()])


NOISY = made("sphere", "n.stl", "--noise", "0.5")
SLAB = boxes(((1, 1, 0.1), (0, 0, 0)))
IN_THE_MESH = boxes(((0.6, 0.6, 0.6), (0.15, 0.15, 0.15)))
FLAT = models.binary_stl([((0, 0, 0), (1, 0, 0), (2, 0, 0)), ((0, 0, 0), (0, 1, 0), (0, 2, 0))])

ROWS = [
    line("redistancing by {} was not steady {} times: the surface may have moved with it; --redistance closest is exact and faster",
         "n.stl -o x.stl --smooth 30% --mode mcf --redistance pde-weno5 --resolution 8", 0, before=NOISY),
    line("simplified to {} facets: {}", "n.stl -o x.stl --facets 100 --simplify 0.0001", 0, before=NOISY),
    line("{} small pieces that stand for no component of the input were left out", "v.stl -o x.stl --method levelset --resolution 16 --surface tetrahedra", 0,
         before=made("vase", "v.stl", "--holes", "2", "--seed", "121")),
    line("{} of {} facets were not remeshed: they would have met others", "v.stl -o x.stl --method levelset --resolution 16 --adapt 0.1h --edge 4h", 0,
         before=made("vase", "v.stl", "--holes", "2", "--seed", "121")),
    line("nothing to work on: none of the {} facets has an area", "m.stl -o x.stl --thicken 0.1", 5, files={"m.stl": FLAT}),
    line("was not written: {}", "cube.stl -o x.stl --smooth 2 --mode mcf --free-volume --resolution 12 --snapshots s", 5),
    line("the surface was not remeshed: {}", "s.stl -o x.stl --method levelset --resolution 14 --hollow 0.429 --surface tetrahedra --edge 30h", 0, before=made("sphere", "s.stl")),
    line("with coarser cells the result was no valid surface: --adapt was left out", "m.stl -o x.ply --method levelset --resolution 8 --adapt 0.1h --crease 60", 5,
         files={"m.stl": boxes(((0.03, 0.3, 1), (1, 0.9, 0)))}),
    line("creases were not cut into the result: it would have met itself there", "m.obj -o x.stl --method levelset --cell 0.1 --surface delaunay", 0,
         files={"m.obj": models.write_obj(turned_box((0.3, 0.1, 0.1), (FAR, FAR, FAR), (0.39, 0.6)) +
                                          [tuple((0.03 * x + 0.5 + FAR, y + 0.9 + FAR, 0.1 * z + 0.24 + FAR) for x, y, z in f) for f in models.cube()])}),
    line("the result could not be verified as a valid solid: {}", "m.obj -o x.stl --method levelset --cell 0.1 --keep-openings --facets 100 --surface tetrahedra", 5, before=far_sphere),
    # The speck's points become one in float32, and a 3MF has no facets without an area.
    line("the result has {} components and genus {}; the level set has {} and {}", "m.obj -o x.3mf --method levelset --cell 0.08 --surface tetrahedra", 5,
         files={"m.obj": speck_between_cubes(0.08, 33001.5)}),
    # Volume meshes.
    line("the mesh does not pass {} ({})", "mesh cube.stl -o m --cell 0.2 --scale 1e-110", 5),
    line("{} cells at the surface would be bad whatever becomes of their points, and are left out", "mesh m.obj -o m --cell 9%", 0,
         files={"m.obj": models.write_obj(turned_box((1, 1, 1), (0, 0, 0), (1.1, 0.8)))}),
    line("the solid is thinner than a cell everywhere", "mesh m.stl -o m --cell 0.3", 5, files={"m.stl": SLAB}),
    line("a mesh with cells of {} has about {} cells and {}", "mesh m.stl -o m --cells 2000 --memory 3M --outside", 6, files={"m.stl": SLAB}),
    line("no more cells fit into memory on the way to {}: {}; raise --memory", "mesh n.stl -o m --cells 3000 --memory 4M", 0, before=NOISY),
    line("the box {} that is to have cells of {} lies beside what is meshed, {}, and has no effect", "mesh cube.stl -o m --cell 0.2 --refine 9,9,9,10,10,10:0.1", 0),
    line("{} parts of less than {} cells that hang together with the rest by no face, {} in all, are left out", "mesh n.stl -o m --cell 0.5", 0,
         before=made("sphere", "n.stl", "--noise", "1", "--holes", "2")),
    # Volume fractions.
    Provoked("a level set with cells of {} takes about {} GB; the budget is {} GB", "ic m.stl --case case --method linear --cell 0.0001 --memory 1M", 6, {"m.stl": IN_THE_MESH}),
    Provoked("the level set has cells of {}, not of {}, to stay within the memory budget: raise --memory", "ic m.stl --case case --method linear --memory 30K", 0, {"m.stl": IN_THE_MESH}),
    # More cells than can be counted: the budget is no obstacle.
    line("the mesh would have more than 2^20 cells along a side", f"mesh cube.stl -o m --outside --domain 100000 --cell 0.1 --coarsest 10 {ENDLESS}", 6),
    line("the mesh would have more than 2^31 cells", f"mesh cube.stl -o m --outside --domain 1000 --cell 0.1 --refine=-900,-900,-900,900,900,900:0.1 {ENDLESS}", 6),
    line("an octree of cells can have {} along a side; with a cell of {} it needs more", f"field cube.stl --cell-octree --cell 3e-7 {ENDLESS}", 6),
    nrrd("the volume is {} cells long; {} are possible", ("spacings: 1 1 1", "spacings: 1 1 1e-7"), code=6, command=f"v.nrrd --iso 9.5 -o x.stl {ENDLESS}"),
]
