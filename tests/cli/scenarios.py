"""What takes more than one call: the same bytes again, signals, closed streams, schemas."""
import json
import os
import pty
import select
import signal
import subprocess
import time
from pathlib import Path

import models
from runner import expect, expect_match

DOCS = Path(__file__).resolve().parents[2] / "docs"
QUICK = ["--resolution", "24"]
DIRTY_KNOT = ["example", "knot", "--noise", "0.2", "--holes", "3", "-q", "-o"]
GROUPS = {}


def scenario(group):
    """Adds a function of a Sandbox to a group of tests."""
    def add(function):
        GROUPS.setdefault(group, []).append(function)
        return function
    return add


# --- the same bytes ---------------------------------------------------------------------------------

@scenario("same-bytes")
def example_depends_on_its_options_alone(box):
    for name, options in {"a": [], "b": [], "c": ["--seed", "2"]}.items():
        box.succeed([*DIRTY_KNOT, f"{name}.stl", *options])
    expect(box.read("a.stl") == box.read("b.stl"), "the same options gave other bytes")
    expect(box.read("a.stl") != box.read("c.stl"), "another seed gave the same bytes")


@scenario("same-bytes")
def example_on_standard_output_is_the_file(box):
    box.succeed(["example", "vase", "--noise", "0.1", "-o", "v.stl"])
    piped = box.succeed(["example", "vase", "--noise", "0.1", "-o", "-"])
    expect(piped.out == box.read("v.stl"), "-o - and -o v.stl differ")


@scenario("same-bytes")
def truth_does_not_depend_on_the_dirt(box):
    box.succeed(["example", "sphere", "-o", "clean.stl"])
    dirt = ["--noise", "0.3", "--holes", "2"]
    box.succeed(["example", "sphere", *dirt, "-o", "dirty.stl", "--truth", "truth.stl"])
    clean, truth, dirty = (models.read_binary_stl(box.read(f"{n}.stl")) for n in ("clean", "truth", "dirty"))
    expect(clean == truth, "the truth is not the shape without noise and holes")
    expect(len(dirty) < len(truth), "no hole was cut")


@scenario("same-bytes")
def clean_on_threads_and_again(box):
    box.succeed([*DIRTY_KNOT, "knot.stl"])
    options = ["-q", "--resolution", "96", "--smooth", "3h"]
    for name, threads in {"one": "1", "two": "2", "again": "2"}.items():
        box.succeed(["knot.stl", "-o", f"{name}.stl", "--threads", threads, *options])
    expect(box.read("one.stl") == box.read("two.stl"), "1 and 2 threads differ")
    expect(box.read("two.stl") == box.read("again.stl"), "two runs differ")


@scenario("same-bytes")
def clean_through_pipes(box):
    box.succeed(["hole.stl", "-o", "x.stl", "-q", *QUICK])
    piped = box.succeed(["-", "-o", "-", "-q", *QUICK], stdin=box.read("hole.stl"))
    expect(piped.out == box.read("x.stl"), "a pipe and a file differ")
    expect(piped.err == b"", "-q is not quiet")


@scenario("same-bytes")
def clean_of_any_input_format(box):
    box.succeed(["cube.stl", "-o", "binary.stl", "-q", *QUICK])
    box.succeed(["cube.ascii.stl", "-o", "ascii.stl", "-q", *QUICK])
    expect(box.read("binary.stl") == box.read("ascii.stl"), "binary and ASCII input give other results")


def scale_input(box, power, options):
    """Cleans a dirty sphere and the same one scaled by 2^power; the results' triangles."""
    box.succeed(["example", "sphere", "--noise", "0.1", "--holes", "2", "-q", "-o", "s.stl"])
    triangles = models.read_binary_stl(box.read("s.stl"))
    box.write("big.stl", models.binary_stl(models.as_points(models.scaled(triangles, 2.0 ** power))))
    for name in ("s", "big"):
        box.succeed([f"{name}.stl", "-o", f"{name}.out.stl", "-q", *options])
    return (models.read_binary_stl(box.read(f"{name}.out.stl")) for name in ("s", "big"))


@scenario("scaling")
def powers_of_two_scale_bit_for_bit(box):
    for power in (30, -30):
        for options in ([], ["--resolution", "40", "--smooth", "4h"], ["--cell", "2%"]):
            result, scaled = scale_input(box, power, options)
            expect(models.scaled(result, 2.0 ** power) == scaled, f"2^{power} with {options}: not scaled")
            for name in box.new_files():
                (box.folder / name).unlink()


@scenario("scaling")
def powers_of_ten_scale_within_a_millionth(box):
    box.succeed(["example", "sphere", "--noise", "0.1", "--holes", "2", "-q", "-o", "s.stl"])
    triangles = models.read_binary_stl(box.read("s.stl"))
    results = {}
    for factor in (1.0, 1e9, 1e-9):
        box.write("in.obj", models.write_obj(models.as_points(models.scaled(triangles, factor))))
        box.succeed(["in.obj", "-o", "out.obj", "-q", "--overwrite", "--resolution", "40"])
        results[factor] = models.read_obj(box.read("out.obj"))
    vertices, facets = results.pop(1.0)
    diagonal = 3.46
    for factor, (scaled_vertices, scaled_facets) in results.items():
        expect(scaled_facets == facets, f"x {factor}: other topology")
        worst = max(abs(a * factor - b) for v, w in zip(vertices, scaled_vertices) for a, b in zip(v, w))
        expect(worst <= 1e-6 * diagonal * factor, f"x {factor}: off by {worst / factor}")


