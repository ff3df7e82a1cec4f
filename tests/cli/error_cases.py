"""What provokes each message of docs/errors.md: rows, other tests, or a reason why nothing can.

A message counts as provoked when
  * a row of cases.py, or of a table of ROWS, printed it with its exit code (the rows are run, and what they print is compared with the catalogue), or
  * NAMED has the name of a test that asserts it: the test exists, and a literal in it holds a piece of the message that no other message has.
There is no third way: what nothing can bring about is no message. An error (all but "the answer is no") has to come with a hint.
To add a message: scripts/check_errors says where it is to be listed; a row in the table of its topic (error_rows.py, option_rows.py, batch_rows.py, threemf_rows.py).
"""
import importlib.machinery
import importlib.util
import os
import re
import shlex
import sys
from concurrent.futures import ThreadPoolExecutor

import batch_rows
import cases
import error_rows
import fault_rows
import faults
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


# Messages that take more than a command: the scenario, or the test of the library, that asserts them.
NAMED = {message: test for test, messages in {
    # What takes a terminal, a signal, or files that are compared.
    "a_mesh_is_not_printed_on_a_terminal": """-o - would print a binary file on the terminal""",
    "what_was_done_before_an_interrupt_stays": """interrupted after {} of {} files""",
    "the_first_signal_ends_the_run_in_order": """interrupted""",
    "waiting_for_standard_input_can_be_ended": """interrupted while reading {}""",
    "bad_cases_are_told_apart": """{} has no condition for the patch {}: OpenFOAM will not read it; --patch-value {}=V gives it one""",
    "lost_components_are_told": """{} of the input's components ({} of area) are not in the surface, being thinner than a cell or smaller than the smoothing length; the largest is at ({}, {}, {})
smoothing moved the surface away from {} of {} points, by {} or more, or left nothing of it there: they have no curvature; a smaller --smooth keeps it nearer""",
    "Nrrd.SkipsAndDetachedData": """the data stand in another file""",
    "Names.PlyGroupsAreRunsOfFaces": """the faces of a group do not follow each other: groups were left out""",
    "FlowMeshJob.LayersThatAreNearlyNowhereAreWarnedOf": """only {} % of the wall's area has all layers: where the model has sharp edges they often have no room; a smaller --cell or thinner layers may keep more""",
    # What the command line checks first, so that only a caller of the library can meet it.
    "Refusals.OfSurfacesInMemory": """the surface has no facets
options of volumes are for files of values
point {} of the result is beyond the range of float32
--cell must be a length greater than zero""",
    "Refusals.OfSurfacesThatAreNoManifolds": """the surface to simplify is no consistently oriented 2-manifold
the surface to remesh is no consistently oriented 2-manifold
the surface to remesh is no 2-manifold: shells share a point
the edge length to remesh to is not positive
the deviation to simplify within is negative or no number""",
    "Refusals.OfExamples": """noise of an example must be a finite number, 0 or more
number of holes of an example must be 0 or more
no such example shape""",
    "Refusals.OfLevelSets": """the error criterion needs a tolerance of 0 or more and a band of at least 2 cells
distances of {} cells are too few for an offset of {}
an octree of single cells can have 1048576 cells a side; this one needs more""",
    "Refusals.OfFieldsAndCurvatures": """nodal curvatures are of order 2 or 4
nodal curvatures have no k1 and k2 to be checked
a band of {} cells is less than the {} that ACCEPTED cells need
--verify-exact compares with the facets of the input, and --smooth moves the surface away from them""",
    "Refusals.OfVolumes": """the volume has no values
no voxel is {} {}: there is no surface
not the name of a volume""",
    "Refusals.OfOutputs": """has no name
{}: the domain is 2^{} of its smallest cells wide; at most 2^{} can be written""",
    "Refusals.OfFlowMeshes": """{}: version {} of gmsh's format is not written
{}: the format has no cells for the {} polyhedra of the mesh
the patch {} is to be of two types, {} and {}
a face of the volume mesh has more than two cells""",
    "Refusals.OfCases": """the field has no boundaryField
volume fractions need a closed surface, and this one is open""",
    # What makes a batch run a file again, and is never printed.
    "Refusals.OfACellThatHasNoRoomInItsShareOfTheMemory": """the default cell of {} does not fit into a share of 1/{} of the memory""",
    # What would take billions of items: the refusal is asked of the count.
    "Refusals.OfFilesThatUnpackToTooMuch": """{}: unpacks to more than {} GB""",
    "Refusals.OfMoreThanCanBeRead": """more than the {} points that can be read
more facets than can be read
more than the {} facets that can be read
holds more points than 32 bits count""",
    "Refusals.OfMoreThanCanBeWritten": """{}: the model takes 4 GiB of a ZIP archive or more
{}: {} items are more than numbers of {} bits count
{}: {} corners of faces are more than labels of 32 bits count""",
    "Refusals.OfMoreThanCanBeNumbered": """the octree would have more than 2^32 - 2 blocks
the surface cuts the lattice into more than 2^32 pieces
the mesh would have more than 2^32 nodes
the mesh would have {} {}, and 32 bits number {}""",
    # What a build without a library says: its source is compiled into the tests as well.
    "MissingLibraries.AreToldWithTheirPackages": """{}: this build writes no .cgns: it was made without the CGNS library
{}: this build writes no .vdb: it was made without OpenVDB
{}: this build reads and writes no .3mf: it was made without lib3mf""",
}.items() for message in messages.splitlines()}

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
        if not ran and message not in NAMED:
            yield code, message, number


