"""Several inputs at once: the same bytes as alone, what one failure does to the others, and what is left behind."""
import itertools
import json
import os
import signal
import time

from runner import expect, expect_match
from scenarios import expect_valid, scenario

MANY = ["cube.stl", "hole.stl", "crossing.stl", "flipped.stl", "inside_out.stl", "twice.stl"]
# Inputs, and what each comes to alone.
OUTCOMES = {"cube.stl": 0, "cut.stl": 3, "nowhere.stl": 3, "triangle.stl": 5}


def without_times(report):
    """What of a result must not depend on how the run was started."""
    return {k: without_times(v) if isinstance(v, dict) else v for k, v in report.items() if k not in ("stages", "seconds")}


def files_in(box, folder):
    return sorted(str(p.relative_to(box.folder / folder)) for p in (box.folder / folder).rglob("*") if p.is_file())


def table_rows(text):
    return [line.split() for line in text.splitlines() if ".stl " in line and ": " not in line]


@scenario("batch")
def the_bytes_and_reports_of_single_runs_at_any_number_of_jobs(box):
    for name in MANY:
        box.succeed([name, "-o", f"alone-{name}", "--report", f"alone-{name}.json", "-q"])
    for jobs in ("1", "2", "3", "0", "auto", "64"):
        folder = f"out-{jobs}"
        run = box.succeed([*MANY, "-o", f"{folder}/", "--report", f"{folder}/reports/", "--jobs", jobs])
        expect([row[0] for row in table_rows(run.text())] == MANY, f"table of {jobs} jobs:\n{run.text()}")
        numbers = [line for line in run.messages().splitlines() if line.startswith("[")]
        expect(numbers == [f"[{i + 1}/{len(MANY)}] {name}" for i, name in enumerate(MANY)], f"progress: {numbers}")
        for name in MANY:
            expect(box.read(f"{folder}/{name}") == box.read(f"alone-{name}"), f"{name} with {jobs} jobs: other bytes than alone")
            alone = without_times(json.loads(box.read(f"alone-{name}.json")))
            report = without_times(json.loads(box.read(f"{folder}/reports/{name[:-4]}.json")))
            report["output"]["file"] = alone["output"]["file"]
            expect(report == alone, f"{name} with {jobs} jobs: another report")
        summary = json.loads(box.read(f"{folder}/reports/summary.json"))
        expect_valid("batch.schema.json", summary)
        expect([f["input"] for f in summary["files"]] == MANY and summary["exit_code"] == 0, f"{summary}")


@scenario("batch")
def a_share_of_the_memory_changes_no_result(box):
    """A default cell that is coarsened for the budget must not be coarsened more for a share of it."""
    box.succeed(["example", "vase", "-q", "-o", "vase.stl"])
    options = ["--method", "levelset", "--memory", "60M", "--surface", "tetrahedra", "-q"]
    box.succeed(["vase.stl", "-o", "alone.stl", *options])
    for jobs in ("1", "2", "4"):
        box.succeed(["vase.stl", "cube.stl", "hole.stl", "-o", f"m{jobs}/", "--jobs", jobs, *options])
        expect(box.read(f"m{jobs}/vase.stl") == box.read("alone.stl"), f"{jobs} jobs gave another result than all of the memory")
        expect(files_in(box, f"m{jobs}") == ["cube.stl", "hole.stl", "vase.stl"], f"{files_in(box, f'm{jobs}')}")


@scenario("batch")
def the_exit_code_is_the_highest_of_all(box):
    number = 0
    for count in (2, 3):
        for names in itertools.permutations(OUTCOMES, count):
            number += 1
            run = box.run([*names, "-o", f"o{number}/", "--json", "-q"])
            expected = max(OUTCOMES[n] for n in names)
            expect(run.code == expected, f"{names}: exit code {run.code}, expected {expected}")
            result = json.loads(run.out)
            expect_valid("batch.schema.json", result)
            expect([f["exit_code"] for f in result["files"]] == [OUTCOMES[n] for n in names], f"{names}: {result['files']}")
            expect(result["exit_code"] == expected, "exit code in the summary")
            written = files_in(box, f"o{number}") if (box.folder / f"o{number}").exists() else []
            expect(written == [n for n in names if OUTCOMES[n] == 0], f"{names}: written {written}")