# --- files ------------------------------------------------------------------------------------------

@scenario("files")
def overwrite_replaces(box):
    box.succeed(["cube.stl", "-o", "other.stl", "--overwrite", "-q", *QUICK])
    box.succeed(["check", "-q", "other.stl"])
    box.succeed(["cube.stl", "-o", "cube.stl", "--overwrite", "-q", *QUICK])
    box.succeed(["check", "-q", "cube.stl"])
    box.expect_files([])


@scenario("files")
def every_format_written_is_a_valid_solid(box):
    for suffix in ("stl", "ply", "obj", "off"):
        box.succeed(["hole.stl", "-o", f"x.{suffix}", "-q", *QUICK])
        box.succeed(["check", "-q", f"x.{suffix}"])


@scenario("files")
def names_may_hold_anything(box):
    for name in (b"caf\xe9.stl", "日本 語.stl".encode(), b"-dash.stl"):
        box.write(os.fsdecode(name), box.read("cube.stl"))
    for name in (b"caf\xe9.stl", "日本 語.stl".encode()):
        parsed = json.loads(box.succeed(["check", "--json", "-q", name]).out.decode("utf-8"))
        expect(parsed["input"]["file"] == name.decode("utf-8", "replace"), f"named {parsed['input']['file']}")
    box.succeed(["check", "-q", "--", "-dash.stl"])
    box.succeed(["example", "sphere", "-q", "--output=-s.stl"])
    box.read("-s.stl")


@scenario("files")
def a_failed_run_leaves_the_existing_output_alone(box):
    result = box.run(["triangle.stl", "-o", "other.stl", "--overwrite", *QUICK])
    expect(result.code == 5, f"exit code {result.code}\n{result.messages()}")
    box.expect_fixtures_untouched()
    box.expect_files([])


# --- defects ----------------------------------------------------------------------------------------

@scenario("defects")
def all_of_a_kind_are_counted_and_the_largest_listed(box):
    box.write("many.stl", models.binary_stl(models.scattered(1100)))
    result = json.loads(box.run(["check", "--json", "many.stl"]).out)
    expect_valid("check.schema.json", result)
    expect(result["locations_total"]["open_loop"] == 1100, f"totals: {result['locations_total']}")
    expect([at["facet"] for at in result["locations"]] == list(range(1000)), "not the largest ones")
    expect(sum(result["locations_total"].values()) == 1100, "places of other kinds")
    lower = result["locations"][10]["box"]["lower"]
    expect(lower == [30, 0, 0], f"place 10 at {lower}")


@scenario("defects")
def lines_are_at_most_80_columns(box):
    # Needles far out, whose numbers take all the digits there are.
    needles = [tuple((-1.23456e-30 * (i + 1) - x, -7.65432e-30 * y, -1.23456e-33 * x) for x, y in
                     ((0, 0), (1.23457e-30, 0), (0, 1.23457e-29))) for i in range(50)]
    box.write("needles.stl", models.binary_stl(needles))
    for name in ("needles.stl", "scattered.stl", "crossing.stl"):
        for line in box.run(["check", "-v", name]).text().splitlines():
            expect(len(line) <= 80, f"{name}: {len(line)} columns: {line}")


@scenario("defects")
def overwrite_replaces_defects(box):
    for name in ("d.vtp", "d.ply"):
        box.write(name, b"old")
        expect(box.run(["check", "-q", "hole.stl", "--output-defects", name]).code == 4, "overwritten")
        expect(box.read(name) == b"old", "touched")
        result = box.run(["check", "-q", "hole.stl", "--output-defects", name, "--overwrite"])
        expect(result.code == 1 and box.read(name) != b"old", f"exit code {result.code}")


@scenario("defects")
def defects_are_the_same_bytes_on_any_number_of_threads(box):
    box.succeed([*DIRTY_KNOT, "knot.stl"])
    for suffix in ("vtp", "ply"):
        for threads in ("1", "2"):
            box.run(["check", "-q", "knot.stl", "--threads", threads, "--output-defects", f"{threads}.{suffix}"])
        expect(box.read(f"1.{suffix}") == box.read(f"2.{suffix}"), f"{suffix} differs")


@scenario("defects")
def a_ply_of_defects_holds_the_defective_facets(box):
    box.run(["check", "-q", "crossing.stl", "--output-defects", "d.ply"])
    defects = json.loads(box.run(["check", "--json", "d.ply"]).out)["defects"]
    expect(defects["facets"] == 12 and defects["points"] == 14, f"{defects}")


