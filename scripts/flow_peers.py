"""Flow meshes of one model by several programs, with the same cell, each judged by the same means (scripts/run_peers cfd).

h is a part of the model's longest side, the domain the model's inside, or a box around it with a margin as wide as that
side (Burnish's own choice). Every program gets the file as it is, holes and all. What the programs are told:

burnish         `burnish mesh FILE --inside|--outside --cell h`: the smallest cells are h where the surface turns, 2 h
                where it is flat (--flat-levels 1), up to 16 h away from it (--coarsest 4), 2 rows of each size (--rows 2)

snappyHexMesh   blockMesh: cubes of COARSEST h about the domain, laid so that no plane of the model's box is one of theirs;
                surfaceFeatureExtract: edges at an included angle of 150 degrees, open and non-manifold ones;
                snappyHexMesh: castellated and snapped to these edges (explicitFeatureSnap), no layers; cells of h
                everywhere at the surface and its edges, 2 rows of each size (nCellsBetweenLevels 2); all else, and the
                limits of quality, from OpenFOAM's caseDicts/mesh/generation (minVol 1e-6 h^3, as it depends on units).
                locationInMesh is a corner of the domain or the roomiest of the middles of chords of the repaired solid:
                snappyHexMesh is told where inside is, by Burnish

gmsh            surfaces classified at edges of 40 degrees (its tutorial 13; with 30 it fails on rocker-arm) in patches that can be parametrised, geometry created from
                them, triangles and tetrahedra with edges of h, without a limit of the size from curvature; outside, COARSEST h
                at the box's corners and extended from the boundary. gmshToFoam makes a case of it, and is not counted

CPU seconds and peak memory are those of whole programs with reading and writing, those of Burnish with repair, its own
checks and its measurement of distances. checkMesh gives cells, angles, volumes and the verdict; foamToSurface the patches
without those of the box, and `burnish compare` distances from the file's surface to them.
"""
import array
import dataclasses
import fnmatch
import json
import math
import os
import re
import resource
import shutil
import subprocess
import threading
from pathlib import Path

# Model, side of the domain, cells along the longest side.
CASES = [("fandisk", "inside", 64), ("rocker-arm", "inside", 160), ("rocker-arm", "outside", 54), ("igea", "inside", 100),
         ("stanford-bunny", "inside", 80), ("stanford-bunny", "outside", 54), ("beetle-alt", "inside", 80),
         ("teapot", "inside", 80), ("cgal_turbine", "inside", 100), ("ofdev_flange", "inside", 100)]
