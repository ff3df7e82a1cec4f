"""What goes in and comes out: surfaces, and the results about them."""
import operator
import os
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Optional

import numpy as np

from . import _burnish
from ._arguments import name_of, path_of
from ._errors import Error, UsageError


class Group(NamedTuple):
    """A named run of faces: a solid of an STL, a group of an OBJ or PLY. Bytes of a name that are no UTF-8 are surrogates, as os.fsdecode makes them."""

    name: str
    first: int
    count: int


@dataclass(eq=False)
class Mesh:
    """A triangle surface as a file holds it, which promises nothing about it.

    Attributes:
        vertices: (n, 3) float64, in the model's units.
        faces: (m, 3) uint32, rows of `vertices`, counter-clockwise seen from outside.
        groups: named runs of faces that together hold all, or none.
        colors: (m, 4) uint8, red, green, blue and alpha of each face; None if there are none.
        file: where it was read from, or "".
        format: such as "binary STL", or "".
        warnings: what the reader tolerated, one sentence each.
        unit: what coordinates are in: "mm", "cm", "m", "in", "um" or "ft"; None if nobody says so. Of files, a 3MF does.
    """

    vertices: np.ndarray
    faces: np.ndarray
    groups: list = field(default_factory=list)
    colors: Optional[np.ndarray] = None
    file: str = ""
    format: str = ""
    warnings: list = field(default_factory=list)
    unit: Optional[str] = None

    @property
    def names(self):
        """The names of the groups, in order."""
        return [group.name for group in self.groups]

    def __repr__(self):
        return f"<burnish.Mesh: {len(self.vertices)} vertices, {len(self.faces)} faces{', ' + self.file if self.file else ''}>"


@dataclass(eq=False)
class Check:
    """What is wrong with a surface, and where.

    Attributes:
        valid_solid: closed, 2-manifold, oriented outwards, free of self-intersections.
        defects: counts by name, such as defects["open_edges"], with volume, area, mean_edge and box; self_intersecting_pairs is exact.
        locations: one dict for each place: kind, position, box, count, length, area, facet. By kind, the largest first, up to 1000 of each kind.
        locations_total: how many there are of each kind.
        warnings: of the reader, if a file was checked, and why there is no thickness.
        thickness: where it was asked for, of a valid solid: a dict (docs/report.md) with minimum, thinnest_at, mean, percentiles, limit, thin_area and places; else None.
    """

    valid_solid: bool
    defects: dict
    locations: list
    locations_total: dict
    warnings: list
    thickness: Optional[dict] = None

    @property
    def too_thin(self):
        """Whether it is thinner somewhere than `min_thickness`."""
        return self.thickness is not None and self.thickness["thin_area"] > 0

    def __bool__(self):
        """Whether the surface is a valid solid that is not too thin."""
        return self.valid_solid and not self.too_thin

    def __repr__(self):
        wrong = ", ".join(f"{count} {kind}" for kind, count in self.locations_total.items() if count)
        return f"<burnish.Check: {'a valid solid, too thin' if self.too_thin else 'a valid solid' if self.valid_solid else wrong or 'no valid solid'}>"


@dataclass(eq=False)
class CleanResult:
    """A cleaned surface, and what was found and done.

    Attributes:
        vertices: (n, 3) float64, in the model's units.
        faces: (m, 3) uint32, counter-clockwise seen from outside.
        groups, colors: of the input, carried over, as in Mesh.
        report: what `burnish --report` writes, as a dict (docs/report.md).
        warnings: what to know about it, one sentence each.
        failure: the GuaranteeError of a result that is not verified; None if all is well.
    """

    vertices: np.ndarray
    faces: np.ndarray
    groups: list
    colors: Optional[np.ndarray]
    report: dict
    warnings: list
    failure: Optional[Error]

    @property
    def unit(self):
        """What coordinates are in, such as "mm": as `units` said, or else as the input does; None if neither did."""
        return self.report["units"]

    @property
    def verified(self):
        """Whether these arrays were found to be a valid solid (a valid sheet, where openings were to stay)."""
        return self.report["output"]["verified"] and self.failure is None

    def __repr__(self):
        return f"<burnish.CleanResult: {len(self.faces)} faces, {'verified' if self.verified else 'not verified'}, method {self.report['method']}>"


