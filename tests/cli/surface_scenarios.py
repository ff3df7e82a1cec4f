"""Surfaces of level sets: sharp edges, sizes and shapes of triangles, simplification."""
import models
from runner import expect, expect_match
from scenarios import scenario, valid_report
from smoothing_scenarios import creases, expect_sharp_cube, fine_cube, noisy_ball, off_cube_edges, read, triangles_of

CELLS = ["--resolution", "24"]


@scenario("surface")
def a_cube_comes_back_with_its_edges_and_corners(box):
    for surface in ("tetrahedra", "delaunay"):
        report = valid_report(box, ["cube.stl", "-o", "x.stl", "--overwrite", "--surface", surface, *CELLS])
        told = report["surface"]
        expect(report["method"] == "levelset" and told["extractor"] == surface and told["reason"] == "asked for", f"{told}")
        expect(told["sharpened"] and told["creases"] == 12 and told["corners"] == 8 and abs(told["crease_length"] - 12) < 1e-6, f"{told}")
        triangles = read(box, "x.stl")
        expect_sharp_cube(triangles, degrees=0.1)
        length = sum(l for m, l, turn in creases(triangles))
        expect(abs(length - 12) < 1e-3, f"{surface}: {length} of sharp edges")
        expect(max(off_cube_edges(m) for m, _, _ in creases(triangles)) < 1e-5, "sharp edges away from the cube's")
        expect(abs(report["after"]["volume"] - 1) < 1e-5, f"volume {report['after']['volume']}")
        expect(report["deviation"]["input_to_output"]["max"] < 1e-5, f"{report['deviation']}")


@scenario("surface")
def coarse_triangles_keep_edges_and_corners(box):
    for size in (["--edge", "4h"], ["--edge-tolerance", "0.1h"]):
        report = valid_report(box, ["cube.stl", "-o", "x.stl", "--overwrite", "--resolution", "32", *size])
        expect(report["surface"]["extractor"] == "delaunay", f"{report['surface']}")
        expect_sharp_cube(read(box, "x.stl"), degrees=0.1)
        expect(abs(report["after"]["volume"] - 1) < 1e-5 and report["after"]["facets"] < 2000, f"{report['after']}")


@scenario("surface")
def tolerance_lets_triangles_grow(box):
    box.succeed(["example", "sphere", "-q", "-o", "ball.stl"])
    uniform = valid_report(box, ["ball.stl", "-o", "a.stl", "--surface", "delaunay", "--resolution", "64", "--crease", "60"])
    report = valid_report(box, ["ball.stl", "-o", "b.stl", "--edge-tolerance", "0.1h", "--resolution", "64", "--crease", "60"])
    expect(report["after"]["facets"] < 0.3 * uniform["after"]["facets"], f"{report['after']['facets']} of {uniform['after']['facets']} facets")
    expect(report["deviation"]["output_to_input"]["rms"] < 0.3 * report["options"]["cell"], f"{report['deviation']}")


@scenario("surface")
def too_many_triangles_are_refused_before_they_are_made(box):
    run = box.run(["cube.stl", "-o", "x.stl", "--edge", "1e-6", *CELLS])
    expect(run.code == 6, f"exit code {run.code}\n{run.messages()}")
    expect_match(r"edges of 1e-06 make about .* facets.*\n  hint: choose a larger --edge", run.messages(), "message")
    box.expect_files([])


@scenario("surface")
def a_bound_holds_for_what_is_simplified(box):
    box.write("noisy.stl", models.binary_stl(noisy_ball(0.02)))
    run = box.run(["noisy.stl", "-o", "x.stl", "--smooth", "auto", "--deviation", "0.08", "--facets", "30"])
    expect(run.code == 5, f"exit code {run.code}\n{run.messages()}")
    expect_match(r"the result is 0\.\d+ from the repaired surface, and --deviation allows 0\.08", run.messages(), "message")
    report = valid_report(box, ["noisy.stl", "-o", "x.stl", "--smooth", "auto", "--deviation", "0.08", "--facets", "600"])
    expect(report["smoothing"]["deviation"] <= 0.0801, f"{report['smoothing']}")
    expect(report["actions"]["facets_kept"] == 0 and report["actions"]["facets_added"] == report["after"]["facets"], f"{report['actions']}")


