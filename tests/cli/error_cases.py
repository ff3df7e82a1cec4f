"""What provokes each message of docs/errors.md: rows of cases.py, rows of this file, other tests, or a reason why nothing can.

A message counts as provoked when
  * a row of cases.py or of ROWS printed it, with its exit code (the rows are run, and what they print is compared with the catalogue), or
  * a scenario (tests/cli/*_scenarios.py) or a C++ test asserts its text: a piece of the message, of LEAST_PIECE letters or more, stands in a literal there, or
  * EXEMPT says why it cannot be provoked from outside.
To add a message: scripts/check_errors says where it is to be listed; a row here, unless another test has it already.
"""
import base64
import importlib.machinery
import importlib.util
import re
import shlex
import struct
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import cases
import models
import runner
from ic_scenarios import HEADER, write_case

ROOT = Path(__file__).resolve().parents[2]
LEAST_PIECE = 11  # letters of a message that a literal of another test has to hold


def load_checker():
    loader = importlib.machinery.SourceFileLoader("check_errors", str(ROOT / "scripts" / "check_errors"))
    spec = importlib.util.spec_from_loader("check_errors", loader)
    module = importlib.util.module_from_spec(spec)
    sys.modules["check_errors"] = module
    loader.exec_module(module)
    return module


def regex_of(message):
    return re.compile(".*?".join(re.escape(part) for part in message.split("{}")), re.DOTALL)


LITERAL = re.compile(r'"((?:\\.|[^"\\\n])*)"')
# What separates fixed text within a literal: metacharacters of regular expressions, and fmt's fields.
JOINT = re.compile(r"\\[dwsSDWnAZb]|\{[^}]*\}|[.\])?][*+?]+|\[[^\]]*\][*+]?|[()|^$*]")


def asserted_texts():
    """Fixed pieces of text in the literals of scenarios and C++ tests, long enough to be of one message."""
    pieces = set()
    for folder, pattern in (("tests/cli", "*_scenarios.py"), ("tests/cli", "scenarios.py"), ("tests", "**/*_test.cpp")):
        for path in (ROOT / folder).glob(pattern):
            for literal in LITERAL.findall(path.read_text(encoding="utf-8")):
                parts = [re.sub(r"\\(?=\W)", "", part).strip(" :,") for part in JOINT.split(literal)]
                pieces.update(p for p in parts if len(p) >= LEAST_PIECE)
    return pieces


def unprovoked(catalogue, printed):
    """Rows of the catalogue that nothing provokes; `printed`: (exit code, text on standard error) of all commands that were run."""
    pieces = asserted_texts()
    for code, message, number, _ in catalogue:
        wanted = regex_of(message)
        ran = any((code == "-" or code == str(c)) and wanted.search(text) for c, text in printed)
        told = any(piece in message for piece in pieces)
        if not ran and not told and message not in EXEMPT:
            yield code, message, number


FROM_LIBRARY = "the command line checks this first: only a caller of the library can meet it"
TOO_LARGE = "takes an input or a result of billions of items"
NO_MEMORY = "the system has to refuse memory at this very moment"
INVARIANT = "a broken invariant of Burnish itself"
RACE = "the disk has to fail, or somebody else to change it, between two steps"
BUILD = "depends on how this build was configured; the other kind of build is tested"
RARE = "depends on the geometry of a result in ways that no small input is known to bring about"

