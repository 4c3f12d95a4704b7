"""The examples of docs/PYTHON.md, README.md and docs/CONTACTS.md, and the commands of all documents whose output is quoted, run as
they stand; every other command that a document names has the options that it is given there.

The sentences of docs/TROUBLESHOOTING.md are Lorica's own, and docs/BENCHMARKS.md is what its figures give.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from shapes import FILES, l_shape

SOURCE = Path(__file__).parents[3]
DOCS = SOURCE / "docs"


def without_gaps(text):
    """Figures are set in columns, whose widths mean nothing."""
    return " ".join(text.split())


class Documents(unittest.TestCase):
    def test_every_example_runs(self):
        examples = re.findall(r"^```python\n(.*?)^```", (DOCS / "PYTHON.md").read_text(), re.M | re.S)
        self.assertGreater(len(examples), 3)
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(FILES / "hero.glb", Path(folder) / "hero.glb")
            os.symlink(FILES / "walk.bvh", Path(folder) / "walk.bvh")
            vertices, faces = l_shape()
            lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
            lines += [" ".join(map(str, v)) for v in vertices] + ["3 " + " ".join(map(str, f)) for f in faces]
            (Path(folder) / "chair.off").write_text("\n".join(lines) + "\n")
            program = "\n".join(examples)
            subprocess.run([sys.executable, "-c", program], cwd=folder, check=True, env=os.environ)
            self.assertGreater((Path(folder) / "parts.png").stat().st_size, 5000)
            # What these name is said in words beside them.
            subprocess.run([os.environ["LORICA"], "contacts", "walk", "-o", "walk.npz"], cwd=folder, check=True, stdout=subprocess.PIPE)
            for page, before in (("README.md", "import lorica; use = print"), ("docs/CONTACTS.md", "")):
                examples = re.findall(r"^```python\n(.*?)^```", (SOURCE / page).read_text(), re.M | re.S)
                self.assertGreater(len(examples), 0, page)
                program = "\n".join([before, *examples])
                subprocess.run([sys.executable, "-c", program], cwd=folder, check=True, stdout=subprocess.PIPE)


class Commands(unittest.TestCase):
    """Each line of a block `sh` runs in one folder, in the order of the pages: a recipe uses what the start made.

    A block `text` after it is what it prints, where `...` stands for anything. Blocks `console` need a display, a network,
    minutes or another program, and are not run; nor are indented lines, which are examples of files that nobody has.
    """

    def setUp(self):
        lorica = Path(os.environ["LORICA"])
        self.environment = dict(os.environ, PATH=f"{lorica.parent}:{os.environ['PATH']}", XDG_CONFIG_HOME="/dev/null",
                                LORICA_RECORDINGS=str(SOURCE / "recordings"))
        for name in ("DISPLAY", "WAYLAND_DISPLAY", "LORICA_VIRTUAL"):
            self.environment.pop(name, None)

    def run_line(self, line, folder):
        return subprocess.run(["bash", "-c", line], cwd=folder, env=self.environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=250)

    def run_pages(self, pages):
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(SOURCE / "recordings/scenes", Path(folder) / "scenes")
            cameras = self.run_line("lorica info --devices", folder).returncode == 0  # else there is no OpenNI2
            for page, fewest in pages:
                count, printed = 0, None
                for kind, block in re.findall(r"^```(\w+)\n(.*?)^```", (DOCS / page).read_text(), re.M | re.S):
                    if kind == "text":
                        self.assert_printed(block, printed, page)
                    if kind != "sh":
                        continue
                    if not cameras and re.search("--virtual|--devices", block):
                        printed = None
                        continue
                    printed = ""
                    for line in block.splitlines():
                        result = self.run_line(line, folder)
                        printed += result.stdout
                        self.assertEqual(result.returncode, 0, f"{page}: {line}\n{result.stdout}")
                        count += 1
                if cameras:
                    self.assertGreaterEqual(count, fewest, f"{page} has lost its commands")

    def assert_printed(self, block, printed, page):
        if printed is None:
            return
        rest = without_gaps(printed)
        for piece in map(without_gaps, re.split(r"\.\.\.|\n", block)):
            self.assertIn(piece, rest, f"{page} says:\n{block}\nprinted now:\n{printed}")
            rest = rest[rest.index(piece) + len(piece):]

    def test_start_and_recipes_run_and_print_what_they_say(self):
        self.run_pages([("START.md", 7), ("RECIPES.md", 10)])

    def test_what_other_pages_quote_is_printed(self):
        others = [page.name for page in sorted(DOCS.glob("*.md")) if page.name not in ("START.md", "RECIPES.md")]
        pages = [page for page in others if "```sh\n" in (DOCS / page).read_text()]
        self.assertIn("EXPORTS.md", pages)
        self.run_pages([(page, 1) for page in pages])

    def test_pictures_of_scenes_are_those_that_are_drawn_now(self):
        from matplotlib.image import imread
        page = (DOCS / "SCENE_GALLERY.md").read_text()
        with tempfile.TemporaryDirectory() as folder:
            os.makedirs(Path(folder) / "docs/pictures")
            for scene in ("boxes", "duel", "targets"):
                line = re.search(rf"^    (lorica snapshot .*scene_{scene}\.png)$", page, re.M)[1]
                result = self.run_line(line, folder)
                self.assertEqual(result.returncode, 0, f"{line}\n{result.stdout}")
                drawn, kept = (imread(Path(where) / f"docs/pictures/scene_{scene}.png")[..., :3] for where in (folder, SOURCE))
                self.assertEqual(drawn.shape, kept.shape)
                # Other versions of Mesa round edges otherwise; a limb or a box elsewhere is hundreds of pixels.
                wrong = (abs(drawn - kept).max(axis=2) > 0.25).mean()
                self.assertLess(wrong, 0.001, f"scene_{scene}.png: run scripts/gallery")

    def test_every_option_is_one_of_its_command(self):
        helps, count = {}, 0
        for page in [SOURCE / "README.md", *sorted(DOCS.glob("*.md"))]:
            for line in re.findall(r"^(?:    )?(?:\w+=\S+ )*lorica ([^#\n]*)", re.sub(r"\\\n *", "", page.read_text()), re.M):
                command, *words = re.split(r"[ |>;]+", line.strip())
                if not command.isalpha():
                    continue
                if command not in helps:
                    helps[command] = self.run_line(f"lorica {command} --help", "/").stdout
                for option in (word.split("=")[0] for word in words if word.startswith("--")):
                    count += 1
                    with self.subTest(page=page.name, command=line):
                        self.assertRegex(helps[command], rf"(?<![\w-]){option}(?![\w-])")
        self.assertGreater(count, 100)


class Benchmarks(unittest.TestCase):
    def test_page_and_charts_are_what_the_kept_figures_give(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(DOCS / "benchmarks", Path(folder) / "benchmarks")
            (Path(folder) / "pictures").mkdir()
            pages = sorted(page.name for page in DOCS.glob("*.md"))  # some of whose tables come from these figures
            for page in pages:
                shutil.copy(DOCS / page, folder)
            (Path(folder) / "BENCHMARKS.md").unlink()
            subprocess.run([sys.executable, SOURCE / "tests/bench/charts.py", folder], check=True)
            drawn = sorted(file.relative_to(folder) for file in Path(folder).glob("**/*") if file.suffix in (".md", ".svg"))
            kept = sorted(file.relative_to(DOCS) for file in (DOCS / "pictures").glob("bench_*.svg"))
            self.assertEqual(drawn, [*map(Path, pages), *kept])
            for file in drawn:
                self.assertEqual((Path(folder) / file).read_text(), (DOCS / file).read_text(), f"{file}: run scripts/benchmarks --draw")


class Sentences(unittest.TestCase):
    def test_every_sentence_is_said_somewhere(self):
        folders = "acd apps capture collision export geometry session skinning viewer".split()
        files = [f for folder in folders for f in (SOURCE / folder).rglob("*.*") if f.suffix in (".cpp", ".h", ".js")]
        said = re.sub(r'"\s*\n\s*"', "", "\n".join(f.read_text() for f in sorted(files)))
        rows = re.findall(r"^\| `(.*?)`.*\|$", (DOCS / "TROUBLESHOOTING.md").read_text(), re.M)
        self.assertGreater(len(rows), 30)
        for sentence in rows:
            # What stands between names, numbers and values is a piece of text in the sources.
            for piece in re.split(r"NAME|\bN\b|\.\.\.|\d+|[:;\"'()]|  ", sentence):
                if len(piece.split()) > 2:
                    with self.subTest(sentence=sentence):
                        self.assertTrue(piece.strip() in said, f"nothing says '{piece.strip()}': {sentence}")


if __name__ == "__main__":
    unittest.main()