LEVELS = 4  # from the background's cells to the surface's
COARSEST = 2 ** LEVELS  # in h
FEATURE_ANGLE = 30  # between the normals at an edge, in degrees; for snappyHexMesh
CLASSIFY_ANGLE = 40  # the same for gmsh, as in its tutorial 13; with 30 it fails on rocker-arm
LEAKS = 0.02  # of the reference volume
FINEST = 2 ** 1.5  # h^3: cells nearer to h than to 2 h
HEXAHEDRON = 3  # among OpenFOAM's cell models, as checkMesh numbers them
DOMAIN = {"domain", "xMin", "xMax", "yMin", "yMax", "zMin", "zMax"}
ENVIRONMENT = {"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ}

CHECKS = {"cells": r"^\s+cells:\s+(\d+)", "regions": r"Number of regions: (\d+)", "skewness": r"Max skewness = ([\d.e+-]+)",
          "non_orthogonality": r"non-orthogonality Max: ([\d.e+-]+)",
          "mean_non_orthogonality": r"non-orthogonality Max: \S+ average: ([\d.e+-]+)",
          "mesh_volume": r"Total volume = ([\d.e+-]+?)\. "}


@dataclasses.dataclass
class Problem:
    """What is to be meshed. Points are lists of three."""
    name: str
    file: Path
    side: str
    cell: float
    lower: list  # of the model's box
    upper: list
    volume: float = None  # of the solid, for reference
    inside: list = None  # a point

    def domain(self):
        """Corners of the box around the model, or of the model's own."""
        margin = max(u - l for l, u in zip(self.lower, self.upper)) if self.side == "outside" else 0
        return [l - margin for l in self.lower], [u + margin for u in self.upper]


# --- the model -------------------------------------------------------------------------------------------

def burnish_json(*command):
    """What a run of Burnish prints with --json. Its exit code may be 1, for what it found."""
    done = subprocess.run([str(part) for part in command] + ["--json"], text=True, capture_output=True)
    if done.returncode not in (0, 1) or not done.stdout:
        raise RuntimeError((done.stderr.strip() or f"exit code {done.returncode}").splitlines()[-1])
    return json.loads(done.stdout)


def problem_of(program, name, file, side, along, volume, folder):
    """The problem of a model; its volume, if not known, and a point inside are taken from what Burnish repairs."""
    box = burnish_json(program, "check", file)["defects"]["box"]
    lower, upper = box["lower"], box["upper"]
    cell = max(u - l for l, u in zip(lower, upper)) / along
    problem = Problem(name, file, side, cell, lower, upper, volume)
    repaired = folder / "repaired.stl"
    try:
        burnish_json(program, file, "-o", repaired, "--overwrite")
    except RuntimeError:  # what is not known has no column, and snappyHexMesh says that it has no point
        return problem
    problem.volume = volume or burnish_json(program, "check", repaired)["defects"]["volume"]
    problem.inside = point_inside(facets_of(repaired))
    return problem


def facets_of(path):
    """Facets of a binary STL, each nine numbers."""
    data = path.read_bytes()
    count = int.from_bytes(data[80:84], "little")
    return [array.array("f", data[at + 12:at + 48]) for at in range(84, 84 + 50 * count, 50)]


def crossings(facets, rays):
    """Where rays along x through the middles of a grid of rays x rays over the facets' box cross facets: {(j, k): [x]}."""
    ends = [(min(min(f[a], f[a + 3], f[a + 6]) for f in facets), max(max(f[a], f[a + 3], f[a + 6]) for f in facets))
            for a in (1, 2)]
    steps = [(high - low) / rays or 1 for low, high in ends]

    def span(axis, facet):
        values = [(facet[axis + 1 + 3 * corner] - ends[axis][0]) / steps[axis] - 0.5 for corner in range(3)]
        return range(max(0, math.ceil(min(values))), min(rays - 1, math.floor(max(values))) + 1)

    found = {}
    for facet in facets:
        for j in span(0, facet):
            for k in span(1, facet):
                x = crossing(facet, ends[0][0] + (j + 0.5) * steps[0], ends[1][0] + (k + 0.5) * steps[1])
                if x is not None:
                    found.setdefault((j, k), []).append(x)
    return {key: (ends[0][0] + (key[0] + 0.5) * steps[0], ends[1][0] + (key[1] + 0.5) * steps[1], sorted(xs))
            for key, xs in found.items()}


def crossing(facet, y, z):
    """x where the line along x through (y, z) crosses a facet, or None."""
    weights = []
    for i in range(3):
        a, b = facet[3 * ((i + 1) % 3):][:3], facet[3 * ((i + 2) % 3):][:3]
        weights.append((a[1] - y) * (b[2] - z) - (a[2] - z) * (b[1] - y))
    if not (all(w > 0 for w in weights) or all(w < 0 for w in weights)):
        return None
    return sum(weights[i] * facet[3 * i] for i in range(3)) / sum(weights)


def point_inside(facets, rays=15, tried=40):
    """The one with the most room among the middles of the longest chords of a closed surface: room to its corners."""
    chords = []
    for y, z, xs in crossings(facets, rays).values():
        if len(xs) % 2 == 0:
            chords += [(b - a, [(a + b) / 2, y, z]) for a, b in zip(xs[::2], xs[1::2])]
    if not chords:
        return None

    def room(chord):
        return min(chord[0] / 2, min(math.dist(chord[1], facet[:3]) for facet in facets))

    return max(sorted(chords, reverse=True)[:tried], key=room)[1]


# --- the programs: each writes its input into a folder, and says what is to be run there --------------------

def burnish_steps(program, problem, folder):
    case = folder / "case"
    return [(True, [program, "mesh", problem.file, f"--{problem.side}", "--cell", f"{problem.cell:.9g}", "-o", case])]


def foam_file(folder, name, text, kind="dictionary"):
    path = folder / "case" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"FoamFile\n{{ version 2.0; format ascii; class {kind}; object {path.name}; }}\n{text}\n", encoding="utf-8")