def read_vtp(path):
    """What VTK reads: points of the verts, counts of cells, kinds and defects of all cells; None without VTK."""
    code = """if True:
        import json, sys
        from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(sys.argv[1])
        reader.Update()
        data, cells = reader.GetOutput(), reader.GetOutput().GetCellData()
        values = lambda a: [a.GetTuple1(i) for i in range(a.GetNumberOfTuples())]
        ends = lambda c: [data.GetPoint(data.GetCell(c).GetPointId(i)) for i in range(data.GetCell(c).GetNumberOfPoints())]
        names = data.GetFieldData().GetAbstractArray("kind_names")
        print(json.dumps({"cells": [ends(c) for c in range(data.GetNumberOfCells())],
            "counts": [data.GetNumberOfVerts(), data.GetNumberOfLines(), data.GetNumberOfPolys()],
            "names": [names.GetValue(i) for i in range(names.GetNumberOfValues())],
            "kind": values(cells.GetArray("kind")), "defect": values(cells.GetArray("defect"))}))"""
    # Debian's own interpreter: no other one sees Debian's VTK.
    result = subprocess.run(["/usr/bin/python3", "-c", code, path], capture_output=True, timeout=120)
    if b"No module named 'vtkmodules'" in result.stderr:
        return None
    expect(result.returncode == 0 and not result.stderr, result.stderr.decode())
    return json.loads(result.stdout)


@scenario("defects")
def vtk_reads_what_is_written(box):
    for name, counts in {"cube": [0, 0, 0], "hole": [1, 3, 0], "twice": [3, 3, 3], "crossing": [1, 0, 12]}.items():
        located = json.loads(box.run(["check", "--json", f"{name}.stl", "--output-defects", f"{name}.vtp"]).out)
        read = read_vtp(box.folder / f"{name}.vtp")
        if read is None:
            print("  skipped: no VTK (scripts/bootstrap picture)")
            return
        expect(read["counts"] == counts, f"{name}: {read['counts']}")
        expect(read["names"] == list(located["locations_total"]), f"{name}: {read['names']}")
        expect([at["defect"] for at in located["locations"]] == list(range(counts[0])), f"{name}: numbers")
        for cell, place in enumerate(located["locations"]):
            expect(read["cells"][cell] == [place["position"]], f"{name}: vert {cell} at {read['cells'][cell]}")
        for cell, points in enumerate(read["cells"]):
            place = located["locations"][int(read["defect"][cell])]
            expect(read["names"][int(read["kind"][cell])] == place["kind"], f"{name}: kind of cell {cell}")
            lower, upper = place["box"]["lower"], place["box"]["upper"]
            inside = all(lower[i] <= p[i] <= upper[i] for p in points for i in range(3))
            expect(inside or place["kind"] == "self_intersection", f"{name}: cell {cell} is elsewhere")


# --- streams ----------------------------------------------------------------------------------------

@scenario("streams")
def full_disk_is_an_error(box):
    with open("/dev/full", "wb") as full:
        for command in ("check cube.stl", "check cube.stl --json", "--help", "example vase -o -"):
            process = box.popen(command.split(), stdout=full)
            _, err = process.communicate(timeout=60)
            expect(process.returncode == 4, f"{command}: exit code {process.returncode}")
            expect_match(r"burnish: standard output: ", err.decode(), "standard error")


@scenario("streams")
def closed_pipe_is_an_error(box):
    for args in (["check", "cube.stl"], ["example", "knot", "-o", "-"]):
        read_end, write_end = os.pipe()
        os.close(read_end)
        process = box.popen(args, stdout=write_end)
        os.close(write_end)
        process.communicate(timeout=60)
        expect(process.returncode == 4, f"{args}: exit code {process.returncode}")


@scenario("streams")
def closed_streams_do_not_end_up_in_files(box):
    script = 'exec "$0" example sphere -o s.stl <&- >&- 2>&-'
    subprocess.run(["/bin/sh", "-c", script, box.program], cwd=box.folder, timeout=60, check=True)
    expect(len(models.read_binary_stl(box.read("s.stl"))) == 550, "the file is not the sphere")


def on_terminal(box, args, **environment):
    """Runs with standard error on a terminal: what is drawn there, and the exit code."""
    main, terminal = pty.openpty()
    process = box.popen(args, environment, stderr=terminal)
    os.close(terminal)
    drawn = b""
    while True:
        ready, _, _ = select.select([main], [], [], 120)
        try:
            piece = os.read(main, 4096) if ready else b""
        except OSError:  # how Linux says that the other end is closed
            piece = b""
        if not piece:
            break
        drawn += piece
    process.communicate(timeout=60)
    os.close(main)
    return drawn.decode(), process.returncode


