"""Names that are not UTF-8, and arguments that are none."""
import os

import burnish
import numpy as np
import pytest

OBJ = b"g a\xff\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\ng b\nf 2 3 4\nf 3 1 4\n"
NAME = os.fsdecode(b"n\xff")


def refusal(function, *arguments, **options):
    with pytest.raises(burnish.UsageError) as caught:
        function(*arguments, **options)
    return str(caught.value)


def test_groups_whose_names_are_no_utf8_go_round(tmp_path):
    (tmp_path / "in.obj").write_bytes(OBJ)
    mesh = burnish.read(tmp_path / "in.obj")
    assert mesh.names == ["a\udcff", "b"] and burnish.check(mesh)
    result = burnish.clean(mesh)
    assert result.groups == mesh.groups
    burnish.write(tmp_path / "out.obj", result)
    assert b"\ng a\xff\n" in (tmp_path / "out.obj").read_bytes()
    assert burnish.read(tmp_path / "out.obj").groups == mesh.groups
    mesh.groups = [burnish.Group(b"a\xff", 0, 2), burnish.Group("b", 2, 2)]
    burnish.write(tmp_path / "bytes.obj", mesh)
    assert (tmp_path / "bytes.obj").read_bytes() == (tmp_path / "out.obj").read_bytes()
    mesh.groups = [burnish.Group("a\udcff", 1, 3)]
    assert r"'a\xff' begins at face 1" in refusal(burnish.check, mesh)


def test_files_whose_names_are_no_utf8(tmp_path, cube):
    path = os.path.join(tmp_path, NAME + ".stl")
    burnish.write(path, *cube)
    assert os.listdir(os.fsencode(tmp_path)) == [b"n\xff.stl"]
    for same in (path, os.fsencode(path), tmp_path / (NAME + ".stl")):
        assert burnish.read(same).file == path
        assert burnish.check(same) and burnish.clean(same).verified and burnish.compare(same, same, samples=100).max == 0
    with pytest.raises(burnish.UnwritableOutputError, match=r"n\\xff\.stl"):
        burnish.write(path, *cube)
    for function in (burnish.read, burnish.clean):
        with pytest.raises(burnish.UnreadableInputError, match=r"m\\xff\.stl"):
            function(os.path.join(tmp_path, os.fsdecode(b"m\xff.stl")))
    heard = []
    burnish.clean(path, progress=lambda stage, fraction: heard.append(stage))
    assert heard
    region = os.path.join(tmp_path, os.fsdecode(b"r\xff.stl"))
    with pytest.raises(burnish.UnreadableInputError, match=r"r\\xff\.stl"):
        burnish.clean(*cube, smooth=0.1, mode="volume", resolution=20, region=region)


def test_paths_that_name_no_file(tmp_path, cube):
    (tmp_path / "x").write_bytes(b"precious")
    told = refusal(burnish.read, f"{tmp_path}/x\0y.stl")
    assert told == f"the path '{tmp_path}/x\\x00y.stl': found a NUL at byte {len(str(tmp_path)) + 2} (no name of a file has one)"
    assert "NUL" in refusal(burnish.write, f"{tmp_path}/x\0y.stl", *cube, overwrite=True) and (tmp_path / "x").read_bytes() == b"precious"
    assert "NUL" in refusal(burnish.clean, *cube, smooth=0.1, region="x\0y") and "NUL" in refusal(burnish.check, b"x\0y")
    assert "position 1" in refusal(burnish.read, "x\ud800.stl")


@pytest.mark.parametrize("samples", [float("nan"), float("inf"), -1, 0, 0.5, True, "many", None, 1e9])
def test_numbers_of_samples_that_are_none(cube, samples):
    assert refusal(burnish.compare, cube, cube, samples=samples) == f"samples {samples}: expected a whole number from 1 to 20000000"


@pytest.mark.parametrize("options, words", [
    ({"threads": float("nan")}, "threads nan: expected a whole number from 1 to 4096"), ({"threads": "two"}, "threads two: expected a whole number"),
    ({"time_limit": float("nan")}, "time_limit nan: expected seconds above 0"), ({"time_limit": "long"}, "time_limit long: expected seconds")])
def test_limits_that_are_none(cube, options, words):
    assert refusal(burnish.check, *cube, **options).startswith(words)


@pytest.mark.parametrize("group, words", [
    (("a", 0), "groups: group 1: expected a name, the first face and the number of faces, found ('a', 0) (burnish.Group(name, first, count))"),
    (("a", 0, 1, 2), "groups: group 1: expected a name"), (("a", "0", 12), "groups: group 1: expected a name"), (("a", 0.5, 12), "groups: group 1: expected a name"),
    (("a", 0, 2**70), "groups: group 1: expected a name"), (7, "groups: group 1: expected a name"), ((7, 0, 12), "groups: group 1: expected a name, found 7"),
    (("\ud800", 0, 12), "groups: group 1 '\\ud800': the character at position 0")])
def test_groups_that_are_none(cube, group, words):
    mesh = burnish.Mesh(*cube, groups=[burnish.Group("first", 0, 12), group])
    assert refusal(burnish.check, mesh).startswith(words)


def test_groups_may_count_with_numpys_numbers(cube):
    assert burnish.check(burnish.Mesh(*cube, groups=[("all", np.int64(0), np.uint32(12))]))