@scenario("batch")
def results_in_json_are_those_of_single_runs(box):
    names = ["hole.stl", "cut.stl", "triangle.stl"]
    result = json.loads(box.run([*names, "-o", "o/", "--json", "-q"]).out)
    hole, cut, triangle = result["files"]
    expect_valid("report.schema.json", hole["result"])
    expect((hole["verdict"], hole["facets"], hole["open_edges_before"], hole["volume"]) == ("valid", 12, 3, 1), f"{hole}")
    expect((cut["verdict"], cut["result"], cut["failure"]["code"]) == ("unreadable", None, "unreadable_input"), f"{cut}")
    expect((triangle["verdict"], triangle["failure"]["exit_code"]) == ("not written", 5), f"{triangle}")
    expect_valid("report.schema.json", triangle["result"])
    checks = json.loads(box.run(["check", *names, "--json", "-q"]).out)
    expect_valid("batch.schema.json", checks)
    expect_valid("check.schema.json", checks["files"][0]["result"])
    expect([f["verdict"] for f in checks["files"]] == ["not valid", "unreadable", "not valid"], f"{checks['files']}")


@scenario("batch")
def the_table_says_what_came_of_each(box):
    run = box.run(["hole.stl", "cut.stl", "crossing.stl", "-o", "o/"])
    rows = table_rows(run.text())
    expect(rows[0][:6] == ["hole.stl", "valid", "12", "3", "0", "1"], f"{rows[0]}")
    expect(abs(float(rows[0][6]) - (1 - 0.5 ** 0.5)) < 0.002, f"{rows[0]}: the middle of the hole, from its rim")
    expect(rows[1][:7] == ["cut.stl", "unreadable", "-", "-", "-", "-", "-"], f"{rows[1]}")
    expect(rows[2][:2] == ["crossing.stl", "valid"] and int(rows[2][4]) > 0 and abs(float(rows[2][5]) - 1.875) < 1e-6, f"{rows[2]}")
    expect_match(r"^cut\.stl: exit code 3: cut\.stl: ", run.text(), "the reason")
    expect_match(r"^2 of 3 done and verified \(", run.text(), "the last line")


@scenario("batch")
def checks_of_several_files(box):
    run = box.run(["check", "cube.stl", "hole.stl", "moved.stl"])
    expect(run.code == 1, f"exit code {run.code}")
    expect([row[1:3] for row in table_rows(run.text())] == [["valid", "12"], ["not", "valid"], ["valid", "12"]], run.text())
    expect_match(r"^2 of 3 are valid solids \(", run.text(), "the last line")
    expect(box.run(["check", "-q", "cube.stl", "moved.stl"]).code == 0, "all are valid")
    mixed = box.run(["check", "-q", "hole.stl", "cut.stl", "cube.stl"])
    expect((mixed.code, mixed.out) == (3, b""), f"exit code {mixed.code}")
    box.run(["check", "-q", "hole.stl", "crossing.stl", "--output-defects", "defects/"])
    expect(files_in(box, "defects") == ["crossing.vtp", "hole.vtp"], f"{files_in(box, 'defects')}")
    box.run(["check", "-q", "hole.stl", "--output-defects", "more/{}-defects.ply"])
    expect(files_in(box, "more") == ["hole-defects.ply"], f"{files_in(box, 'more')}")