@scenario("streams")
def a_terminal_shows_a_bar_and_clears_it(box):
    drawn, code = on_terminal(box, ["check", "cube.stl"], TERM="xterm")
    expect(code == 0, f"exit code {code}")
    expect_match(r"\r\x1b\[K\[[#.]+\] +\d+%  reading", drawn, "the terminal")
    expect(drawn.endswith("\r\x1b[K"), "the bar stays behind")
    expect(on_terminal(box, ["check", "-q", "cube.stl"], TERM="xterm") == ("", 0), "-q is not quiet")
    drawn, _ = on_terminal(box, ["check", "cube.stl"], TERM="dumb")
    expect("\x1b" not in drawn, "a dumb terminal is drawn on")


@scenario("streams")
def without_a_terminal_a_line_per_stage(box):
    lines = box.succeed(["check", "cube.stl"]).messages().splitlines()
    expect(lines and all(line.endswith(" s") for line in lines), f"{lines}")


@scenario("streams")
def a_mesh_is_not_printed_on_a_terminal(box):
    main, terminal = pty.openpty()
    process = box.popen(["example", "sphere", "-o", "-"], stdout=terminal)
    _, err = process.communicate(timeout=60)
    os.close(terminal)
    os.close(main)
    expect(process.returncode == 2, f"exit code {process.returncode}")
    expect_match(r"binary file on the terminal\n  hint: redirect", err.decode(), "standard error")


# --- signals ----------------------------------------------------------------------------------------

def start_long_run(box):
    """A run of many seconds, caught in the act: it has said what it is doing, and has a temporary file."""
    if not (box.folder / "knot.stl").exists():
        box.succeed([*DIRTY_KNOT, "knot.stl"])
    size = ["--resolution", "600", "--memory", "16G"]
    process = box.popen(["knot.stl", "-o", "x.stl", "--report", "r.json", *size])
    os.read(process.stderr.fileno(), 1)
    time.sleep(0.5)
    return process


@scenario("signals")
def the_first_signal_ends_the_run_in_order(box):
    for number in (signal.SIGINT, signal.SIGTERM):
        process = start_long_run(box)
        temporaries = [name for name in box.new_files() if name.endswith(".tmp")]
        expect(temporaries, "there is no temporary to leave behind")
        asked = time.monotonic()
        process.send_signal(number)
        out, err = process.communicate(timeout=60)
        expect(process.returncode == 130, f"exit code {process.returncode}\n{err.decode()}")
        expect(time.monotonic() - asked < 5, f"it took {time.monotonic() - asked:.1f} s to stop")
        expect_match(r"^burnish: interrupted$", err.decode(), "standard error")
        expect(out == b"", "something on standard output")
        box.expect_files(["knot.stl"])


@scenario("signals")
def the_second_signal_ends_it_at_once(box):
    process = start_long_run(box)
    process.send_signal(signal.SIGSTOP)  # so that both arrive before the run can act on the first
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGTERM)
    process.send_signal(signal.SIGCONT)
    asked = time.monotonic()
    process.communicate(timeout=60)
    expect(process.returncode == 130, f"exit code {process.returncode}")
    expect(time.monotonic() - asked < 1, "it did not end at once")
    box.expect_files(["knot.stl"])


@scenario("signals")
def waiting_for_standard_input_can_be_ended(box):
    process = box.popen(["check", "-"], stdin=subprocess.PIPE)
    os.read(process.stderr.fileno(), 1)
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    expect(process.wait(timeout=10) == 130, f"exit code {process.returncode}")
    expect_match(r"^burnish: interrupted while reading standard input$", process.stderr.read().decode(), "standard error")


@scenario("signals")
def a_check_can_be_ended(box):
    box.succeed(["example", "nozzle", "-q", "-o", "n.stl"])
    process = box.popen(["check", "n.stl"])
    os.read(process.stderr.fileno(), 1)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=60)
    expect((process.returncode, out) == (130, b""), f"exit code {process.returncode}")


@scenario("signals")
def ignored_signals_stay_ignored(box):
    process = box.popen(["check", "-"], stdin=subprocess.PIPE,
                        preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))  # as nohup does
    os.read(process.stderr.fileno(), 1)
    process.send_signal(signal.SIGHUP)
    out, _ = process.communicate(box.read("cube.stl"), timeout=60)
    expect(process.returncode == 0, f"exit code {process.returncode}")
    expect_match(r"^valid solid$", out.decode(), "standard output")


# --- deviations -------------------------------------------------------------------------------------

@scenario("deviations")
def comparisons_hold_to_the_schema(box):
    for more in ([], ["--exact", "--samples", "20"], ["--max", "1%"], ["-o", "d.vtp", "--overwrite"],
                 ["--normals"], ["--normals", "--floor", "hole.stl", "--input", "moved.stl", "--samples", "50"]):
        for b in ("moved.stl", "hole.stl", "triangle.stl"):
            expect_valid("compare.schema.json", json.loads(box.run(["compare", "cube.stl", b, "--json", *more]).out))


