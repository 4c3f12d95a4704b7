#!/usr/bin/env python3
"""The measures of the paper's figures for a mesh in several poses of your own (Thul et al. 2018).

    sequence_figures.py take.npz figures [--parts 12]

take.npz has `vertices` (frames, n, 3) and `faces` (m, 3). Written are figures/*.png and figures/figures.csv:

    fig3   error against the number of candidate edges, of the published algorithm and of the quality preset
    fig8   the error in each keyframe: parts made for it alone, and for all keyframes together
    fig9   the error in every frame: parts made in the first frame, and in the keyframes
    fig10  error against the number of parts, in the keyframes and in the frames that are none
"""
import argparse
import csv
from pathlib import Path

import lorica
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def unseen(parts):
    """The mean error of the frames that are no keyframes."""
    return np.mean(np.delete(parts.errors, parts.keyframes)) if len(parts.keyframes) < parts.frame_count else np.nan


def measure(vertices, faces, count):
    """A table for each figure: the name of its x axis, and rows of x and a value for each series."""
    together = lorica.decompose(vertices, faces, parts=count)
    keys = together.keyframes
    candidates = (1, 2, 4, 8, 16, 32)
    yield "fig3", "candidate edges", ("paper", "quality"), [
        (c, *(lorica.decompose(vertices, faces, parts=count, preset=preset, candidates=c).error
              for preset in ("paper", "quality")))
        for c in candidates
    ]
    alone = [lorica.decompose(vertices[k], faces, parts=count).error for k in keys]
    yield "fig8", "keyframe", ("each by itself", "all together"), [
        (k, one, together.errors[k]) for k, one in zip(keys, alone)
    ]
    first = lorica.decompose(vertices, faces, parts=count, keyframes=1)
    yield "fig9", "frame", ("made in the first frame", f"made in {len(keys)} keyframes"), list(
        zip(range(len(vertices)), first.errors, together.errors)
    )
    counts = sorted({max(1, count // 4), max(1, count // 2), count, 2 * count})
    several = [lorica.decompose(vertices, faces, parts=n) for n in counts]
    yield "fig10", "parts", ("keyframes", "unseen frames"), [
        (n, np.mean([parts.errors[k] for k in parts.keyframes]), unseen(parts)) for n, parts in zip(counts, several)
    ]


def draw(file, x_name, series, rows):
    table = np.array(rows, dtype=float)
    axes = plt.figure(figsize=(8, 4)).add_subplot()
    for i, name in enumerate(series):
        axes.plot(table[:, 0], table[:, i + 1], marker="o" if len(table) < 40 else None, label=name)
    axes.set(xlabel=x_name, ylabel="relative volume error", ylim=(0, None))
    axes.legend()
    plt.savefig(file, dpi=120, bbox_inches="tight")
    plt.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequence", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--parts", type=int, default=12)
    options = parser.parse_args()
    arrays = np.load(options.sequence)
    options.folder.mkdir(parents=True, exist_ok=True)
    with open(options.folder / "figures.csv", "w", newline="") as file:
        out = csv.writer(file)
        out.writerow(("figure", "series", "x", "error"))
        for figure, x_name, series, rows in measure(arrays["vertices"], arrays["faces"], options.parts):
            draw(options.folder / f"{figure}.png", x_name, series, rows)
            for i, name in enumerate(series):
                out.writerows((figure, name, row[0], row[i + 1]) for row in rows)
            print(f"{figure}: " + ", ".join(f"{n} {np.nanmean([r[i + 1] for r in rows]):.1%}" for i, n in enumerate(series)))


if __name__ == "__main__":
    main()