@scenario("batch")
def folders_and_patterns(box):
    box.succeed(["hole.stl", "-o", "alone.stl", "-q"])
    box.succeed(["hole.stl", "-o", "new/deep/", "--report", "new/", "-q"])
    expect(files_in(box, "new") == ["deep/hole.stl", "hole.json"], f"{files_in(box, 'new')}")
    box.succeed(["hole.stl", "-o", "folder", "-q"])  # one that is there
    box.succeed(["hole.stl", "cube.stl", "-o", "p/{}-x.ply", "-q"])
    expect(files_in(box, "p") == ["cube-x.ply", "hole-x.ply"], f"{files_in(box, 'p')}")
    for name in ("new/deep/hole.stl", "folder/hole.stl"):
        expect(box.read(name) == box.read("alone.stl"), f"{name} has other bytes")
    again = box.run(["hole.stl", "cube.stl", "-o", "folder/", "-q"])
    expect(again.code == 4 and files_in(box, "folder") == ["cube.stl", "hole.stl"], f"exit code {again.code}: an output was there, the other one was not")
    box.succeed(["hole.stl", "cube.stl", "-o", "folder/", "-q", "--overwrite"])


@scenario("batch")
def names_that_clash_are_told_before_anything_runs(box):
    (box.folder / "a").mkdir()
    (box.folder / "b").mkdir()
    for name in ("a/part.stl", "b/part.stl", "b/part.ply"):
        box.write(name, box.read("cube.stl"))
    before = box.new_files()
    for arguments, message in {
        ("a/part.stl", "b/part.stl", "-o", "o/"): r"o/part\.stl: -o would write a/part\.stl and b/part\.stl to the same file\n  hint: do it in two runs",
        ("a/part.stl", "a/part.stl", "-o", "o/"): r"to the same file",
        ("a/part.stl", "b/part.ply", "-o", "o/{}.stl"): r"o/part\.stl: -o would write",
        ("a/part.stl", "b/part.ply", "-o", "o/", "--report", "r/"): r"r/part\.json: --report would write",
        ("a/part.stl", "cube.stl", "-o", "a/", "--overwrite"): r"a/part\.stl: -o names an input\n  hint: write to another folder",
        ("a/part.stl", "cube.stl", "-o", "./a/../a", "--overwrite"): r"-o names an input",
        ("a/part.stl", "cube.stl", "-o", "o/{}.stl", "--report", "o/{}.stl"): r"-o and --report name the same file",
        ("a/part.stl", "cube.stl", "-o", "o.stl"): r"-o o\.stl: one file for several inputs\n  hint: .*-o out/.*'out/\{\}\.stl'",
        ("a/part.stl", "cube.stl", "-o", "-"): r"-o -: one file for several inputs",
        ("a/part.stl", "cube.stl", "-o", "o/", "--report", "r.json"): r"--report r\.json: one file for several inputs",
        ("a/part.stl", "-", "-o", "o/"): r"standard input has no name",
        ("-", "-o", "o/"): r"standard input has no name",
        ("a/part.stl", "cube.stl", "-o", "o/{}.xyz"): r"o/part\.xyz: ",
        ("a/part.stl", "cube.stl"): r"unexpected argument 'cube\.stl'\n  hint: .*-o out/",
        ("a/part.stl", "cube.stl", "-o", "o/", "--jobs", "-1"): r"--jobs -1: expected a whole number",
    }.items():
        run = box.run(list(arguments))
        expect(run.code == 2, f"{arguments}: exit code {run.code}\n{run.messages()}")
        expect_match(r"\Aburnish: " + r".*" + message, run.messages(), f"{arguments}")
        expect(box.new_files() == before, f"{arguments} made {box.new_files()}")
        expect(box.read("a/part.stl") == box.read("cube.stl"), "an input was changed")


def processes_of(pid):
    with open(f"/proc/{pid}/task/{pid}/children", encoding="ascii") as children:
        return [int(word) for word in children.read().split()]


def wait_for(condition, what, seconds=30):
    end = time.monotonic() + seconds
    while not condition():
        expect(time.monotonic() < end, f"no {what} after {seconds} s")
        time.sleep(0.02)