@scenario("deviations")
def a_comparison_says_what_it_found(box):
    result = json.loads(box.succeed(["compare", "cube.stl", "moved.stl", "--json", "-o", "d.ply", "--max", "10%"]).out)
    expect(result["max"] == 0.125 and abs(result["diagonal"] - 3 ** 0.5) < 1e-15, "sizes")
    expect(result["difference"]["box_lower"] == [0.125, 0, 0], f"difference: {result['difference']}")
    expect(abs(result["max_percent"] - 12.5 / 3 ** 0.5) < 1e-12 and result["within_limit"] is True, "percent")
    expect(abs(result["limit"] - 0.1 * 3 ** 0.5) < 1e-15, f"limit {result['limit']}")
    for side in ("a_to_b", "b_to_a"):
        found = result[side]
        expect(found["distance"]["p99.9"] == 0.125 and found["distance"]["p50"] < 1e-15, f"{side}: {found['distance']}")
        expect(found["distance"]["samples"] == 200008, "samples")
        # A third of the surface has moved.
        expect(abs(found["distance"]["mean"] - 0.125 / 3) < 1e-3, f"mean {found['distance']['mean']}")
        expect(abs(abs(found["farthest"][0] - found["opposite"][0]) - 0.125) < 1e-15, "where")
    expect(result["deviation_sign"] == "winding_number", "sign")
    open_one = json.loads(box.succeed(["compare", "cube.stl", "hole.stl", "--json", "-o", "e.ply"]).out)
    expect(open_one["deviation_sign"] == "closest_facet", "sign at an open surface")
    expect(open_one["b"]["volume"] is None and "open" in open_one["b"]["no_volume_reason"], "volume of an open surface")
    expect(open_one["difference"]["volume"] is None, "difference of volumes")


# A cube with an edge of 2 about a unit cube: volume 8, and every sample 0.5 away but for those beyond the unit cube's faces.
@scenario("deviations")
def a_comparison_with_a_truth_says_what_it_found(box):
    box.write("large.stl", models.binary_stl([tuple(tuple(2 * c - 0.5 for c in p) for p in t) for t in models.cube()]))
    result = json.loads(box.succeed(["compare", "large.stl", "cube.stl", "--normals", "--json", "--floor", "cube.stl", "--input", "large.stl",
                                     "--crease-width", "0.25", "--crease-angle", "45"]).out)
    truth = result["truth"]
    expect(truth["result"]["volume_percent"] == 700 and truth["input"]["volume_percent"] == 0, f"volumes: {truth}")
    expect(truth["creases"] == 12 and truth["crease_length"] == 12 and truth["crease_width"] == 0.25, f"creases: {truth}")
    mean_edge = (2 + 2 ** 0.5) / 3
    expect(abs(truth["mean_edge"] - mean_edge) < 1e-15, f"mean edge {truth['mean_edge']}")
    everywhere = truth["result"]["all"]
    expect(abs(everywhere["rms_back"] - 0.5) < 1e-12, f"rms back {everywhere['rms_back']}")
    expect(abs(everywhere["angle_degrees_back"]) < 1e-12, f"angle back {everywhere['angle_degrees_back']}")
    # Of a face of 2 x 2, u and v beyond the unit square are off by |u| - 1/2: mean square 1/4 + 2 (1/2) (1/12).
    expect(abs(everywhere["rms_there"] - (1 / 4 + 1 / 12) ** 0.5) < 1e-3, f"rms there {everywhere['rms_there']}")
    both = ((everywhere["rms_there"] ** 2 + everywhere["rms_back"] ** 2) / 2) ** 0.5
    expect(abs(everywhere["rms"] - both) < 1e-15 and abs(everywhere["rms_mean_edges"] - both / mean_edge) < 1e-15, f"rms {everywhere['rms']}")
    expect(everywhere["samples_there"] == 60000, f"samples {everywhere['samples_there']}")
    # Within 1/4 of its edges a face has 3/4 of its area.
    near = truth["result"]["near_creases"]
    expect(abs(near["samples_back"] / 60000 - 0.75) < 1e-3, f"near: {near['samples_back']}")
    floor = truth["floor"]["figures"]
    expect(floor["all"]["rms"] < 1e-15 and floor["volume_percent"] == 0, f"floor: {floor}")


@scenario("deviations")
def comparisons_are_the_same_bytes_on_any_number_of_threads(box):
    box.succeed([*DIRTY_KNOT, "a.stl"])
    box.succeed(["example", "knot", "-q", "-o", "b.stl"])
    out = {}
    for threads in ("1", "2"):
        for exact in ([], ["--exact", "--samples", "2000"]):
            key = threads, bool(exact)
            out[key] = box.succeed(["compare", "a.stl", "b.stl", "--json", "--threads", threads, *exact]).out
        for suffix in ("vtp", "ply"):
            box.succeed(["compare", "b.stl", "a.stl", "-q", "--threads", threads, "-o", f"{threads}.{suffix}"])
        out[threads, "truth"] = box.succeed(["compare", "a.stl", "b.stl", "--normals", "--json", "--threads", threads, "--map", f"map{threads}.vtp"]).out
    expect(out["1", False] == out["2", False], "rounded distances differ")
    expect(out["1", True] == out["2", True], "exact distances differ")
    expect(out["1", "truth"] == out["2", "truth"], "errors against a truth differ")
    expect(box.read("map1.vtp") == box.read("map2.vtp"), "maps differ")
    for suffix in ("vtp", "ply"):
        expect(box.read(f"1.{suffix}") == box.read(f"2.{suffix}"), f"{suffix} differs")