@scenario("surface")
def topology_is_that_of_the_level_set(box):
    box.succeed(["example", "knot", "-q", "-o", "knot.stl"])
    for surface in ("tetrahedra", "delaunay"):
        report = valid_report(box, ["knot.stl", "-o", "x.stl", "--overwrite", "--surface", surface, "--resolution", "64"])
        topology = report["surface"]["topology"]
        expect(topology["genus"] == 1 and topology["components"] == 1 and topology["agrees"], f"{topology}")
        expect(topology["level_set_genus"] == 1 and topology["level_set_components"] == 1, f"{topology}")


@scenario("surface")
def delaunay_keeps_to_sizes_and_angles(box):
    box.succeed(["example", "sphere", "-q", "-o", "ball.stl"])
    report = valid_report(box, ["ball.stl", "-o", "a.stl", "--surface", "delaunay", "--cell", "2%", "--crease", "60"])
    expect(report["surface"]["shapes"]["min_angle"] >= 20, f"{report['surface']['shapes']}")
    coarse = valid_report(box, ["ball.stl", "-o", "b.stl", "--edge", "4h", "--cell", "2%", "--surface", "delaunay", "--crease", "60"])
    ratio = report["after"]["facets"] / coarse["after"]["facets"]
    expect(10 < ratio < 25, f"{report['after']['facets']} facets, {coarse['after']['facets']} with four times the edge")
    angled = valid_report(box, ["ball.stl", "-o", "c.stl", "--min-angle", "28", "--cell", "2%", "--crease", "60"])
    expect(angled["surface"]["extractor"] == "delaunay" and "asked for" in angled["surface"]["reason"], f"{angled['surface']}")


@scenario("surface")
def auto_chooses_by_the_number_of_facets(box):
    box.succeed(["example", "knot", "-q", "-o", "knot.stl"])
    small = valid_report(box, ["cube.stl", "-o", "x.stl", "--overwrite", *CELLS])["surface"]
    expect(small["extractor"] == "delaunay" and 0 < small["predicted_facets"] <= 50000, f"{small}")
    large = valid_report(box, ["knot.stl", "-o", "x.stl", "--overwrite", "--resolution", "250"])["surface"]
    expect(large["extractor"] == "tetrahedra" and large["predicted_facets"] > 50000, f"{large}")


@scenario("surface")
def edges_may_be_given_to_the_octree(box):
    box.succeed(["example", "sphere", "-q", "-o", "ball.stl"])
    report = valid_report(box, ["ball.stl", "-o", "x.stl", "--surface", "tetrahedra", "--edge", "3h", "--cell", "2%"])
    cell = report["options"]["cell"]
    expect(0.75 < report["after"]["mean_edge"] / (3 * cell) < 1.25, f"mean edge {report['after']['mean_edge'] / cell} cells")


@scenario("surface")
def simplified_to_a_number_of_facets(box):
    box.succeed(["example", "knot", "-q", "-o", "knot.stl"])
    for more in ([], ["--surface", "tetrahedra", "--resolution", "100"]):
        report = valid_report(box, ["knot.stl", "-o", "x.stl", "--overwrite", "--facets", "4000", *more])
        expect(3998 <= report["after"]["facets"] <= 4000, f"{report['after']['facets']} facets")
        expect(report["surface"]["facets_before"] > 20000 and report["output"]["verified"], f"{report['surface']}")
        expect(report["method"] == ("levelset" if more else "local"), f"{report['method']}")
        expect(0 < report["deviation"]["output_to_input"]["rms"] < 0.01 * 2.5, f"{report['deviation']}")


@scenario("surface")
def simplified_within_a_deviation(box):
    report = valid_report(box, ["cube.stl", "-o", "x.stl", "--surface", "tetrahedra", "--simplify", "0.001", *CELLS])
    expect(report["after"]["facets"] <= 60, f"{report['after']['facets']} facets of a cube")
    expect(report["surface"]["simplify_deviation"] <= 0.001, f"{report['surface']}")
    expect(abs(report["after"]["volume"] - 1) < 0.004, f"volume {report['after']['volume']}")


