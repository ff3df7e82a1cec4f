"""Shapes that several tests take."""
import os
from pathlib import Path

import numpy as np
import pytest

CUBE_VERTICES = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
CUBE_FACES = np.array([[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]])


@pytest.fixture
def cube():
    """The unit cube: vertices, faces."""
    return CUBE_VERTICES.copy(), CUBE_FACES.copy()


def sphere(level, radius=1.0):
    """An octahedron, each face cut into four `level` times, on the sphere: vertices, faces."""
    vertices = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    for _ in range(level):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                m = np.add(vertices[a], vertices[b])
                middles[key] = len(vertices)
                vertices.append(tuple(m / np.linalg.norm(m)))
            return middles[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return radius * np.array(vertices, dtype=float), np.array(faces, dtype=np.uint32)


def volume(vertices, faces):
    """By the divergence theorem."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


@pytest.fixture
def program():
    """The command line's program."""
    return os.environ["BURNISH_PROGRAM"]


@pytest.fixture
def source():
    """The root of the sources."""
    return Path(__file__).resolve().parents[2]