def foam_case(folder):
    """A case without a mesh."""
    foam_file(folder, "system/controlDict", "application simpleFoam; startFrom startTime; startTime 0; stopAt endTime; endTime 1;"
              "\ndeltaT 1; writeControl timeStep; writeInterval 1; writeFormat binary; writePrecision 15; writeCompression off;")
    foam_file(folder, "system/fvSchemes", "divSchemes {} gradSchemes {} laplacianSchemes {}")
    foam_file(folder, "system/fvSolution", "")
    (folder / "case" / "0").mkdir()


def vector(values):
    return "(" + " ".join(f"{value:.12g}" for value in values) + ")"


def block_mesh(problem):
    """blockMesh's dictionary and the lower corner: cubes of COARSEST h, at least half of one around the domain."""
    size = COARSEST * problem.cell
    lower, upper = problem.domain()
    room = 0.5 if problem.side == "inside" else 0
    lower = [l - (room + 0.137 + 0.01 * axis) * size for axis, l in enumerate(lower)]
    counts = [math.ceil((u - l) / size + room) for l, u in zip(lower, upper)]
    corners = [[lower[axis] + (size * counts[axis] if corner[axis] else 0) for axis in range(3)]
               for corner in ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))]
    faces = "(0 4 7 3) (1 2 6 5) (0 1 5 4) (3 7 6 2) (0 3 2 1) (4 5 6 7)"
    return (f"scale 1;\nvertices ({' '.join(map(vector, corners))});\n"
            f"blocks (hex (0 1 2 3 4 5 6 7) ({' '.join(map(str, counts))}) simpleGrading (1 1 1));\n"
            f"boundary (domain {{ type patch; faces ({faces}); }});"), lower


SNAPPY = """#includeEtc "caseDicts/mesh/generation/snappyHexMeshDict.cfg"
addLayers off;
geometry {{ model.stl {{ type triSurfaceMesh; name model; }} }}
castellatedMeshControls
{{
    maxLocalCells 20000000;
    nCellsBetweenLevels 2;
    features ({{ file "model.eMesh"; level {level}; }});
    refinementSurfaces {{ model {{ level ({level} {level}); patchInfo {{ type wall; }} }} }}
    refinementRegions {{}}
    locationInMesh {point};
}}
snapControls {{ explicitFeatureSnap true; implicitFeatureSnap false; }}
addLayersControls
{{
    layers {{}}
    relativeSizes true;
    expansionRatio 1.2;
    finalLayerThickness 0.5;
    minThickness 0.001;
}}
"""


def snappy_steps(problem, folder):
    foam_case(folder)
    block, corner = block_mesh(problem)
    point = problem.inside if problem.side == "inside" else [c + 0.3217 * COARSEST * problem.cell for c in corner]
    if point is None:
        raise RuntimeError("no point inside was found")
    (folder / "case/constant/triSurface").mkdir(parents=True)
    shutil.copy(problem.file, folder / "case/constant/triSurface/model.stl")
    foam_file(folder, "system/blockMeshDict", block)
    foam_file(folder, "system/surfaceFeatureExtractDict", "model.stl { extractionMethod extractFromSurface; "
              f"includedAngle {180 - FEATURE_ANGLE}; subsetFeatures {{ nonManifoldEdges yes; openEdges yes; }} }}")
    foam_file(folder, "system/meshQualityDict", '#includeEtc "caseDicts/mesh/generation/meshQualityDict.cfg"\n'
              f"minVol {1e-6 * problem.cell ** 3:.6g};")
    foam_file(folder, "system/snappyHexMeshDict", SNAPPY.format(level=LEVELS, point=vector(point)))
    return [(True, ["blockMesh", "-case", "case"]), (True, ["surfaceFeatureExtract", "-case", "case"]),
            (True, ["snappyHexMesh", "-overwrite", "-case", "case"])]


GMSH = """Merge "{file}";
ClassifySurfaces{{{angle} * Pi / 180, 1, 1, Pi}};
CreateGeometry;
s() = Surface{{:}};
Physical Surface("surface") = s();
Surface Loop(1) = s();
Mesh.MeshSizeFromCurvature = 0;
Mesh.MeshSizeMin = {cell:.12g};
Mesh.MeshSizeMax = {coarsest:.12g};
"""


