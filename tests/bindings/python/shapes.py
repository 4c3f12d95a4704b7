"""Small meshes, and the files that tests/bindings/files.cmake made."""

import ctypes
import os
from pathlib import Path

import numpy as np

FILES = Path(os.environ["LORICA_TEST_FILES"])


class _MallocState(ctypes.Structure):
    names = "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost"
    _fields_ = [(name, ctypes.c_size_t) for name in names.split()]


def kilobytes_in_use():
    """What malloc has given out, in all threads; the process's size depends on which threads ran."""
    libc = ctypes.CDLL(None)
    libc.mallinfo2.restype = _MallocState
    state = libc.mallinfo2()
    return (state.uordblks + state.hblkhd) // 1024


def box(low=(0, 0, 0), high=(1, 1, 1)):
    """A closed box: 8 vertices, 12 triangles."""
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
    vertices = np.asarray(low) + corners * (np.asarray(high, dtype=float) - np.asarray(low))
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    faces = [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]
    return vertices, np.array(faces)


def l_shape():
    """Three unit cubes in an L: volume 3, one concave edge, so two boxes fit exactly."""
    outline = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    vertices = np.array([(x, y, z) for z in (0, 1) for x, y in outline], dtype=float)
    lid = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    faces = [(c, b, a) for a, b, c in lid] + [(a + 6, b + 6, c + 6) for a, b, c in lid]
    for a in range(6):
        b = (a + 1) % 6
        faces += [(a, b, b + 6), (a, b + 6, a + 6)]
    return vertices, np.array(faces)


def torus(major=96, minor=48):
    """A torus that takes a while: 2 x major x minor triangles."""
    u, v = np.meshgrid(np.arange(major), np.arange(minor), indexing="ij")
    a, b = 2 * np.pi * u / major, 2 * np.pi * v / minor
    ring = 1 + 0.3 * np.cos(b)
    vertices = np.stack([ring * np.cos(a), ring * np.sin(a), 0.3 * np.sin(b)], axis=-1).reshape(-1, 3)
    p, q = u * minor, (u + 1) % major * minor
    w = (v + 1) % minor
    faces = np.stack([p + v, q + v, q + w, p + v, q + w, p + w], axis=-1).reshape(-1, 3)
    return vertices, faces


def volume(vertices, faces):
    """Of a closed mesh, by the divergence theorem."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def farthest_outside(hull, points):
    """How far points stick out of a convex hull's planes."""
    a, b, c = (hull.vertices[hull.faces[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    whole = lengths[:, 0] > 1e-9  # slivers lie between others
    a, normals = a[whole], normals[whole] / lengths[whole]
    return (points @ normals.T - np.einsum("ij,ij->i", normals, a)).max(axis=1)