@scenario("surface")
def sheets_can_be_simplified(box):
    points, facets = fine_cube()
    open_box = [t for t in triangles_of(points, facets) if not all(p[2] == 1 for p in t)]
    box.write("open.stl", models.binary_stl(open_box))
    report = valid_report(box, ["open.stl", "-o", "x.stl", "--keep-openings", "--facets", "100"])
    expect(report["output"]["is_sheet"] and report["after"]["facets"] <= 100 and report["after"]["open_loops"] == 1, f"{report['after']}")
    expect(abs(report["after"]["area"] - 5) < 0.01, f"area {report['after']['area']}")


@scenario("surface")
def clashes_are_refused(box):
    for arguments, message in ((["--surface", "tetrahedra", "--min-angle", "20"], "--min-angle is for --surface delaunay"),
                               (["--surface", "tetrahedra", "--edge-tolerance", "0.1h"], "--edge-tolerance is for --surface delaunay"),
                               (["--surface", "delaunay", "--keep-openings"], "no openings to keep"),
                               (["--method", "local", "--edge", "0.1"], "--edge is a matter of the level set"),
                               (["--min-angle", "31"], "expected an angle between 0 and 30 degrees"),
                               (["--facets", "3"], "expected a whole number from 4"),
                               (["--simplify", "1h"], "cannot be given in cells"),
                               (["--surface", "cubes"], "--surface cubes")):
        run = box.run(["cube.stl", "-o", "x.stl", *arguments])
        expect(run.code == 2, f"exit code {run.code} of {arguments}\n{run.messages()}")
        expect_match(message, run.messages(), "message")
        box.expect_files([])


@scenario("surface")
def creases_can_be_left_to_the_cells(box):
    report = valid_report(box, ["cube.stl", "-o", "x.stl", "--surface", "tetrahedra", "--crease", "179", *CELLS])
    expect(report["surface"]["creases"] == 0, f"{report['surface']}")


@scenario("surface")
def the_same_bytes_on_any_number_of_threads(box):
    for i, surface in enumerate(("tetrahedra", "delaunay")):
        for threads in (1, 2):
            box.succeed(["cube.stl", "-o", f"{surface}{threads}.stl", "--surface", surface, "--threads", str(threads), "-q", *CELLS])
        expect(box.read(f"{surface}1.stl") == box.read(f"{surface}2.stl"), f"{surface}: other bytes on another number of threads")


SPECKS = [  # cubes: side, and lower corner
    (0.05, -0.225, 0.778, -0.605), (0.05, 0.595, 2.395, -1.922), (0.03, 1.685, 2.705, 0.705), (0.05, -0.205, 2.678, 1.595),
    (0.1, -1.55, -1.93, 0.65), (0.1, -1.45, 2.85, 1.35), (0.05, 0.678, 1.875, 1.095), (0.05, -0.605, -0.425, 2.378), (0.05, -0.225, 2.675, 1.475),
    (0.05, -1.205, 0.078, 2.478), (0.03, -1.595, -1.615, 1.205), (0.1, -0.747, -1.347, 2.37), (0.03, 0.185, -0.612, -1.595),
    (0.05, 2.595, 1.975, -1.905), (0.1, 2.153, 0.45, -0.13), (0.15, -0.855, 1.828, -1.555), (0.15, 1.145, -1.455, -0.155),
    (0.03, 2.085, -0.112, -0.212), (0.15, -1.455, -0.872, 0.145), (0.1, 1.25, -0.23, 0.97), (0.03, -1.912, 1.185, 0.785),
    (0.03, 1.988, -1.315, -0.095), (0.05, -1.622, 2.175, -1.325)
]


@scenario("surface")
def facets_that_a_3mf_drops_do_not_keep_it_from_being_mended(box):
    """Where float32 has steps of 0.04 cells, facets lose their area. An STL has them still, a 3MF does not: by its numbers of facets others would be mended."""
    far = 38000
    cubes = [tuple(tuple(side * c + o + far for c, o in zip(p, corner)) for p in f) for side, *corner in SPECKS for f in models.cube()]
    box.write("specks.obj", models.write_obj(cubes))
    box.succeed(["specks.obj", "-o", "x.3mf", "--method", "levelset", "--cell", "0.1", "--surface", "tetrahedra", "-q"])
    box.succeed(["check", "x.3mf", "-q"])
