"""Smoothing, denoising, offsets and sweeps: what the files that come out look like, against shapes that are known."""
import json
import math
import random
import struct

import models
from curvature_scenarios import shifted, sphere
from runner import expect, expect_match
from scenarios import QUICK, expect_valid, scenario, valid_report

SIDE = 24           # squares along an edge of the cubes
EDGE = (2 + math.sqrt(2)) / 3 / SIDE  # their mean edge: two sides and a diagonal
BALL = 4 / 3 * math.pi


# --- models -------------------------------------------------------------------------------------------

def fine_cube(n=SIDE):
    """The unit cube in n x n squares a face: points by their place on the grid, and facets between places."""
    points, facets = {}, []
    for axis in range(3):
        for end in (0, n):
            def place(i, j):
                at = [0, 0, 0]
                at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3] = end, i, j
                points[tuple(at)] = tuple(c / n for c in at)
                return tuple(at)
            for i in range(n):
                for j in range(n):
                    a, b, c, d = (place(i + di, j + dj) for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
                    facets += [(a, b, c), (a, c, d)] if end else [(a, c, b), (a, d, c)]
    return points, facets


def triangles_of(points, facets):
    return [tuple(points[p] for p in f) for f in facets]


def as_stored(p):
    """As float32 holds it."""
    return struct.unpack("<3f", struct.pack("<3f", *p))


def outwards(place, n=SIDE):
    """The cube's normal at a place of its grid, the average at edges and corners."""
    d = [-(c == 0) + (c == n) for c in place]
    length = math.sqrt(sum(c * c for c in d))
    return [c / length for c in d]


def noisy_cube(sigma, seed=1):
    """Triangles of a fine cube with normally distributed noise along its normals."""
    points, facets = fine_cube()
    rng = random.Random(seed)
    moved = {}
    for place, p in points.items():
        by = rng.gauss(0, sigma)
        moved[place] = tuple(c + by * d for c, d in zip(p, outwards(place)))
    return triangles_of(moved, facets)


def noisy_ball(sigma, seed=2, n=24):
    """A ball of radius 1 with noise along its radii."""
    rng, scale = random.Random(seed), {}
    def moved(p):
        return tuple(c * scale.setdefault(p, 1 + rng.gauss(0, sigma)) for c in p)
    rounded = [tuple(tuple(round(c, 9) for c in p) for p in t) for t in sphere(n, 1.0)]
    return [tuple(moved(p) for p in t) for t in rounded]


def damaged(triangles, kind, seed=3):
    """With facets deleted or turned over; or each facet with points of its own, a rounding error apart from each other."""
    rng = random.Random(seed)
    if kind == "holes":
        return [t for t in triangles if rng.random() > 0.01]
    if kind == "flipped":
        return [t[::-1] if rng.random() < 0.05 else t for t in triangles]
    return [tuple(tuple(c + rng.uniform(-1e-7, 1e-7) for c in p) for p in t) for t in triangles]


# --- measures -----------------------------------------------------------------------------------------

def read(box, name):
    return models.as_points(models.read_binary_stl(box.read(name)))


def points_of(triangles):
    return {p for t in triangles for p in t}


def normal(t):
    u, v = ([b - a for a, b in zip(t[0], q)] for q in t[1:])
    n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    size = math.sqrt(sum(c * c for c in n))
    return [c / size for c in n], size / 2


def angle(m, n):
    return math.degrees(math.acos(max(-1, min(1, sum(a * b for a, b in zip(m, n))))))


def percentile(values, share):
    return sorted(values)[int(share * (len(values) - 1))]


def tilt(t):
    """Degrees between a facet's normal and that of the cube's face that it is nearest to."""
    middle = [sum(c) / 3 - 0.5 for c in zip(*t)]
    axis = max(range(3), key=lambda a: abs(middle[a]))
    face = [0, 0, 0]
    face[axis] = math.copysign(1, middle[axis])
    return angle(normal(t)[0], face)


def creases(triangles, least=45):
    """(middle, length, angle in degrees) of the edges at which facets turn by at least that much."""
    sides = {}
    for t in triangles:
        for i in range(3):
            sides.setdefault(frozenset((t[i], t[(i + 1) % 3])), []).append(normal(t)[0])
    for edge, normals in sides.items():
        expect(len(normals) == 2, f"{len(normals)} facets at an edge")
        turn = angle(*normals)
        if turn >= least:
            a, b = edge
            yield [(x + y) / 2 for x, y in zip(a, b)], math.dist(a, b), turn


def off_cube_edges(p):
    """The distance of a point from the nearest of the unit cube's twelve edges' lines."""
    off = sorted(min(abs(c), abs(c - 1)) for c in p)
    return math.hypot(off[0], off[1])


def expect_sharp_cube(triangles, degrees=3.0, folds=0.0):
    """Flat faces and twelve sharp edges where the unit cube has them; elsewhere no more than this length of folds."""
    tilts = [tilt(t) for t in triangles]
    expect(percentile(tilts, 0.95) < degrees, f"95 % of facets are within {percentile(tilts, 0.95)} degrees of their face")
    sharp = list(creases(triangles))
    at_edges = [(length, turn) for middle, length, turn in sharp if off_cube_edges(middle) < EDGE / 2]
    length = sum(l for l, _ in at_edges)
    expect(abs(length - 12) < 0.6, f"sharp edges of {length}, not 12")
    expect(abs(percentile([a for _, a in at_edges], 0.5) - 90) < 1.5, f"median angle {percentile([a for _, a in at_edges], 0.5)}")
    expect(percentile([abs(a - 90) for _, a in at_edges], 0.9) < 10, f"90 % of angles are within {percentile([abs(a - 90) for _, a in at_edges], 0.9)} of 90 degrees")
    elsewhere = sum(l for _, l, _ in sharp) - length
    expect(elsewhere <= folds, f"folds of {elsewhere} off the edges")


def expect_verified(report, mode):
    expect(report["output"]["verified"] and report["output"]["written"] and report["after"]["valid_solid"], f"{report['output']}")
    expect(report["smoothing"]["mode"] == mode and report["smoothing"]["mode_reason"], f"mode {report['smoothing']['mode']}: {report['smoothing']['mode_reason']}")


def expect_volume(report, volume, within):
    expect(abs(report["after"]["volume"] / volume - 1) <= within, f"volume {report['after']['volume']}, expected {volume}")


# --- noise that is found ------------------------------------------------------------------------------

@scenario("smoothing")
def auto_takes_the_noise_off_a_cube_and_keeps_its_edges(box):
    for share, degrees in ((0.1, 2.0), (0.25, 4.0)):
        sigma = share * EDGE
        box.write("n.stl", models.binary_stl(noisy_cube(sigma)))
        report = valid_report(box, ["n.stl", "-o", "x.stl", "--smooth", "auto", "--overwrite"])
        expect_verified(report, "feature")
        expect(report["method"] == "local", f"{report['method']}: {report['method_reason']}")
        noise = report["smoothing"]["noise"]
        expect(abs(noise["sigma"] / sigma - 1) < 0.15, f"sigma {noise['sigma']}, it is {sigma}")
        expect(abs(noise["mean_edge"] / EDGE - 1) < 0.1, f"mean edge {noise['mean_edge']}")
        expect_volume(report, report["before"]["volume"], 1e-6)
        expect(0.7 * sigma < report["smoothing"]["rms_moved"] < 1.1 * sigma, f"moved {report['smoothing']['rms_moved']} by noise of {sigma}")
        before, after = read(box, "n.stl"), read(box, "x.stl")
        expect(len(after) == len(before), "other facets")
        expect(percentile([tilt(t) for t in before], 0.95) > 4 * degrees, "there was no noise")
        expect_sharp_cube(after, degrees)


@scenario("smoothing")
def auto_leaves_what_has_no_noise_alone(box):
    shapes = {"cube": triangles_of(*fine_cube()), "ball": sphere(24, 1.0), "coarse": models.cube()}
    for name, triangles in shapes.items():
        box.write(f"{name}.stl", models.binary_stl(triangles))
        report = valid_report(box, [f"{name}.stl", "-o", f"{name}.out.stl", "--smooth", "auto"])
        expect(report["smoothing"]["mode"] is None and report["smoothing"]["mode_reason"] == "there is no noise to remove", f"{name}: {report['smoothing']}")
        expect(report["smoothing"]["noise"]["sigma"] == 0 and report["smoothing"]["outliers"] == 0, f"{name}: {report['smoothing']}")
        expect(report["method"] == "local" and report["output"]["verified"], f"{name}: {report['method']}")
        expect(read(box, f"{name}.out.stl") == read(box, f"{name}.stl"), f"{name} was changed")


@scenario("smoothing")
def auto_denoises_what_is_broken_too(box):
    sigma = 0.2 * EDGE
    cube = noisy_cube(sigma)
    for kind in ("holes", "flipped", "unwelded"):
        box.write("n.stl", models.binary_stl(damaged(cube, kind)))
        report = valid_report(box, ["n.stl", "-o", "x.stl", "--smooth", "auto", "--overwrite"])
        expect_verified(report, "feature")
        expect(not report["before"]["valid_solid"], f"{kind}: nothing was broken")
        expect(abs(report["smoothing"]["noise"]["sigma"] / sigma - 1) < 0.15, f"{kind}: sigma {report['smoothing']['noise']['sigma']}, it is {sigma}")
        expect_volume(report, 1, 0.005)
        result = read(box, "x.stl")
        # A few slivers beside mended places lie folded.
        expect_sharp_cube(result, folds=1.0)


@scenario("smoothing")
def auto_drops_fragments_and_puts_spikes_back(box):
    ball = sphere(24, 1.0)
    spike = ball[777][0]
    away = tuple(1.3 * c for c in spike)
    stray = [tuple(tuple(1.5 + 0.005 * c for c in p) for p in t) for t in models.cube()[:-1]]  # open: dirt, not a part
    spiked = [tuple(away if p == spike else p for p in t) for t in ball]
    box.write("s.stl", models.binary_stl(spiked + stray))
    report = valid_report(box, ["s.stl", "-o", "x.stl", "--smooth", "auto"])
    expect_verified(report, "feature")
    smoothing = report["smoothing"]
    expect(smoothing["outliers"] == 1 and smoothing["noise"]["sigma"] == 0, f"{smoothing}")
    expect(abs(smoothing["max_moved"] - 0.3) < 0.01, f"moved by {smoothing['max_moved']}")
    expect(report["actions"]["fragments_dropped"] == 1 and report["after"]["components"] == 1, f"{report['actions']}")
    dropped = [c for c in report["components"]["largest"] if c["fate"] == "dropped"]
    expect([(c["reason"], c["facets"]) for c in dropped] == [("a stray fragment", 11)], f"{dropped}")
    before, after = points_of(read(box, "s.stl")), points_of(read(box, "x.stl"))
    new = after - before
    expect(len(new) == 1 and math.dist(new.pop(), spike) < 0.01, "the spike is not back on the ball")
    expect(before - after == {as_stored(away)} | points_of([tuple(map(as_stored, t)) for t in stray]), "more than that was changed")
    # Without --smooth auto nobody asked for either.
    kept = valid_report(box, ["s.stl", "-o", "y.stl"])
    expect(kept["actions"]["fragments_dropped"] == 0 and kept["after"]["components"] == 2, f"{kept['actions']}")
    # Of a valid solid each part is one, however small.
    box.write("two.stl", models.binary_stl(ball + [tuple(tuple(1.5 + 0.005 * c for c in p) for p in t) for t in models.cube()]))
    valid_report(box, ["two.stl", "-o", "z.stl", "--smooth", "auto"])
    expect(read(box, "z.stl") == read(box, "two.stl"), "it was valid as it was")


# --- what is chosen -----------------------------------------------------------------------------------

@scenario("smoothing")
def modes_follow_from_what_is_given(box):
    box.write("cube.noisy.stl", models.binary_stl(noisy_cube(0.2 * EDGE)))
    box.write("ball.noisy.stl", models.binary_stl(noisy_ball(0.01)))
    box.write("ball.stl", models.binary_stl(sphere(24, 1.0)))
    cases = (
        ("cube.noisy.stl", ["--smooth", "0.15"], "feature", "local", "creases"),
        ("cube.noisy.stl", ["--smooth", "0.15", *QUICK], "feature", "levelset", "creases"),
        ("cube.noisy.stl", ["--smooth", "3h", *QUICK], "volume", "levelset", "cells"),
        ("ball.noisy.stl", ["--smooth", "0.2"], "feature", "local", "random"),
        ("ball.noisy.stl", ["--smooth", "0.3", *QUICK], "volume", "levelset", "a level set was asked for"),
        ("ball.noisy.stl", ["--smooth", "0.3", "--deviation", "1h", *QUICK], "volume", "levelset", "cells"),
        ("ball.noisy.stl", ["--smooth", "auto", "--mode", "volume", *QUICK], "volume", "levelset", "asked for"),
        ("ball.stl", ["--smooth", "0.2", "--resolution", "40"], "volume", "levelset", "a level set was asked for"),
        ("ball.stl", ["--smooth", "0.2", "--curvature-radius", "0.5", *QUICK], "mcf", "levelset", "radius"),
        ("ball.stl", ["--smooth", "0.2", "--mode", "feature"], "feature", "local", "asked for"),
    )
    for name, options, mode, method, reason in cases:
        report = valid_report(box, [name, "-o", "x.stl", "--overwrite", *options])
        expect_verified(report, mode)
        expect(report["method"] == method, f"{name} {options}: {report['method']}, {report['method_reason']}")
        expect(reason in report["smoothing"]["mode_reason"], f"{name} {options}: {report['smoothing']['mode_reason']}")


# --- bounds -------------------------------------------------------------------------------------------

@scenario("smoothing")
def no_point_moves_farther_than_the_deviation(box):
    sigma = 0.2 * EDGE
    box.write("n.stl", models.binary_stl(noisy_cube(sigma)))
    free = valid_report(box, ["n.stl", "-o", "free.stl", "--smooth", "auto"])
    expect(free["smoothing"]["max_moved"] > 2 * sigma, f"{free['smoothing']}")
    for options in (["--smooth", "auto"], ["--smooth", "0.2"], ["--smooth", "auto", "--mode", "feature"]):
        report = valid_report(box, ["n.stl", "-o", "x.stl", "--overwrite", "--deviation", repr(sigma), *options])
        expect_verified(report, "feature")
        told = report["smoothing"]
        expect(report["options"]["deviation"] == sigma, f"{options}: {report['options']}")
        # Points are rounded to float32.
        expect(0 < told["max_moved"] <= sigma * (1 + 1e-9) and 0 < told["deviation"] <= sigma + 1e-6, f"{options}: {told}")
        for a, b in zip(read(box, "n.stl"), read(box, "x.stl")):
            for p, q in zip(a, b):
                expect(math.dist(p, q) <= sigma + 1e-6, f"{options}: {p} moved to {q}")


@scenario("smoothing")
def level_sets_stay_within_the_deviation(box):
    box.write("n.stl", models.binary_stl(noisy_ball(0.02)))
    for mode in ("volume", "mcf", "filtered"):
        base = ["n.stl", "-o", "x.stl", "--overwrite", "--mode", mode, "--smooth", "0.8", "--resolution", "48"]
        report = valid_report(box, [*base, "--deviation", "0.02"])
        expect_verified(report, mode)
        cell = report["options"]["cell"]
        expect(report["options"]["deviation"] == 0.02 and 0 < report["smoothing"]["deviation"] <= 0.02 + cell, f"{mode}: {report['smoothing']}")
        free = valid_report(box, [*base, "--deviation", "1"])["smoothing"]["deviation"]
        expect(report["smoothing"]["deviation"] < free - 0.1 * cell, f"{mode}: the bound of 0.02 changed {free} to {report['smoothing']['deviation']}")


@scenario("smoothing")
def exit_code_5_says_that_the_deviation_was_exceeded(box):
    box.write("n.stl", models.binary_stl(noisy_ball(0.02)))
    for options in (["--smooth", "auto", "--deviation", "1e-5"], ["--smooth", "0.5", "--mode", "volume", "--deviation", "1e-5", *QUICK],
                    ["--smooth", "0.5", "--mode", "mcf", "--free-volume", "--deviation", "0.01", "--resolution", "12"],
                    ["--smooth", "30%", "--mode", "reinit", "--deviation", "0.001", "--resolution", "16"]):
        run = box.run(["n.stl", "-o", "x.stl", "--overwrite", "--json", "-q", *options])
        report = json.loads(run.out)
        expect_valid("report.schema.json", report)
        slack = report["options"]["cell"] or 1e-3 * report["options"]["deviation"]
        exceeded = report["smoothing"]["deviation"] > report["options"]["deviation"] + slack
        expect(report["smoothing"]["deviation"] > 0, f"{options}: not measured")
        expect(run.code == (5 if exceeded else 0), f"{options}: exit code {run.code}, {report['smoothing']}")
        expect(report["output"]["verified"] != exceeded and (report["failure"] is not None) == exceeded, f"{options}: {report['failure']}")


# --- regions ------------------------------------------------------------------------------------------

def smoothed_in_region(box, region, inside):
    """Smooths a noisy cube inside a region only; how many points stayed in it, and its tilts there before and after."""
    report = valid_report(box, ["n.stl", "-o", "x.stl", "--overwrite", "--smooth", "auto", "--region", region])
    expect_verified(report, "feature")
    before, after = read(box, "n.stl"), read(box, "x.stl")
    expect(len(before) == len(after), "other facets")
    moved = 0
    for t, u in zip(before, after):
        for p, q in zip(t, u):
            if not inside(p):
                expect(p == q, f"{region}: {p} lies outside and moved to {q}")
            moved += p != q
    deep = [(t, u) for t, u in zip(before, after) if all(inside(p, 3 * EDGE) for p in t)]
    return moved, [tilt(t) for t, _ in deep], [tilt(u) for _, u in deep]


@scenario("smoothing")
def points_outside_a_region_stay_bit_for_bit(box):
    box.write("n.stl", models.binary_stl(noisy_cube(0.2 * EDGE)))
    box.write("box.txt", b"# the lower half, and a little more\nbox 2 2 0.5  -1 -1 -1\n")
    box.write("balls.txt", b"sphere 0 0 0 0.5\r\nsphere 1 1 1 0.4 # two corners\r\n")
    box.write("region.stl", models.binary_stl([tuple((3 * x - 1, 3 * y - 1, 1.5 * z - 1) for x, y, z in t) for t in models.cube()]))
    def below(p, margin=0):
        return p[2] < 0.5 - margin
    def in_balls(p, margin=0):
        return math.dist(p, (0, 0, 0)) < 0.5 - margin or math.dist(p, (1, 1, 1)) < 0.4 - margin
    for region, inside in (("box.txt", below), ("balls.txt", in_balls), ("region.stl", below)):
        moved, before, after = smoothed_in_region(box, region, inside)
        expect(moved > 500 and len(before) > 100, f"{region}: {moved} moved, {len(before)} facets")
        expect(percentile(after, 0.5) < 0.25 * percentile(before, 0.5), f"{region}: tilts {percentile(before, 0.5)} -> {percentile(after, 0.5)}")
    expect(smoothed_in_region(box, "box.txt", below) == smoothed_in_region(box, "region.stl", below), "a box and its surface differ")


@scenario("smoothing")
def level_sets_stay_where_they_are_outside_a_region(box):
    box.write("n.stl", models.binary_stl(noisy_ball(0.02)))
    box.write("half.txt", b"box -2 -2 0  2 2 2\n")
    options = ["--mode", "volume", "--surface", "tetrahedra", "--resolution", "48", "-q"]
    box.succeed(["n.stl", "-o", "none.stl", *options, "--method", "levelset"])
    report = valid_report(box, ["n.stl", "-o", "half.stl", *options[:-1], "--smooth", "0.6", "--region", "half.txt"])
    expect_verified(report, "volume")
    cell = report["options"]["cell"]
    def rms(name, keep):
        off = [math.hypot(*p) - 1 for p in points_of(read(box, name)) if keep(p[2])]
        return math.sqrt(sum(o * o for o in off) / len(off))
    expect(rms("half.stl", lambda z: z > 0.4) < 0.5 * rms("none.stl", lambda z: z > 0.4), "not smooth inside")
    expect(abs(rms("half.stl", lambda z: z < -cell) / rms("none.stl", lambda z: z < -cell) - 1) < 0.02, "smoothed outside")
    below = [p for p in points_of(read(box, "half.stl")) if p[2] < -6 * cell]
    stay = points_of(read(box, "none.stl"))
    # Whether a thin facet is improved depends on its neighbours, and through them on what is farther away.
    expect(len(below) > 1000 and sum(p in stay for p in below) >= 0.999 * len(below), "points outside were moved")


@scenario("smoothing")
def regions_that_make_no_sense_are_refused(box):
    box.write("n.stl", models.binary_stl(noisy_cube(0.2 * EDGE)))
    hint = r"\n  hint: .*box X0 Y0 Z0 X1 Y1 Z1.*sphere X Y Z R"
    for text, complaint in ((b"box 0 0 0 1 1 1\ncube 0 0 0 1\n", r"bad\.txt: line 2.*expected 'box' or 'sphere', found 'cube'" + hint),
                            (b"# none\n\nbox 0 0 0 1 1\n", r"bad\.txt: line 3.*expected 6 numbers behind 'box', found ''" + hint),
                            (b"sphere 0 0 0 1 2\n", r"bad\.txt: line 1.*expected the end of the line, found '2'" + hint),
                            (b"sphere 0 0 0 -1\n", r"bad\.txt: line 1.*radius greater than zero, found -1" + hint),
                            (b"sphere 0 0 zero 1\n", r"bad\.txt: line 1.*expected 4 numbers behind 'sphere', found 'zero'" + hint),
                            (b"# nothing\n", r"bad\.txt.*expected boxes or spheres, found none" + hint)):
        box.write("bad.txt", text)
        run = box.run(["n.stl", "-o", "x.stl", "--smooth", "auto", "--region", "bad.txt"])
        expect(run.code == 3, f"{text}: exit code {run.code}\n{run.messages()}")
        expect_match(complaint, run.messages(), f"error for {text}")
    for region, complaint in (("missing.txt", r"burnish: missing\.txt: "), ("missing.stl", r"burnish: missing\.stl: "), ("text.stl", r"burnish: text\.stl: "),
                              ("triangle.stl", r"burnish: triangle\.stl: expected a closed surface.*\n  hint: ")):
        run = box.run(["n.stl", "-o", "x.stl", "--smooth", "auto", "--region", region])
        expect(run.code == 3, f"{region}: exit code {run.code}\n{run.messages()}")
        expect_match(complaint, run.messages(), f"error for {region}")
    expect("x.stl" not in box.new_files(), "something was written")


# --- walls --------------------------------------------------------------------------------------------

@scenario("smoothing")
def balls_are_offset_and_hollowed(box):
    box.write("ball.stl", models.binary_stl(sphere(32, 1.0)))
    cases = ((["--offset", "0.2"], 1.2 ** 3, 1), (["--offset", "+0.2"], 1.2 ** 3, 1), (["--offset=-0.2"], 0.8 ** 3, 1),
             (["--hollow", "0.2"], 1 - 0.8 ** 3, 2), (["--offset", "0.2", "--hollow", "0.1"], 1.2 ** 3 - 1.1 ** 3, 2))
    for options, volume, components in cases:
        report = valid_report(box, ["ball.stl", "-o", "x.stl", "--overwrite", *options, "--resolution", "40"])
        expect_verified_walls(report)
        expect(report["after"]["components"] == components, f"{options}: {report['after']}")
        expect_volume(report, volume * BALL, 0.01)
        radii = sorted(math.hypot(*p) for p in points_of(read(box, "x.stl")))
        outer = 1 if "--offset" not in options[0] else 1.2 if "=" not in options[0] else 0.8
        expect(abs(radii[-1] - outer) < 0.02, f"{options}: outer radius {radii[-1]}")
    expect(report["options"]["offset"] == 0.2 and report["options"]["hollow"] == 0.1, f"{report['options']}")


def expect_verified_walls(report):
    expect(report["output"]["verified"] and report["method"] == "levelset" and not report["failure"], f"{report['output']}")


@scenario("smoothing")
def what_is_smoothed_is_offset(box):
    box.write("n.stl", models.binary_stl(noisy_ball(0.02)))
    report = valid_report(box, ["n.stl", "-o", "x.stl", "--smooth", "0.6", "--mode", "volume", "--offset", "0.2", "--resolution", "48"])
    expect_verified(report, "volume")
    expect_volume(report, 1.2 ** 3 * BALL, 0.01)
    radii = [math.hypot(*p) for p in points_of(read(box, "x.stl"))]
    rough = math.sqrt(sum((r - 1.2) ** 2 for r in radii) / len(radii))
    expect(rough < 0.006, f"rms {rough} off the ball of 1.2")
    # Facets are denoised first, then the level set is built of them.
    box.write("c.stl", models.binary_stl(noisy_cube(0.2 * EDGE)))
    report = valid_report(box, ["c.stl", "-o", "y.stl", "--smooth", "auto", "--offset=-0.1", "--resolution", "60"])
    expect_verified(report, "feature")
    expect_volume(report, 0.8 ** 3, 0.01)
    tilts = [tilt(t) for t in read(box, "y.stl") if normal(t)[1] > 1e-6]
    expect(percentile(tilts, 0.5) < 2, f"tilts {percentile(tilts, 0.5)}")


# --- sweeps -------------------------------------------------------------------------------------------

def sweep(box, args, code=0):
    run = box.run(["sweep", *args, "--json", "-q"])
    expect(run.code == code, f"exit code {run.code} of {args}\n{run.messages()}")
    reports = json.loads(run.out)
    for report in reports:
        expect_valid("report.schema.json", report)
    return reports


@scenario("smoothing")
def a_sweep_gives_a_file_for_each_length(box):
    box.write("n.stl", models.binary_stl(noisy_ball(0.02)))
    lengths = ["0.2", "0.4", "0.8"]
    reports = sweep(box, ["n.stl", "--smooth", ",".join(lengths), "-o", "s{}.stl", "--mode", "volume", "--cell", "0.05", "--report", "r.json"])
    expect(reports == json.loads(box.read("r.json")), "--json and --report differ")
    expect([r["output"]["file"] for r in reports] == [f"s{l}.stl" for l in lengths], f"{[r['output'] for r in reports]}")
    moved = []
    for length, report in zip(lengths, reports):
        expect_verified(report, "volume")
        expect(report["smoothing"]["length"] == float(length) and report["options"]["cell"] == 0.05, f"{report['smoothing']}")
        expect_volume(report, reports[0]["smoothing"]["volume_before"], 2e-3)
        expect(abs(report["smoothing"]["volume_after"] / report["smoothing"]["volume_before"] - 1) < 1e-3, f"{report['smoothing']}")
        moved.append((report["smoothing"]["rms_moved"], report["deviation"]["input_to_output"]["rms"]))
        single = valid_report(box, ["n.stl", "-o", "one.stl", "--overwrite", "--smooth", length, "--mode", "volume", "--cell", "0.05"])
        # The same surface but for rounding: room for the longest length moves the lattice's origin.
        one, swept = read(box, "one.stl"), read(box, f"s{length}.stl")
        expect(len(one) == len(swept), f"{length}: {len(swept)} facets, a run of its own gives {len(one)}")
        off = max(math.dist(p, q) for t, u in zip(one, swept) for p, q in zip(t, u))
        expect(off < 1e-6, f"{length}: {off} from what a run of its own gives")
        expect(abs(single["smoothing"]["rms_moved"] / moved[-1][0] - 1) < 1e-9, f"{length}: {single['smoothing']}")
    expect(moved == sorted(moved) and moved[0][0] < moved[-1][0], f"{moved}")


@scenario("smoothing")
def a_sweep_on_facets_equals_single_runs(box):
    sigma = 0.2 * EDGE
    box.write("n.stl", models.binary_stl(damaged(noisy_cube(sigma), "holes")))
    reports = sweep(box, ["n.stl", "--smooth", "0.1,0.2,8%", "-o", "s-{}.stl"])
    for length, report in zip(("0.1", "0.2", "8%"), reports):
        expect_verified(report, "feature")
        single = valid_report(box, ["n.stl", "-o", "one.stl", "--overwrite", "--smooth", length])
        expect(box.read("one.stl") == box.read(f"s-{length}.stl"), f"a run of its own gives another file for {length}")
        same = ("before", "after", "smoothing", "deviation", "holes", "method", "method_reason")
        for key in same:
            expect(single[key] == report[key], f"{length}: {key} differs: {single[key]}, {report[key]}")


@scenario("smoothing")
def a_sweep_touches_no_file_that_exists(box):
    box.write("n.stl", models.binary_stl(noisy_ball(0.02, n=8)))
    box.write("s-0.4.stl", b"old")
    args = ["sweep", "n.stl", "--smooth", "0.2,0.4", "-o", "s-{}.stl", "--mode", "volume", *QUICK]
    run = box.run(args)
    expect(run.code == 4 and "s-0.4.stl" in run.messages() and "--overwrite" in run.messages(), f"exit code {run.code}\n{run.messages()}")
    box.expect_files(["n.stl", "s-0.4.stl"])
    expect(box.read("s-0.4.stl") == b"old", "touched")
    run = box.succeed([*args, "--overwrite"])
    box.expect_files(["n.stl", "s-0.2.stl", "s-0.4.stl"])
    expect_match(r"^s-0\.2\.stl +valid +\d+(.|\n)*^s-0\.4\.stl +valid +\d+", run.text(), "table")
    for line in run.text().splitlines():
        expect(len(line) <= 92, f"{len(line)} columns: {line}")
    failed = sweep(box, ["triangle.stl", "--smooth", "0.2,0.4", "-o", "t-{}.stl"], code=5)
    expect(len(failed) == 1 and failed[0]["failure"]["code"] == "guarantee_unmet", f"{failed}")
    box.expect_files(["n.stl", "s-0.2.stl", "s-0.4.stl"])


# --- limits, warnings, threads ------------------------------------------------------------------------

@scenario("smoothing")
def out_of_time_nothing_is_written(box):
    box.succeed(["example", "knot", "--noise", "0.2", "-q", "-o", "knot.stl"])
    for command in (["knot.stl", "-o", "x.stl", "--smooth", "auto"], ["knot.stl", "-o", "x.stl", "--smooth", "1%", "--mode", "volume"],
                    ["sweep", "knot.stl", "-o", "x{}.stl", "--smooth", "1%,2%"]):
        run = box.run([*command, "--time-limit", "0.01", "--json"])
        expect(run.code == 7, f"exit code {run.code} of {command}\n{run.messages()}")
        expect_match(r"burnish: the time limit is over\n  hint: .*--time-limit", run.messages(), "error")
        error = json.loads(run.out)["error"]
        expect(error["code"] == "time_limit" and error["exit_code"] == 7, f"{error}")
        box.expect_files(["knot.stl"])
    box.succeed(["cube.stl", "-o", "x.stl", "-q", "--time-limit", "100"])


@scenario("smoothing")
def options_without_effect_are_told(box):
    box.write("half.txt", b"box 0 0 0 1 1 0.5\n")
    idle = {"--deviation": ["0.1"], "--redistance": ["fmm"], "--mode": ["feature"], "--free-volume": [], "--region": ["half.txt"], "--curvature-radius": ["1"]}
    for option, value in idle.items():
        run = box.succeed(["cube.stl", "-o", "x.stl", "--overwrite", option, *value])
        expect_match(rf"burnish: warning: {option}: has no effect without --smooth", run.messages(), "warning")
    run = box.succeed(["cube.stl", "-o", "x.stl", "--overwrite"])
    expect("no effect" not in run.messages(), run.messages())
    run = box.succeed(["cube.stl", "-o", "x.stl", "--overwrite", "--smooth", "auto", "--mode", "feature", "--deviation", "0.1"])
    expect("no effect" not in run.messages(), run.messages())


@scenario("smoothing")
def smoothing_gives_the_same_bytes_on_any_number_of_threads(box):
    box.write("n.stl", models.binary_stl(damaged(noisy_cube(0.2 * EDGE), "holes")))
    for options in (["--smooth", "auto"], ["--smooth", "0.2", "--mode", "feature", "--region", "balls.txt"], ["--smooth", "0.2", "--mode", "volume"],
                    ["--smooth", "0.2", "--mode", "filtered"], ["--smooth", "auto", "--mode", "volume", "--region", "balls.txt"],
                    ["--smooth", "0.2", "--mode", "volume", "--offset", "0.1", "--hollow", "0.1"]):
        box.write("balls.txt", b"sphere 0 0 0 0.7\n")
        quick = [] if options == ["--smooth", "auto"] or "feature" in options else ["--resolution", "32"]
        for threads in "12":
            box.succeed(["n.stl", "-q", "-o", f"{threads}.stl", "--overwrite", "--threads", threads, *options, *quick])
        expect(box.read("1.stl") == box.read("2.stl"), f"{options}: 1 and 2 threads differ")