@dataclass(eq=False)
class Comparison:
    """How far two surfaces are from each other.

    Attributes:
        a_to_b, b_to_a: dicts of the distances from samples of the one to the other: distance (max, mean, rms, percentiles, samples), angle (the same,
            between normals, in degrees), and the farthest sample with the point opposite.
        max: the largest distance of both: a lower bound of the Hausdorff distance.
        diagonal: of the box of `a`.
        vertices_a: (n,) float64, distance of each vertex of `a` from `b`, positive outside; None unless asked for. vertices_b: likewise, from `a`.
        report: what `burnish compare --json` prints, as a dict.
        alignment: how `a` was moved, if that was asked for: a dict with rotation (rows) and translation, such that a point p went to rotation @ p + translation,
            angle_degrees, rms_before, rms_after, kept, converged and more (docs/cli.md); else None.
    """

    a_to_b: dict
    b_to_a: dict
    max: float
    diagonal: float
    vertices_a: Optional[np.ndarray]
    vertices_b: Optional[np.ndarray]
    report: dict
    alignment: Optional[dict] = None

    def __repr__(self):
        return f"<burnish.Comparison: max {self.max:.6g}, mean {self.a_to_b['distance']['mean']:.6g} and {self.b_to_a['distance']['mean']:.6g}>"


def is_path(value):
    """Whether it names a file."""
    return isinstance(value, (str, bytes, os.PathLike))


def read(path, salvage=False, weld=True):
    """Reads an STL, OBJ, PLY, OFF or 3MF file.

    Args:
        path: the file, a str, bytes or an os.PathLike; its format is found from its content.
        salvage: take what a truncated or malformed file holds, with warnings, instead of refusing it.
        weld: let faces that meet at bitwise equal coordinates share vertices, in the order of their first use. Without, an STL has three
            vertices of its own per face, and other files those that they list.

    Returns:
        Mesh: coordinates are exact; stored normals are not looked at. Of a 3MF, `unit` is the file's, and coordinates are as it has them.

    Raises:
        UnreadableInputError: names file, place, what was expected and what was found.
        UsageError: the path has a NUL in it.
    """
    path = path_of(path)
    found = _burnish.read(path, salvage, weld)
    return Mesh(found["vertices"], found["faces"], [Group(*g) for g in found["groups"]], found["colors"], os.fsdecode(path), found["format"], found["warnings"],
                found["unit"])


def write(path, vertices, faces=None, overwrite=False, unit=None):
    """Writes a surface: .stl (binary), .stla (ASCII), .ply (binary, double precision), .obj, .off or .3mf.

    Args:
        path: the file; it appears under its name only once it is complete.
        vertices: (n, 3) float32 or float64; or a Mesh, a CleanResult, or whatever has `vertices` and `faces`, and then no `faces`.
        faces: (m, 3) int32, int64, uint32 or uint64.
        overwrite: an existing file may be replaced.
        unit: what a .3mf says that coordinates are in: "mm", "cm", "m", "in", "um" or "ft". None: that of the Mesh or CleanResult, or else "mm".
            Other formats have none. No coordinate is changed.

    Raises:
        UnwritableOutputError: the file exists, or cannot be written.
        UsageError: the suffix or the unit is unknown, or an array is no surface.
    """
    surface = arrays_of(vertices, faces)
    _burnish.write(path_of(path), surface if unit is None else surface[:4] + (unit,), overwrite)


def arrays_of(vertices, faces):
    """(vertices, faces, groups, colors, unit) of what stands for a surface."""
    if faces is not None:
        return as_array(vertices, float), as_array(faces, np.int64), (), None, None
    if isinstance(vertices, tuple) and len(vertices) == 2:
        return arrays_of(*vertices)
    if hasattr(vertices, "vertices") and hasattr(vertices, "faces"):
        arrays = as_array(vertices.vertices, float), as_array(vertices.faces, np.int64)
        return arrays + ((groups_of(vertices.groups), vertices.colors, vertices.unit) if isinstance(vertices, (Mesh, CleanResult)) else ((), None, None))
    raise UsageError(f"a {type(vertices).__name__} is no surface", "give vertices and faces, a Mesh, or a path")


def groups_of(groups):
    """As (bytes, int, int)."""
    return [group_of(group, f"groups: group {i}") for i, group in enumerate(groups)]


def group_of(group, what):
    """One of them."""
    try:
        name, first, count = group
        return name_of(name, what), run_of(first), run_of(count)
    except UsageError:
        raise
    except (TypeError, ValueError):
        raise UsageError(f"{what}: expected a name, the first face and the number of faces, found {group!r}", "burnish.Group(name, first, count)") from None


def run_of(number):
    """An index of a face, or how many there are."""
    number = operator.index(number)
    if abs(number) >= 2**63:
        raise ValueError(number)
    return number


def surface_of(vertices, faces=None, salvage=False):
    """The same of a path, too, with the reader's warnings behind it."""
    if faces is None and is_path(vertices):
        mesh = read(vertices, salvage)
        return arrays_of(mesh, None), mesh.warnings
    return arrays_of(vertices, faces), []


def as_array(given, kind):
    """Lists become arrays; arrays (of subclasses, too) stay what they are."""
    if isinstance(given, np.ndarray):
        return np.asarray(given)
    try:
        return np.asarray(given, dtype=kind)
    except (TypeError, ValueError) as error:
        raise UsageError(f"expected rows of three numbers: {error}") from None
