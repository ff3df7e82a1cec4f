"""Options from files and back (--config, --save-config), and lengths with units (--units)."""
import json
import random
import re

import models
from runner import expect, expect_match
from scenarios import QUICK, expect_valid, scenario

COMMANDS = ["clean", "sweep", "check", "compare", "field", "curvature", "mesh", "ic", "example"]
# A value for what stands for one in help; of an option alone, or of a command's.
SAMPLES = {"FILE": "a # b.stl", "OUT": 'say "x".vtp', "DIR": "d\\e", "PATH": "case", "PATTERN": "o/{}.stl", "CASE": "c", "L": "0.5", "T": "0.25", "TOL": "0.1", "R": "2", "V": "0.5",
           "N": "10", "S": "2", "K": "7", "ANGLE": "30", "A": "20", "DEG": "30", "D": "-0.5", "H": "0.1", "X": "2", "U": "mm", "SIZE": "800M", "NAME": "a_b", "CELLS": "4",
           "L,L,...": "0.1,0.2%", "BOX": "0,0,0,1,1,2", "BOX:L": "0,0,0,1,1,2:0.5", "NAME=T,...": "in=patch", "NAME=V,...": "in=1", "LIST": "phi,level", "P": "one", "F": "polyhedral", "M": "volume", "W": "near"}
SPECIAL = {"--method": "", "--mode": "volume", "--nested": "cavity", "--surface": "delaunay", "--redistance": "fmm", "--octree": "cells", "--accepted": "band", "--at": "vertices",
           "--order": "2", "--flavour": "polyhedral", "--msh-version": "2.2", "--iso": "300", "--layers": "3", "--domain": "20", "--time": "1", "--flat-levels": "2", "--coarsest": "2",
           "--ratio": "1.5", "--check": "10", "--resolution": "24", "--jobs": "auto", "--cells": "200k", "--noise": "0.3", "--narrow-band": "3h"}
METHODS = {"clean": "local", "sweep": "levelset", "curvature": "nodal", "mesh": "local", "ic": "exact"}


def options_of(box, command):
    """(name, what stands for its value or nothing), as the help has them."""
    text = box.succeed([command, "--help"]).text()
    found = re.findall(r"^  (?:-\w, |    )(--[a-z-]+)(?: (\S+))?(?:\n|  )", text, re.MULTILINE)
    expect(len(found) > 5, f"options of {command}: {found}")
    return found


def sample_of(command, name, value):
    if name == "--method":
        return METHODS[command]
    return SPECIAL[name] if name in SPECIAL else SAMPLES[value]


@scenario("config")
def every_option_of_every_command_goes_to_a_file_and_back(box):
    number = 0
    for command in COMMANDS:
        for name, value in options_of(box, command):
            if name in ("--config", "--save-config", "--help", "--version"):
                continue
            number += 1
            given = [name] if not value else [f"{name}={sample_of(command, name, value)}"]
            box.succeed([command, "--save-config", f"a{number}.ini", *given])
            saved = box.read(f"a{number}.ini")
            lines = [line for line in saved.decode().splitlines() if line and line[0] not in "#["]
            expect(len(lines) == 1 and lines[0].startswith(f"{name[2:]} = "), f"{command} {given}: saved {lines}")
            box.succeed([command, "--config", f"a{number}.ini", "--save-config", f"b{number}.ini"])
            again = [line for line in box.read(f"b{number}.ini").decode().splitlines() if line and line[0] not in "#["]
            expect(again == lines, f"{command} {given}: {lines} became {again}")
    expect(number > 150, f"only {number} options")


@scenario("config")
def all_options_of_a_command_at_once_and_in_order(box):
    given = ["--units", "in", "--smooth", "2mm", "--free-volume", "--keep-volume", "--free-volume", "-q", "--memory=1G", "-o", "x y.stl"]
    box.succeed(["clean", *given, "--save-config", "a.ini"])
    box.succeed(["clean", "--config", "a.ini", "--save-config", "b.ini"])
    expect(box.read("a.ini") == box.read("b.ini"), "a configuration that was read and saved has other bytes")
    order = [line.split(" = ")[0] for line in box.read("a.ini").decode().splitlines() if line and line[0] not in "#["]
    expect(order == ["units", "smooth", "keep-volume", "free-volume", "quiet", "memory", "output"], f"order: {order}")


