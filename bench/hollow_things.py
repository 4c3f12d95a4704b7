#!/usr/bin/env python3
"""Hollow things beside CoACD, each at a threshold of 0.05.

usage: hollow_things.py table LORICA FOLDER [COACD]    CSV of Lorica and CoACD's program on all meshes of a folder: hulls, the
                                                       volume of all, the largest distance from a hull to the file's surface in
                                                       percent of its longest side, CPU seconds
       hollow_things.py cuts LORICA EXAMPLES OUT.svg   pictures of cuts through hulls: Lorica's, and CoACD's own results; EXAMPLES
                                                       is the folder `examples` of CoACD's repository
"""
import csv
import json
import math
import os
import re
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

SECONDS = 300  # of CPU time, for each program and mesh


def objects_of(path):
    """Points and triangles of each object of an OBJ, STL (binary) or VRML file; points may be of several objects."""
    if path.suffix == ".stl":
        data = path.read_bytes()
        count = struct.unpack_from("<I", data, 80)[0]
        points, triangles = {}, []
        for k in range(count):
            numbers = struct.unpack_from("<9f", data, 96 + 50 * k)
            triangles.append([points.setdefault(numbers[i:i + 3], len(points)) for i in (0, 3, 6)])
        return list(points), [triangles]
    points, objects = [], []
    if path.suffix == ".wrl":
        for shape in path.read_text().split("Shape {")[1:]:
            numbers = [float(word) for word in re.search(r"point \[([^\]]*)", shape)[1].replace(",", " ").split()]
            faces = [int(word) for word in re.search(r"coordIndex \[([^\]]*)", shape)[1].replace(",", " ").split()]
            objects.append([[v + len(points) for v in faces[i:i + 3]] for i in range(0, len(faces), 4)])
            points += [tuple(numbers[i:i + 3]) for i in range(0, len(numbers), 3)]
        return points, objects
    for line in path.read_text(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["o"]:
            objects.append([])
        elif words[:1] == ["v"]:
            points.append(tuple(map(float, words[1:4])))
        elif words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) for word in words[1:]]
            corners = [v - 1 if v > 0 else v + len(points) for v in corners]
            objects = objects or [[]]
            objects[-1] += [[corners[0], *pair] for pair in zip(corners[1:], corners[2:])]
    return points, [triangles for triangles in objects if triangles]


def run(command):
    """CPU seconds; none if the program failed or took too long. What it printed."""
    before = os.times()
    done = subprocess.run(["bash", "-c", f'ulimit -t {SECONDS}; exec "$@"', "-", *command], capture_output=True, text=True)
    after = os.times()
    return (None if done.returncode else after[2] - before[2] + after[3] - before[3]), done.stdout


def table(lorica, folder, coacd=None):
    out = csv.writer(sys.stdout)
    out.writerow("object program hulls volume distance_percent cpu_seconds".split())
    with tempfile.TemporaryDirectory() as work:
        for mesh in sorted(path for path in Path(folder).iterdir() if path.suffix in (".obj", ".stl")):
            points, objects = objects_of(mesh)
            plain, hulls = Path(work, "plain.obj"), Path(work, "hulls.obj")
            number = {p: n for n, p in enumerate(dict.fromkeys(points), 1)}  # CoACD reads only OBJ, and does not weld
            faces = [[number[points[v]] for v in t] for triangles in objects for t in triangles]
            plain.write_text("".join("v %r %r %r\n" % p for p in number) + "".join("f %d %d %d\n" % (*t,) for t in faces if len(set(t)) == 3))
            programs = {"Lorica": [lorica, "decompose", mesh, "--max-concavity", "0.05", "--export-obj", hulls]}
            if coacd:
                programs["CoACD"] = [coacd, "-i", plain, "-o", hulls, "-ro", Path(work, "remeshed.obj"), "-t", "0.05", "--seed", "1"]
            for program, command in programs.items():
                hulls.unlink(missing_ok=True)
                seconds, _ = run(command)
                if seconds is None:
                    out.writerow([mesh.stem, program, "", "", "", ""])
                    continue
                _, scored = run([lorica, "score", mesh, hulls, "--json", "-"])
                own, made = objects_of(hulls)
                side = max(max(p[i] for p in points) - min(p[i] for p in points) for i in range(3))
                largest = 100 * json.loads(scored)["hullsToSurface"]["largest"] / side
                six = lambda a, b, c: sum(a[i] * (b[i - 2] * c[i - 1] - b[i - 1] * c[i - 2]) for i in range(3))
                volume = sum(abs(sum(six(*(own[v] for v in t)) for t in hull)) for hull in made) / 6
                out.writerow([mesh.stem, program, len(made), f"{volume:.4g}", f"{largest:.2f}", f"{seconds:.2f}"])
                sys.stdout.flush()


