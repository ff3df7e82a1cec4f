"""Small models, and just enough STL and OBJ to look into what the program wrote."""
import struct

CUBE_CORNERS = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
CUBE_FACETS = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
               (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]


def cube(facets=CUBE_FACETS, offset=(0, 0, 0)):
    """The unit cube as triangles, oriented outwards."""
    return [tuple(tuple(c + o for c, o in zip(CUBE_CORNERS[i], offset)) for i in f) for f in facets]


def scattered(count):
    """Triangles apart from each other, each smaller than the one before."""
    return [tuple((x / (i + 1) + 3 * i, y / (i + 1), 0) for x, y in ((0, 0), (1, 0), (0, 1))) for i in range(count)]


def binary_stl(triangles, header=b"test"):
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *(c for p in t for c in p), 0) for t in triangles)
    return header.ljust(80, b"\0") + struct.pack("<I", len(triangles)) + body


def ascii_stl(triangles):
    lines = ["solid test"]
    for t in triangles:
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {p[0]!r} {p[1]!r} {p[2]!r}" for p in t),
                  "endloop", "endfacet"]
    return "\n".join(lines + ["endsolid test", ""]).encode()


def read_binary_stl(data):
    """The triangles of a binary STL, each as nine float32 coordinates."""
    (count,) = struct.unpack_from("<I", data, 80)
    assert len(data) == 84 + 50 * count, f"{len(data)} bytes for {count} facets"
    return [struct.unpack_from("<9f", data, 84 + 50 * i + 12) for i in range(count)]


def scaled(triangles, factor):
    """Triangles of nine coordinates, times `factor`."""
    return [tuple(c * factor for c in t) for t in triangles]


def as_points(triangles):
    return [(t[0:3], t[3:6], t[6:9]) for t in triangles]


def read_obj(data):
    """Vertices and facets (as they stand) of an OBJ."""
    vertices, facets = [], []
    for line in data.decode().splitlines():
        if line.startswith("v "):
            vertices.append(tuple(float(x) for x in line.split()[1:4]))
        elif line.startswith("f "):
            facets.append(line)
    return vertices, facets


def write_obj(triangles):
    lines = [f"v {p[0]!r} {p[1]!r} {p[2]!r}" for t in triangles for p in t]
    lines += [f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}" for i in range(len(triangles))]
    return ("\n".join(lines) + "\n").encode()


def fixtures():
    """The files every case finds in its folder."""
    solid = binary_stl(cube())
    return {
        "cube.stl": solid,
        "cube.ascii.stl": ascii_stl(cube()),
        "moved.stl": binary_stl(cube(offset=(0.125, 0, 0))),
        "cut.stl": solid[:-20],                        # the last facet is not all there
        "hole.stl": binary_stl(cube(CUBE_FACETS[1:])),
        "flipped.stl": binary_stl(cube(CUBE_FACETS[1:] + [CUBE_FACETS[0][::-1]])),
        "inside_out.stl": binary_stl(cube([f[::-1] for f in CUBE_FACETS])),
        "twice.stl": binary_stl(cube() + cube()[:1]),
        "crossing.stl": binary_stl(cube() + cube(offset=(0.5, 0.5, 0.5))),
        "triangle.stl": binary_stl(cube()[:1]),
        "crossed.stl": binary_stl([((0, 0, 0), (2, 0, 0), (0, 2, 0)), ((0.5, 0.5, -1), (0.5, 0.5, 1), (1, 0.2, 1))]),
        "scattered.stl": binary_stl(scattered(60)),
        "empty.stl": b"",
        "text.stl": b"this is not a mesh\n",
        "other.stl": b"do not touch\n",
        "other.ply": b"do not touch\n",
    }