@scenario("config")
def a_configuration_gives_the_same_bytes(box):
    options = ["--resolution", "24", "--smooth", "2h", "--mode", "volume", "--free-volume", "-q"]
    box.succeed(["hole.stl", "-o", "a.stl", *options, "--save-config", "run.ini"])
    again = box.run(["hole.stl", "--config", "run.ini"])
    expect(again.code == 4, f"the output of the file is to be taken: exit code {again.code}")
    box.succeed(["hole.stl", "--config", "run.ini", "-o", "b.stl"])
    expect(box.read("a.stl") == box.read("b.stl"), "other bytes from a configuration")
    box.succeed(["hole.stl", "--config", "run.ini", "-o", "c.stl", "--resolution", "32"])
    box.succeed(["hole.stl", "-o", "d.stl", *options[2:], "--resolution", "32"])
    expect(box.read("c.stl") == box.read("d.stl"), "the command line did not go first")
    expect(box.read("c.stl") != box.read("a.stl"), "the resolution had no effect")


@scenario("config")
def sections_and_what_all_commands_share(box):
    box.write("burnish.ini", b"\xef\xbb\xbf# all\r\nquiet = true\nunits = cm\r\n\n[check]   # of check\nunits = mm\njson = true\n[mesh]\ncells = 200k\n[clean]\nresolution = 24\n")
    data = json.loads(box.succeed(["check", "cube.stl", "--config", "burnish.ini"]).out)
    expect(data["units"] == "mm", f"the section did not go first: {data['units']}")
    run = box.succeed(["cube.stl", "-o", "x.stl", "--config", "burnish.ini", "--report", "r.json"])
    report = json.loads(box.read("r.json"))
    expect(report["units"] == "cm" and report["method"] == "levelset" and run.out == b"" and run.err == b"", f"{report['units']}, {report['method']}")
    box.succeed(["compare", "cube.stl", "cube.stl", "--config", "burnish.ini"])


@scenario("config")
def repeatable_options_have_several_lines(box):
    boxes = ["--refine", "0,0,0,1,1,1:0.1", "--refine", "0,0,0,2,2,2:0.2"]
    box.succeed(["mesh", *boxes, "--save-config", "a.ini"])
    box.succeed(["mesh", "--config", "a.ini", "--save-config", "b.ini"])
    expect(box.read("a.ini") == box.read("b.ini") and box.read("a.ini").count(b"\nrefine = ") == 2, box.read("a.ini").decode())


@scenario("config")
def what_is_wrong_is_told_with_its_place(box):
    for text, message in {
        "\n\nsmooth = 0,5\n": r"c\.ini:3: --smooth 0,5: not a length\n  hint: .*decimal point",
        "smoth = 1\n": r"c\.ini:1: unknown option 'smoth'\n  hint: did you mean 'smooth'\?",
        "[clean]\nsmoth = 1\n": r"c\.ini:2: unknown option 'smoth' in \[clean\]\n  hint: did you mean 'smooth'\?",
        "[mesh]\nfacets = 10\n": r"c\.ini:2: unknown option 'facets' in \[mesh\]",
        "--smooth = 1\n": r"c\.ini:1: unknown option '--smooth'\n  hint: did you mean 'smooth'\?",
        "xyzzy = 1\n": r"c\.ini:1: unknown option 'xyzzy'\n  hint: 'burnish --help' lists",
        "[claen]\n": r"c\.ini:1: unknown command '\[claen\]'\n  hint: did you mean '\[clean\]'\?",
        "[clean\n": r"c\.ini:1: expected '\[command\]', found '\[clean'",
        "[clean]\n[check]\n[clean]\n": r"c\.ini:3: \[clean\] is there twice",
        "smooth\n": r"c\.ini:1: expected 'name = value', found 'smooth'",
        "= 1\n": r"c\.ini:1: unknown option ''",
        "smooth =\n": r"c\.ini:1: 'smooth' has no value\n  hint: delete the line",
        "smooth = # 1\n": r"c\.ini:1: 'smooth' has no value",
        "smooth = 1\nsmooth = 2\n": r"c\.ini:2: 'smooth' is there twice",
        "overwrite = yes\n": r"c\.ini:1: 'overwrite' is a switch: expected true or false, found 'yes'",
        'output = "x.stl\n': r"c\.ini:1: a quoted value has no end",
        'output = "x.stl" y\n': r"c\.ini:1: expected a comment behind the quoted value, found 'y'",
        'output = "x\\y"\n': r"c\.ini:1: expected one of .* found '\\y'",
        'output = "x\\': r"c\.ini:1: expected one of",
        "config = other.ini\n": r"c\.ini:1: 'config' cannot be set in a configuration",
        "help = true\n": r"c\.ini:1: 'help' cannot be set in a configuration",
        "a\0b = 1\n": r"c\.ini: not a text file",
    }.items():
        box.write("c.ini", text.encode())
        run = box.run(["cube.stl", "-o", "x.stl", "--config", "c.ini"])
        expect(run.code == 2, f"{text!r}: exit code {run.code}\n{run.messages()}")
        expect_match(r"\Aburnish: " + message, run.messages(), repr(text))
    for name, message in {"no.ini": r"no\.ini: the configuration cannot be read: ", "folder": r"folder: the configuration cannot be read: it is a folder",
                          "c.inj": r"c\.inj: .*\n  hint: did you mean 'c\.ini'\?", "-": r"--config needs a file's name"}.items():
        run = box.run(["cube.stl", "-o", "x.stl", "--config", name])
        expect(run.code == 2, f"exit code {run.code} of {name}")
        expect_match(r"\Aburnish: " + message, run.messages(), name)
    box.write("big.ini", b"# much\n" * 200_000)
    expect_match(r"big\.ini: expected a configuration, found more than a megabyte", box.run(["cube.stl", "-o", "x.stl", "--config", "big.ini"]).messages(), "a large file")
    box.expect_files(["big.ini", "c.ini"])


