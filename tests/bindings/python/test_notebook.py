"""docs/lorica.ipynb runs as it stands, and says what it says.

    python3 test_notebook.py renew     runs it and keeps what it gives
"""

import sys
import unittest
from pathlib import Path

import matplotlib.font_manager  # noqa: F401 - makes its cache now: else a cell says that it does
import nbformat  # python3-nbclient; scripts/setup --tests installs it
from nbclient import NotebookClient

PAGE = Path(__file__).parents[3] / "docs" / "lorica.ipynb"


def run():
    """The notebook with what its cells give now."""
    notebook = nbformat.read(PAGE, as_version=4)
    NotebookClient(notebook, timeout=1500, kernel_name="python3").execute()
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
    return notebook


def text_of(cell):
    return "".join(output["text"] for output in cell.get("outputs", []) if output["output_type"] == "stream")


def pictures_of(cell):
    return [output["data"]["image/png"] for output in cell.get("outputs", []) if "image/png" in output.get("data", {})]


class Notebook(unittest.TestCase):
    def test_every_cell_runs_and_says_the_same(self):
        kept = nbformat.read(PAGE, as_version=4)
        now = run()
        for old, new in zip(kept.cells, now.cells, strict=True):
            self.assertEqual(text_of(new), text_of(old), old.source)
            self.assertEqual(len(pictures_of(new)), len(pictures_of(old)), old.source)
            for picture in pictures_of(new):
                self.assertGreater(len(picture), 8000)
        self.assertGreaterEqual(sum(map(len, map(pictures_of, now.cells))), 3)


if __name__ == "__main__":
    if sys.argv[1:] == ["renew"]:
        nbformat.write(run(), PAGE)
    else:
        unittest.main()
