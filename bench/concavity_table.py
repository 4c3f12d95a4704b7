#!/usr/bin/env python3
"""The field's table: usage: concavity_table.py LORICA FOLDER [PRESET...]

Decomposes each mesh of a folder at --max-concavity 0.05 and prints a CSV: parts, CoACD's concavity of the worst part and of
the mean part, CPU seconds of the whole command, and the hash of the result. The last rows are means, and the median of
the seconds. A mesh that is refused has the sentence instead.
"""
import csv
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

if len(sys.argv) < 3:
    sys.exit(__doc__)
lorica, folder, *presets = sys.argv[1:]
out = csv.writer(sys.stdout)
out.writerow("mesh preset parts concavity mean_concavity cpu_seconds hash".split())
for preset in presets or ["fast"]:
    rows = []
    for mesh in sorted(Path(folder).iterdir(), key=lambda path: path.name.lower()):
        if mesh.suffix not in (".off", ".obj", ".stl", ".ply"):
            continue
        before = os.times()
        command = [lorica, "decompose", mesh, "--preset", preset, "--max-concavity", "0.05", "--json", "-"]
        done = subprocess.run(command, capture_output=True, text=True)
        after = os.times()
        if done.returncode:
            out.writerow([mesh.stem, preset, done.stderr.strip().splitlines()[-1]])
            continue
        of = json.loads(done.stdout)
        seconds = after[2] - before[2] + after[3] - before[3]
        rows.append([of["parts"], of["concavity"], of["meanConcavity"], seconds])
        numbers = [f"{x:.4f}" for x in rows[-1][1:3]]
        out.writerow([mesh.stem, preset, of["parts"], *numbers, f"{seconds:.2f}", of["hash"]])
        sys.stdout.flush()
    if rows:
        parts, worst, mean, seconds = zip(*rows)
        means = [f"{statistics.fmean(x):.4f}" for x in (worst, mean)]
        median = f"{statistics.median(seconds):.2f}"
        out.writerow([f"mean of {len(rows)}", preset, f"{statistics.fmean(parts):.1f}", *means, median])
