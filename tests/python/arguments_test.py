"""Arguments that mean nothing are refused with words that say where, what, and the way out."""
import burnish
import numpy as np
import pytest
from conftest import sphere


def refusal(*arguments, function=burnish.clean, **options):
    with pytest.raises(burnish.UsageError) as caught:
        function(*arguments, **options)
    assert isinstance(caught.value, ValueError) and caught.value.code == "usage"
    return str(caught.value)


@pytest.mark.parametrize("function", [burnish.clean, burnish.check])
def test_arrays(cube, function):
    v, f = cube
    told = lambda *arrays: refusal(*arrays, function=function)  # noqa: E731
    assert told(v[:, :2], f) == "vertices: expected the shape (n, 3), found (8, 2) (one row per point or triangle)"
    assert told(v.ravel(), f) == "vertices: expected the shape (n, 3), found (24,) (one row per point or triangle)"
    assert told(v, np.hstack([f, f])).startswith("faces: expected the shape (n, 3), found (12, 6)")
    assert told(v.astype(int), f) == "vertices: expected float32 or float64, found int64 (astype(float) converts)"
    assert told(v.astype(complex), f).startswith("vertices: expected float32 or float64, found complex128")
    assert told(v.astype(">f8"), f).startswith("vertices: expected float32 or float64, found >f8")
    assert told(v, f.astype(float)) == "faces: expected int32, int64, uint32 or uint64, found float64 (faces.astype('uint32') converts)"
    assert told(v, f[:0]) == "faces: no rows (there is nothing to work on)"
    bad = f.copy()
    bad[7, 1] = 8
    assert told(v, bad) == "faces: row 7 has the index 8, and there are 8 vertices (indices count from 0)"
    bad[7, 1] = -1
    assert told(v, bad).startswith("faces: row 7 has the index -1")
    for worst in (np.nan, np.inf):
        ill = v.copy()
        ill[3, 2] = worst
        assert told(ill, f).startswith(f"vertices: row 3 is not finite: (1, 1, {worst})")
    assert told(3, None) == "a int is no surface (give vertices and faces, a Mesh, or a path)"
    assert "expected rows of three numbers" in told([["a", "b", "c"]], f)


def test_points_and_colours(cube):
    ill = np.zeros((4, 3))
    ill[2, 0] = np.nan
    assert refusal(*cube, ill, function=burnish.signed_distance).startswith("points: row 2 is not finite")
    mesh = burnish.Mesh(*cube, colors=np.zeros((3, 4), dtype=np.uint8))
    assert refusal(mesh) == "colors: expected one row per face, 12, found 3"
    mesh = burnish.Mesh(*cube, groups=[burnish.Group("a", 0, 5), burnish.Group("b", 6, 6)])
    assert refusal(mesh).startswith("groups: 'b' begins at face 6 and has 6; expected a run that begins at 5, of 12 faces")


@pytest.mark.parametrize("options, words", [
    ({"smooth": "0,5"}, "smooth 0,5"), ({"smooth": -1}, "smooth -1"), ({"smooth": float("nan")}, "smooth nan"), ({"cell": "2h"}, "cell 2h"),
    ({"mode": "featur"}, "mode featur"), ({"resolution": 3}, "resolution 3"), ({"resolution": 30.5}, "resolution 30.5"), ({"keep_openings": 1}, "keep_openings 1: expected True or False"),
    ({"cell": True}, "cell True: expected a value"), ({"cell": 1, "resolution": 30}, "exclude each other"), ({"memory": "much"}, "memory much"),
    ({"iso": 3}, "options of volumes"), ({"threads": 0}, "threads 0"), ({"time_limit": 0}, "time_limit 0"), ({"progress": 3}, "progress")])
def test_options(cube, options, words):
    assert words in refusal(*cube, **options)


def test_unknown_options(cube):
    with pytest.raises(TypeError, match="clean.. got an unexpected keyword argument 'smoth'; did you mean 'smooth'?"):
        burnish.clean(*cube, smoth=1)


def test_numbers_of_numpy_and_none_are_values(cube):
    a = burnish.clean(*cube, resolution=np.int64(20), smooth=None, crease=np.float64(35), keep_largest=np.bool_(True))
    b = burnish.clean(*cube, resolution=20, crease="35", keep_largest=True)
    assert a.vertices.tobytes() == b.vertices.tobytes() and a.report["options"] == b.report["options"]


def test_false_means_the_opposite_where_there_is_one():
    v, f = sphere(3)
    results = {w: burnish.clean(v, f, smooth="20%", mode="mcf", resolution=32, **o).report["after"]["volume"]
               for w, o in {"kept": {}, "true": {"keep_volume": True}, "false": {"keep_volume": False}, "free": {"free_volume": True}, "not free": {"free_volume": False}}.items()}
    assert results["kept"] == results["true"] == results["not free"] and results["false"] == results["free"] < 0.95 * results["kept"]


def test_what_has_no_effect_is_told(cube):
    assert burnish.clean(*cube, deviation=0.1).warnings[0] == "--deviation has no effect without --smooth"


def test_missing_and_broken_files(tmp_path):
    for function in (burnish.read, burnish.check, burnish.clean):
        with pytest.raises(burnish.UnreadableInputError) as caught:
            function(tmp_path / "none.stl")
        assert isinstance(caught.value, OSError) and "none.stl" in str(caught.value) and caught.value.code == "unreadable_input"
    (tmp_path / "cut.stl").write_bytes(b"\0" * 80 + (2).to_bytes(4, "little") + np.arange(12, dtype="<f4").tobytes() + b"\0\0")
    with pytest.raises(burnish.UnreadableInputError):
        burnish.read(tmp_path / "cut.stl")
    mesh = burnish.read(tmp_path / "cut.stl", salvage=True)
    assert len(mesh.faces) == 1 and mesh.warnings


def test_unknown_suffixes(tmp_path, cube):
    assert ".xyz" in refusal(tmp_path / "a.xyz", *cube, function=burnish.write)


def test_limits(cube):
    with pytest.raises(burnish.MemoryLimitError) as caught:
        burnish.clean(*cube, resolution=100000, memory="10M", method="levelset")
    assert isinstance(caught.value, MemoryError)
    with pytest.raises(burnish.TimeLimitError) as caught:
        burnish.clean(*sphere(4), resolution=400, smooth="2%", mode="volume", time_limit=0.05)
    assert isinstance(caught.value, TimeoutError)
