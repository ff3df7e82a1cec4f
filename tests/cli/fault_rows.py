"""Rows that provoke messages of docs/errors.md: what only a fault of the system brings about (see error_cases.py and faults.py)."""
import os
import struct

import faults
from ic_scenarios import write_case
from provoked import MESH, Provoked, nrrd, packed
from threemf_rows import GOOD


def failing(message, fault, command, code, file="", **more):
    """While the function `fault` fails."""
    return Provoked(message, command, code, fault=(fault, file), **more)


def one_large_hole(box):
    """A binary STL of one facet more than can be read, in 70 GB that no disk holds."""
    facets = (2**32 - 1) // 3 + 1
    with open(box.folder / "m.stl", "wb") as file:
        file.write(bytes(80) + struct.pack("<I", facets))
        file.truncate(84 + 50 * facets)


def with_pipe(box):
    """A case whose mesh has a pipe beside it, which nothing can copy."""
    write_case(box)
    os.mkfifo(box.folder / "case" / MESH / "pipe")


def read_only(box):
    (box.folder / "case").mkdir()
    (box.folder / "case").chmod(0o555)
    faults.let_nobody_in(box)


ROWS = [
    # Memory that the system refuses.
    failing("zlib: not enough memory to compress a block", "compress2", "field cube.stl -o x.vtu --cell 0.2", 6),
    failing("zlib: not enough memory to compress a block", "deflateInit2", "field cube.stl -o x.nrrd --cell 0.2 --samples 8", 6),
    failing("zlib: not enough memory to compress a mesh", "compress2", "cube.stl -o x.stl --html x.html", 6),
    failing("zlib: not enough memory to decompress", "inflateInit2", "v.nrrd --iso 9.5 -o x.stl", 6, files=nrrd("", ("encoding: ascii", "encoding: gzip\nendian: little")).files),
    failing("{}: cannot be unpacked", "inflateInit2", "ic cube.stl --case case", 3, before=lambda box: packed(box.folder / "case" / MESH / "points")),
    failing("{}: cannot be compressed", "deflateInit2", "mesh cube.stl -o case --cell 0.2 --compressed", 4),
    Provoked("out of memory", "truncate -s 1G m.stl; ulimit -v 500000; burnish check m.stl --threads 1", 6, in_shell=True),
    failing("no process", "fork", "check cube.stl hole.stl", 6),
    failing("no thread: {}", "pthread_create", "check knot.stl", 6, before=lambda box: box.succeed(["example", "knot", "-q", "-o", "knot.stl"])),
    failing("{} are more than the {} that can be read", "nothing, and maps lazily", "check m.stl", 3, before=one_large_hole),
    # Disks that fail, folders that are shut.
    failing("{}: cannot be read back", "read", "mesh cube.stl -o x.cgns --cell 0.2", 4, file=".tmp", library="the CGNS library"),
    Provoked("{}: cannot be kept: {}", "mesh cube.stl -o case --cell 0.2 --overwrite", 4, before=with_pipe),
    Provoked("{}: cannot be written into: {}", faults.as_nobody("mesh cube.stl -o case --cell 0.2"), 4, in_shell=True, before=read_only),
    # What no library should do.
    failing("has a triangle with the point {} of a mesh that has {}", "gettriangleindices", "check m.3mf", 3, files={"m.3mf": GOOD}),
    failing("internal error: {}", "a thrown surprise", "field cube.stl -o x.vtu --cell 0.2", 70),
]
