#!/usr/bin/env python3
"""The field's table: usage: concavity_table.py [--turned N] LORICA FOLDER [PRESET | WHO=COMMAND]...

Decomposes each mesh of a folder at --max-concavity 0.05 and prints a CSV: parts, CoACD's concavity of the worst part and of
the mean part, the same as `lorica score` measures it for anybody's hulls, CPU seconds of the whole command, and the hash
of the result. The last rows are means, and the median of the seconds. A mesh that is refused has the sentence instead.

WHO=COMMAND is another program, which writes hulls as OBJ: {mesh}, {out} and {parts}, as many as the first preset made, are
put in. With --turned each mesh (.off, .obj) is turned N times, seeded, at the same limit in its own unit: the fewest and the
most parts, and how far apart the concavities lie. The exit status is 1 if one that is taken as it lies is refused in a rotation.
"""
import csv
import json
import os
import shlex
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path


def run(command):
    """The output of a command, its CPU seconds, and the sentence if it failed."""
    before = os.times()
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    after = os.times()
    said = (done.stderr.strip().splitlines() or [f"exit status {done.returncode}"])[-1] if done.returncode else ""
    return done.stdout, after[2] - before[2] + after[3] - before[3], said


def decompose(mesh, preset, *more, limit=0.05):
    text, seconds, said = run([lorica, "decompose", mesh, "--preset", preset, "--max-concavity", limit, "--json", "-", *more])
    return json.loads(text) if not said else None, seconds, said


def scored(mesh, hulls):
    text, _, said = run([lorica, "score", mesh, hulls, "--json", "-"])
    return ["", ""] if said else [json.loads(text)[name] for name in ("concavity", "meanConcavity")]


def made_by(who, mesh, parts, hulls):
    """Parts, the two concavities, seconds, hash, and the concavities that are measured; or a sentence."""
    name, other, command = who.partition("=")
    if not other:
        of, seconds, said = decompose(mesh, name, "--export-obj", hulls, "--force")
        return said or [of["parts"], of["concavity"], of["meanConcavity"], seconds, of["hash"], *scored(mesh, hulls)]
    _, seconds, said = run(word.format(mesh=mesh, out=hulls, parts=parts) for word in shlex.split(command))
    if said or not hulls.exists():
        return said or "made nothing"
    count = sum(line.startswith(("o ", "g ")) for line in hulls.read_text().splitlines())
    return [count, "", "", seconds, "", *scored(mesh, hulls)]


def turned(mesh, preset, count, file):
    """The fewest and the most parts of the turned mesh, and how far apart its concavities lie; or what refused it."""
    import numpy as np
    words = [line.split("#")[0].split() for line in mesh.read_text().splitlines()]
    if mesh.suffix == ".obj":
        places = [line[1:4] for line in words if line[:1] == ["v"]]
        number = lambda word: int(word.split("/")[0])
        faces = [[number(word) - 1 if number(word) > 0 else len(places) + number(word) for word in line[1:]]
                 for line in words if line[:1] == ["f"]]
    else:
        words = [line for line in words if line and line != ["OFF"]]
        vertices, triangles = map(int, words[0][-3:-1] if words[0][0] == "OFF" else words[0][:2])
        places = [line[:3] for line in words[1:vertices + 1]]
        faces = [list(map(int, line[1:int(line[0]) + 1])) for line in words[vertices + 1:vertices + triangles + 1]]
    places = np.array(places, float)
    side = lambda points: np.ptp(points, axis=0).max()  # what CoACD divides by, which is another one for a turned mesh
    random, results = np.random.default_rng(1), []
    for _ in range(count):
        turn, triangle = np.linalg.qr(random.normal(size=(3, 3)))
        turn = turn * np.sign(np.diag(triangle))
        turn[:, 0] *= np.linalg.det(turn)
        moved = places @ turn.T
        rows = [" ".join(map(repr, row)) for row in moved.tolist()]
        shapes = [" ".join(map(str, [len(face), *face])) for face in faces]
        file.write_text("\n".join(["OFF", f"{len(places)} {len(faces)} 0", *rows, *shapes]) + "\n")
        share = side(moved) / side(places)
        of, _, said = decompose(file, preset, limit=0.05 / share)
        if said:
            return f"turned: {said}" if not decompose(mesh, preset)[2] else said
        results.append((of["parts"], of["concavity"] * share))
    parts, concavity = zip(*results)
    return [min(parts), max(parts), max(concavity) - min(concavity)]


def shown(row):
    return [f"{value:.4f}" if isinstance(value, float) else value for value in row]


turns = int(sys.argv[2]) if sys.argv[1:2] == ["--turned"] else 0
arguments = sys.argv[3:] if turns else sys.argv[1:]
if len(arguments) < 2:
    sys.exit(__doc__)
lorica, folder, *everyone = arguments
out = csv.writer(sys.stdout, lineterminator="\n")
out.writerow(("mesh preset fewest_parts most_parts spread" if turns else
              "mesh preset parts concavity mean_concavity cpu_seconds hash scored scored_mean").split())
parts, refused = {}, 0
for who in everyone or ["fast"]:
    rows, name = [], who.partition("=")[0]
    for mesh in sorted(Path(folder).iterdir(), key=lambda path: path.name.lower()):
        if mesh.suffix not in (".off", ".obj", ".stl", ".ply"):
            continue
        with tempfile.TemporaryDirectory() as work:
            row = (turned(mesh, who, turns, Path(work) / "turned.off") if turns else
                   made_by(who, mesh, parts.get(mesh, ""), Path(work) / "hulls.obj"))
        if isinstance(row, str):
            refused += row.startswith("turned: ")
            out.writerow([mesh.stem, name, row])
            continue
        parts.setdefault(mesh, row[0])
        rows.append(row)
        out.writerow([mesh.stem, name, *shown(row)])
        sys.stdout.flush()
    if rows:
        of = [[value for value in column if value != ""] for column in zip(*rows)]
        means = [statistics.median(column) if index == 3 else statistics.fmean(column)
                 if column and not isinstance(column[0], str) else "" for index, column in enumerate(of)]
        out.writerow([f"mean of {len(rows)}", name, *shown(means)])
sys.exit(1 if refused else 0)