def gmsh_script(problem):
    outside = problem.side == "outside"
    text = GMSH.format(file=problem.file.resolve(), angle=CLASSIFY_ANGLE, cell=problem.cell,
                       coarsest=problem.cell * (COARSEST if outside else 1))
    if not outside:
        return text + 'Volume(1) = {1};\nPhysical Volume("fluid") = {1};\n'
    lower, upper = problem.domain()
    text += (f'Field[1] = MathEval; Field[1].F = "{problem.cell:.12g}";\n'
             "Field[2] = Restrict; Field[2].InField = 1; Field[2].FacesList = {s()}; Field[2].EdgesList = {Curve{:}};\n"
             "Background Field = 2;\np = newp; l = newl; f = news;\n")
    for i in range(8):
        at = [(upper if i >> axis & 1 else lower)[axis] for axis in range(3)]
        text += f"Point(p + {i}) = {{{', '.join(f'{x:.12g}' for x in at)}, {problem.cell * COARSEST:.12g}}};\n"
    edges = [(i, i | 1 << axis) for axis in range(3) for i in range(8) if not i >> axis & 1]
    text += "".join(f"Line(l + {n}) = {{p + {a}, p + {b}}};\n" for n, (a, b) in enumerate(edges))
    for n, corners in enumerate(((0, 2, 6, 4), (1, 3, 7, 5), (0, 1, 5, 4), (2, 3, 7, 6), (0, 1, 3, 2), (4, 5, 7, 6))):
        sides = [(a, b) for a, b in zip(corners, corners[1:] + corners[:1])]
        loop = ", ".join(f"l + {edges.index((a, b))}" if (a, b) in edges else f"-(l + {edges.index((b, a))})" for a, b in sides)
        text += f"Curve Loop(1000000 + {n}) = {{{loop}}}; Plane Surface(f + {n}) = {{1000000 + {n}}};\n"
    return text + ('Physical Surface("domain") = {f : f + 5};\nSurface Loop(2) = {f : f + 5};\nVolume(1) = {2, 1};\n'
                   'Physical Volume("fluid") = {1};\n')


def gmsh_steps(problem, folder):
    foam_case(folder)
    (folder / "model.geo").write_text(gmsh_script(problem), encoding="utf-8")
    return [(True, ["gmsh", "-3", "model.geo", "-format", "msh2", "-o", "mesh.msh"]),
            (False, ["gmshToFoam", "-case", "case", "mesh.msh"])]


PEERS = {"snappyHexMesh": (snappy_steps, ("blockMesh", "surfaceFeatureExtract", "snappyHexMesh")),
         "gmsh": (gmsh_steps, ("gmsh", "gmshToFoam"))}


def peers_here():
    """Of each peer whether all its programs are installed."""
    return {name: all(shutil.which(needed) for needed in programs) for name, (_, programs) in PEERS.items()}


# --- running and judging -----------------------------------------------------------------------------------

def reason(log):
    """Why a program stopped, in its own words."""
    foam = re.search(r"FOAM FATAL (?:IO )?ERROR\s*:?\s*\n(.*)", log)
    errors = [line for line in log.splitlines() if line.startswith(("Error", "burnish:"))]
    text = foam[1] if foam else errors[0].split(":", 1)[1] if errors else (log.strip() or "no word").splitlines()[-1]
    return re.sub(r"\s+", " ", text).strip()[:160]


def step(command, folder, limit):
    """Runs a program: its CPU seconds, wall seconds and peak memory, and "error" if it failed or ran out of time."""
    path = folder / (Path(command[0]).name + ".log")
    with open(path, "w+", encoding="utf-8", errors="replace") as log:
        process = subprocess.Popen([str(part) for part in command], cwd=folder, stdout=log, stderr=subprocess.STDOUT,
                                   env=ENVIRONMENT, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)))
        timer = threading.Timer(4 * limit, process.kill)  # wall seconds, on a busy machine
        begun = os.times().elapsed
        timer.start()
        try:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = code = os.waitstatus_to_exitcode(status)
        finally:
            timer.cancel()
            process.kill()  # if this script has been told to end; nothing where the program has
    line = {"cpu_seconds": usage.ru_utime + usage.ru_stime, "wall_seconds": os.times().elapsed - begun,
            "peak_mb": usage.ru_maxrss * 1024 / 1e6}
    name = Path(command[0]).name
    if line["cpu_seconds"] > limit - 1 or line["wall_seconds"] >= 4 * limit:
        line["error"] = f"{name}: stopped after {limit} CPU s"
    elif code != 0:
        line["error"] = f"{name}: {'exit code' if code > 0 else 'signal'} {abs(code)}: {reason(path.read_text(errors='replace'))}"
    return line


