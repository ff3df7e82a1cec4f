"""Volumes of numbers, .vti and .nrrd, as the input: the surface on which they have a value."""
import gzip
import math
import struct

from runner import expect, expect_match
from scenarios import scenario, valid_report

CENTER = (0.31, -0.17, 0.23)
SIDE, RADIUS = 28, 10
EXACT = 4 / 3 * math.pi * RADIUS ** 3


def ball(x, y, z):
    """Distance, positive inside."""
    return RADIUS - math.dist((x, y, z), CENTER)


def share(x, y, z):
    """Of a voxel that the ball fills, to first order: a plane between the voxel's corners."""
    return min(1, max(0, 0.5 + ball(x, y, z)))


def values_of(function, layers=SIDE):
    middle = (SIDE - 1) / 2
    return [function(i - middle, j - middle, k - middle) for k in range(layers) for j in range(SIDE) for i in range(SIDE)]


def nrrd(values, layers=SIDE, kind="<f", name="float"):
    low = -(SIDE - 1) / 2
    header = (f"NRRD0004\ntype: {name}\ndimension: 3\nsizes: {SIDE} {SIDE} {layers}\nspacings: 1 1 1\naxis mins: {low} {low} {low}\n"
              "endian: little\nencoding: gzip\n\n")
    return header.encode() + gzip.compress(b"".join(struct.pack(kind, v) for v in values))


def vti(arrays):
    low = -(SIDE - 1) / 2
    extent = f"0 {SIDE - 1} 0 {SIDE - 1} 0 {SIDE - 1}"
    data = "".join(f'<DataArray type="Float32" Name="{name}" format="ascii">{" ".join(f"{v:.6g}" for v in values)}</DataArray>' for name, values in arrays.items())
    return (f'<VTKFile type="ImageData" byte_order="LittleEndian"><ImageData WholeExtent="{extent}" Origin="{low} {low} {low}" Spacing="1 1 1">'
            f'<Piece Extent="{extent}"><PointData>{data}</PointData></Piece></ImageData></VTKFile>').encode()


@scenario("volume")
def a_ball_comes_out_of_its_distances(box):
    box.write("ball.nrrd", nrrd(values_of(ball)))
    for arguments in (["ball.nrrd"], ["--from-field", "ball.nrrd"]):
        report = valid_report(box, [*arguments, "--iso", "0", "-o", "x.stl", "--overwrite"])
        volume = report["volume"]
        expect(report["input"]["format"] == "nrrd" and volume["nodes"] == [SIDE] * 3 and volume["type"] == "float32", f"{volume}")
        expect(volume["iso"] == 0 and not volume["iso_was_chosen"] and volume["inside"] == "above" and volume["border_voxels"] == 0, f"{volume}")
        expect(abs(report["after"]["volume"] / EXACT - 1) < 0.008, f"volume {report['after']['volume'] / EXACT}")
        expect(report["surface"]["topology"]["genus"] == 0 and report["surface"]["topology"]["components"] == 1, f"{report['surface']['topology']}")
    # The value moves the surface, and the other side of it is a cavity in a box.
    report = valid_report(box, ["ball.nrrd", "--iso", "2", "-o", "y.stl"])
    expect(abs(report["after"]["volume"] / (EXACT * 0.8 ** 3) - 1) < 0.01, f"{report['after']}")
    report = valid_report(box, ["ball.nrrd", "--iso", "0", "--below", "-o", "z.stl"])
    expect(abs(report["after"]["volume"] / (SIDE ** 3 - EXACT) - 1) < 0.01 and report["surface"]["topology"]["cavities"] == 1, f"{report['after']}")
    expect(report["volume"]["border_voxels"] == SIDE ** 3 - (SIDE - 2) ** 3 and "runs off the volume" in " ".join(report["warnings"]), f"{report['volume']}")


@scenario("volume")
def steps_are_smoothed_on_the_volumes_own_lattice(box):
    box.write("steps.nrrd", nrrd(values_of(lambda *p: ball(*p) > 0), kind="<B", name="uchar"))
    report = valid_report(box, ["steps.nrrd", "--iso", "auto", "-o", "x.stl", "--smooth", "4h", "--mode", "volume", "--deviation", "2h"])
    expect(abs(report["volume"]["iso"] - 0.5) < 1e-3 and report["volume"]["iso_was_chosen"], f"{report['volume']}")
    expect(report["options"]["cell"] == 1 and report["method"] == "levelset", f"{report['options']}")
    expect(abs(report["after"]["volume"] / EXACT - 1) < 0.02, f"volume {report['after']['volume'] / EXACT}")
    expect(0 < report["smoothing"]["deviation"] <= 2.01 and report["smoothing"]["rms_moved"] > 0.05, f"{report['smoothing']}")
    expect(not any("staircase" in w for w in report["warnings"]), f"{report['warnings']}")
    report = valid_report(box, ["steps.nrrd", "--iso", "0.5", "-o", "s.stl"])
    expect(any("staircase" in w for w in report["warnings"]), f"{report['warnings']}")
    # With a cell of its own the level set is that of the iso-surface's facets.
    report = valid_report(box, ["steps.nrrd", "--iso", "0.5", "-o", "y.stl", "--smooth", "4", "--mode", "volume", "--cell", "0.8"])
    expect(report["options"]["cell"] == 0.8 and abs(report["after"]["volume"] / EXACT - 1) < 0.02, f"{report['options']}")