EXEMPT = {message: reason for reason, messages in {
    FROM_LIBRARY: """the error criterion needs a tolerance of 0 or more and a band of at least 2 cells
distances of {} cells are too few for an offset of {}
nodal curvatures have no k1 and k2 to be checked
nodal curvatures are of order 2 or 4
a band of {} cells is less than the {} that ACCEPTED cells need
--cell must be a length greater than zero
noise of an example must be a finite number, 0 or more
number of holes of an example must be 0 or more
the surface has no facets
options of volumes are for files of values
point {} of the result is beyond the range of float32
the deviation to simplify within is negative or no number
the volume has no values
{}: expected at least one along each axis
not the name of a volume
no voxel is {} {}: there is no surface
has no name
the surface to simplify is no consistently oriented 2-manifold
the surface to remesh is no consistently oriented 2-manifold
the surface to remesh is no 2-manifold: shells share a point
the patch {} is to be of two types, {} and {}
the surface reaches the end of the domain
no such example shape
{}: the format has no cells for the {} polyhedra of the mesh""",
    TOO_LARGE: """{}: {} items are more than numbers of {} bits count
{}: {} corners of faces are more than labels of 32 bits count
more than the {} points that can be read
more facets than can be read
more than the {} facets that can be read
{} are more than the {} that can be read
{}: unpacks to more than {} GB
{}: the domain is 2^{} of its smallest cells wide; at most 2^{} can be written
the volume is {} cells long; {} are possible
the surface cuts the lattice into more than 2^32 pieces
the octree would have more than 2^32 - 2 blocks
an octree of single cells can have 1048576 cells a side; this one needs more
an octree of cells can have {} along a side; with a cell of {} it needs more
the mesh would have more than 2^31 cells
the mesh would have more than 2^20 cells along a side
the mesh would have more than 2^32 nodes
the mesh would have {} {}, and 32 bits number {}""",
    NO_MEMORY: """out of memory
{}: cannot be unpacked
{}: cannot be compressed
zlib: not enough memory to decompress
zlib: not enough memory to compress a block
zlib: not enough memory to compress a mesh""",
    INVARIANT: """internal error: {}
a face of the volume mesh has more than two cells
a face of the volume mesh has no nearest facet
a face of the volume mesh is neither on the surface nor on a side of the domain""",
    RACE: """{}: cannot be read back
{}: OpenVDB: {}
{}: cannot be kept: {}
{}: cannot be written into: {}""",
    BUILD: """{}: this build writes no .cgns: it was made without the CGNS library
{}: this build writes no .vdb: it was made without OpenVDB""",
    RARE: """the result has {} components and genus {}; the level set has {} and {}
no solid: nothing of the input bounds a volume that cells of this size can hold
nothing to work on: none of the {} facets has an area
the mesh does not pass {} ({})
a mesh with cells of {} has about {} cells and {}
with coarser cells the result was no valid surface: --adapt was left out
parts of the input with {} of area are not in the result; the largest is at ({}, {}, {}): {}
the surface was not remeshed: {}
{} of {} facets were not remeshed: they would have met others
simplified to {} facets: {}
for so few facets, creases below {} degrees were given up
smoothing moved the surface away from {} of {} points, by {} or more, or left nothing of it there: they have no curvature; a smaller --smooth keeps it nearer
no more cells fit into memory on the way to {}: {}; raise --memory
the mesh has {} connected regions, and {} would be right: {}; a smaller --cell resolves more
the mesh's volume is {} % off what is to be meshed: the cell is large for this model
{} of {} cells have no volume, or a negative one: checkMesh tells which; their fractions are of no value
none of the model's volume is in the mesh, though their boxes meet: all fractions are 0
the level set has cells of {}, not of {}, to stay within the memory budget: raise --memory
smoothing changed the volume by {} %: {}
{} small pieces that stand for no component of the input were left out
was not written: {}""",
    "a signal has to come while the program works: the group 'signals' sends them": """interrupted
interrupted while reading {}""",
}.items() for message in messages.splitlines()}

# --- the tests


def run_row(case, program):
    """What a row of cases.py prints."""
    with runner.Sandbox(program) as box:
        result = box.run(shlex.split(case.command), case.stdin, case.env)
        return result.code, result.messages()


def every_message_is_provoked(program):
    """All that the catalogue lists is printed by a row here or of cases.py, asserted by another test, or has a reason not to be."""
    catalogue = load_checker().catalogue(ROOT)
    printed = [row.run(program) for row in ROWS]
    printed += [run_row(case, program) for rows in cases.GROUPS.values() for case in rows if case.code != 0]
    left = list(unprovoked(catalogue, printed))
    runner.expect(not left, "no test provokes these messages of docs/errors.md; add to ROWS of tests/cli/error_cases.py\n"
                  "  line(MESSAGE, COMMAND, EXIT_CODE), or an entry of EXEMPT with the reason:\n" +
                  "\n".join(f"  docs/errors.md:{number}: {code} {message}" for code, message, number in left))


def exemptions_are_of_the_catalogue(_program):
    listed = {message for _, message, _, _ in load_checker().catalogue(ROOT)}
    gone = sorted((set(EXEMPT) | {row.message for row in ROWS}) - listed)
    runner.expect(not gone, "not in docs/errors.md any more; remove from tests/cli/error_cases.py:\n" + "\n".join(gone))


def tests():
    """(name, function of the program's path)."""
    for function in (exemptions_are_of_the_catalogue, every_message_is_provoked):
        yield function.__name__, function