@scenario("config")
def saving_replaces_nothing(box):
    expect(box.run(["clean", "--save-config", "other.stl"]).code == 4, "an existing file")
    expect(box.run(["cube.stl", "-o", "x.stl", "--save-config", "cube.stl", "--overwrite"]).code == 2, "the input")
    box.expect_fixtures_untouched()
    box.succeed(["clean", "--save-config", "a.ini", "--smooth", "1"])
    box.succeed(["clean", "--save-config", "a.ini", "--smooth", "2", "--overwrite"])
    expect_match(r"^smooth = 2$", box.read("a.ini").decode(), "the file")
    bad = box.run(["clean", "--save-config", "b.ini", "--smooth", "0"])
    expect(bad.code == 2, "a value that means nothing is not saved")
    box.expect_files(["a.ini"])


@scenario("config")
def malformed_files_never_crash(box):
    chance = random.Random(1)
    pieces = [b"[clean]", b"[", b"]", b"=", b"\n", b"\r\n", b" ", b"#", b'"', b"\\", b"smooth", b"overwrite", b"true", b"0.5", b"\xff", b"\x00", b"--", b"units", b"mm", b"output", b"\t"]
    for _ in range(300):
        box.write("f.ini", b"".join(chance.choice(pieces) for _ in range(chance.randrange(1, 14))))
        run = box.run(["clean", "--config", "f.ini", "--save-config", "g.ini", "--overwrite"])
        expect(run.code in (0, 2), f"exit code {run.code} of {box.read('f.ini')!r}\n{run.messages()}")
        expect(run.code == 0 or run.messages().startswith("burnish: f.ini"), f"{box.read('f.ini')!r}: {run.messages()}")


@scenario("config")
def the_command_line_wins_over_another_way_to_say_it(box):
    box.write("c.ini", b"resolution = 50\nquiet = true\nmax-hole = 3\n")
    box.succeed(["hole.stl", "-o", "a.stl", "--config", "c.ini", "--cell", "0.125", "-v", "--report", "a.json", "--save-config", "saved.ini"])
    expect(json.loads(box.read("a.json"))["options"]["cell"] == 0.125, "the cell of the command line")
    expect_match(r"^cell = 0\.125$", box.read("saved.ini").decode(), "the file")
    expect(not re.search(r"^(resolution|quiet) = ", box.read("saved.ini").decode(), re.MULTILINE), "what was overruled is saved")
    box.write("d.ini", b"resolution = 50\n[clean]\ncell = 0.125\n")
    box.succeed(["hole.stl", "-o", "d.stl", "--config", "d.ini", "-q"])
    box.write("e.ini", b"cell = 0.125\nresolution = 50\n")
    expect_match(r"\Aburnish: e\.ini:1, e\.ini:2: --cell and --resolution exclude each other\n", box.run(["hole.stl", "-o", "e.stl", "--config", "e.ini"]).messages(), "both in a file")
    box.write("f.ini", b"\nsnapshots = s\nsmooth = 0.1\n")
    run = box.run(["hole.stl", "-o", "e.stl", "--config", "f.ini", "--html", "e.html"])
    expect_match(r"\Aburnish: f\.ini:2: --html and --snapshots exclude each other\n", run.messages(), "options that are no alternatives")