def run(steps, folder, limit):
    """The steps one after the other: seconds add up, of those that count; the memory is the largest."""
    total = {"cpu_seconds": 0.0, "wall_seconds": 0.0, "peak_mb": 0.0}
    for counted, command in steps:
        line = step(command, folder, limit)
        if counted:
            total = {"cpu_seconds": total["cpu_seconds"] + line["cpu_seconds"],
                     "wall_seconds": total["wall_seconds"] + line["wall_seconds"],
                     "peak_mb": max(total["peak_mb"], line["peak_mb"])}
        if "error" in line:
            return {**total, "error": line["error"]}
    return total


def checked(log):
    """What checkMesh says. Its exit status is no verdict."""
    found = {name: re.search(pattern, log + " ", re.MULTILINE) for name, pattern in CHECKS.items()}
    return {**{name: float(match[1]) for name, match in found.items() if match}, "passes": "Mesh OK" in log,
            "fails": [text.strip() for text in re.findall(r"^ \*{2,}(.*)$", log, re.MULTILINE)]}


def field_of(path):
    """Values of a uniform or nonuniform scalar field's inside, as OpenFOAM writes it, binary or not."""
    data = path.read_bytes()
    head = re.search(rb"internalField\s+(?:uniform\s+([^;\s]+)|nonuniform\s+List<scalar>\s+(\d+)\s*\()", data)
    if head[1]:
        return [float(head[1])]
    count, body = int(head[2]), data[head.end():]
    if re.search(rb"format\s+binary", data[:2000]):
        return array.array("d", body[:8 * count])
    return [float(text) for text in body[:body.index(b")")].split()]


def shares(volumes, shapes, cell):
    """Of the cells those nearer to h than to 2 h, and of the volume that of hexahedra. Fields of one value are uniform."""
    if len(shapes) == 1:
        shapes = list(shapes) * len(volumes)
    if len(volumes) == 1:
        volumes = list(volumes) * len(shapes)
    whole = math.fsum(volumes)
    return {"finest": sum(v < FINEST * cell ** 3 for v in volumes) / len(volumes),
            "hexahedra": math.fsum(v for v, s in zip(volumes, shapes) if round(s) == HEXAHEDRON) / whole if whole else None}


def without_domain(lines):
    """Of an ASCII STL the solids that are no side of the domain's box."""
    keep = True
    for line in lines:
        if line.startswith("solid"):
            keep = line.split()[1:2] == [] or line.split()[1] not in DOMAIN
        if keep:
            yield line


def enclosed(path):
    """Volume that the facets of an ASCII STL enclose, negative where they look inwards."""
    with open(path, encoding="utf-8") as file:
        points = [[float(text) for text in line.split()[1:4]] for line in file if line.split()[:1] == ["vertex"]]
    origin = points[0] if points else None
    points = [[x - o for x, o in zip(point, origin)] for point in points]
    return math.fsum(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2])
                     + a[2] * (b[0] * c[1] - b[1] * c[0])
                     for a, b, c in zip(points[0::3], points[1::3], points[2::3])) / 6


