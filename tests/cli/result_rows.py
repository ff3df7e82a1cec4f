"""Rows that provoke messages of docs/errors.md: what depends on the geometry of a result, and on memory while it is made (see error_cases.py)."""
import models
from provoked import Provoked, line


def made(shape, name, *options):
    """What makes an example."""
    return lambda box: box.succeed(["example", shape, *options, "-q", "-o", name])


def boxes(*sizes):
    """Unit cubes scaled by `sizes` and moved: ((size, size, size), (x, y, z))."""
    return models.binary_stl([tuple(tuple(s * c + o for s, c, o in zip(size, p, at)) for p in f) for size, at in sizes for f in models.cube()])


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
    # Volume meshes.
    line("the solid is thinner than a cell everywhere", "mesh m.stl -o m --cell 0.3", 5, files={"m.stl": SLAB}),
    line("a mesh with cells of {} has about {} cells and {}", "mesh m.stl -o m --cells 2000 --memory 3M --outside", 6, files={"m.stl": SLAB}),
    line("no more cells fit into memory on the way to {}: {}; raise --memory", "mesh n.stl -o m --cells 3000 --memory 4M", 0, before=NOISY),
    line("the box {} that is to have cells of {} lies beside what is meshed, {}, and has no effect", "mesh cube.stl -o m --cell 0.2 --refine 9,9,9,10,10,10:0.1", 0),
    line("{} parts of less than {} cells that hang together with the rest by no face, {} in all, are left out", "mesh n.stl -o m --cell 0.5", 0,
         before=made("sphere", "n.stl", "--noise", "1", "--holes", "2")),
    # Volume fractions.
    Provoked("a level set with cells of {} takes about {} GB; the budget is {} GB", "ic m.stl --case case --method linear --cell 0.0001 --memory 1M", 6, {"m.stl": IN_THE_MESH}),
    Provoked("the level set has cells of {}, not of {}, to stay within the memory budget: raise --memory", "ic m.stl --case case --method linear --memory 30K", 0, {"m.stl": IN_THE_MESH}),
]