@scenario("config")
def json_in_a_configuration_counts_for_errors(box):
    box.write("c.ini", b"json = true\n")
    for arguments, code in ((["check", "nowhere.stl"], 3), (["hole.stl", "-o", "-"], 2), (["hole.stl"], 2)):
        run = box.run([*arguments, "--config", "c.ini"])
        expect(run.code == code and json.loads(run.out)["error"]["exit_code"] == code, f"{arguments}: {run.code}, {run.text()}")
    box.write("c.ini", b"[check]\njson = true\n[clean]\njson = false\n")
    expect(box.run(["nowhere.stl", "-o", "x.stl", "--config", "c.ini"]).out == b"", "another command's json")
    for arguments in (["check", "nowhere.stl", "--smooth", "1", "--json"], ["check", "--json", "nowhere.stl", "--smooth"]):
        expect(json.loads(box.run(arguments).out)["error"]["exit_code"] == 2, f"{arguments}: a word that is not understood")
    for arguments in (["check", "nowhere.stl", "--smooth", "1", "--", "--json"], ["check", "nowhere.stl", "--output-defects=--json"]):
        expect(box.run(arguments).out == b"", f"{arguments}: --json is no option there")


@scenario("config")
def what_no_run_would_take_is_not_saved(box):
    for arguments, message in {
        ("hole.stl", "-o", "s5.stl", "--save-config", "s5.stl"): r"s5\.stl: --output and --save-config name the same file",
        ("hole.stl", "-o", "x.stl", "--report", "r.json", "--save-config", "./r.json"): r"\./r\.json: --report and --save-config name the same file",
        ("clean", "--quiet", "--verbose", "--save-config", "a.ini"): r"--quiet and --verbose exclude each other\n  hint: give one",
        ("clean", "--cell", "1", "--resolution", "50", "--save-config", "a.ini"): r"--cell and --resolution exclude each other",
    }.items():
        run = box.run([*arguments, "--overwrite"])
        expect(run.code == 2, f"{arguments}: exit code {run.code}\n{run.messages()}")
        expect_match(r"\Aburnish: " + message, run.messages(), f"{arguments}")
    box.expect_files([])
    box.succeed(["clean", "--cell", "auto", "--resolution", "50", "--save-config", "a.ini"])
    box.succeed(["clean", "--config", "a.ini", "--smooth", "1", "--save-config", "a.ini", "--overwrite"])


# --- units ------------------------------------------------------------------------------------------

def stretched_cube(box, name, factor):
    box.write(name, models.binary_stl([tuple(tuple(c * factor for c in p) for p in t) for t in models.cube()]))


@scenario("units")
def a_length_in_any_unit_is_the_same_length(box):
    stretched_cube(box, "part.stl", 16)
    for units, lengths in {"mm": ["1", "1mm", "0.1cm", "0.001m", "1000um"], "in": ["0.5", "0.5in", "12.7mm", "1.27cm"], "ft": ["1", "12in", "304.8mm"], "m": ["0.25", "25cm"],
                           "um": ["2", "0.002mm"], "cm": ["0.5", "5mm"]}.items():
        results = set()
        for i, length in enumerate(lengths):
            box.succeed(["part.stl", "-o", f"{i}.stl", "--cell", length, "--units", units, "-q", "--overwrite", "--report", "r.json", "--surface", "tetrahedra"])
            report = json.loads(box.read("r.json"))
            expect_valid("report.schema.json", report)
            expect(report["units"] == units, f"units: {report['units']}")
            results.add((round(report["options"]["cell"], 12), box.read(f"{i}.stl")))
        expect(len(results) == 1, f"{lengths} in {units}: {len(results)} results")
        expect(next(iter(results))[0] == float(re.sub("[a-z]", "", lengths[0])), f"the cell is {next(iter(results))[0]}")


@scenario("units")
def the_unit_stands_anywhere_on_the_command_line(box):
    for arguments in (["--max", "0.1cm", "--units", "mm"], ["--units=mm", "--max=0.1cm"]):
        data = json.loads(box.succeed(["compare", "cube.stl", "moved.stl", "--json", "-q", *arguments]).out)
        expect((data["limit"], data["units"]) == (1, "mm"), f"{data['limit']}, {data['units']}")
        expect_valid("compare.schema.json", data)


