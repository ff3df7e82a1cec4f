"""Burnish: gives back a closed, oriented, intersection-free surface for a dirty one.

    import burnish

    mesh = burnish.read("dirty.stl")
    print(burnish.check(mesh))
    result = burnish.clean(mesh, smooth="auto")
    burnish.write("clean.ply", result)

Surfaces are NumPy arrays: vertices (n, 3) in the model's units, faces (m, 3) counter-clockwise seen from outside. Wherever `vertices, faces` are taken, a
single argument can stand for both: a Mesh, a CleanResult, a tuple (vertices, faces), any object with `vertices` and `faces`, and, where something is only
read, a path. Arrays of float32 or float64 and of int32, int64, uint32 or uint64 are taken; they are never changed. Arrays that come back are float64 and
uint32; they lie on the library's memory, without a copy, and are yours.

Functions let other threads of Python run while they work, use all processors unless told otherwise, and give the same bits for any number of threads.
Ctrl-C stops them with KeyboardInterrupt. All errors are burnish.Error; see the classes.
"""
import json as _json

import numpy as _np

from . import _burnish
from ._burnish import __version__
from ._arguments import path_of as _path_of, positive as _positive, whole as _whole
from ._errors import BugError, Error, GuaranteeError, MemoryLimitError, TimeLimitError, UnreadableInputError, UnwritableOutputError, UsageError, error_of as _error_of
from ._options import text_of as _text_of, texts_of as _texts_of, with_options as _with_options
from ._surfaces import (Check, CleanResult, Comparison, Group, Mesh, arrays_of as _arrays_of, as_array as _as_array, is_path as _is_path, read,
                        surface_of as _surface_of, write)

__all__ = ["BugError", "Check", "CleanResult", "Comparison", "Error", "Group", "GuaranteeError", "MemoryLimitError", "Mesh", "TimeLimitError",
           "UnreadableInputError", "UnwritableOutputError", "UsageError", "__version__", "check", "clean", "compare", "read", "signed_distance", "write"]


def _settings(threads, progress, time_limit):
    if progress is not None and not callable(progress):
        raise UsageError(f"progress: expected something to call, found {type(progress).__name__}", "progress=lambda stage, fraction: ...")
    return (None if threads is None else _whole(threads, "threads", 1, 4096), progress, None if time_limit is None else _positive(time_limit, "time_limit", "seconds"))


def check(vertices, faces=None, *, salvage=False, thickness=False, min_thickness=None, threads=None, progress=None, time_limit=None):
    """Says what is wrong with a surface and where, and whether it is a valid solid.

    Args:
        vertices: (n, 3) float32 or float64; or a Mesh or a path, and then no `faces`.
        faces: (m, 3) int32, int64, uint32 or uint64.
        salvage: of a path: take what a broken file holds.
        thickness: also measure how thick a valid solid is.
        min_thickness: also list where it is thinner than this length, as in `clean`; implies `thickness`.
        threads, progress, time_limit: as in `clean`.

    Returns:
        Check: true where the surface is a valid solid that is nowhere thinner than `min_thickness`, if that is given. Vertices at bitwise equal
        coordinates count as one.

    Raises:
        UsageError: the arrays are no surface; the message names array, row, expected and found.
        UnreadableInputError: of a path.
    """
    surface, warnings = _surface_of(vertices, faces, salvage)
    limit = None if min_thickness is None else _text_of(min_thickness, "min_thickness")
    if isinstance(limit, bool):
        raise UsageError(f"min_thickness {limit}: expected a length")
    found = _json.loads(_burnish.check(surface, bool(thickness), limit, _settings(threads, progress, time_limit))["json"])
    return Check(found["defects"]["valid_solid"], found["defects"], found["locations"], found["locations_total"], warnings + found["warnings"], found["thickness"])