@scenario("batch")
def a_run_that_crashes_is_told_of_and_the_rest_go_on(box):
    for number, name in ((signal.SIGSEGV, "Segmentation fault"), (signal.SIGKILL, "Killed"), (signal.SIGABRT, "Aborted")):
        for jobs in ("1", "2"):
            os.mkfifo(box.folder / "waits.stl")
            process = box.popen(["cube.stl", "waits.stl", "hole.stl", "-o", "o/", "--json", "--jobs", jobs])
            # Only the run that waits for the pipe is left once the others have written, or are yet to begin.
            wait_for(lambda: (box.folder / "o/cube.stl").exists(), "first result")
            if jobs == "2":
                wait_for(lambda: (box.folder / "o/hole.stl").exists(), "last result")
            wait_for(lambda: len(processes_of(process.pid)) == 1 and reads_pipe(processes_of(process.pid)[0]), "run that waits")
            os.kill(processes_of(process.pid)[0], number)
            out, err = process.communicate(timeout=60)
            expect(process.returncode == 70, f"exit code {process.returncode}\n{err.decode()}")
            result = json.loads(out)
            expect_valid("batch.schema.json", result)
            expect([f["exit_code"] for f in result["files"]] == [0, 70, 0], f"{result['files']}")
            crashed = result["files"][1]
            expect(crashed["verdict"] == "crashed" and f"signal {int(number)} ({name})" in crashed["failure"]["message"], f"{crashed}")
            expect_match(rf"^burnish: the run was ended by signal {int(number)} ", err.decode(), "standard error")
            expect(files_in(box, "o") == ["cube.stl", "hole.stl"], f"left: {files_in(box, 'o')}")
            for name_ in ("cube.stl", "hole.stl"):
                (box.folder / "o" / name_).unlink()
            (box.folder / "waits.stl").unlink()