@scenario("units")
def summaries_have_the_unit(box):
    check = box.succeed(["check", "cube.stl", "--units", "mm"]).text()
    expect_match(r"\Acube\.stl \(binary STL, in mm\)\n", check, "the first line")
    expect_match(r"^volume, mm\^3 +1$\n^area, mm\^2 +6$\n^mean edge, mm +1\.13807", check, "volume, area and edge")
    expect_match(r"^size +1 x 1 x 1, diagonal 1\.73205 mm$", check, "the size")
    clean = box.succeed(["hole.stl", "-o", "x.stl", "--units", "in", *QUICK]).text()
    expect_match(r"^volume, in\^3 +0\.916667 +1$", clean, "before and after")
    expect_match(r"^output -> input +rms \S+ in \(.*%\), max \S+ in \(", clean, "the deviation")
    table = box.succeed(["check", "cube.stl", "moved.stl", "--units", "mm"]).text()
    expect_match(r"volume mm\^3", table, "the head of the table")
    for command in (["curvature", "cube.stl", "--resolution", "24"], ["field", "cube.stl", *QUICK], ["field", "cube.stl", "--cell-octree"], ["mesh", "cube.stl", "--dry-run", "--cell", "0.2"]):
        expect_match(r"\Acube\.stl \(binary STL, in ft\)\n", box.succeed([*command, "--units", "ft"]).text(), f"{command}")
        schema = "cell_octree" if "--cell-octree" in command else command[0]
        data = json.loads(box.succeed([*command, "--units", "ft", "--json", "-q"]).out)
        expect_valid(f"{schema}.schema.json", data)
        expect(data["units"] == "ft", f"{command}: {data['units']}")
        expect(json.loads(box.succeed([*command, "--json", "-q"]).out)["units"] is None, f"{command}: a unit that nobody has told")
    expect_match(r"^lengths in mm$", box.succeed(["compare", "cube.stl", "moved.stl", "--units", "mm"]).text(), "comparing")


@scenario("units")
def lengths_that_make_no_sense(box):
    for arguments, message in {
        ("--cell", "5mm"): r"--cell 5mm: not a length\n  hint: leave the unit out.*model's own units; or say what these are, such as --units mm",
        ("--cell", "0.05in"): r"--cell 0\.05in: not a length\n  hint: .*--units",
        ("--cell", "5km", "--units", "mm"): r"--cell 5km: not a length\n  hint: .*0\.5 mm|0\.5mm",
        ("--cell", "5 mm", "--units", "mm"): r"--cell 5 mm: not a length",
        ("--cell", "mm", "--units", "mm"): r"--cell mm: not a length",
        ("--units", "mn"): r"--units mn: expected one of mm, cm, m, in, um, ft\n  hint: did you mean",
        ("--units", "inch"): r"--units inch: expected one of",
        ("--offset=-1mm",): r"--offset 1mm: not a length\n  hint: .*--units mm",
    }.items():
        run = box.run(["cube.stl", "-o", "x.stl", *arguments])
        expect(run.code == 2, f"{arguments}: exit code {run.code}\n{run.messages()}")
        expect_match(r"\Aburnish: " + message, run.messages(), f"{arguments}")
    box.expect_files([])


@scenario("units")
def parts_of_values_have_units_too(box):
    box.succeed(["cube.stl", "-o", "a.stl", "--offset=-1mm", "--units", "cm", "-q", *QUICK])
    box.succeed(["cube.stl", "-o", "b.stl", "--offset=-0.1", "-q", *QUICK])
    expect(box.read("a.stl") == box.read("b.stl"), "an offset with a unit")
    box.succeed(["sweep", "crossing.stl", "-o", "s{}.stl", "--smooth", "1mm,0.3", "--units", "cm", "-q", "--mode", "volume", *QUICK])
    box.succeed(["sweep", "crossing.stl", "-o", "t{}.stl", "--smooth", "0.1,0.3", "-q", "--mode", "volume", *QUICK])
    expect(box.read("s1mm.stl") == box.read("t0.1.stl"), "a sweep's lengths with units")
    for name, refine in {"c": "0,0,0,1,1,0.5:1mm", "d": "0,0,0,1,1,0.5:0.1"}.items():
        box.succeed(["mesh", "cube.stl", "-o", f"{name}.vtu", "--cell", "0.2", "--refine", refine, "--units", "cm", "-q"])
    expect(box.read("c.vtu") == box.read("d.vtu"), "a refinement with a unit")
