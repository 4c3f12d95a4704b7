#!/usr/bin/env python3
"""Draws docs/BENCHMARKS.md, its charts and the tables of other pages from the CSV files in docs/benchmarks, which
scripts/benchmarks writes.

usage: charts.py [FOLDER]                     FOLDER stands for docs/, for a test that compares
       charts.py --compare A B NAME...        the same programs' CSV of two commits, in folders A and B
"""
import csv
import math
import re
import statistics
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2] / "docs"
COLORS = {"Lorica": "#1f5fa8", "quality": "#1f5fa8", "fast": "#5f9fdc", "paper": "#9a9a9a", "": "#d9822b"}


def rows_of(path):
    """Dicts of a CSV's rows, and what its comments say of version, machine and command."""
    lines = path.read_text().splitlines()
    about = dict(line[2:].split(": ", 1) for line in lines if re.match(r"# (version|machine|command|table): ", line))
    lines = [line for line in lines if line and not line.startswith("#")]
    return list(csv.DictReader(line for i, line in enumerate(lines) if i == 0 or line != lines[0])), about  # runs repeat it


def color_of(who):
    return next((color for name, color in COLORS.items() if name and name in who), COLORS[""])


def text(x, y, words, anchor="start", size=12, color="#222"):
    words = str(words).replace("&", "&amp;").replace("<", "&lt;")
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{color}" text-anchor="{anchor}">{words}</text>'


def svg(width, height, title, parts):
    return "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif">',
                      f'<rect width="{width}" height="{height}" fill="#fff"/>', text(12, 22, title, size=15), *parts,
                      "</svg>\n"])


