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



# --- what is damaged

VTI = ('<VTKFile type="ImageData" byte_order="LittleEndian" header_type="UInt32"><ImageData WholeExtent="0 3 0 3 0 3" Origin="0 0 0" Spacing="1 1 1">'
       '<Piece Extent="0 3 0 3 0 3"><PointData><DataArray type="Float32" Name="a" format="ascii">' + " ".join(str(i) for i in range(64)) +
       "</DataArray></PointData></Piece></ImageData></VTKFile>")
NRRD = "NRRD0004\ntype: float\ndimension: 3\nsizes: 4 4 4\nspacings: 1 1 1\nencoding: ascii\n\n" + " ".join(str(i) for i in range(64))
PLY = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
OFF = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
ASCII = models.ascii_stl(models.cube()).decode()
VALUES = " ".join(str(i) for i in range(64))


def words(*numbers):
    return base64.b64encode(struct.pack(f"<{len(numbers)}I", *numbers)).decode()


def blocks(*head, data=b""):
    """Damaged blocks of compressed data, instead of the values."""
    return [("<VTKFile ", '<VTKFile compressor="vtkZLibDataCompressor" '), ('"ascii"', '"binary"'), (VALUES, words(*head) + base64.b64encode(data).decode())]


def edited(text, edits):
    for old, new in edits:
        assert old in text, f"{old!r} is not there to be replaced"
        text = text.replace(old, new, 1)
    return text.encode("latin-1")


@dataclass
class Provoked:
    """This message of the catalogue, by this command in a folder with these files; `mesh`: edits of the files of an OpenFOAM case."""
    message: str
    command: str
    code: int = 2
    files: dict = field(default_factory=dict)
    mesh: list = field(default_factory=list)
    before: object = None  # a function of the sandbox
    stdin: bytes = b""
    in_shell: bool = False  # for what only redirections provoke

    def run(self, program):
        with runner.Sandbox(program) as box:
            for name, data in self.files.items():
                (box.folder / name).parent.mkdir(parents=True, exist_ok=True)
                box.write(name, data)
            if self.mesh is not None and " --case case" in self.command:
                write_case(box)
                for name, old, new in self.mesh:
                    path = box.folder / "case" / name
                    path.write_bytes(edited(path.read_text(), [(old, new)]) if old else new if isinstance(new, bytes) else new.encode())
            if self.before:
                self.before(box)
            result = self.through_shell(box) if self.in_shell else box.run(shlex.split(self.command), self.stdin)
        text = result.messages()
        runner.expect(result.code == self.code, f"{self.command}: exit code {result.code}, expected {self.code}: {self.message}\n{text}")
        runner.expect(regex_of(self.message).search(text), f"{self.command}: expected the message\n  {self.message}\nfound\n{text}")
        return result.code, text


    def through_shell(self, box):
        done = subprocess.run(f"{shlex.quote(box.program)} {self.command}", shell=True, cwd=box.folder, capture_output=True)
        return runner.Result(done.returncode, done.stdout, done.stderr)


def line(message, command, code=2, **more):
    return Provoked(message, command, code, **more)


def vti(message, *edits, code=3, command="v.vti --iso 9.5 -o x.stl"):
    return Provoked(message, command, code, {"v.vti": edited(VTI, edits)})


def nrrd(message, *edits, code=3, command="v.nrrd --iso 9.5 -o x.stl"):
    return Provoked(message, command, code, {"v.nrrd": edited(NRRD, edits)})


def model(message, name, data, code=3, options="", command=None):
    return Provoked(message, command or f"{name} -o x.stl {options}", code, {name: data if isinstance(data, bytes) else data.encode("latin-1")})


def case(message, file, old, new, code=3):
    return Provoked(message, "ic cube.stl --case case --overwrite", code, mesh=[(file, old, new)])


MESH = "constant/polyMesh/"
FIELD = HEADER.format("volScalarField", "alpha.water") + "dimensions [0 0 0 0 0 0 0];\ninternalField uniform 0;\nboundaryField { walls { type zeroGradient; } }\n"
WITH_FIELD = [("0/alpha.water", "", FIELD)]


