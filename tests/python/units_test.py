"""Units: what a 3MF says of its coordinates stays with them, and lengths may have one."""
import re
import zipfile

import burnish
import numpy as np
import pytest
from conftest import sphere

UNITS = {"mm": "millimeter", "cm": "centimeter", "m": "meter", "in": "inch", "um": "micron", "ft": "foot"}


def unit_in(path):
    """What a 3MF's own XML says."""
    with zipfile.ZipFile(path) as archive:
        text = archive.read("3D/3dmodel.model").decode()
    return re.search(r'<model[^>]* unit="(\w+)"', text)[1]


@pytest.fixture
def threemf(tmp_path, cube):
    """threemf(unit): a cube of side 1 in that unit, as a file."""
    def make(unit):
        path = tmp_path / f"cube_{unit}.3mf"
        burnish.write(path, *cube, unit=unit)
        return path

    try:
        make("mm").unlink()
    except burnish.UsageError:
        pytest.skip("built without lib3mf")
    return make


@pytest.mark.parametrize("unit", UNITS)
def test_a_3mf_keeps_its_unit(tmp_path, threemf, unit):
    path = threemf(unit)
    assert unit_in(path) == UNITS[unit]
    mesh = burnish.read(path)
    assert mesh.unit == unit and mesh.vertices.max() == 1
    result = burnish.clean(mesh)
    assert result.unit == result.report["units"] == burnish.clean(path).unit == unit
    for thing in (mesh, result):
        burnish.write(tmp_path / "again.3mf", thing, overwrite=True)
        assert unit_in(tmp_path / "again.3mf") == UNITS[unit] and burnish.read(tmp_path / "again.3mf").vertices.max() == 1


def test_the_unit_that_is_told_goes_before_the_meshs(tmp_path, threemf):
    mesh = burnish.read(threemf("in"))
    burnish.write(tmp_path / "told.3mf", mesh, unit="cm")
    assert unit_in(tmp_path / "told.3mf") == "centimeter"
    result = burnish.clean(mesh, units="mm")
    assert result.unit == "mm" and burnish.clean(mesh, units="in").warnings == []
    assert result.warnings == ["the mesh says that its unit is in, units says mm: the latter was believed, and no coordinate is changed"] == result.report["warnings"]
    assert np.array_equal(result.vertices, burnish.clean(mesh).vertices)


def test_without_a_unit_there_is_none(tmp_path, cube):
    burnish.write(tmp_path / "cube.stl", *cube)
    mesh = burnish.read(tmp_path / "cube.stl")
    assert mesh.unit is None and burnish.clean(mesh).unit is None and burnish.clean(*cube).unit is None


def test_a_unit_that_is_none_is_refused(tmp_path, cube):
    for call in (lambda: burnish.write(tmp_path / "a.stl", *cube, unit="furlong"), lambda: burnish.check(burnish.Mesh(*cube, unit="furlong")),
                 lambda: burnish.clean(burnish.Mesh(*cube, unit="furlong"))):
        with pytest.raises(burnish.UsageError) as caught:
            call()
        assert str(caught.value) == "unit 'furlong': expected 'mm', 'cm', 'm', 'in', 'um' or 'ft', or None"
    assert not (tmp_path / "a.stl").exists()


def test_lengths_may_have_a_unit_where_the_models_is_known():
    def smooth_of(surface, **options):
        return burnish.clean(surface, mode="volume", resolution=24, **options).report["options"]["smooth"]

    ball, in_inches = burnish.Mesh(*sphere(3)), burnish.Mesh(*sphere(3), unit="in")
    assert smooth_of(ball, smooth=0.05) == 0.05
    # Wherever `units` stands.
    assert smooth_of(ball, units="mm", smooth="0.05mm") == smooth_of(ball, smooth="0.05mm", units="mm") == 0.05
    assert smooth_of(ball, units="cm", smooth="0.5mm") == pytest.approx(0.05, rel=1e-15)
    assert smooth_of(ball, units="in", smooth="2.54mm") == smooth_of(in_inches, smooth="2.54mm") == pytest.approx(0.1, rel=1e-15)
    with pytest.raises(burnish.UsageError, match="smooth 0.05mm"):
        smooth_of(ball, smooth="0.05mm")
    with pytest.raises(burnish.UsageError, match="units yard"):
        smooth_of(ball, units="yard")


def test_comparisons_tell_the_unit_and_that_there_are_two(cube):
    inches, feet = burnish.Mesh(*cube, unit="in"), burnish.Mesh(*cube, unit="ft")
    found = burnish.compare(inches, feet, samples=100)
    assert found.report["units"] == "in" and found.max == 0
    assert found.report["b"]["warnings"] == ["its unit is ft, that of A is in: coordinates are compared as they are"]
    assert burnish.compare(inches, inches, samples=100).report["b"]["warnings"] == []