def cut_of(points, triangles, axis, at):
    """The segments of a cut through triangles by an upright plane across x (0) or z (2), Y being up."""
    segments = []
    for t in triangles:
        ends = []
        for a, b in zip(t, (*t[1:], t[0])):
            da, db = points[a][axis] - at, points[b][axis] - at
            if (da < 0) != (db < 0):
                ends.append([points[a][i] + da / (da - db) * (points[b][i] - points[a][i]) for i in (2 - axis, 1)])
        if len(ends) == 2:
            segments.append(ends)
    return segments


def cuts(lorica, examples, out):
    parts, top, width = [], 40, 300
    for name in ("Bottle", "Kettle", "KitchenPot"):
        mesh = Path(examples, f"{name}.obj")
        points, surface = objects_of(mesh)
        low, high = [min(p[i] for p in points) for i in range(3)], [max(p[i] for p in points) for i in range(3)]
        axis = min((0, 2), key=lambda i: high[i] - low[i])
        at = low[axis] + 0.503 * (high[axis] - low[axis])  # not through vertices
        scale = width / max(high[2 - axis] - low[2 - axis], high[1] - low[1])
        with tempfile.TemporaryDirectory() as work:
            hulls = Path(work, "hulls.obj")
            subprocess.run([lorica, "decompose", mesh, "--max-concavity", "0.05", "--export-obj", hulls], check=True, capture_output=True)
            sides = {"Lorica": objects_of(hulls), "CoACD": objects_of(Path(examples, f"results/{name}_out.wrl"))}
        for left, (who, (own, objects)) in zip((20, width + 60), sides.items()):
            place = lambda p: f"{left + (p[0] - low[2 - axis]) * scale:.1f},{top + (high[1] - p[1]) * scale:.1f}"
            parts.append(f'<text x="{left}" y="{top - 14}">{name}, {who}: {len(objects)} hulls</text>')
            for k, hull in enumerate(objects):
                ends = [p for segment in cut_of(own, hull, axis, at) for p in segment]
                middle = [sum(p[i] for p in ends) / max(1, len(ends)) for i in (0, 1)]
                ends.sort(key=lambda p: math.atan2(p[1] - middle[1], p[0] - middle[0]))  # a cut through a hull is convex
                if ends:
                    parts.append(f'<polygon points="{" ".join(dict.fromkeys(map(place, ends)))}" fill="hsl({k * 137 % 360},60%,65%)" '
                                 'stroke="#555" stroke-width=".4"/>')
            lines = "".join({f"M{place(min(e))}L{place(max(e))}": 0 for triangles in surface for e in cut_of(points, triangles, axis, at)})
            parts.append(f'<path d="{lines}" fill="none" stroke="#000" stroke-width=".8"/>')
        top += (high[1] - low[1]) * scale + 46
    Path(out).write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {2 * width + 80} {top - 26:.0f}" font-family="sans-serif" '
                         'font-size="13"><rect width="100%" height="100%" fill="#fff"/>' + "\n".join(parts) + "</svg>\n")


if len(sys.argv) < 4 or sys.argv[1] not in ("table", "cuts"):
    sys.exit(__doc__)
{"table": table, "cuts": cuts}[sys.argv[1]](*sys.argv[2:])
