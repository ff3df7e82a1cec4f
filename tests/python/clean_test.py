"""Cleaning, checking, comparing, distances: against exact values, and against the program."""
import json
import subprocess

import burnish
import numpy as np
import pytest
from conftest import sphere, volume


def run(program, *arguments):
    """The program's standard output."""
    return subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def test_a_cube_without_a_facet_gets_its_volume_back(cube):
    vertices, faces = cube
    assert not burnish.check(vertices, faces[1:])
    result = burnish.clean(vertices, faces[1:])
    assert volume(result.vertices, result.faces) == pytest.approx(1, abs=1e-15)
    assert result.verified and result.failure is None and burnish.check(result)
    assert result.report["after"]["volume"] == pytest.approx(1, abs=1e-15)


def noisy_sphere():
    vertices, faces = sphere(4)
    vertices *= 1 + 0.01 * np.sin(40 * vertices[:, :1])
    return vertices, faces[5:]


@pytest.mark.parametrize("options", [{}, {"smooth": "auto"}, {"smooth": "3%", "mode": "volume", "resolution": 40}, {"method": "levelset", "cell": 0.06},
                                     {"facets": 300}, {"keep_openings": True}, {"offset": -0.05, "cell": "2%"}, {"surface": "delaunay", "cell": "3%", "deviation": "2%", "smooth": "1%"},
                                     {"resolution": 40, "smooth": "4h", "free_volume": True}])
def test_the_same_bytes_as_the_program(tmp_path, program, options):
    burnish.write(tmp_path / "in.ply", *noisy_sphere())
    words = [w for k, v in options.items() for w in (["--" + k.replace("_", "-")] if v is True else [f"--{k.replace('_', '-')}={v}"])]
    run(program, tmp_path / "in.ply", "-o", tmp_path / "cli.ply", "--report", tmp_path / "report.json", *words)
    result = burnish.clean(*noisy_sphere(), **options)
    burnish.write(tmp_path / "python.ply", result)
    assert (tmp_path / "python.ply").read_bytes() == (tmp_path / "cli.ply").read_bytes()
    told, written = result.report, json.loads((tmp_path / "report.json").read_text())
    assert told.keys() == written.keys()
    for part in set(told) - {"input", "output", "stages"}:
        assert told[part] == written[part], part
    from_file = burnish.clean(tmp_path / "in.ply", **options)
    assert np.array_equal(from_file.vertices, result.vertices) and np.array_equal(from_file.faces, result.faces)


def test_float32_is_what_an_stl_holds(tmp_path, program):
    burnish.write(tmp_path / "in.ply", *noisy_sphere())
    run(program, tmp_path / "in.ply", "-o", tmp_path / "cli.stl", "--resolution=40")
    result = burnish.clean(*noisy_sphere(), float32=True, resolution=40)
    assert np.array_equal(result.vertices, result.vertices.astype(np.float32))
    burnish.write(tmp_path / "python.stl", result)
    assert (tmp_path / "python.stl").read_bytes() == (tmp_path / "cli.stl").read_bytes()


def test_threads_make_no_difference():
    one, all_of_them = (burnish.clean(*noisy_sphere(), resolution=30, threads=t) for t in (1, None))
    assert one.vertices.tobytes() == all_of_them.vertices.tobytes() and one.faces.tobytes() == all_of_them.faces.tobytes()


def test_a_volume_is_cleaned_by_its_path(tmp_path):
    n = 24
    axis = np.arange(n) - (n - 1) / 2
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    values = (8 - np.sqrt(x * x + y * y + z * z)).astype("<f4")
    header = f"NRRD0004\ntype: float\ndimension: 3\nsizes: {n} {n} {n}\nspacings: 1 1 1\nendian: little\nencoding: raw\n\n"
    (tmp_path / "ball.nrrd").write_bytes(header.encode() + values.tobytes())
    result = burnish.clean(tmp_path / "ball.nrrd", iso=0)
    assert volume(result.vertices, result.faces) == pytest.approx(4 / 3 * np.pi * 512, rel=0.02)


def test_what_bounds_no_solid_raises_with_the_report(cube):
    flat = cube[0] * [1, 1, 0]
    with pytest.raises(burnish.GuaranteeError) as caught:
        burnish.clean(flat, cube[1])
    error = caught.value
    assert error.code == "guarantee_unmet" and error.hint and error.result.report["failure"]["code"] == "guarantee_unmet"
    result = burnish.clean(flat, cube[1], allow_invalid=True)
    assert not result.verified and str(result.failure) == str(error)


def test_checks_agree_with_the_program(tmp_path, program, cube):
    vertices, faces = cube
    burnish.write(tmp_path / "open.ply", vertices, faces[:-1])
    told = json.loads(subprocess.run([program, "check", tmp_path / "open.ply", "--json", "-q"], capture_output=True, text=True).stdout)
    for found in (burnish.check(vertices, faces[:-1]), burnish.check(tmp_path / "open.ply"), burnish.check(burnish.read(tmp_path / "open.ply"))):
        assert not found and found.defects == told["defects"] and found.locations == told["locations"]
    assert found.defects["open_edges"] == 3 and found.locations[0]["kind"] == "open_loop"
    assert burnish.check(vertices, faces).valid_solid


