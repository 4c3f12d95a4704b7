"""The examples of docs/PYTHON.md run as they stand."""

import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from shapes import FILES, l_shape

PAGE = Path(__file__).parents[3] / "docs" / "PYTHON.md"


class Documents(unittest.TestCase):
    def test_every_example_runs(self):
        examples = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), re.M | re.S)
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


if __name__ == "__main__":
    unittest.main()
