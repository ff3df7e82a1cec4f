"""A message of docs/errors.md and the command that provokes it, and the damaged files that it takes."""
import base64
import gzip
import re
import shlex
import struct
import subprocess
from dataclasses import dataclass, field

import faults
import models
import runner
from ic_scenarios import HEADER, write_case


def regex_of(message):
    return re.compile(".*?".join(re.escape(part) for part in message.split("{}")), re.DOTALL)


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


def packed(path):
    """Puts a gzip file of it in its place."""
    path.with_name(path.name + ".gz").write_bytes(gzip.compress(path.read_bytes()))
    path.unlink()


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
    in_shell: bool = False  # for what only redirections and limits provoke: a line of the shell, in which burnish is the program under test
    fault: tuple = ()       # a function that fails, and for reading which files (faults.environment)
    library: str = ""       # that the build may be without: then its absence is told instead

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
            result = self.through_shell(box) if self.in_shell else box.run(shlex.split(self.command), self.stdin, faults.environment(*self.fault) if self.fault else None)
        text = result.messages()
        if self.library and f"made without {self.library}" in text:
            return self.code, self.message
        runner.expect(result.code == self.code, f"{self.command}: exit code {result.code}, expected {self.code}: {self.message}\n{text}")
        runner.expect(regex_of(self.message).search(text), f"{self.command}: expected the message\n  {self.message}\nfound\n{text}")
        return result.code, text

    def through_shell(self, box):
        text = self.command.replace("burnish", shlex.quote(box.program), 1)
        done = subprocess.run(["bash", "-c", text], cwd=box.folder, capture_output=True, check=False)
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