def test_comparisons_agree_with_the_program(tmp_path, program):
    a, b = sphere(3), sphere(3, radius=1.1)
    burnish.write(tmp_path / "a.ply", *a)
    burnish.write(tmp_path / "b.ply", *b)
    told = json.loads(run(program, "compare", tmp_path / "a.ply", tmp_path / "b.ply", "--json", "--samples=5000"))
    found = burnish.compare(a, b, samples=5000, vertices=True)
    assert found.a_to_b == told["a_to_b"] and found.b_to_a == told["b_to_a"] and found.diagonal == told["diagonal"]
    assert found.vertices_a.shape == (len(a[0]),) and found.vertices_a.max() < 0 < found.vertices_b.min()
    # The outer vertices are above the inner ones.
    assert np.allclose(found.vertices_b, 0.1, atol=1e-3) and found.vertices_b.max() <= 0.1 + 1e-15
    assert burnish.compare(a, tmp_path / "a.ply", samples=100).max < 1e-15


def test_distances_to_a_box_are_exact():
    rng = np.random.default_rng(1)
    sides = np.array([1.0, 2.0, 3.0])
    vertices = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]) * sides
    from conftest import CUBE_FACES
    points = rng.uniform(-2, 5, (2000, 3))
    q = np.abs(points - sides / 2) - sides / 2
    expected = np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(axis=1), 0)
    assert (expected < 0).sum() > 10
    for exact, tolerance in ((True, 1e-14), (False, 1e-12)):
        assert np.abs(burnish.signed_distance(vertices, CUBE_FACES, points, exact=exact) - expected).max() <= tolerance
    inside_out = burnish.signed_distance(vertices, CUBE_FACES[:, ::-1].copy(), points)
    assert np.abs(inside_out - expected).max() <= 1e-14


def test_distances_to_a_sphere_are_within_the_facets_sag():
    vertices, faces = sphere(5)
    edge = np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1).max()
    rng = np.random.default_rng(2)
    points = rng.uniform(-1.5, 1.5, (1500, 3))
    error = burnish.signed_distance(burnish.Mesh(vertices, faces), points) - (np.linalg.norm(points, axis=1) - 1)
    # Facets lie inside the sphere, by (circumradius)^2 / 2 at most.
    assert error.min() >= -1e-15 and error.max() <= edge**2 / 6 * 1.05
    assert np.abs(burnish.signed_distance(vertices, faces, vertices)).max() == 0


def test_thickness_is_that_of_the_box(tmp_path, program, cube):
    vertices, faces = cube[0] * [4, 5, 0.25], cube[1]
    found = burnish.check(vertices, faces, min_thickness=0.3)
    assert found.valid_solid and found.too_thin and not found
    assert found.thickness["minimum"] == pytest.approx(0.25, rel=1e-9) and found.thickness["limit"] == 0.3
    assert found.thickness["places"][0]["thickness"] == pytest.approx(0.25, rel=1e-9)
    burnish.write(tmp_path / "plate.ply", vertices, faces)
    told = json.loads(subprocess.run([program, "check", tmp_path / "plate.ply", "--json", "--min-thickness=0.3"], capture_output=True, text=True).stdout)
    assert found.thickness == told["thickness"] == burnish.check(tmp_path / "plate.ply", min_thickness="0.3").thickness
    assert burnish.check(vertices, faces, min_thickness=0.2) and burnish.check(vertices, faces).thickness is None
    assert burnish.check(vertices, faces, thickness=True).thickness["limit"] is None
    assert burnish.check(burnish.Mesh(vertices, faces, unit="cm"), min_thickness="3mm").thickness["limit"] == pytest.approx(0.3, rel=1e-15)
    open_box = burnish.check(vertices, faces[1:], thickness=True)
    assert open_box.thickness is None and not open_box.too_thin and open_box.warnings[0].startswith("no thickness")
    for wrong in ("2h", "3mm", -1, True, "thin"):
        with pytest.raises(burnish.UsageError, match="min_thickness"):
            burnish.check(vertices, faces, min_thickness=wrong)


def test_alignment_is_the_motion_that_was_undone(cube):
    # A wedge of three different sides and no symmetry: a motion is found as it was.
    vertices = cube[0] * [3, 2, 1] + 0.4 * cube[0][:, [1, 2, 0]] * cube[0][:, [0, 1, 2]]
    turn = np.deg2rad(25)
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    moved = vertices @ rotation.T + [5, -2, 1]
    found = burnish.compare((moved, cube[1]), (vertices, cube[1]), samples=2000, align=True, vertices=True)
    assert np.allclose(np.array(found.alignment["rotation"]), rotation.T, atol=1e-7)
    assert np.allclose(moved @ np.array(found.alignment["rotation"]).T + found.alignment["translation"], vertices, atol=1e-7)
    assert found.max < 1e-7 and np.abs(found.vertices_a).max() < 1e-7
    assert burnish.compare((moved, cube[1]), (vertices, cube[1]), samples=2000).alignment is None