def judged(program, problem, folder):
    """What checkMesh and Burnish's comparison say about the mesh in a folder's case."""
    case = ["-case", "case"]
    log = subprocess.run(["checkMesh", *case, "-allTopology", "-allGeometry", "-writeFields", "(cellVolume cellShapes)"],
                         cwd=folder, text=True, errors="replace", capture_output=True, env=ENVIRONMENT).stdout
    line = checked(log)
    if "mesh_volume" not in line:
        return {"error": f"checkMesh: {reason(log)}"}
    fields = [folder / "case/0" / name for name in ("cellVolume", "cellShapes")]
    if all(path.exists() for path in fields):
        line |= shares(*map(field_of, fields), problem.cell)
    solid = line["mesh_volume"] if problem.side == "inside" else None
    subprocess.run(["foamToSurface", *case, "all.stl"], cwd=folder, capture_output=True, env=ENVIRONMENT)
    if (folder / "all.stl").exists():
        with open(folder / "all.stl", encoding="utf-8") as patches, open(folder / "patch.stl", "w", encoding="utf-8") as out:
            out.writelines(without_domain(patches))
        if problem.side == "outside":
            solid = abs(enclosed(folder / "patch.stl"))
        try:
            far = burnish_json(program, "compare", problem.file, folder / "patch.stl")["a_to_b"]["distance"]
            line |= {"distance_max": far["max"] / problem.cell, "distance_rms": far["rms"] / problem.cell}
        except (RuntimeError, KeyError):
            pass  # no such column in the row
    line["volume_error"] = solid / problem.volume - 1 if solid is not None and problem.volume else None
    return line


# --- the table ---------------------------------------------------------------------------------------------

def number(value, form="{:.3g}"):
    return "" if value is None else form.format(value)


def volume_text(line):
    error = line.get("volume_error")
    if error is None:
        return ""
    text = f"{1 + error:.3g} times" if error > 0.5 else f"{100 * error:+.2f} %"
    return f"**{text}**" if abs(error) > LEAKS else text


def row(line):
    start = [line["case"], line["program"]]
    if "error" in line:
        return start + [f"**none**: {line['error']}", "", "", number(line.get("cpu_seconds")),
                        number(line.get("peak_mb"), "{:.0f}")] + [""] * 7
    verdict = "Mesh OK" if line["passes"] else "**fails**: " + "; ".join(line["fails"])
    per_second = line["cells"] / line["cpu_seconds"] if line["cpu_seconds"] else None
    far = f"{number(line.get('distance_max'), '{:.2f}')} / {number(line.get('distance_rms'), '{:.3f}')}"
    return start + [number(line.get("cells"), "{:,.0f}"), number(line.get("finest"), "{:.0%}"),
                    number(line.get("hexahedra"), "{:.0%}"), number(line["cpu_seconds"]), number(line["peak_mb"], "{:.0f}"),
                    number(per_second, "{:,.0f}"),
                    f"{number(line.get('non_orthogonality'))} / {number(line.get('mean_non_orthogonality'))}",
                    number(line.get("skewness")), number(line.get("regions"), "{:.0f}"), volume_text(line),
                    far if "distance_max" in line else "", verdict]


def table(lines):
    """A table in Markdown, one row per case and program, those of a case together."""
    cases = {case: n for n, case in enumerate(dict.fromkeys(line["case"] for line in lines))}
    programs = ["burnish", *PEERS]
    lines = sorted(lines, key=lambda line: (cases[line["case"]], programs.index(line["program"])))
    rows = [["model", "program", "cells", "of them finest", "hexahedra, of the volume", "CPU s", "peak MB", "cells per CPU s",
             "non-orthogonality, max / mean", "skewness", "regions", "volume", "distance, max / rms, h", "checkMesh, all"]]
    rows += [row(line) for line in lines]
    rows.insert(1, ["---"] * len(rows[0]))
    return "\n".join("| " + " | ".join(each) + " |" for each in rows)


# --- a case --------------------------------------------------------------------------------------------------

def cases(data, patterns):
    """(model, file, side, cells along) of those cases whose models are there, and match."""
    for model, side, along in CASES:
        file = next(iter(sorted(data.glob(f"*/{model}.stl"))), None)
        if file and any(fnmatch.fnmatch(text, pattern) for pattern in patterns for text in (model, f"{model} {side}")):
            yield model, file, side, along


def measure(problem, name, program, folder, limit):
    """One run of a program on a problem in an empty folder: what it cost, and "error" if it made no mesh."""
    try:
        steps = burnish_steps(program, problem, folder) if name == "burnish" else PEERS[name][0](problem, folder)
    except RuntimeError as error:
        return {"error": str(error)}
    return run(steps, folder, limit)