@scenario("deviations")
def lines_of_comparisons_are_at_most_80_columns(box):
    box.write("far.stl", models.binary_stl([tuple((-1.23456e-30 - x, -7.65432e-30 * y, -1.23456e-33 * x) for x, y in
                                                  ((0, 0), (1.23457e-30, 0), (0, 1.23457e-29)))]))
    box.write("farther.stl", models.binary_stl([tuple((y, -1.23456e-30 * x, -7.65432e-30 + x) for x, y in
                                                      ((-1.23457e-9, 0), (1.23457e-30, -1.23457e-9), (0, 1.23457e-29)))]))
    for a, b in (("far.stl", "cube.stl"), ("farther.stl", "far.stl"), ("hole.stl", "flipped.stl")):
        for line in box.succeed(["compare", a, b]).text().splitlines():
            expect(len(line) <= 80, f"{len(line)} columns: {line}")
        for line in box.succeed(["compare", a, b, "--normals", "--floor", a, "--input", b]).text().splitlines():
            expect(len(line) <= 80, f"{len(line)} columns: {line}")


@scenario("deviations")
def vtk_reads_deviations_with_their_sign(box):
    try:
        import vtk
    except ImportError:
        print("skipped: there is no VTK (Debian: python3-vtk9)")
        return
    box.write("large.stl", models.binary_stl([tuple(tuple(3 * c - 1 for c in p) for p in t) for t in models.cube()]))
    for a, sign in (("cube.stl", -1), ("large.stl", 1)):
        b = {"cube.stl": "large.stl", "large.stl": "cube.stl"}[a]
        for suffix, make in (("vtp", vtk.vtkXMLPolyDataReader), ("ply", vtk.vtkPLYReader)):
            box.succeed(["compare", a, b, "-q", "--overwrite", "-o", f"d.{suffix}"])
            reader = make()
            reader.SetFileName(str(box.folder / f"d.{suffix}"))
            reader.Update()
            surface = reader.GetOutput()
            expect(surface.GetNumberOfPoints() == 8 and surface.GetNumberOfCells() == 12, f"{suffix}: other sizes")
            if suffix == "ply":  # the reader knows of no properties but colours
                colors = surface.GetPointData().GetScalars()
                most = colors.GetComponent(0, 2 if sign < 0 else 0)
                expect(most in (180, 192), f"colour of {a}: {[colors.GetComponent(0, i) for i in range(3)]}")
                continue
            deviation, distance = (surface.GetPointData().GetArray(name) for name in ("deviation", "distance"))
            for i in range(8):
                expected = 1 if a == "cube.stl" else 3 ** 0.5
                expect(abs(distance.GetValue(i) - expected) < 1e-12, f"distance {distance.GetValue(i)} of {a}")
                expect(deviation.GetValue(i) == sign * distance.GetValue(i), f"deviation {deviation.GetValue(i)} of {a}")


@scenario("deviations")
def vtk_reads_maps_of_errors(box):
    try:
        import vtk
    except ImportError:
        print("skipped: there is no VTK (Debian: python3-vtk9)")
        return
    box.succeed(["compare", "moved.stl", "cube.stl", "--normals", "-q", "--map", "m.vtp"])
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(box.folder / "m.vtp"))
    reader.Update()
    numbers = reader.GetOutput().GetCellData()
    angle, distance = (numbers.GetArray(name) for name in ("angle_error", "distance_error"))
    expect(angle.GetNumberOfTuples() == 12, "numbers for all facets")
    expect(max(angle.GetValue(f) for f in range(12)) < 1e-12, "no facet is turned")
    expect(sorted(round(distance.GetValue(f), 12) for f in range(12)) == [0] * 8 + [0.125] * 4, "distances of facets")


# --- schemas ----------------------------------------------------------------------------------------