def lacks_hint(code, text):
    """Whether an error was printed, and no hint below it."""
    return code > 1 and re.search(r"^burnish: (?!warning: )", text, re.MULTILINE) and "\n  hint: " not in text


def every_message_is_provoked(program):
    """All that the catalogue lists is printed by a row here or of cases.py, or asserted by a named test."""
    catalogue = load_checker().catalogue(ROOT)
    faults.library()  # before there are threads
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        told = [*pool.map(lambda row: (row.command, *row.run(program)), ROWS)]
        told += pool.map(lambda case: (case.command, *run_row(case, program)), (case for rows in cases.GROUPS.values() for case in rows if case.code != 0))
    bare = [(command, text) for command, code, text in told if lacks_hint(code, text)]
    runner.expect(not bare, "errors without a hint at a way out:\n" + "\n".join(f"  {command}\n{text}" for command, text in bare))
    printed = [(code, text) for _, code, text in told]
    left = list(unprovoked(catalogue, printed))
    runner.expect(not left, "no test provokes these messages of docs/errors.md; add to the table of its topic (tests/cli/*_rows.py)\n"
                  "  line(MESSAGE, COMMAND, EXIT_CODE), or an entry of NAMED of tests/cli/error_cases.py:\n" +
                  "\n".join(f"  docs/errors.md:{number}: {code} {message}" for code, message, number in left))


def named_tests_assert_their_messages(_program):
    """Each test that NAMED has exists, and holds a piece of its message that is of no other."""
    bodies = named_tests.bodies()
    texts = {message for _, message, _, _ in load_checker().catalogue(ROOT)}
    for message, test in NAMED.items():
        runner.expect(test in bodies, f"there is no test {test}, which is to assert: {message}")
        runner.expect(named_tests.asserts(bodies[test], message, texts - {message}), f"the test {test} asserts no piece that is only of: {message}")


def rows_and_names_are_of_the_catalogue(_program):
    listed = {message for _, message, _, _ in load_checker().catalogue(ROOT)}
    gone = sorted((set(NAMED) | {row.message for row in ROWS}) - listed)
    runner.expect(not gone, "not in docs/errors.md any more; remove from tests/cli:\n" + "\n".join(gone))


def tests():
    """(name, function of the program's path)."""
    for function in (rows_and_names_are_of_the_catalogue, named_tests_assert_their_messages, every_message_is_provoked):
        yield function.__name__, function