def shown(value):
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def ticks(low, high, log):
    if log:
        return [10.0**e for e in range(math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9) + 1)]
    step = 10 ** math.floor(math.log10(high - low))
    step = next(step * s for s in (0.1, 0.2, 0.5, 1, 2) if (high - low) / (step * s) <= 8)
    return [step * n for n in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def axis(low, high, left, right, log):
    at = math.log10 if log else float
    return lambda value: left + (at(value) - at(low)) / (at(high) - at(low)) * (right - left)


def bars(title, unit, groups, log=False, dots=False, low=None):
    """Groups of (label, [(who, value), ...]): a bar for each value, or with `dots` all of a group on one line."""
    values = [value for _, group in groups for _, value in group]
    if low is None:
        low = 10 ** math.floor(math.log10(min(values))) if log else 0
    high = 10 ** math.ceil(math.log10(max(values))) if log else max(values) * 1.05
    x = axis(low, high, 250, 690, log)
    parts, y = [], 44
    whos = list(dict.fromkeys(who for _, group in groups for who, _ in group))
    if dots:
        place = 250
        for who in whos:
            parts += [f'<circle cx="{place}" cy="{y - 4}" r="5" fill="{color_of(who)}"/>', text(place + 10, y, who)]
            place += 40 + 7 * len(who)
        y += 22
    top = y - 12
    for label, group in groups:
        if dots:
            parts.append(text(240, y, label, "end"))
            parts += [f'<circle cx="{x(value):.1f}" cy="{y - 4}" r="5" fill="{color_of(who)}" fill-opacity=".85"/>'
                      for who, value in group]
            y += 20
            continue
        if label:
            parts.append(text(12, y, label, color="#555"))
            y += 20
        for who, value in group:
            parts += [text(240, y, who, "end"), text(x(value) + 6, y, f"{shown(value)} {unit}"),
                      f'<rect x="250" y="{y - 11}" width="{max(1, x(value) - 250):.1f}" height="14" fill="{color_of(who)}"/>']
            y += 20
        y += 8
    grid = [part for value in ticks(low, high, log) for part in
            (f'<path d="M{x(value):.1f} {top}V{y - 6}" stroke="#ddd"/>', text(x(value), y + 10, shown(value), "middle", 11, "#777"))]
    return svg(790, y + 24, title, grid + parts)


def lines(title, x_name, y_name, series):
    """Series of (who, [(x, y), ...]) on two logarithmic axes."""
    points = [point for _, line in series for point in line]
    low = [10 ** math.floor(math.log10(min(p[i] for p in points))) for i in (0, 1)]
    high = [10 ** math.ceil(math.log10(max(p[i] for p in points)) + 1e-9) for i in (0, 1)]
    x, y = axis(low[0], high[0], 80, 620, True), axis(low[1], high[1], 340, 50, True)
    parts = []
    for value in ticks(low[0], high[0], True):
        parts += [f'<path d="M{x(value):.1f} 50V340" stroke="#ddd"/>', text(x(value), 358, shown(value), "middle", 11, "#777")]
    for value in ticks(low[1], high[1], True):
        parts += [f'<path d="M80 {y(value):.1f}H620" stroke="#ddd"/>', text(74, y(value) + 4, shown(value), "end", 11, "#777")]
    parts += [text(350, 380, x_name, "middle"), text(80, 42, y_name)]
    palette = ["#1f5fa8", "#d9822b", "#3a8f4d", "#9a4fa0"]
    places = []  # of names, one below the other where lines end together
    for (who, line), color in zip(series, palette):
        path = " ".join(f"{x(a):.1f},{y(b):.1f}" for a, b in line)
        parts.append(f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="2.5"/>')
        end, place = x(line[-1][0]) + 6, y(line[-1][1]) + 4
        while any(abs(place - y_of) < 13 and abs(end - x_of) < 60 for x_of, y_of in places):
            place += 13
        places.append((end, place))
        parts.append(text(end, place, who, color=color))
    return svg(790, 394, title, parts)


class Page:
    """Collects sections of Markdown with their charts, and in which rows another is better."""

    def __init__(self, folder):
        self.folder, self.parts, self.worse = folder, [], []
        version = lambda path: [int(n) for n in path.name.split(".")]
        self.version = max((path for path in (folder / "benchmarks").iterdir() if path.is_dir()), key=version)
        self.reported = rows_of(folder / "benchmarks/others.csv")[0]

    def read(self, name):
        path = self.version / f"{name}.csv"
        return rows_of(path) if path.exists() else ([], {})

    def section(self, title, words, about, **charts):
        self.parts += [f"## {title}", "", textwrap.fill(words, 118, break_long_words=False, break_on_hyphens=False), ""]
        for name, drawn in charts.items():
            (self.folder / f"pictures/bench_{name}.svg").write_text(drawn)
            self.parts += [f"![{title}](pictures/bench_{name}.svg)", ""]
        if about:
            self.parts += [f"`{about['command']}`; {about['machine']}.", ""]

    def said(self, name, pattern):
        """What the comments of a CSV say: the groups of each match."""
        return re.findall("^# " + pattern, (self.version / f"{name}.csv").read_text(), re.M)

    def table(self, name, after, head, rows):
        """Puts a table in place of the one that follows these words in a document."""
        lines = ["| " + " | ".join(row) + " |" for row in (head, *rows)]
        lines = [re.sub(r"\|  (?=\|)", "| ", re.sub(r"\|  (?=\|)", "| ", line)) for line in lines]
        lines.insert(1, "|" + "---|" * len(head))
        text = (self.folder / name).read_text()
        start = text.index("\n\n| ", text.index(after)) + 2
        (self.folder / name).write_text(text[:start] + "\n".join(lines) + text[(text + "\n").index("\n\n", start):])

    def compare(self, what, unit, ours, who, theirs, more_is_better=False):
        if (theirs > ours) if more_is_better else (theirs < ours):
            self.worse.append((what, f"{shown(ours)} {unit}".strip(), who, f"{shown(theirs)} {unit}".strip()))


def without_avx512(page, name, what, ratio):
    """A sentence on a ratio: of the same benchmark without AVX-512, too, which many processors lack."""
    (rows, _), (other, _) = page.read(name), page.read(name + "_avx2")
    return f"{what} is {ratio(rows):.3g} with AVX-512, and {ratio(other):.3g} where the same program is held to AVX2."


def live(page):
    rows, about = page.read("live")
    cost = {row["what"]: float(row["cpu_median_us"]) for row in rows}
    beside = {row["beside"]: float(row["beside_cpu_median_us"]) for row in rows}
    skinning = beside["skinning the mesh and its cut points"]
    bullet = beside["btConvexHullComputer on the same points"]
    ours = [(f"Lorica, {label}", cost[what]) for label, what in (
        ("motions of the parts", "rigid motions of all parts"), ("16 points a hull", "hulls with faces of 16 points, with cover"),
        ("64 points a hull", "hulls with faces of 64 points, with cover"), ("exact hulls", "hulls with faces"),
        ("exact, after a jump", "hulls with faces after a jump"))]
    for who, value in ours[3:]:
        page.compare(f"a frame of a character, {who.removeprefix('Lorica, ')}", "us", value, "skinning its mesh", skinning)
    page.section("A frame of a character", "Hulls of 16 parts of the mannequin in all six motions at 60 Hz, on one core: median "
                 "CPU time of a frame. Skinning moves the same mesh with its cut points; Bullet builds the same hulls from them. "
                 + without_avx512(page, "live", "Bullet over exact hulls", lambda rows: next(
                     float(row["cpu_ratio"]) for row in rows if row["what"] == "hulls with faces")),
                 about, live=bars("A frame of a character", "us", [("", [*ours, ("skinning the mesh", skinning),
                                                                     ("Bullet's hulls", bullet)])], log=True))


def growth(page):
    rows, about = page.read("crowd")
    line = lambda column: [(float(row["avatars"]), float(row[column])) for row in rows if float(row[column]) > 0]
    first = line("hulls_cpu_us")[0]
    page.section("Growth with avatars", "Hulls of 64 points on one core, and contacts between the avatars. *In proportion* is what "
                 "one avatar takes, times their number: a single one stays in the processor's cache.", about,
                 crowd=lines("A frame of many avatars", "avatars", "microseconds", [
                     ("hulls", line("hulls_cpu_us")), ("in proportion", [(n, first[1] * n) for n, _ in line("hulls_cpu_us")]),
                     ("contacts", line("contacts_cpu_us"))]))
    rows, about = page.read("scaling")
    sweeps = {}
    for row in rows:
        sweeps.setdefault(row["sweep"], []).append((float(row["value"]), float(row["cpu_seconds"])))
    page.section("Growth of a decomposition", "Bumpy spheres, preset `fast`: CPU seconds as one quantity grows.", about,
                 scaling=lines("A decomposition", "vertices, parts or keyframes", "CPU seconds",
                               [(name, sweeps[name]) for name in ("vertices", "parts", "keyframes")]))


def score(page):
    rows, about = page.read("vhacd")
    own, seconds, scores = {}, {}, {}
    for row in rows:
        if row["score17"]:
            own.setdefault(f"{row['mesh']} {row['wanted']}".lower(), {})[row["preset"]] = float(row["score17"])
            seconds.setdefault(row["preset"], []).append(float(row["cpu_seconds"]))
            scores.setdefault(row["preset"], []).append(float(row["score17"]))
    groups, coacd = [], {row["mesh, parts"]: float(row["CoACD"]) for row in page.read("rotations")[0] if row["CoACD"]}
    for label in coacd:
        theirs = [("CoACD", coacd[label])]
        groups.append((label, [*own[label].items(), *theirs]))
        for preset in ("fast", "quality"):
            for who, value in [*theirs, ("the paper's algorithm", own[label]["paper"])]:
                page.compare(f"score of {label}, `{preset}`", "", own[label][preset], who, value, True)
    for label, score_of in own.items():
        if label not in coacd:
            page.compare(f"score of {label}, `fast`", "", score_of["fast"], "the paper's algorithm", score_of["paper"], True)
    mean = {preset: statistics.fmean(values) for preset, values in scores.items()}
    median = {preset: statistics.median(values) for preset, values in seconds.items()}
    for preset in ("fast", "quality"):
        page.compare(f"CPU seconds of a mesh, `{preset}`, median", "s", median[preset], "the paper's algorithm", median["paper"])
    words = ("Score of the paper's Eq. 17, which 1 is the best of, on V-HACD's meshes at the part counts of its Fig. 11. *paper* is the "
             "published algorithm, by this program; CoACD's figures are those of [DECOMPOSITION](DECOMPOSITION.md), at as many parts. "
             f"Means of all {len(scores['fast'])} rows: " + ", ".join(f"`{name}` {value:.4f}" for name, value in mean.items()) + "; median CPU "
             "seconds: " + ", ".join(f"{value:.2f}" for value in median.values()) + ".")
    page.section("Quality of parts", words, about, score=bars("Score, 1 is best", "", groups, dots=True, low=0.5))


def presets(page):
    """The tables of docs/DECOMPOSITION.md: the same rows as the charts of scores and of growth."""
    rows, _ = page.read("vhacd")
    names = ["paper", "fast", "quality"]
    of = {name: [row for row in rows if row["preset"] == name] for name in names}
    score_of = {name: {f"{row['mesh']} {row['wanted']}".lower(): row["score17"] for row in of[name]} for name in names}
    each = lambda shown: [shown(of[name]) for name in names]
    middle = lambda column: each(lambda own: f"{statistics.median(float(row[column]) for row in own):.2f}")
    scores = lambda meshes: [", ".join(f"{float(score_of[name][mesh]):.3f}" for mesh in meshes) for name in names]
    no_worse = lambda own: sum(row["score17"] >= other["score17"] for row, other in zip(own, of["paper"]))
    groups = [("table 5", "sledge 14", "torus 5", "block 19"), ("octopus 31", "genus 12", "elk_toy 13", "dinosaur 8"), ("bunny 8",)]
    page.table("DECOMPOSITION.md", "`build/bench/vhacd FOLDER tests/bench/vhacd_counts.csv`", [f"{len(of['fast'])} rows", *names], [
        ["mean score", *each(lambda own: f"{statistics.fmean(float(row['score17']) for row in own):.4f}")],
        ["rows at least as good as `paper`", "", *each(lambda own: f"{no_worse(own)} of {len(own)}")[1:]],
        [f"median seconds, {rows[0]['threads']} threads", *middle("seconds")], ["median CPU seconds", *middle("cpu_seconds")],
        *([", ".join(group), *scores(group)] for group in groups)])
    powers = page.said("scaling", r"(\w+): seconds scale with the power (\S+), CPU seconds (\S+)")
    page.table("DECOMPOSITION.md", "`build/bench/scaling`", ["with the power of", *(name for name, _, _ in powers)], [
        ["seconds grow", *(wall for _, wall, _ in powers)], ["CPU seconds grow", *(cpu for _, _, cpu in powers)]])


def frames(page):
    """The tables of docs/LIVE_HULLS.md: a frame of a body, its memory, rays."""
    rows, _ = page.read("live")
    hz = [row for row in rows if " at 30 Hz: " in row["what"]]
    page.table("LIVE_HULLS.md", "`build/bench/live`, over", ["", "median", "CPU", "worst", "beside it, in the same run"], [
        [row["what"], *(f"{float(row[column]):,.1f} us" for column in ("median_us", "cpu_median_us", "worst_us")),
         f"{row['beside']}: {float(row['beside_median_us']):,.0f} us"] for row in rows if row not in hz])
    page.table("LIVE_HULLS.md", "where bodies move farther between frames", ["exact hulls at 30 Hz", "median", "worst"], [
        [row["what"].split(": ")[1].replace("_", " "), *(f"{float(row[column]):,.0f} us" for column in ("median_us", "worst_us"))] for row in hz])
    memory = page.said("live", r"a body allocates (\S+) MB and uses (\S+) MB of it; all share (\S+) MB")
    page.table("LIVE_HULLS.md", "certificates: `build/bench/moving_hull`", [
        "a body's memory, besides the file", "shared by all of a kind", "reserved for any frame", "touched in frames"], [
        [what, *(f"{float(size):.2f} MB" for size in (shared, reserved, touched))]
        for what, (reserved, touched, shared) in zip(("exact", "64 points per hull"), memory)])
    rows, _ = page.read("rays")
    of = lambda row, column: f"{float(row[column]):,.2f}" if float(row[column]) < 10 else f"{float(row[column]):,.0f}"
    page.table("LIVE_HULLS.md", "`bench/rays --frames 5`", [
        "vertices of a hull, avatars", "a frame: here", "skinning + Embree", "a ray: here", "on the skin", "Embree", "Bullet", "a ball: here", "Bullet"], [
        [f"{row['hull_vertices']}, {row['avatars']}", of(row, "update_us"), f"{of(row, 'skin_us')} + {of(row, 'refit_us')}",
         *(of(row, column) for column in ("ray_us", "on_skin_us", "embree_us", "bullet_us", "ball_us", "bullet_ball_us"))]
        for row in rows if row["rays"] == "10000"])


def hulls(page):
    rows, about = page.read("hull_vertices")
    limits = list(dict.fromkeys(row["limit"] for row in rows))
    of = {limit: [row for row in rows if row["limit"] == limit] for limit in limits}
    growth = lambda limit, column: 100 * statistics.median(float(row[column]) for row in of[limit])
    below = lambda limit: sum(float(row["growth"]) <= float(row["pchs_growth"]) for row in of[limit])
    for limit in limits:
        page.compare(f"added volume of hulls, {limit}", "%", growth(limit, "growth"), "PCHS", growth(limit, "pchs_growth"))
    page.table("DECOMPOSITION.md", "`build/bench/hull_vertices`", ["added volume, median of the rows", *limits], [
        ["Lorica", *(f"{growth(limit, 'growth'):.2g} %" for limit in limits)],
        ["PCHS", *(f"{growth(limit, 'pchs_growth'):.2g} %" for limit in limits)],
        ["rows where Lorica adds no more", *(f"{below(limit)} of {len(of[limit])}" for limit in limits)]])
    page.section("Hulls with few vertices", "The volume that is added to the hulls of the same rows when they may have only so many vertices "
                 "or half-spaces: median of the rows. PCHS (Jacobson 2026, progressive convex hull simplification) drops half-spaces, and "
                 "was written from its paper; 18 half-spaces are what it is shown with there.", about,
                 hull_vertices=bars("Added volume, less is better", "%", [
                     (limit, [("Lorica", growth(limit, "growth")), ("PCHS", growth(limit, "pchs_growth"))]) for limit in limits], log=True))


def measured(page):
    """Tables of what does not depend on time: concavities of the shared meshes, errors of real and rendered depth."""
    rows, _ = page.read("concavity")
    of = {preset: {row["mesh"]: row for row in rows if row["preset"] == preset} for preset in ("fast", "quality")}
    cell = lambda row: f"{row['parts']}, {row['concavity']}, {row['mean_concavity']}, {float(row['cpu_seconds']):.1f}"
    page.table("DECOMPOSITION.md", "Most of the set's other meshes are below.", ["", "`fast`: parts, largest concavity, mean of the parts, CPU s", "`quality`"], [
        [mesh.replace("mean of", "mean of the") + "; median CPU s" * mesh.startswith("mean"), cell(row), cell(of["quality"][mesh])]
        for mesh, row in of["fast"].items()])
    rows, _ = page.read("hollow")
    of = {program: {row["object"].replace("_", " "): row for row in rows if row["program"] == program} for program in ("Lorica", "CoACD")}
    cell = lambda row: f"{row['hulls']}, {row['volume']}, {row['distance_percent']} %, {float(row['cpu_seconds']):.1f}" if row["hulls"] else "none"
    page.table("DECOMPOSITION.md", "`tests/bench/hollow_things.py table", ["", *(f"{program}: hulls, volume of all, distance, CPU s" for program in of)], [
        [name, cell(row), cell(of["CoACD"][name])] for name, row in of["Lorica"].items()])
    for name, row in of["CoACD"].items():
        if row["hulls"]:
            page.compare(f"{name}, largest concavity 0.05", "hulls", float(of["Lorica"][name]["hulls"]), "CoACD", float(row["hulls"]))
    hollow = of["CoACD"]
    of = {program: {row["mesh"]: row for row in page.read("coacd")[0] if row["program"] == program} for program in ("Lorica", "CoACD")}
    for name, row in of["CoACD"].items():
        if float(row["concavity"]) <= 0.0525 and name not in hollow:  # of what meets the limit
            page.compare(f"{name}, largest concavity 0.05", "hulls", float(of["Lorica"][name]["hulls"]), "CoACD", float(row["hulls"]))
    unseen = page.said("figures", r"unseen motion, (\w+), mean error: (\d+) uniform keyframes (\S+), chosen (\S+), first frame (\S+)")
    page.table("DECOMPOSITION.md", "(`--figures 0`)", ["", f"{unseen[0][1]} keyframes evenly", f"{unseen[0][1]} chosen (`--keyframes auto`)", "first frame only"],
               [[f"`{preset}`", *numbers] for preset, _, *numbers in unseen])
    (alone, together, _), = page.said("figures", r"figure 8: mean error alone (\S+), together (\S+), ratio (\S+)")
    (first, count, all_of, most, most_of), = page.said("figures", r"figure 9: mean error from the first frame (\S+), from (\d+) keyframes (\S+); largest (\S+), (\S+)")
    page.table("DECOMPOSITION.md", "*Figures 8 and 9*", ["relative volume error", "mean", "largest"], [
        ["Fig. 8, parts made for each keyframe by itself", alone, ""], ["Fig. 8, parts made for all keyframes", together, ""],
        ["Fig. 9, parts made for the first frame", first, most], [f"Fig. 9, parts made for {count} keyframes", all_of, most_of]])
    rows, _ = page.read("sensor")
    for camera in dict.fromkeys(row["camera"] for row in rows if row["camera"].startswith("Kinect")):  # others': tests/bench/README.md
        groups, number = {}, r"\d[\d.]*(?: to \d[\d.]*)?(?= (?:px|m)\b)"
        for row in (row for row in rows if row["camera"] == camera):
            groups.setdefault(re.sub(number, "#", row["statistic"]), []).append(row)
        joined = lambda group, column: ", ".join(f"{float(row[column]):.2g}" for row in group)
        page.table("VIRTUAL_SENSOR.md", f"\n*{camera.removeprefix('Kinect v1, ').capitalize()}*: ",
                   [camera, "real", "rendered"], [
            [label.replace("#", ", ".join(re.search(number, row["statistic"])[0] for row in group)) if "#" in label else label,
             joined(group, "real"), joined(group, "rendered")] for label, group in groups.items()])


def tracking(page):
    """The tables of docs/TRACKING.md: rendered people; real ones, means of four runs, and rooms composed of them."""
    rows, _ = page.read("tracking")
    of = {(row["motion"], row["body"]): row for row in rows}
    cell = lambda row: f"{float(row['mean_mm']):.0f} / {float(row['p95_mm']):.0f}, {row['limb_wrong_percent']}"
    page.table("TRACKING.md", "**Rendered people**", ["motion", "10 % taller", "25 % heavier"], [
        [motion.replace("_", " "), *(cell(of[motion, body]) for body in ("tall", "heavy"))] for motion in dict.fromkeys(row["motion"] for row in rows)])
    kinds = {"cut out": "cutout", "A": "A", "B": "B", "C": "C", "RealSense": "realsense_point", "no ring": "without a ring", "composed": "composed"}
    rows = page.read("tracking_real")[0] + page.read("tracking_composed")[0]
    runs = {name: [row for row in rows if row["recording"] == kind] for name, kind in kinds.items()}

    def mean(runs, column, digits):
        values = [float(row[column]) for row in runs if row[column]]
        return f"{(max if column == 'first_frame' else statistics.fmean)(values):.{digits}f}" if values else ""

    for after, lines in (
            ("**By marks and masks**", (
                ("marked limb joints off, %", "marked_limbs_off_percent", 1), ("sure ones off, %", "marked_limbs_sure_off_percent", 1),
                ("sure joints 10 cm outside the mask, %", "sure_outside_percent", 1), ("overlap of pixels", "overlap", 2),
                ("followed after 1 s, %", "after_1s_followed_percent", 0), ("first followed, frame (the latest)", "first_frame", 0),
                ("false people, frames", "false_frames", 0), ("jumps in 1,000 pairs of frames", "pops_in_1000", 0),
                ("CPU, mean / p99, ms", "cpu_ms_mean cpu_ms_p99", 0))),
            ("**Against the Kinect SDK**", (
                ("median / p95, mm", "after_1s_median_mm after_1s_p95_mm", 0),
                ("a limb off, % of frames", "after_1s_limb_off_percent", 0), ("sure and off, %", "after_1s_sure_off_percent", 1)))):
        page.table("TRACKING.md", after, ["", *kinds], [
            [label, *(" / ".join(filter(None, (mean(of, column, digits) for column in columns.split()))) for of in runs.values())]
            for label, columns, digits in lines])


def others(page):
    rows, about = page.read("field")
    of = {}
    for row in rows:
        if row["cpu_seconds"] and not row["mesh"].startswith("mean"):
            of.setdefault(row["preset"], {})[row["mesh"]] = row
    # Of others, what `lorica score` measures.
    number = lambda row, column: float(row[column] or row[{"concavity": "scored", "mean_concavity": "scored_mean"}[column]])
    value = lambda who, meshes, column, mean=statistics.fmean: mean(number(of[who][mesh], column) for mesh in meshes)
    columns = {"largest of a mesh": "concavity", "mean of the parts": "mean_concavity", "parts": "parts", "CPU seconds, median": "cpu_seconds"}
    means = dict.fromkeys(columns.values(), statistics.fmean) | {"cpu_seconds": statistics.median}
    lines, groups = [], {name: [] for name in columns}
    for (who, meshes), after in zip(of.items(), [*list(of.values())[1:], {}]):
        for name in [who] + ["fast"] * (len(meshes) < len(of["fast"]) and meshes.keys() != after.keys()):
            of_all = {column: value(name, meshes, column, mean) for column, mean in means.items()}
            lines.append([f"`{name}`" + ", the same" * (name != who) if name in ("fast", "quality") else name, str(len(meshes)), f"{of_all['parts']:.1f}",
                          *(f"{of_all[column]:.4f}"[1:] for column in ("concavity", "mean_concavity")), f"{of_all['cpu_seconds']:.2f}"])
            if name == who:
                label = (f"Lorica {who}" if who in ("fast", "quality") else who) + f" ({len(meshes)})" * (len(meshes) < len(of["fast"]))
                for group, column in columns.items():
                    groups[group].append((label, of_all[column]))
                    if who not in ("fast", "quality"):
                        page.compare(f"{column.replace('_', ' ')}, {len(meshes)} meshes", "", value("fast", meshes, column, means[column]), who, of_all[column])
    lines += [[f"{row['who']}, as reported", row["meshes"], row["parts"], row["concavity"], "", row["seconds"]] for row in page.reported]
    page.table("DECOMPOSITION.md", "**The field's set.**", ["", "meshes", "parts", "largest concavity", "mean of the parts", "median CPU s"], lines)
    turned = [row for row in page.read("turned")[0] if row["spread"] and not row["mesh"].startswith("mean")]
    page.table("DECOMPOSITION.md", "**Turned.**", ["meshes", "the same parts in all", "parts apart, most", "concavity apart: median, largest"], [[
        str(len(turned)), str(sum(row["fewest_parts"] == row["most_parts"] for row in turned)),
        str(max(int(row["most_parts"]) - int(row["fewest_parts"]) for row in turned)),
        ", ".join(f"{mean(float(row['spread']) for row in turned):.4f}" for mean in (statistics.median, max))]])
    hulls = [(row[""], [("CoACD", float(row["CoACD: hulls"])), ("Lorica fast", float(row["the same call: hulls"]))]) for row in page.read("hollow_examples")[0]]
    for label, ((who, theirs), (_, ours)) in hulls:
        page.compare(f"hulls, {label}", "hulls", ours, who, theirs)
    groups["CPU seconds, median"] += [(f"{row['who']} (reported)", float(row["seconds"])) for row in page.reported]
    page.section("V-HACD, CoACD, CuACD", "The field's set, see [DECOMPOSITION](DECOMPOSITION.md). CuACD and CoACD (reported) are as their authors report of 61 "
                 "meshes; the hulls are of CoACD's own example objects at threshold 0.05.", about,
                 concavity=bars("CoACD's concavity, less is better", "", [(name, groups[name]) for name in list(groups)[:2]]),
                 counts=bars("Parts, fewer are better", "", [("parts", groups["parts"])]),
                 seconds=bars("Median seconds, less is better", "s", [("a mesh", groups["CPU seconds, median"])], log=True),
                 hulls=bars("Hulls of hollow things, fewer are better", "hulls", hulls))


def kept(page):
    """Tables as their CSV has them, of what programs and files of others have a part in: `# table:` says after which words of which
    page they stand. A column `+name` shares a cell with the one before."""
    for path in sorted((page.folder / "benchmarks").rglob("*.csv")):
        about = rows_of(path)[1]
        if "table" not in about:
            continue
        head, *rows = csv.reader(line for line in path.read_text().splitlines() if not line.startswith("#"))
        table = [[] for _ in (head, *rows)]
        for cells, row in zip(table, ([name.lstrip("+") for name in head], *rows)):
            for name, value in zip(head, row):
                if not name.startswith("+"):
                    cells.append(value)
                elif value:
                    cells[-1] += f", {value}"
        page.table(*about["table"].split(", after "), table[0], table[1:])
    of = {row[""]: row for row in page.read("robot_coacd")[0]}
    page.compare("hulls of H1's 18 meshes, largest concavity 0.05", "hulls", float(of["`lorica export --parts 256`"]["hulls"]), "CoACD", float(of["CoACD"]["hulls"]))


def particles(page):
    rows, about = page.read("particles")
    groups, where = [], ""
    for row in rows:
        if row["threads"] == "1":
            where = row["task"].removesuffix(", unsorted") if row["task"].endswith(", unsorted") else where
            label = row["task"].replace("the same", where)
            groups.append((label, [("Lorica", float(row["cpu_ms"])), ("a plain loop", float(row["reference_cpu_ms"]))]))
            page.compare(f"particles, {label}", "ms", float(row["cpu_ms"]), "a plain loop", float(row["reference_cpu_ms"]))
    page.section("Particles", f"{int(rows[0]['particles']):,} particles pushed out of a body: CPU time of a frame. The plain loop goes "
                 "particle by particle and hull by hull, and leaves some inside ([PARTICLES](PARTICLES.md)). "
                 + without_avx512(page, "particles", "The loop over Lorica, first row,", lambda rows: float(rows[0]["ratio"])),
                 about,
                 particles=bars("Particles pushed out of a body", "ms", groups))
    pairs = [row for row in rows if row["threads"] == "1"], [row for row in rows if row["threads"] == "2"]
    page.table("PARTICLES.md", "`build/bench/particles`", [
        "particles", "inside", "wall, one thread; two", "CPU", "plain loop, CPU", "deeper than 1 mm after the plain loop", "after this"], [
        [one["task"], f"{float(one['inside_percent']):.1f} %", f"{float(one['wall_ms']):.0f}; {float(two['wall_ms']):.0f}", f"{float(one['cpu_ms']):.0f}",
         f"{float(one['reference_cpu_ms']):.0f}", f"{int(one['reference_deeper_than_1mm']):,}", one["deeper_than_1mm"]] for one, two in zip(*pairs)])
    rows, about = page.read("sand")
    if not rows:
        return
    page.table("PARTICLES.md", "`build/bench/sand`", ["", "particles", "wall", "CPU", "worst frame: wall", "CPU"], [
        [row["what"], f"{int(row['particles']):,}", *(f"{float(row[column]):.0f}" for column in ("wall ms", "cpu ms", "most wall ms", "most cpu ms"))]
        for row in rows])
    cost = {row["what"]: row for row in rows}
    own, plain = cost["the same sand"], cost["plain scalar sand without a body"]
    page.compare("simulated sand", "ms", float(own["cpu ms"]), "a plain loop", float(plain["cpu ms"]))
    walks = [(row["what"].replace("walk", "Lorica, walk") + f", {int(row['particles']):,}", float(row["cpu ms"]))
             for row in rows if row["what"].startswith("walk")]
    page.section("Sand and water", f"Median CPU time of a frame while the mannequin walks through, and of {int(own['particles']):,} "
                 "grains without a body against a plain scalar loop.", about,
                 sand=bars("Sand and water", "ms", [("", walks), ("without a body", [("Lorica", float(own["cpu ms"])),
                                                                                    ("a plain loop", float(plain["cpu ms"]))])]))


def rays(page):
    rows, about = page.read("rays")
    if not rows:
        return
    groups = []
    for row in rows:
        if row["rays"] != "10000":
            continue
        label = f"{row['hull_vertices']} vertices a hull, avatars: {row['avatars']}".replace("exact vertices a hull", "exact hulls")
        of = lambda *columns: sum(float(row[column]) for column in columns) / 10000
        groups.append((label, [("Lorica", float(row["ray_us"]) + of("update_us")),
                               ("Embree, the skin", float(row["embree_us"]) + of("skin_us", "refit_us")),
                               ("Bullet", float(row["bullet_us"]) + of("update_us", "bullet_update_us"))]))
        for who, column in (("Embree", "embree_us"), ("Bullet", "bullet_us")):
            page.compare(f"a ray to hulls, {label}, without the frame", "us", float(row["ray_us"]), who, float(row[column]))
        page.compare(f"a ray to the skin, {label}, without the frame", "us", float(row["on_skin_us"]), "Embree", float(row["embree_us"]))
    page.section("Rays", "One of 10,000 rays, with its share of what a frame costs before: hulls for Lorica and Bullet, skinning and refitting "
                 "for Embree.", about, rays=bars("A ray of 10,000", "us", groups, log=True))


def serve(page):
    rows, about = page.read("latency")
    if rows:
        row = rows[0]
        page.section("Latency", f"From a depth image of the virtual camera to a client's frame, over {row['frames']} frames: median of the "
                     f"pose {float(row['posed_median_ms']):.0f} ms; at the client {float(row['mean_ms']):.0f} ms in the mean, "
                     f"{float(row['p95_ms']):.0f} ms for 95 of 100, {float(row['largest_ms']):.0f} ms at most.", about)


def draw(folder):
    page = Page(folder)
    for section in (live, frames, growth, score, presets, hulls, measured, tracking, others, kept, particles, rays, serve):
        section(page)
    worse = [f"| {what} | {ours} | {who}: {theirs} |" for what, ours, who, theirs in page.worse]
    intro = ["# Benchmarks", "", textwrap.fill(f"Made by `scripts/benchmarks` from the CSV files in [benchmarks](benchmarks/{page.version.name}), which the "
             "programs of [bench](../tests/bench/README.md) write; `others.csv` has the figures of others. *Other work* is the load when it began. Lorica is blue. Version "
             f"{page.version.name}. To compare two commits: `scripts/benchmarks --compare A B`.", 118), ""]
    page.parts += ["## Where others are better", "", "Every comparison above in which Lorica loses.", "",
                   "| what | Lorica | better |", "|---|---|---|", *worse, ""]
    (folder / "BENCHMARKS.md").write_text("\n".join(intro + page.parts).rstrip() + "\n")


def compare(a, b, names):
    """Prints the rows of two commits side by side: times as a quotient, and whether the results have equal hashes."""
    for name in names:
        old, new = (rows_of(Path(folder) / f"{name}.csv")[0] for folder in (a, b))
        time = next(c for c in ("cpu_median_us", "hulls_cpu_us", "cpu_ms", "cpu_seconds", "cpu ms") if c in new[0])
        print(f"{name}, {time}: {'A':>8} {'B':>8}    B/A  result")
        for before, after in zip(old, new):
            label = " ".join(list(after.values())[:2] if time == "cpu_seconds" else list(after.values())[:1])
            pair = float(before[time]), float(after[time])
            same = "same" if before["hash"] == after["hash"] else "DIFFERS"
            print(f"  {label[:48]:48} {pair[0]:10.4g} {pair[1]:10.4g} {pair[1] / pair[0] if pair[0] else 1:6.2f}  {same}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--compare"]:
        compare(sys.argv[2], sys.argv[3], sys.argv[4:])
    else:
        draw(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT)
