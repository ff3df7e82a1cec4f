"""What goes in and out: files, arrays, memory."""
import subprocess
import sys

import burnish
import numpy as np
import pytest
from conftest import sphere, volume

VERTEX_TYPES = [np.float32, np.float64]
FACE_TYPES = [np.int32, np.int64, np.uint32, np.uint64]


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off", ".stl", ".stla"])
def test_what_is_written_is_read_back(tmp_path, suffix):
    vertices, faces = sphere(2)
    vertices = vertices.astype(np.float32)
    path = tmp_path / f"sphere{suffix}"
    burnish.write(path, vertices, faces)
    mesh = burnish.read(path)
    assert np.array_equal(mesh.vertices[mesh.faces], vertices[faces].astype(float))
    assert len(mesh.vertices) == len(vertices)
    assert mesh.file == str(path) and mesh.warnings == []


def test_double_precision_survives_a_ply(tmp_path):
    vertices, faces = sphere(1, radius=1 / 3)
    burnish.write(tmp_path / "a.ply", vertices, faces)
    mesh = burnish.read(tmp_path / "a.ply", weld=False)
    assert mesh.vertices.tobytes() == vertices.tobytes()
    assert mesh.faces.tobytes() == faces.astype(np.uint32).tobytes()


def test_an_stl_is_welded_unless_told_otherwise(tmp_path, cube):
    burnish.write(tmp_path / "cube.stl", *cube)
    assert burnish.read(tmp_path / "cube.stl").vertices.shape == (8, 3)
    assert burnish.read(tmp_path / "cube.stl", weld=False).vertices.shape == (36, 3)


def test_names_and_colours_go_round(tmp_path, cube):
    colors = np.zeros((12, 4), dtype=np.uint8)
    colors[:, 0], colors[:, 3] = np.arange(12) * 20, 255
    mesh = burnish.Mesh(*cube, groups=[burnish.Group("floor", 0, 2), burnish.Group("rest", 2, 10)], colors=colors)
    burnish.write(tmp_path / "cube.ply", mesh)
    read = burnish.read(tmp_path / "cube.ply")
    assert read.names == ["floor", "rest"] and read.groups == mesh.groups
    assert np.array_equal(read.colors, colors)
    cleaned = burnish.clean(read)
    assert cleaned.groups == mesh.groups and np.array_equal(cleaned.colors, colors)


def test_an_existing_file_stays_unless_told_otherwise(tmp_path, cube):
    path = tmp_path / "cube.stl"
    path.write_text("precious")
    with pytest.raises(burnish.UnwritableOutputError) as caught:
        burnish.write(path, *cube)
    assert caught.value.code == "unwritable_output" and str(path) in str(caught.value)
    assert path.read_text() == "precious"
    burnish.write(path, *cube, overwrite=True)
    assert len(burnish.read(path).faces) == 12


def test_arrays_lie_on_the_librarys_memory(tmp_path):
    vertices, faces = sphere(3)
    burnish.write(tmp_path / "a.ply", vertices, faces)
    mesh = burnish.read(tmp_path / "a.ply")
    for array, shape, kind in ((mesh.vertices, (len(vertices), 3), np.float64), (mesh.faces, (len(faces), 3), np.uint32)):
        assert type(array.base).__name__ == "PyCapsule" and not array.flags.owndata
        assert array.flags.c_contiguous and array.flags.writeable and array.shape == shape and array.dtype == kind


def test_arrays_outlive_what_they_came_with(cube):
    vertices = burnish.clean(*cube).vertices
    for _ in range(10):
        burnish.clean(*sphere(3))
    assert vertices.min() == 0 and vertices.max() == 1 and len(vertices) == 8


@pytest.mark.parametrize("vertex_type", VERTEX_TYPES)
@pytest.mark.parametrize("face_type", FACE_TYPES)
def test_types_of_arrays_make_no_difference(cube, vertex_type, face_type):
    vertices, faces = cube[0].astype(vertex_type), cube[1].astype(face_type)
    result = burnish.clean(vertices, faces)
    assert np.array_equal(result.vertices[result.faces], cube[0][cube[1]])


def test_strided_arrays_and_lists_are_taken(cube):
    vertices, faces = cube
    expected = vertices[faces]
    wide = np.zeros((8, 6))
    wide[:, ::2] = vertices
    for v, f in ((wide[:, ::2], faces), (np.asfortranarray(vertices), np.asfortranarray(faces)), (vertices.tolist(), faces.tolist())):
        result = burnish.clean(v, f)
        assert np.array_equal(result.vertices[result.faces], expected)


def test_arguments_are_not_changed(cube):
    vertices, faces = cube
    vertices.flags.writeable = faces.flags.writeable = False
    burnish.clean(vertices, faces, recentre=True)
    assert vertices.min() == 0 and faces.max() == 7


def test_memory_does_not_grow():
    code = """
import sys; sys.path[:0] = {path!r}
import burnish, gc
from conftest import sphere
def resident():
    return int(open('/proc/self/statm').read().split()[1]) * 4096
v, f = sphere(5)
def once():
    r = burnish.clean(v, f); burnish.check(v, f); burnish.signed_distance(v, f, v[:50]); burnish.compare((v, f), r, samples=100)
    try: burnish.clean(v, f[:4], smooth='nonsense')
    except burnish.Error: pass
for _ in range(8): once()
gc.collect(); before = resident()
for _ in range(50): once()
gc.collect(); print(resident() - before, v.nbytes + f.nbytes)
"""
    out = subprocess.run([sys.executable, "-c", code.format(path=sys.path)], capture_output=True, text=True, check=True).stdout.split()
    growth, one_surface = map(int, out)
    # One surface that was kept at each call would make 50 of them.
    assert growth < 16 * one_surface


def test_volume_of_the_sphere_approaches_the_balls():
    errors = [4 / 3 * np.pi - volume(*sphere(level)) for level in (2, 3)]
    assert 3.7 < errors[0] / errors[1] < 4.3
