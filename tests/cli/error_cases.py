"""What provokes each message of docs/errors.md: rows, other tests, or a reason why nothing can.

A message counts as provoked when
  * a row of cases.py, or of a table of ROWS, printed it with its exit code (the rows are run, and what they print is compared with the catalogue), or
  * NAMED has the name of a test that asserts it: the test exists, and a literal in it holds a piece of the message that no other message has, or
  * EXEMPT says why it cannot be provoked from outside.
To add a message: scripts/check_errors says where it is to be listed; a row in the table of its topic (error_rows.py, option_rows.py, batch_rows.py, threemf_rows.py).
"""
import importlib.machinery
import importlib.util
import shlex
import sys

import batch_rows
import cases
import error_rows
import fault_rows
import named_tests
import option_rows
import result_rows
import runner
import threemf_rows
from provoked import regex_of

ROOT = named_tests.ROOT
ROWS = [*error_rows.ROWS, *option_rows.ROWS, *batch_rows.ROWS, *threemf_rows.ROWS, *result_rows.ROWS, *fault_rows.ROWS]


def load_checker():
    loader = importlib.machinery.SourceFileLoader("check_errors", str(ROOT / "scripts" / "check_errors"))
    spec = importlib.util.spec_from_loader("check_errors", loader)
    module = importlib.util.module_from_spec(spec)
    sys.modules["check_errors"] = module
    loader.exec_module(module)
    return module


FROM_LIBRARY = "the command line checks this first: only a caller of the library can meet it"
TOO_LARGE = "takes an input or a result of billions of items"
NO_MEMORY = "the system has to refuse memory at this very moment"
INVARIANT = "a broken invariant of Burnish itself"
RACE = "the disk has to fail, or somebody else to change it, between two steps"
BUILD = "depends on how this build was configured; the other kind of build is tested"
SHARED = "makes a batch run the file again with all of the memory, and is never printed (scenario a_share_of_the_memory_changes_no_result)"
OPEN = "no row yet: the inputs that were tried do not bring it about"
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
{}: the format has no cells for the {} polyhedra of the mesh
{}: version {} of gmsh's format is not written
--verify-exact compares with the facets of the input, and --smooth moves the surface away from them
the edge length to remesh to is not positive
the field has no boundaryField
volume fractions need a closed surface, and this one is open
has a triangle with the point {} of a mesh that has {}""",
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
the mesh would have {} {}, and 32 bits number {}
holds more points than 32 bits count
{}: the model takes 4 GiB of a ZIP archive or more""",
    NO_MEMORY: """no process
out of memory
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
{}: this build writes no .vdb: it was made without OpenVDB
{}: this build reads and writes no .3mf: it was made without lib3mf""",
    SHARED: """the default cell of {} does not fit into a share of 1/{} of the memory""",
    OPEN: """a level set with cells of {} takes about {} GB; the budget is {} GB
redistancing by {} was not steady {} times: the surface may have moved with it; --redistance closest is exact and faster
the solid is thinner than a cell everywhere
creases were not cut into the result: it would have met itself there
the result could not be verified as a valid solid: {}""",
    RARE: """the result has {} components and genus {}; the level set has {} and {}
nothing to work on: none of the {} facets has an area
the mesh does not pass {} ({})
a mesh with cells of {} has about {} cells and {}
with coarser cells the result was no valid surface: --adapt was left out
the surface was not remeshed: {}
{} of {} facets were not remeshed: they would have met others
simplified to {} facets: {}
no more cells fit into memory on the way to {}: {}; raise --memory
the level set has cells of {}, not of {}, to stay within the memory budget: raise --memory
{} small pieces that stand for no component of the input were left out
was not written: {}""",
    "a signal has to come while the program works: the group 'signals' sends them": """interrupted
interrupted while reading {}""",
}.items() for message in messages.splitlines()}

# Messages that take more than a command: the scenario, or the test of the library, that asserts them.
NAMED = {
    "-o - would print a binary file on the terminal": "a_mesh_is_not_printed_on_a_terminal",
    "interrupted after {} of {} files": "what_was_done_before_an_interrupt_stays",
    "{} has no condition for the patch {}: OpenFOAM will not read it; --patch-value {}=V gives it one": "bad_cases_are_told_apart",
    "{} of the input's components ({} of area) are not in the surface, being thinner than a cell or smaller than the smoothing length; the largest is at ({}, {}, {})":
        "lost_components_are_told",
    "smoothing moved the surface away from {} of {} points, by {} or more, or left nothing of it there: they have no curvature; a smaller --smooth keeps it nearer":
        "lost_components_are_told",
    "the data stand in another file": "Nrrd.SkipsAndDetachedData",
    "the faces of a group do not follow each other: groups were left out": "Names.PlyGroupsAreRunsOfFaces",
    "only {} % of the wall's area has all layers: where the model has sharp edges they often have no room; a smaller --cell or thinner layers may keep more":
        "FlowMeshJob.LayersThatAreNearlyNowhereAreWarnedOf",
}

# --- the tests


def run_row(case, program):
    """What a row of cases.py prints."""
    with runner.Sandbox(program) as box:
        result = box.run(shlex.split(case.command), case.stdin, case.env)
        return result.code, result.messages()


def unprovoked(catalogue, printed):
    """Rows of the catalogue that nothing provokes; `printed`: (exit code, text on standard error) of all commands that were run."""
    for code, message, number, _ in catalogue:
        wanted = regex_of(message)
        ran = any((code == "-" or code == str(c)) and wanted.search(text) for c, text in printed)
        if not ran and message not in EXEMPT and message not in NAMED:
            yield code, message, number


def every_message_is_provoked(program):
    """All that the catalogue lists is printed by a row here or of cases.py, asserted by another test, or has a reason not to be."""
    catalogue = load_checker().catalogue(ROOT)
    printed = [row.run(program) for row in ROWS]
    printed += [run_row(case, program) for rows in cases.GROUPS.values() for case in rows if case.code != 0]
    left = list(unprovoked(catalogue, printed))
    runner.expect(not left, "no test provokes these messages of docs/errors.md; add to the table of its topic (tests/cli/*_rows.py)\n"
                  "  line(MESSAGE, COMMAND, EXIT_CODE), or an entry of NAMED or EXEMPT of tests/cli/error_cases.py:\n" +
                  "\n".join(f"  docs/errors.md:{number}: {code} {message}" for code, message, number in left))


def named_tests_assert_their_messages(_program):
    """Each test that NAMED has exists, and holds a piece of its message that is of no other."""
    bodies = named_tests.bodies()
    texts = {message for _, message, _, _ in load_checker().catalogue(ROOT)}
    for message, test in NAMED.items():
        runner.expect(test in bodies, f"there is no test {test}, which is to assert: {message}")
        runner.expect(named_tests.asserts(bodies[test], message, texts - {message}), f"the test {test} asserts no piece that is only of: {message}")


def exemptions_are_of_the_catalogue(_program):
    listed = {message for _, message, _, _ in load_checker().catalogue(ROOT)}
    gone = sorted((set(EXEMPT) | set(NAMED) | {row.message for row in ROWS}) - listed)
    runner.expect(not gone, "not in docs/errors.md any more; remove from tests/cli:\n" + "\n".join(gone))


def tests():
    """(name, function of the program's path)."""
    for function in (exemptions_are_of_the_catalogue, named_tests_assert_their_messages, every_message_is_provoked):
        yield function.__name__, function