def validator(name):
    import jsonschema  # Debian: python3-jsonschema
    schema = json.loads((DOCS / name).read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def expect_valid(name, data):
    errors = validator(name).iter_errors(data)
    complaints = [f"{'/'.join(map(str, e.absolute_path))}: {e.message}" for e in errors]
    expect(not complaints, f"against docs/{name}: " + "; ".join(complaints))


def json_result(box, command, *args, code=0):
    """What a command tells with --json, held against the schema that is named like the command."""
    run = box.run([command, *args, "--json", "-q"])
    expect(run.code == code, f"exit code {run.code} of {args}\n{run.messages()}")
    result = json.loads(run.out)
    if "error" not in result:
        expect_valid(f"{command}.schema.json", result)
    return result


@scenario("schemas")
def checks(box):
    for name in ("cube.stl", "hole.stl", "crossing.stl", "triangle.stl"):
        expect_valid("check.schema.json", json.loads(box.run(["check", "--json", name]).out))
    data = json.loads(box.run(["check", "--json", "--salvage", "cut.stl"]).out)
    expect_valid("check.schema.json", data)
    expect(len(data["warnings"]) == 1, f"warnings: {data['warnings']}")
    expect(data["defects"]["facets"] == 11, "facets of a cut file")


@scenario("schemas")
def every_field_of_the_schemas_is_described(_):
    def walk(schema, path):
        for name, field in schema.get("properties", {}).items():
            expect("description" in field or "$ref" in field, f"{path}/{name} is not described")
            walk(field, f"{path}/{name}")
        closed = schema.get("additionalProperties") is False
        is_object = "object" in (schema.get("type") or ())
        expect(not is_object or closed, f"{path} is open")
        optional = set(schema.get("properties", ())) - set(schema.get("required", ()))
        expect(optional == ({"result"} if path == "batch.schema.json/file" else set()), f"{path}: {optional} may be missing: name them in 'required'")
    for name in ("batch.schema.json", "cell_octree.schema.json", "check.schema.json", "compare.schema.json", "curvature.schema.json", "field.schema.json", "ic.schema.json", "mesh.schema.json", "report.schema.json"):
        schema = validator(name).schema
        walk(schema, name)
        for key, part in schema["$defs"].items():
            walk(part, f"{name}/{key}")


@scenario("schemas")
def fields(box):
    for options in ([], ["-o", "f.htg", "--blocks"], ["-o", "f.vti"], ["-o", "g.htg", "--smooth", "3h", "--mode", "mcf"], ["-o", "f.vtu", "--verify-exact", "100", "--band", "5"], ["--adapt", "0.1h", "--max-face-cut", "9"]):
        result = json.loads(box.succeed(["field", "crossing.stl", "--json", "-q", *QUICK, *options]).out)
        expect_valid("field.schema.json", result)
        expect((result["output"] is None) == ("-o" not in options), f"output: {result['output']}")
        expect((result["grid"]["divided"] is None) == ("--adapt" not in options), f"{result['grid']['divided']}")
        expect(sum(level["blocks"] for level in result["grid"]["by_level"]) == result["grid"]["blocks"], "blocks by level")
        expect(result["volume"]["level_set"] < result["volume"]["input"] == 2, f"{result['volume']}")
        if "--verify-exact" in options:
            expect(result["verification"]["passed"] and result["verification"]["kernel"]["nodes"] == 100, f"{result['verification']}")
    failed = box.run(["field", "triangle.stl", "--json", "-q"])
    expect(failed.code == 5, f"exit code {failed.code}")
    expect_valid("field.schema.json", json.loads(failed.out))


@scenario("schemas")
def octrees_of_cells(box):
    for options in ([], ["-o", "f.htg"], ["-o", "f.vtu", "--max-face-cut", "6", "--resolution", "32"]):
        result = json.loads(box.succeed(["field", "triangle.stl", "--cell-octree", "--json", "-q", *options]).out)
        expect_valid("cell_octree.schema.json", result)
        expect((result["output"] is None) == (not options), f"output: {result['output']}")
        cells = result["cells"]
        expect(sum(level["cells"] for level in cells["levels"]) == cells["count"], "cells by level")
        expect(sum(level["cut"] for level in cells["levels"]) == cells["cut"] > 0, "cells cut by level")


@scenario("schemas")
def report_of_a_run(box):
    box.succeed(["hole.stl", "-o", "x.stl", "--report", "r.json", "-q", *QUICK])
    report = json.loads(box.read("r.json"))
    expect_valid("report.schema.json", report)
    expect(report["output"] == {"file": "x.stl", "format": "binary STL", "written": True, "verified": True,
                                "is_sheet": False},
           f"output: {report['output']}")
    expect(report["failure"] is None, "a failure")
    expect(report["before"]["open_edges"] == 3 and report["after"]["open_edges"] == 0, "open edges")
    expect(report["after"]["valid_solid"] is True, "no valid solid")
    expect(abs(report["options"]["cells_along_longest_side"] - 24) < 1e-9, "cells along the longest side")
    expect(report["deviation"]["output_to_input"]["samples"] > 0, "no deviation")
    expect(len(report["stages"]) >= 3, "stages")


@scenario("schemas")
def report_agrees_with_check(box):
    box.succeed(["crossing.stl", "-o", "x.stl", "--report", "r.json", "-q", *QUICK])
    report = json.loads(box.read("r.json"))
    for side, name in {"before": "crossing.stl", "after": "x.stl"}.items():
        checked = json.loads(box.run(["check", "--json", name]).out)
        expect(report[side] == checked["defects"], f"{side} differs")


@scenario("schemas")
def printed_report_is_the_written_one(box):
    printed = json.loads(box.succeed(["cube.stl", "-o", "x.stl", "--json", "--report", "r.json", *QUICK]).out)
    expect(printed == json.loads(box.read("r.json")), "--json and --report differ")


@scenario("schemas")
def report_of_a_smoothing_run(box):
    box.succeed([*DIRTY_KNOT, "knot.stl"])
    options = ["--smooth", "3h", "--deviation", "1%", "--resolution", "64"]
    report = json.loads(box.succeed(["knot.stl", "-o", "x.ply", "--json", "-q", *options]).out)
    expect_valid("report.schema.json", report)
    expect(abs(report["smoothing"]["length"] - 3 * report["options"]["cell"]) < 1e-12, "smoothing length")
    expect(report["smoothing"]["steps"] > 0, "no steps")


def valid_report(box, args, code=0):
    """The report of a run with this exit code, which the schema holds for; --json prints it."""
    result = box.run([*args, "--json", "-q"])
    expect(result.code == code, f"exit code {result.code} of {args}\n{result.messages()}")
    report = json.loads(result.out)
    expect_valid("report.schema.json", report)
    return report


@scenario("schemas")
def report_of_a_local_run(box):
    report = valid_report(box, ["hole.stl", "-o", "x.stl"])
    expect(report["method"] == "local" and report["method_reason"], f"method: {report['method']}")
    expect(report["options"]["cell"] == 0 and report["grid"]["blocks"] == 0, "a level set")
    expect(report["holes"]["count"] == 1 and report["holes"]["largest"][0]["filled"], f"holes: {report['holes']}")
    expect(report["changes"]["count"] == 1, f"changes: {report['changes']}")
    expect(report["actions"]["facets_kept"] == 11 and report["actions"]["facets_added"] == 1, f"{report['actions']}")
    expect(report["losses"] == {"count": 0, "largest": []}, f"losses: {report['losses']}")


@scenario("schemas")
def report_of_a_valid_input(box):
    report = valid_report(box, ["cube.stl", "-o", "x.stl"])
    expect(report["method"] == "local", f"method: {report['method']}")
    expect(report["deviation"] == {"input_to_output": None, "output_to_input": None}, f"{report['deviation']}")
    expect([c["fate"] for c in report["components"]["largest"]] == ["kept"], f"{report['components']}")


@scenario("schemas")
def report_of_a_level_set_run(box):
    report = valid_report(box, ["crossing.stl", "-o", "x.stl", "--method", "levelset", *QUICK])
    expect(report["method"] == "levelset" and report["method_reason"] == "asked for", f"{report['method_reason']}")
    expect(report["options"]["cell"] > 0 and report["grid"]["blocks"] > 0, "no level set")
    expect([c["fate"] for c in report["components"]["largest"]] == ["merged", "merged"], f"{report['components']}")
    expect(report["changes"]["count"] == 0, f"changes: {report['changes']}")


@scenario("schemas")
def report_of_a_sheet(box):
    for options in ([], ["--smooth", "3h", *QUICK], ["--max-hole", "0.5"]):
        keep = [] if "--max-hole" in options else ["--keep-openings"]
        report = valid_report(box, ["hole.stl", "-o", "x.ply", "--overwrite", *keep, *options])
        expect(report["output"]["is_sheet"] and report["output"]["verified"], f"{options}: {report['output']}")
        expect(report["after"]["open_loops"] == 1, f"{options}: {report['after']}")
        expect(report["options"]["max_hole"] == (0.5 if not keep else 0), f"{options}: {report['options']}")


@scenario("schemas")
def report_of_a_thickened_sheet(box):
    report = valid_report(box, ["triangle.stl", "-o", "x.stl", "--thicken", "0.2"])
    expect(report["options"]["thicken"] == 0.2 and report["after"]["valid_solid"], f"{report['options']}")


@scenario("schemas")
def report_of_dropped_and_moved_components(box):
    far = models.cube(offset=(100, 0, 0))
    stray = [((50, 0, 0), (50.1, 0, 0), (50, 0.1, 0))]
    box.write("three.stl", models.binary_stl(models.cube() + far + stray))
    report = valid_report(box, ["three.stl", "-o", "x.stl", "--keep-largest", "--recentre", "--gap", "0.001"])
    expect([c["fate"] for c in report["components"]["largest"]] == ["kept", "dropped", "lost"],
           f"{report['components']}")
    expect(report["losses"]["count"] >= 2, f"losses: {report['losses']}")
    expect(report["options"]["gap"] == 0.001, f"{report['options']}")
    expect(abs(report["recentred_by"][0] - 50.5) < 0.1, f"{report['recentred_by']}")
    local = valid_report(box, ["crossed.stl", "-o", "y.stl", "--method", "local", "--keep-openings"], code=5)
    expect(local["method"] == "local" and "local repair" in local["failure"]["message"], f"{local['failure']}")


@scenario("schemas")
def report_of_a_failure(box):
    result = box.run(["triangle.stl", "-o", "x.stl", "--json", "--report", "r.json", *QUICK])
    expect(result.code == 5, f"exit code {result.code}\n{result.messages()}")
    report = json.loads(result.out)
    expect_valid("report.schema.json", report)
    expect(report == json.loads(box.read("r.json")), "--json and --report differ")
    expect(report["failure"]["code"] == "guarantee_unmet" and report["failure"]["exit_code"] == 5, "failure")
    expect(report["output"]["written"] is False and report["output"]["verified"] is False, "written")
    box.expect_files(["r.json"])