@scenario("volume")
def one_of_several_arrays(box):
    box.write("two.vti", vti({"ball": values_of(ball), "plain": values_of(lambda x, y, z: x)}))
    report = valid_report(box, ["two.vti", "--iso", "0", "-o", "x.stl"])
    expect(report["volume"]["array"] == "ball" and abs(report["after"]["volume"] / EXACT - 1) < 0.008, f"{report['volume']}")
    report = valid_report(box, ["two.vti", "--iso", "0", "--array", "plain", "-o", "y.stl"])
    expect(abs(report["after"]["volume"] / (SIDE ** 3 / 2) - 1) < 0.01, f"{report['after']['volume']}")
    run = box.run(["two.vti", "--iso", "0", "--array", "other", "-o", "z.stl"])
    expect(run.code == 3, f"exit code {run.code}")
    expect_match(r"expected an array 'other', found 'ball', 'plain'", run.messages(), "message")


@scenario("volume")
def components_are_chosen_as_usual(box):
    box.write("two.nrrd", nrrd(values_of(lambda x, y, z: max(ball(x, y, z), 1.5 - math.dist((x, y, z), (11, 11, 11))))))
    report = valid_report(box, ["two.nrrd", "--iso", "0", "-o", "x.stl"])
    expect(report["surface"]["topology"]["components"] == 2, f"{report['surface']}")
    for smooth in ([], ["--smooth", "3h", "--mode", "volume"]):
        report = valid_report(box, ["two.nrrd", "--iso", "0", "--keep-largest", "-o", "x.stl", "--overwrite", *smooth])
        expect(report["surface"]["topology"]["components"] == 1 and abs(report["after"]["volume"] / EXACT - 1) < 0.01, f"{report['after']}")


@scenario("volume")
def the_same_bytes_on_any_number_of_threads(box):
    box.write("ball.nrrd", nrrd(values_of(lambda *p: round(255 * share(*p))), kind="<B", name="uint8"))
    for smooth in ([], ["--smooth", "3h", "--mode", "mcf"]):
        for name, threads in (("a", "1"), ("b", "2")):
            box.succeed(["ball.nrrd", "--iso", "127.5", "-q", "-o", f"{name}.stl", "--overwrite", "--threads", threads, *smooth])
        expect(box.read("a.stl") == box.read("b.stl"), "threads changed the result")


@scenario("volume")
def what_cannot_be_done_is_said(box):
    box.write("ball.nrrd", nrrd(values_of(ball)))
    values = values_of(ball)
    values[SIDE * SIDE * 2 + SIDE * 3 + 4] = math.nan
    box.write("nan.nrrd", nrrd(values))
    box.write("short.nrrd", nrrd(values_of(ball))[:-2000])
    for arguments, code, message in (
            (["ball.nrrd"], 2, r"values are from -?[\d.]+ to [\d.]+: expected --iso V.*\n  hint: --iso auto takes Otsu's threshold, -?[\d.]+ here"),
            (["ball.nrrd", "--iso", "500"], 2, r"--iso 500: values are from .* to .*"),
            (["ball.nrrd", "--iso", "much"], 2, r"--iso much: expected a number"),
            (["nan.nrrd", "--iso", "0"], 3, r"nan\.nrrd: the value of voxel \(4, 3, 2\) is nan"),
            (["short.nrrd", "--iso", "0"], 3, r"short\.nrrd: .*expected \d+ values, found \d+"),
            (["ball.nrrd", "--iso", "0", "--memory", "50K"], 6, r"28 x 28 x 28 values need"),
            (["cube.stl", "--iso", "0"], 2, r"cube\.stl: expected a volume"),
            (["--from-field", "cube.stl"], 2, r"cube\.stl: expected a volume")):
        run = box.run([*arguments, "-o", "x.stl"])
        expect(run.code == code, f"{arguments}: exit code {run.code}\n{run.messages()}")
        expect_match(message, run.messages(), "message")
        expect("x.stl" not in box.new_files(), "something was written")