def reads_pipe(pid):
    """Whether a process waits for somebody to write into a named pipe."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii", errors="replace") as stat:
            return stat.read().rsplit(")", 1)[1].split()[0] == "S"
    except FileNotFoundError:
        return False


@scenario("batch")
def an_interrupted_batch_leaves_nothing_half_written(box):
    box.succeed(["example", "knot", "--noise", "0.2", "--holes", "3", "-q", "-o", "knot.stl"])
    for i in range(3):
        box.write(f"k{i}.stl", box.read("knot.stl"))
    inputs = ["k0.stl", "k1.stl", "k2.stl", "cube.stl"]
    before = box.new_files()
    for jobs, number, whole_group in (("1", signal.SIGINT, False), ("2", signal.SIGINT, True), ("3", signal.SIGTERM, False)):
        process = box.popen([*inputs, "-o", "o/", "--report", "r/", "--jobs", jobs, "--resolution", "600", "--memory", "16G"], start_new_session=True)
        wait_for(lambda: (box.folder / "o").exists() and any(n.endswith(".tmp") for n in os.listdir(box.folder / "o")), "work", 100)
        workers = processes_of(process.pid)
        asked = time.monotonic()
        if whole_group:
            os.killpg(process.pid, number)  # as a terminal does
        else:
            process.send_signal(number)
        out, err = process.communicate(timeout=60)
        expect(process.returncode == 130, f"exit code {process.returncode}\n{err.decode()}")
        expect(time.monotonic() - asked < 5, "it took long to stop")
        expect_match(r"^burnish: interrupted after 0 of 4 files$", err.decode(), "standard error")
        expect(out == b"", "something on standard output")
        expect(not any(os.path.exists(f"/proc/{w}") for w in workers), "a run has outlived the program")
        expect(box.new_files() == before, f"left: {box.new_files()}")


@scenario("batch")
def what_was_done_before_an_interrupt_stays(box):
    os.mkfifo(box.folder / "waits.stl")
    process = box.popen(["cube.stl", "waits.stl", "hole.stl", "-o", "o/", "--report", "r/"])
    wait_for(lambda: (box.folder / "o/cube.stl").exists() and len(processes_of(process.pid)) == 1 and b"[2/3]" in os.read(process.stderr.fileno(), 4096), "second run")
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    expect(process.returncode == 130, f"exit code {process.returncode}\n{err.decode()}")
    expect_match(r"^burnish: interrupted after 1 of 3 files$", err.decode(), "standard error")
    expect((files_in(box, "o"), files_in(box, "r")) == (["cube.stl"], ["cube.json"]), f"left: {files_in(box, 'o')}, {files_in(box, 'r')}")


@scenario("batch")
def runs_end_when_the_program_is_killed(box):
    os.mkfifo(box.folder / "waits.stl")
    process = box.popen(["check", "waits.stl", "cube.stl"])
    wait_for(lambda: processes_of(process.pid), "run")
    workers = processes_of(process.pid)
    process.kill()
    process.wait(timeout=10)
    wait_for(lambda: not any(os.path.exists(f"/proc/{w}") for w in workers), "end of the runs", 10)


@scenario("batch")
def the_time_limit_is_each_files_own(box):
    box.succeed(["example", "knot", "--noise", "0.2", "-q", "-o", "knot.stl"])
    run = box.run(["knot.stl", "hole.stl", "-o", "o/", "--time-limit", "0.000001", "-q", "--json"])
    expect(run.code == 7 and [f["verdict"] for f in json.loads(run.out)["files"]] == ["time limit", "time limit"], f"exit code {run.code}\n{run.messages()}")
    expect(not (box.folder / "o").exists(), "an empty folder is left")


@scenario("batch")
def the_same_of_sixty_names(box):
    names = [f"n{i:02}.stl" for i in range(60)]
    for name in names:
        box.write(name, box.read("cube.stl"))
    result = json.loads(box.succeed(["check", *names, "--json", "-q", "--jobs", "8"]).out)
    expect([f["input"] for f in result["files"]] == names and {f["volume"] for f in result["files"]} == {1}, "order or volumes")


@scenario("batch")
def nothing_but_the_result_replaces_an_input(box):
    box.write("smooth-25.stl", box.read("cube.stl"))
    (box.folder / "in").mkdir()
    (box.folder / "link").symlink_to("in")
    for name in ("in/a.stl", "in/b.stl", "in/summary.stl"):
        box.write(name, box.read("cube.stl"))
    before = {name: box.read(name) for name in ("cube.stl", "smooth-25.stl", "in/a.stl", "in/b.stl", "in/summary.stl")}
    files = box.new_files()
    for arguments, message in {
        ("cube.stl", "-o", "x.stl", "--report", "cube.stl"): r"cube\.stl: --report and the input name the same file\n  hint: give one",
        ("in/a.stl", "-o", "x.stl", "--report", "link/a.stl"): r"link/a\.stl: --report and the input name the same file",
        ("in/a.stl", "-o", "x.stl", "--html", "link/a.stl"): r"link/a\.stl: --html and the input name the same file",
        ("smooth-25.stl", "-o", "x.stl", "--smooth", "0.1", "--snapshots", "."): r"smooth-25\.stl: --snapshots and the input name the same file",
        ("cube.stl", "-o", "s/smooth-75.stl", "--smooth", "0.1", "--snapshots", "s"): r"s/smooth-75\.stl: --snapshots and -o name the same file",
        ("sweep", "cube.stl", "-o", "x{}.stl", "--smooth", "0.1,0.2", "--report", "cube.stl"): r"cube\.stl: --report and the input name the same file",
        ("in/a.stl", "in/b.stl", "-o", "link/"): r"link/a\.stl: -o names an input\n  hint: write to another folder",
        ("in/a.stl", "cube.stl", "-o", "in/{}.ply", "--html", "link/{}.ply"): r"link/a\.ply: -o and --html name the same file",
        ("in/summary.stl", "cube.stl", "-o", "o/", "--report", "r/"): r"r/summary\.json: --report would write in/summary\.stl and the summary to the same file\n  hint: .*rename",
    }.items():
        run = box.run([*arguments, "--overwrite"])
        expect(run.code == 2, f"{arguments}: exit code {run.code}\n{run.messages()}")
        expect_match(r"\Aburnish: (\./)?" + message, run.messages(), f"{arguments}")
        expect(box.new_files() == files, f"{arguments} made {box.new_files()}")
        expect(all(box.read(name) == data for name, data in before.items()), f"{arguments} changed an input")
    box.succeed(["in/summary.stl", "cube.stl", "-o", "o/", "-q"])  # without a report there is no summary


@scenario("batch")
def every_hole_of_a_pattern_and_the_folder_of_the_summary(box):
    box.succeed(["hole.stl", "cube.stl", "-o", "o/{}/{}-x{}.ply", "--report", "r/{}/r.json", "-q"])
    expect(files_in(box, "o") == ["cube/cube-xcube.ply", "hole/hole-xhole.ply"], f"{files_in(box, 'o')}")
    expect(files_in(box, "r") == ["cube/r.json", "hole/r.json", "summary.json"], f"{files_in(box, 'r')}")
    box.write("a{}b.stl", box.read("cube.stl"))
    box.succeed(["a{}b.stl", "cube.stl", "-o", "p/{}{}.stl", "-q"])
    expect(files_in(box, "p") == ["a{}ba{}b.stl", "cubecube.stl"], f"a name's own {{}}: {files_in(box, 'p')}")


@scenario("batch")
def threads_limit_jobs(box):
    for threads, jobs, expected in (("1", "2", 1), ("1", "auto", 1), ("2", "4", 2), ("64", "2", 2)):
        result = json.loads(box.succeed(["check", "cube.stl", "moved.stl", "cube.ascii.stl", "-q", "--json", "--threads", threads, "--jobs", jobs]).out)
        expect(result["jobs"] == expected, f"{threads} threads, {jobs} jobs: {result['jobs']} at once")


@scenario("batch")
def nothing_is_left_when_nobody_reads_the_output(box):
    for name in ("first.stl", "waits.stl"):
        os.mkfifo(box.folder / name)
    before = box.new_files()
    with open("/dev/full", "wb") as full:
        process = box.popen(["first.stl", "waits.stl", "-o", "o/", "--report", "r/", "-v", "--jobs", "2"], stdout=full)
        wait_for(lambda: (box.folder / "r").exists() and sum(n.endswith(".tmp") for n in os.listdir(box.folder / "r")) == 3, "temporaries of both runs and of the summary")
        workers = processes_of(process.pid)
        started = time.monotonic()
        box.write("first.stl", box.read("cube.stl"))
        _, err = process.communicate(timeout=60)
    expect(process.returncode == 4, f"exit code {process.returncode}\n{err.decode()}")
    expect_match(r"^burnish: standard output: cannot write: ", err.decode(), "standard error")
    expect(time.monotonic() - started < 4, "it took long to stop")
    expect(len(workers) == 2 and not any(os.path.exists(f"/proc/{w}") for w in workers), f"runs left of {workers}")
    expect((files_in(box, "o"), files_in(box, "r")) == (["first.stl"], ["first.json"]), f"left: {files_in(box, 'o')}, {files_in(box, 'r')}")
    expect(box.new_files() == sorted([*before, "o", "r"]), f"left: {box.new_files()}")


@scenario("batch")
def units_of_each_file(box):
    box.succeed(["cube.stl", "-o", "inch.3mf", "--units", "in", "-q"])
    box.succeed(["cube.stl", "-o", "mm.3mf", "--units", "mm", "-q"])
    run = box.succeed(["check", "inch.3mf", "cube.stl", "mm.3mf", "--json", "-q"])
    result = json.loads(run.out)
    expect_valid("batch.schema.json", result)
    expect(result["units"] is None and [f["units"] for f in result["files"]] == ["in", None, "mm"], f"{[f['units'] for f in result['files']]}")
    table = box.succeed(["check", "inch.3mf", "cube.stl", "mm.3mf"]).text()
    expect_match(r"^file .* volume +s$", table, "a head without a unit")
    for row in (r"^inch\.3mf .* 1 in\^3 +[\d.]+$", r"^cube\.stl .* 1 +[\d.]+$", r"^mm\.3mf .* 1 mm\^3 +[\d.]+$"):
        expect_match(row, table, "a row")
    expect_match(r"^file .* volume in\^3 +s$(.|\n)*^inch\.3mf .* 1 +[\d.]+$", box.succeed(["check", "inch.3mf", "./inch.3mf"]).text(), "one unit of all")
    cleaned = box.succeed(["inch.3mf", "mm.3mf", "-o", "u/"]).text()
    expect_match(r"^mm\.3mf .* 1 mm\^3 ", cleaned, "a cleaned file's row")