def with_field(message, old, new, code=3, options=""):
    return Provoked(message, "ic cube.stl --case case --overwrite " + options, code, mesh=WITH_FIELD + ([("0/alpha.water", old, new)] if old else []))


ROWS = [
    # The command line.
    line("--html needs a file's name", "cube.stl -o x.stl --html -"),
    line("--html and --snapshots exclude each other", "cube.stl -o x.stl --smooth 0.1 --snapshots s --html x.html"),
    line("{}: {} and {} name the same file", "cube.stl -o x.stl --html x.stl"),
    line("{} and {} exclude each other", "clean --cell 1 --resolution 10 --save-config x.ini"),
    line("{}: --save-config names the input", "cube.stl -o x.stl --save-config cube.stl"),
    line("{} {}: expected one of {}", "curvature cube.stl -o x.vtp --order 3"),
    line("--snapshots needs a length", "cube.stl -o x.stl --snapshots 2"),
    line("--cell-max needs --adapt", "cube.stl -o x.stl --cell-max 1"),
    line("{} is for --surface delaunay", "cube.stl -o x.stl --surface tetrahedra --edge-tolerance 0.1h"),
    line("--method local has no cells to measure lengths in", "cube.stl -o x.stl --method local --smooth 2h"),
    line("{} {}: expected a number of cells from 100 to 4000M", "mesh cube.stl -o m --cells 3"),
    line("{} {}: expected BOX:L", "mesh cube.stl -o m --refine 3"),
    line("{} {}: expected an angle up to 90 degrees", "mesh cube.stl -o m --flat-angle 95"),
    line("{} {}: expected an angle up to 180 degrees", "mesh cube.stl -o m --crease 200"),
    line("{} {}: expected a ratio from 1 to 2", "mesh cube.stl -o m --layers 2 --ratio 3"),
    line("{} is for layers", "mesh cube.stl -o m --first 0.1"),
    line("--smooth: either all lengths of a sweep are in cells, or none is", "sweep cube.stl --smooth 2h,0.1 -o 'out/{}.stl'"),
    line("{}: expected a volume, whose name ends in .vti, .nrrd or .nhdr", "cube.stl --iso 1 -o x.stl"),
    line("--cell-max {} is smaller than the finest cell, {}", "cube.stl -o x.stl --method levelset --cell 0.1 --adapt 0.1h --cell-max 0.01"),
    line("--cell-max is {}, less than the finest cell's {}",
         "field cube.stl -o x.vtu --cell-octree --cell 0.1 --cell-max 0.01"),
    line("expected a spacing greater than zero, found {}", "field cube.stl -o x.vti --samples 8 --box 0,0,0,0,0,0", 2),
    # Models.
    model("is {}", "m.stl", "<!DOCTYPE html>\n"),
    model("expected a point's finite coordinate, found {}", "m.obj", "v 0 0 x\n"),
    model("expected 'OFF', found {}", "m.off", "OGG\n"),
    model("binary OFF cannot be read", "m.off", OFF.replace("OFF", "OFF BINARY")),
    model("expected the number of {}, found {}", "m.off", OFF.replace("3 1 0", "x 1 0")),
    model("expected points of three coordinates, found {}", "m.off", OFF.replace("OFF", "4OFF")),
    model("truncated at {}: header promises {} {}, file holds {}", "m.off", OFF.replace("3 1 0", "3 9 0")),
    model("expected 'ply', found {}", "m.ply", "plx\n"),
    model("format ascii, binary_little_endian or binary_big_endian", "m.ply", PLY.replace("format ascii", "format other")),
    model("the number of elements {}", "m.ply", PLY.replace("vertex 3", "vertex x")),
    model("a whole-numbered count", "m.ply", PLY.replace("list uchar", "list float")),
    model("the type of a property", "m.ply", PLY.replace("float x", "real x")),
    model("'element' before 'property'", "m.ply", "ply\nformat ascii 1.0\nproperty float x\nend_header\n"),
    model("expected 'end_header', found the file's end", "m.ply", PLY[:60]),
    model("the header has no line 'format'", "m.ply", PLY.replace("format ascii 1.0\n", "")),
    model("truncated at {}: header promises {} of {}, file holds {}", "m.ply", PLY.replace("face 1", "face 2")),
    model("{}: a list of {} has no valid length", "m.ply", PLY.replace("3 0 1 2", "-3 0 1 2").replace("uchar", "char")),
    model("a point has a coordinate that is missing or not a finite number", "m.ply", PLY.replace("1 0 0", "nan 0 0")),
    model("expected 'facet', found 'vertex'", "m.stl", "solid x\nvertex 0 0 0\nendsolid x\n"),
    model("truncated: the file ends within a facet", "m.stl", ASCII[:200]),
    model("{} of a vertex: expected {}, found {}", "m.stl", ASCII.replace("vertex 0", "vertex z", 1)),
    model("expected a facet of 3 vertices, found {}", "m.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n"),
    model("facet {} has a coordinate that is not a finite number", "m.stl", models.binary_stl([((0, 0, 0), (1, 0, 0), (0, float("nan"), 0))])),
    model("a binary STL has at least {} bytes, this file has {}", "m.stl", b"\0" * 40),
    model("is empty but for blanks and comments", "m.stl", " \n\n"),
    model("{}: expected a size between {} and {}, found a bounding box with a diagonal of {}", "m.obj", "v 0 0 0\nv 1e200 0 0\nv 0 1e200 0\nf 1 2 3\n"),
    model("{}: expected a closed surface around a region, found one that encloses nothing", "r.stl", models.binary_stl(models.cube()[:1]), command="cube.stl -o x.stl --smooth 0.1 --region r.stl"),
    model("expected {} numbers behind '{}', found {}", "r.txt", "box 0 0 x\n", command="cube.stl -o x.stl --smooth 0.1 --region r.txt"),
    model("expected the end of the line, found {}", "r.txt", "sphere 0 0 0 1 2\n", command="cube.stl -o x.stl --smooth 0.1 --region r.txt"),
    model("expected 'box' or 'sphere', found {}", "r.txt", "cone 0 0 0 1\n", command="cube.stl -o x.stl --smooth 0.1 --region r.txt"),
    model("expected boxes or spheres, found none", "r.txt", "# none\n", command="cube.stl -o x.stl --smooth 0.1 --region r.txt"),
    model("expected a radius greater than zero, found {}", "r.txt", "sphere 0 0 0 -1\n", command="cube.stl -o x.stl --smooth 0.1 --region r.txt"),
    # Warnings of the readers.
    model("read as {}, in spite of the name's suffix", "m.obj", models.binary_stl(models.cube()), 0, command="check m.obj"),
    model("the keyword OFF is missing", "m.off", OFF[4:], 1, command="check m.off"),
    model("truncated at {}: header promises {} of {}, file holds {}", "m.ply", PLY.replace("face 1", "face 2"), 1, command="check m.ply --salvage"),
    model("truncated at {}: header promises {} {}, file holds {}", "m.off", OFF.replace("3 1 0", "3 9 0"), 1, command="check m.off --salvage"),
    model("{}: a list of {} has no valid length", "m.ply", PLY.replace("face 1", "face 2").replace("3 0 1 2", "3 0 1 2\n-3 0 1 2").replace("uchar", "char"), 1, command="check m.ply --salvage"),
    model("left out {} with coordinates that are not finite numbers, and their facets", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nf 1 2 3\nf 1 2 4\n", 1, command="check m.obj --salvage"),
    model("left out {}, the first at {}", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\n", 1, command="check m.obj --salvage"),
    model("left out {} of fewer than three corners, the first at {}", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\n", 1, command="check m.obj"),
    model("with more than three vertices cut into triangles", "m.stl",
          "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n", 1, command="check m.stl"),
    model("read with a decimal comma", "m.stl", ASCII.replace("vertex 0 ", "vertex 0,5 ", 1), 1, command="check m.stl --salvage"),
    model("that an STL does not have ignored", "m.stl", ASCII.replace("endfacet", "endfacet\nwhat", 1), 0, command="check m.stl"),
    model("the file ends without 'endsolid': it may have been cut off", "m.stl", ASCII[:ASCII.rindex("endsolid")], 0, command="check m.stl"),
    model("header promises {}, file holds {}: all were read", "m.stl", (lambda d: d[:80] + struct.pack("<I", 3) + d[84:])(models.binary_stl(models.cube())), 0, command="check m.stl"),
    model("left out {} with coordinates that are not finite, the first at {}", "m.stl",
          models.binary_stl(models.cube() + [((0, 0, 0), (1, 0, 0), (0, float("nan"), 0))]), 0, command="check m.stl --salvage"),
    model("{} behind the last of {} ignored", "m.stl", models.binary_stl(models.cube()) + b"signature", 0, command="check m.stl"),
    model("left out", "m.stl", ASCII.replace("vertex 0", "vertex z", 1), 1, command="check m.stl --salvage"),
    # Volumes.
    vti("expected a type such as UInt16 or Float32, found {}", ("Float32", "String")),
    vti("<{}> has no attribute {}", (' type="Float32"', "")),
    vti("expected a file of ImageData, found {}", ('type="ImageData"', 'type="PolyData"')),
    vti("expected a header_type of UInt32 or UInt64, found {}", ("UInt32", "UInt8")),
    vti("expected data compressed by zlib, or not at all; found {}", ("<VTKFile ", '<VTKFile compressor="vtkLZ4DataCompressor" ')),
    vti("expected axes parallel to the coordinates', found Direction={}", ("<ImageData ", '<ImageData Direction="0 1 0 1 0 0 0 0 1" ')),
    vti("expected an extent of six whole numbers, from and to along each axis; found {}", ("0 3 0 3 0 3", "0 3 0 3")),
    vti("expected three finite numbers as {}, found {}", ('Origin="0 0 0"', 'Origin="0 0 x"')),
    vti("expected one piece that is the whole image, found a part of it", ('Piece Extent="0 3', 'Piece Extent="0 2')),
    vti("expected an encoding raw or base64, found {}", ("</VTKFile>", '<AppendedData encoding="hex">_</AppendedData></VTKFile>')),
    vti("expected '_' before the appended data", ("</VTKFile>", '<AppendedData encoding="raw"></AppendedData></VTKFile>')),
    vti("expected VTK's XML with a piece of an image", ("Piece", "Peace"), ("/Piece", "/Peace")),
    vti("expected an array of one component, found {} of {}", ('Name="a"', 'Name="a" NumberOfComponents="3"'), command="v.vti --iso 9.5 --array a -o x.stl"),
    vti("expected a spacing other than 0, found {}", ('Spacing="1 1 1"', 'Spacing="0 1 1"')),
    vti("expected a spacing between {} and {}, found {}", ('Spacing="1 1 1"', 'Spacing="1e-200 1 1"')),
    vti("expected voxels at places that can be told apart, found a spacing of {} at coordinates of {}", ('Origin="0 0 0"', 'Origin="1e30 0 0"')),
    vti("expected {} bytes of data, found {}", ('"ascii"', '"binary"'), (VALUES, words(4) + words(*range(64)))),
    vti("expected the format ascii, binary or appended, found {}", ('"ascii"', '"other"')),
    vti("expected an offset into the {} bytes of appended data, found {}", ('format="ascii"', 'format="appended" offset="99"'), ("</VTKFile>", '<AppendedData encoding="raw">_</AppendedData></VTKFile>')),
    vti("expected blocks of compressed data, found {}", *blocks(1)),
    vti("the end of the data", *blocks(1)),
    vti("{} of {} bytes and {} of the last one, for {} bytes", *blocks(1, 7, 0, 3)),
    vti("one of {} bytes in {}", *blocks(1, 256, 0, 99999)),
    vti("damaged ones: block {} of {} is the first", *[(o, n) if o != VALUES else (o, words(1, 256, 0, 3) + words(0)) for o, n in blocks(1)]),
    vti("expected {} values, found {}", (" 62 63<", "<")),
    vti("expected a number, found {}", (" 62 63<", " 62 x<")),
    vti("{} cannot be in the {} bytes that are there for them: the file is cut off, or its header is wrong", ("0 3 0 3 0 3", "0 99 0 99 0 99"), ("0 3 0 3 0 3", "0 99 0 99 0 99")),
    vti("the value of voxel ({}, {}, {}) is {}: expected a finite number", (" 62 63<", " 62 nan<")),
    vti("{}: --iso {}: {}, so nothing, or everything, would be inside", code=2, command="v.vti --iso 99 -o x.stl"),
    vti("{}: {}: expected --iso V, the value on the surface", code=2, command="v.vti -o x.stl"),
    vti("{}: all values are {}: there is no surface", (VALUES, " ".join("5" * 64)), code=5, command="v.vti --iso auto -o x.stl"),
    vti("expected the end of a tag, found that of the file", ("</VTKFile>", "<VTKFile")),
    nrrd("expected a type such as 'unsigned short' or 'float', found {}", ("type: float", "type: block")),
    nrrd("expected a line '{}: ...' in the header, found none", ("type: float\n", "")),
    nrrd("expected a first line such as NRRD0004, found {}", ("NRRD0004", "NRXD")),
    nrrd("expected 'field: value', found {}", ("dimension: 3", "dimension 3")),
    nrrd("expected a whole number as {}, found {}", ("dimension: 3", "dimension: x")),
    nrrd("expected three axes, or four with one of length 1, found {}", ("dimension: 3", "dimension: 2")),
    nrrd("expected {} sizes of at least 1, found {}", ("4 4 4", "4 4 0")),
    nrrd("expected {} sizes, found {}", ("4 4 4", "4 4 4 4")),
    nrrd("expected four axes with one of length 1, found {}", ("dimension: 3", "dimension: 4"), ("4 4 4", "2 2 4 4")),
    nrrd("expected vectors such as (1,0,0), found {}", ("spacings: 1 1 1", "space directions: (1,0) (0,1) x")),
    nrrd("expected {} numbers as {}, found {}", ("spacings: 1 1 1", "spacings: 1 1 x")),
    nrrd("expected spacings other than 0, and ends of axes that differ", ("spacings: 1 1 1", "spacings: 1 1 0")),
    nrrd("expected directions of three axes in space", ("spacings: 1 1 1", "space directions: (1,0,0) (0,1,0) none")),
    nrrd("expected axes x, y and z parallel to the coordinates', in that order; found {}", ("spacings: 1 1 1", "space directions: (0,1,0) (1,0,0) (0,0,1)")),
    nrrd("expected one file of data, found {}", ("spacings", "data file: a%d.raw\nspacings")),
    nrrd("the data file {} is not there, or is none", ("spacings", "data file: a.raw\nspacings")),
    nrrd("expected the encoding raw, gzip or ascii, found {}", ("ascii", "bzip2")),
    nrrd("expected a number of bytes, or -1 for raw data", ("spacings", "byte skip: -3\nspacings")),
    nrrd("expected the endian little or big, found {}", ("encoding: ascii", "encoding: raw\nendian: middle"), (VALUES, VALUES * 4)),
    nrrd("compressed data are damaged: {}", ("encoding: ascii", "encoding: gzip\nendian: little"), (VALUES, VALUES)),
    nrrd("{}: {} need {} GB; the budget is {} GB", code=6, command="v.nrrd --iso 9.5 -o x.stl --memory 100"),
    # OpenFOAM.
    case("'{}' closes nothing", MESH + "boundary", "1(walls", "1()) walls"),
    case("'#{' is not closed", MESH + "boundary", "type wall;", "type #{ wall;"),
    case("brackets within brackets, too many of them", MESH + "boundary", "type wall;", "type wall; a " + "(" * 300 + ")" * 300 + ";"),
    case("'{}' where '{}' of a list or dictionary was expected", MESH + "boundary", "type wall;", "type wall; a (};"),
    case("'{}' is not closed", MESH + "boundary", "type wall;", "type wall; a \"b;"),
    case("expected an entry's name, found {}", MESH + "boundary", "1(walls", "1({ } walls"),
    case("expected {}32 or {}64 in arch, found {}", MESH + "points", "format ascii;", 'format ascii; arch "LSB;label=16;scalar=64";'),
    case("its numbers are binary, with their most significant byte first", MESH + "points", "format ascii;", 'format binary; arch "MSB;label=32;scalar=64";'),
    case("it does not begin with a dictionary FoamFile: no file of an OpenFOAM case", MESH + "points", "FoamFile", "FoamFull"),
    case("the file ends within its header FoamFile", MESH + "points", "", "FoamFile { version 2.0;"),
    case("expected '{}' {}, found {}", MESH + "points", "125\n(", "125\n["),
    case("{}: directives are not supported in the files of a mesh", MESH + "points", "125\n(", "#include \"x\"\n("),
    case("expected a {}, found {}", MESH + "points", "125\n(", "many\n("),
    case("expected a coordinate, found {}", MESH + "points", "(0.0 0.0 0.0)", "(x 0 0)"),
    case("{} {} are promised, and the file ends {} bytes later", MESH + "points", "125\n(", "999999\n("),
    case("{} {} does not exist: there are {}", MESH + "faces", "4(", "4(9999 "),
    case("expected a list of {}, found one of {}", MESH + "owner", "240\n(", "239\n("),
    case("a list of one and the same value was not expected", MESH + "neighbour", "", HEADER.format("labelList", "neighbour") + "144{0}\n"),
    case("expected the class {}, found {}", MESH + "points", "vectorField", "labelList"),
    case("face {} has {} points", MESH + "faces", "", HEADER.format("faceList", "faces") + "1(2(0 1))\n"),
    case("cell {} does not exist: {} faces do not bound as many", MESH + "owner", "\n0\n", "\n99999\n"),
    case("face {} has the same cell {} on both sides", MESH + "neighbour", "(\n1\n", "(\n0\n"),
    case("patch {}: expected a whole number {}, found {}", MESH + "boundary", "nFaces", "nFazes"),
    case("the list of patches is not closed", MESH + "boundary", "})\n", "}\n"),
    case("{} is no patch: it has no type", MESH + "boundary", "type wall;", ""),
    case("patch {}: expected its faces from {} on, among {}; found {} from {} on", MESH + "boundary", "startFace 144", "startFace 143"),
    case("{} faces on the boundary belong to no patch", MESH + "boundary", "nFaces 96", "nFaces 95"),
    Provoked("is no folder", "ic cube.stl --case cube.stl", 3),
    Provoked("no such folder", "ic cube.stl --case nowhere", 3),
    Provoked("{}: there is no mesh", "ic cube.stl --case case", 3, before=lambda box: (box.folder / "case" / MESH / "faces").unlink()),
    with_field("expected the class volScalarField, found {}", "volScalarField", "volVectorField"),
    with_field("it has no internalField", "internalField uniform 0;", ""),
    with_field("it has no boundaryField", "boundaryField", "otherField"),
    with_field("patch {} is not in the mesh", "", "", 2, "--patch-value inlet=1"),
    # Writing.
    Provoked("{}: is no folder", "mesh cube.stl -o case --cell 0.2", 4, mesh=None, before=lambda box: ((box.folder / "case").mkdir(), box.write("case/constant", b""))),
    line("cannot be written: {}", "mesh cube.stl -o cube.stl/m --cell 0.2", 4),
    line("cannot be written: {}", "cube.stl -o nowhere/x.stl", 4),
    # No result.
    line("no solid: nothing of the model is left after --offset and --hollow", "cube.stl -o x.stl --offset -0.6 --cell 0.1", 5),
    model("no solid: none of the {} facets has an area", "m.stl", models.binary_stl([((0, 0, 0), (1, 0, 0), (2, 0, 0))]), 5),
    model("{}: nothing to work on: all {} facets lie in one point", "m.stl", models.binary_stl([((0, 0, 0),) * 3]), 5, command="field m.stl -o x.vtu --cell-octree --cell 0.1"),
    model("no solid: the surface encloses a volume of {} with an area of {}: it is flat, or its parts cancel", "m.stl",
          models.binary_stl([((0, 0, 0), (1, 0, 0), (0, 1, 0)), ((0, 0, 0), (1, 1, 0), (1, 0, 0)), ((0, 0, 0), (0, 1, 0), (1, 1, 0)), ((1, 0, 0), (1, 1, 0), (0, 1, 0))]), 5),
    line("nothing is left: every component is smaller than --min-component", "cube.stl -o x.stl --min-component 99", 5),
    line("{}: with its wide openings left open it bounds no volume: {} open edges", "mesh hole.stl -o m --max-hole 0.01 --cell 0.2", 5),
    line("a {} of thickness {} needs cells of {} or less; the cell is {}", "cube.stl -o x.stl --hollow 0.05 --cell 0.2", 5),
    model("the model lies too far from the origin: float32, which STL stores, has steps of more than {} cells there", "far.obj",
          "".join("v " + " ".join(str(1e7 + c) for c in p) + "\n" for f in models.cube() for p in f) + "".join(f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}\n" for i in range(12)), 5,
          options="--method levelset --cell 0.1"),
    line("the domain, {}, {} the model, {}, at its side {}: the room there is {}, and {} cells, {}, are needed", "mesh cube.stl -o m --outside --domain 0,0,0,2,2,2 --cell 0.2", 2),
    line("the mesh has no patch {}: its patches are {}", "mesh cube.stl -o m --cell 0.2 --patch-type inlet=wall", 2),
    line("no cell of the mesh lies on this side of the surface", "mesh cube.stl -o m --cell 9", 5),
    line("the box {} is to have cells of {}: less than 1/{} of those at the surface, {}", "mesh cube.stl -o m --cell 0.2 --refine 0,0,0,1,1,1:0.000001", 2),
    line("the layers are {} cells thick together, where cells are {}; at most {} have room", "mesh cube.stl -o m --cell 0.2 --layers 9 --first 0.2", 2),
    line("a mesh with cells of {} {}", "mesh cube.stl -o m --cell 0.0001 --memory 100M", 6),
    line("a spacing of {} makes more than {} samples", "field cube.stl -o x.vti --spacing 0.00001", 6),
    line("a mesh with cells of {} at the surface and of {} in the box {} {}", "mesh cube.stl -o m --cell 0.1 --refine 0,0,0,1,1,1:0.005 --memory 100M", 6),
    line("the time limit is over", "cube.stl -o x.stl --method levelset --resolution 400 --time-limit 0.01", 7),
    # Warnings.
    line("{} has no effect in mode {}", "cube.stl -o x.stl --smooth 0.1 --mode feature --free-volume", 0),
    line("--crease has no effect: the facets stay as they are", "cube.stl -o x.stl --crease 20", 0),
    Provoked("no solid: smoothing left nothing of the model", "cube.stl -o x.stl --smooth 2 --mode mcf --free-volume --resolution 24", 5),
    model("{} of {} facets were turned over: their orientation contradicts their neighbours', so that which side is inside was found from what can be seen from outside",
          "m.stl", models.binary_stl([f if i % 2 else f[::-1] for i, f in enumerate(models.cube())]), 0),
    line("the default cell of {} was coarsened to {} to stay within the memory budget", "cube.stl -o x.stl --method levelset --memory 5M", 0),
    line("there is no array 'facet': a surface that was smoothed has left the facets", "field cube.stl -o x.vtu --smooth 0.1 --mode mcf --cell 0.1 --data facet", 0),
    line("has no effect without --smooth", "cube.stl -o x.stl --free-volume", 0),
    line("has no effect without --output-defects", "check cube.stl --overwrite", 0),
    line("has no effect without -o", "field cube.stl --cell 0.1 --overwrite", 0),
    line("has no effect without --output or --map", "compare cube.stl moved.stl --overwrite", 0),
    nrrd("the volume has two values only, so its surface is a staircase: --smooth 4h takes the steps off", (VALUES, " ".join("01"[all(0 < (i >> s) % 4 < 3 for s in (0, 2, 4))] for i in range(64))),
         code=0, command="v.nrrd --iso 0.5 -o x.stl"),
    Provoked("the case is decomposed too: decomposePar has to be run again for its parts to see the field", "ic cube.stl --case case", 0, before=lambda box: (box.folder / "case/processor0").mkdir()),
    Provoked("{}: its mesh is decomposed: it is in the folders processor0, ... alone", "ic cube.stl --case case", 3,
             before=lambda box: ((box.folder / "case/processor0").mkdir(), (box.folder / "case/constant").rename(box.folder / "case/processor0/constant"))),
    Provoked("the model and the mesh do not overlap: {}", "ic m.stl --case case", 5, {"m.stl": models.binary_stl(models.cube(offset=(9, 0, 0)))}),
    Provoked("{}: the mesh has no cells", "ic cube.stl --case case", 3, mesh=[(MESH + n, "", HEADER.format(c, n) + "0()\n") for n, c in
             (("faces", "faceList"), ("owner", "labelList"), ("neighbour", "labelList"), ("boundary", "polyBoundaryMesh"))]),
    case("expected a list of {} at most, as many as there are faces, found one of {}", MESH + "neighbour", "", HEADER.format("labelList", "neighbour") + "300(" + "1 " * 300 + ")\n"),
    case("the places where faces begin do not ascend from 0", MESH + "faces", "", HEADER.format("faceCompactList", "faces") + "3(0 4 3)\n4(0 1 2 3)\n"),
    case("expected ')' behind {} {} in binary, found {}", MESH + "points", "",
         'FoamFile { version 2.0; format binary; arch "LSB;label=32;scalar=64"; class vectorField; object points; }\n1\n(' + "0" * 24 + "x"),
    case("a coordinate is not finite", MESH + "points", "",
         (b'FoamFile { version 2.0; format binary; arch "LSB;label=32;scalar=64"; class vectorField; object points; }\n1\n(' + struct.pack("<3d", 0, float("nan"), 0) + b")")),
    case("{} {} does not exist: numbers begin at 0", MESH + "neighbour", "",
         (b'FoamFile { version 2.0; format binary; arch "LSB;label=32;scalar=64"; class labelList; object neighbour; }\n1\n(' + struct.pack("<i", -1) + b")")),
    with_field("the file ends within a list of {} values", FIELD, FIELD.replace("format ascii", 'format binary; arch "LSB;label=32;scalar=64"').replace("uniform 0", "nonuniform List<scalar> 64(0")),
    with_field("expected ')' behind a list in binary", FIELD, FIELD.replace("format ascii", 'format binary; arch "LSB;label=32;scalar=64"').replace("uniform 0", "nonuniform List<scalar> 1(01234567x")),
    Provoked("patch {} is of the type {}, which has no value", "ic cube.stl --case case --overwrite --patch-value walls=1", 2,
             mesh=[(MESH + "boundary", "type wall;", "type empty;"), ("0/alpha.water", "", FIELD.replace("zeroGradient", "empty"))]),
    Provoked("{}: cannot write: {}", "check cube.stl --json >/dev/full", 4, in_shell=True),
    Provoked("cannot be written: {}", "cube.stl -o - -q >/dev/full", 4, in_shell=True),
    line("{}: cannot be made: {}", "cube.stl -o x.stl --smooth 0.1 --snapshots cube.stl/x", 4),
]

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