@_with_options
def clean(vertices, faces=None, *, float32=False, salvage=False, allow_invalid=False, threads=None, progress=None, time_limit=None, **options):
    """Repairs a surface, and smooths it if asked to: the result is closed, oriented, free of self-intersections, and verified.

    The arrays that come back are what `burnish IN -o OUT.ply` would write, bit for bit, and what was verified.

    Args:
        vertices: (n, 3) float32 or float64, in the model's units; or a Mesh or a path, and then no `faces`. A path may name a volume (.vti, .nrrd).
        faces: (m, 3) int32, int64, uint32 or uint64.
        float32: round the result to what an STL stores before it is verified; do so if you are going to write one.
        salvage: of a path: take what a broken file holds.
        allow_invalid: return a result that could not be verified, with its `failure`, instead of raising.
        threads: at most so many. The result does not depend on it.
        progress: called as progress(stage, fraction) about ten times a second; what it raises stops the run.
        time_limit: in seconds.
        options: those of the command line, with underscores for hyphens. Values are read by the same rules: lengths are numbers in the model's units
            (0.5), or texts in percent of the box' diagonal ("0.2%"), in cells ("2h"), or, where `units` or the Mesh says what the model is in, in a
            unit ("0.2mm"); a switch is True. None: not given. These are:

    @OPTIONS@

    Returns:
        CleanResult: vertices, faces and the report.

    Raises:
        GuaranteeError: the result could not be verified, or the input bounds no solid. Its `result` holds the report.
        UsageError: an argument means nothing, or options exclude each other.
        UnreadableInputError, MemoryLimitError, TimeLimitError, KeyboardInterrupt.

    Example:
        >>> result = burnish.clean(vertices, faces, smooth="0.5%", mode="volume", resolution=200)
        >>> result.report["after"]["volume"]
    """
    source = _path_of(vertices) if faces is None and _is_path(vertices) else _arrays_of(vertices, faces)
    found = _burnish.clean(source, _texts_of(options), salvage, float32, _settings(threads, progress, time_limit))
    failure = _error_of(*found["failure"]) if found["failure"] else None
    result = CleanResult(found["vertices"], found["faces"], [Group(*g) for g in found["groups"]], found["colors"], _json.loads(found["json"]), found["warnings"], failure)
    if failure is not None:
        failure.result = result
        if not allow_invalid:
            raise failure
    return result


def compare(a, b, *, samples=200_000, exact=False, vertices=False, align=False, threads=None, progress=None, time_limit=None):
    """Says how far two surfaces are from each other, both ways, and where.

    Args:
        a, b: each a Mesh, a CleanResult, a path, or a tuple (vertices, faces).
        samples: taken of each by area, and as many vertices at most.
        exact: take every distance by exact arithmetic: about 15 times slower.
        vertices: also give the signed distance of each vertex, as arrays in the order of the vertices given.
        align: first move `a` onto `b`, rigidly, from any position; everything is then told of it at its new place.
        threads, progress, time_limit: as in `clean`.

    Returns:
        Comparison: distances in the model's units. The same numbers as `burnish compare`.

    Raises:
        UsageError, UnreadableInputError: as `check` does.
    """
    samples = _whole(samples, "samples", 1, 20_000_000)
    settings = _settings(threads, progress, time_limit)
    (first, _), (second, _) = _surface_of(a), _surface_of(b)
    found = _json.loads(_burnish.compare(first, second, samples, exact, bool(align), settings)["json"])
    alignment = found["alignment"]
    if vertices and alignment:
        first = (first[0] @ _np.array(alignment["rotation"]).T + alignment["translation"], *first[1:])
    of_a = _burnish.signed_distance(second, first[0], exact, settings) if vertices else None
    of_b = _burnish.signed_distance(first, second[0], exact, settings) if vertices else None
    a_to_b, b_to_a = found["a_to_b"], found["b_to_a"]
    return Comparison(a_to_b, b_to_a, max(a_to_b["distance"]["max"], b_to_a["distance"]["max"]), found["diagonal"], of_a, of_b, found, alignment)


def signed_distance(vertices, faces, points=None, *, exact=True, threads=None, progress=None, time_limit=None):
    """The distance of points from a surface, negative inside.

    Inside is where the winding number is not zero, of closed surfaces; of open ones, what is behind the closest face.

    Args:
        vertices, faces: the surface, as for `clean`; or a Mesh or a path in place of both: signed_distance(mesh, points).
        points: (k, 3) float32 or float64.
        exact: by exact arithmetic, off by one rounding (about 30 us a point); without, by a few roundings of the coordinates and about 15 times faster.
        threads, progress, time_limit: as in `clean`.

    Returns:
        ndarray: (k,) float64, in the model's units.

    Raises:
        UsageError, UnreadableInputError: as `check` does.
    """
    if points is None:
        faces, points = None, faces
    surface, _ = _surface_of(vertices, faces)
    return _burnish.signed_distance(surface, _as_array(points, float), exact, _settings(threads, progress, time_limit))
