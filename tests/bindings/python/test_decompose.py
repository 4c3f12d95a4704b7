import csv
import gc
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path

import lorica
import numpy as np
from shapes import box, farthest_outside, kilobytes_in_use, l_shape, torus, volume


class Decompose(unittest.TestCase):
    def test_two_boxes_are_found_in_an_l(self):
        parts = lorica.decompose(*l_shape(), parts=2)
        self.assertEqual(len(parts), 2)
        self.assertAlmostEqual(parts.mesh_volume, 3, 12)
        self.assertAlmostEqual(parts.hull_volume, 3, 9)
        self.assertAlmostEqual(parts.error, 0, 9)

    def test_volumes_are_those_of_the_faces(self):
        for hull in lorica.decompose(*torus(24, 12), parts=5):
            self.assertAlmostEqual(volume(hull.vertices, hull.faces), hull.volume, 12)

    def test_hulls_hold_every_vertex(self):
        vertices, faces = torus(24, 12)
        for limit in (0, 12):
            parts = lorica.decompose(vertices, faces, parts=6, hull_vertices=limit)
            nearest = np.min([farthest_outside(hull, vertices) for hull in parts], axis=0)
            self.assertLess(nearest.max(), 1e-6)
            if limit:
                self.assertLessEqual(max(len(hull.vertices) for hull in parts), limit)

    def test_planes_of_hulls_are_few(self):
        vertices, faces = torus(24, 12)
        few = lorica.decompose(vertices, faces, parts=6, hull_planes=10)
        self.assertLessEqual(max(len(hull.vertices) for hull in few), 16)  # three planes in each corner
        nearest = np.min([farthest_outside(hull, vertices) for hull in few], axis=0)
        self.assertLess(nearest.max(), 1e-6)
        self.assertLess(few.hull_volume, lorica.decompose(vertices, faces, parts=6, hull_vertices=7).hull_volume)

    def test_types_and_strides_do_not_matter(self):
        vertices, faces = l_shape()
        same = lorica.decompose(vertices, faces, parts=2)
        wide = np.zeros((len(vertices), 6))
        wide[:, ::2] = vertices
        others = [
            (wide[:, ::2], faces),
            (np.asfortranarray(vertices), np.asfortranarray(faces)),
            (vertices.astype(np.float32), faces.astype(np.uint8)),
            (vertices.astype(int), faces[:, :].astype(">i4")),
            (vertices.tolist(), faces.tolist()),
        ]
        for other in others:
            for a, b in zip(same, lorica.decompose(*other, parts=2)):
                self.assertTrue(np.array_equal(a.vertices, b.vertices) and np.array_equal(a.faces, b.faces))

    def test_the_given_arrays_stay_as_they_are(self):
        vertices, faces = l_shape()
        before = vertices.copy(), faces.copy()
        lorica.decompose(vertices, faces, parts=2)
        self.assertTrue(np.array_equal(vertices, before[0]) and np.array_equal(faces, before[1]))

    def test_threads_do_not_change_the_hulls(self):
        one = lorica.decompose(*torus(24, 12), parts=5, threads=1)
        many = lorica.decompose(*torus(24, 12), parts=5, threads=4)
        for a, b in zip(one, many):
            self.assertTrue(np.array_equal(a.vertices, b.vertices))

    def test_limits_end_it(self):
        mesh = torus(24, 12)
        few = lorica.decompose(*mesh, max_error=0.2)
        self.assertLessEqual(few.error, 0.2)
        self.assertLessEqual(lorica.decompose(*mesh, max_error=0.3, hull_vertices=12).error, 0.3)
        self.assertGreater(len(lorica.decompose(*mesh, max_distance=0.02)), len(lorica.decompose(*mesh, max_distance=0.2)))

    def test_views_outlive_what_they_show(self):
        vertices = lorica.decompose(*l_shape(), parts=2)[1].vertices
        copy = vertices.copy()
        gc.collect()
        lorica.decompose(*torus(24, 12), parts=4)
        self.assertFalse(vertices.flags.owndata)
        self.assertTrue(np.array_equal(vertices, copy))

    def test_views_cannot_be_written(self):
        hull = lorica.decompose(*l_shape(), parts=2)[0]
        for array in (hull.vertices, hull.faces):
            with self.assertRaises(ValueError):
                array[0, 0] = 1

    def test_open_meshes_get_a_body_unless_refused(self):
        vertices, faces = box()
        open_box = vertices, faces[2:]
        self.assertIn("is open", lorica.decompose(*open_box, parts=1).repaired)
        with self.assertRaisesRegex(ValueError, "the mesh is open"):
            lorica.decompose(*open_box, closed_body="never")

    def test_small_faults_are_repaired(self):
        vertices, faces = box()
        parts = lorica.decompose(vertices, faces[:, ::-1], parts=1)
        self.assertIn("inside out", parts.repaired)
        self.assertAlmostEqual(parts[0].volume, 1, 12)

    def test_an_error_above_a_half_is_a_warning(self):
        vertices, faces = l_shape()
        thin = vertices.copy()
        thin[:, :2][vertices[:, :2] == 1] = 0.1  # an area of 0.39 in a hull of 2.195
        with self.assertWarnsRegex(RuntimeWarning, "hulls have 462.8 % more volume than the mesh"):
            lorica.decompose(thin, faces, parts=1)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            lorica.decompose(vertices, faces, parts=1)  # 3.5 of 3
            lorica.decompose(thin, faces, parts=2)
            with self.assertRaises(RuntimeWarning):
                lorica.decompose(thin, faces, parts=1)

    def test_parts_are_a_sequence(self):
        parts = lorica.decompose(*l_shape(), parts=2)
        self.assertTrue(np.array_equal(parts[-1].vertices, parts[1].vertices))
        self.assertEqual(len(list(parts)), 2)
        for index in (2, -3):
            with self.assertRaises(IndexError):
                parts[index]

    def test_saved_parts_come_back(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "parts.lorica"
            made = lorica.decompose(*l_shape(), parts=2)
            made.save(file)
            for a, b in zip(made, lorica.load_parts(file, *l_shape())):
                self.assertTrue(np.array_equal(a.vertices, b.vertices))
            with self.assertRaisesRegex(ValueError, "made from mesh .12 vertices., expected a decomposition of mesh .8"):
                lorica.load_parts(file, *box())
            with self.assertRaisesRegex(OSError, "nowhere"):
                made.save(Path(folder) / "nowhere" / "parts.lorica")

    def test_nothing_leaks(self):
        mesh = box()

        def often(count):
            for _ in range(count):
                hull = lorica.decompose(*mesh, parts=1, threads=1)[0]
                hull.vertices, hull.faces
                with self.assertRaises(ValueError):
                    lorica.decompose(mesh[0], mesh[1] + 1)
            return kilobytes_in_use()

        first = often(1000)
        self.assertLess(often(10000) - first, 500)  # [kB], or 50 bytes a call: less than one hull or sentence


class Refused(unittest.TestCase):
    def refuses(self, sentence, vertices, faces, **settings):
        with self.assertRaisesRegex(ValueError, sentence):
            lorica.decompose(vertices, faces, **settings)

    def test_wrong_arrays(self):
        vertices, faces = box()
        self.refuses(r"vertices: found shape \(8, 2\), expected \(n, 3\)", vertices[:, :2], faces)
        self.refuses(r"vertices: found shape \(24,\), expected \(n, 3\)", vertices.ravel(), faces)
        self.refuses(r"faces: found shape \(12, 4\), expected \(m, 3\)", vertices, np.c_[faces, faces[:, 0]])
        self.refuses("faces: found type float64, expected integers", vertices, faces.astype(float))
        self.refuses("vertices: found type complex128, expected numbers", vertices.astype(complex), faces)
        self.refuses("vertices: found type <U", vertices.astype(str), faces)
        self.refuses("vertices: found no array|vertices: found shape", [[1, 2, 3], [4, 5]], faces)
        self.refuses("vertices: found shape", None, faces)

    def test_wrong_numbers(self):
        vertices, faces = box()
        for value in (np.nan, np.inf, -np.inf):
            broken = vertices.copy()
            broken[5, 1] = value
            self.refuses(f"vertex 5: y is {value}, expected a finite number", broken, faces)
        for index in (8, -1, 2**40):
            broken = faces.astype(np.int64)
            broken[7, 2] = index
            self.refuses(f"triangle 7: found vertex {index}, expected 0 to 7", vertices, broken)

    def test_empty_meshes(self):
        vertices, faces = box()
        self.refuses("triangle", vertices, faces[:0], closed_body="never")
        self.refuses("triangle|vert", vertices[:0], faces[:0])

    def test_wrong_settings(self):
        mesh = box()
        for settings in (
            {"parts": -1},
            {"parts": 2**31 - 1},
            {"threads": -1},
            {"threads": 2**31 - 1},
            {"max_error": float("nan")},
            {"max_distance": -1.0},
            {"max_concavity": -1.0},
            {"thickness": -1.0},
            {"walls": "thick"},
            {"hull_vertices": 3},
            {"hull_vertices": 2**31 - 1},
            {"hull_planes": 3},
            {"preset": "best"},
            {"closed_body": "maybe"},
            {"progress": 3},
        ):
            with self.subTest(settings):
                self.refuses("expected", *mesh, **settings)

    def test_frames_have_hulls_that_hold_them(self):
        vertices, faces = torus(24, 12)
        wave = np.linspace(0, 1, 9)[:, None] * np.sin(3 * vertices[:, 0])
        frames = np.repeat(vertices[None], 9, axis=0)
        frames[:, :, 2] += 0.5 * wave
        parts = lorica.decompose(frames, faces, parts=6)
        self.assertEqual(parts.frame_count, 9)
        self.assertLess(len(parts.keyframes), 9)
        for k, frame in enumerate(frames):
            hulls = parts.frame(k)
            nearest = np.min([farthest_outside(hull, frame) for hull in hulls], axis=0)
            self.assertLess(nearest.max(), 1e-6)
            own = volume(frame, faces)
            self.assertAlmostEqual(parts.errors[k], sum(hull.volume for hull in hulls) / own - 1, 5)
        self.assertAlmostEqual(parts.error, np.mean(parts.errors), 12)
        self.assertEqual(len(parts), len(parts.frame(0)))
        self.assertTrue(np.array_equal(parts[0].vertices, parts.frame(0)[0].vertices))
        self.assertEqual(lorica.decompose(frames, faces, parts=6, threads=1).hash, parts.hash)
        self.assertEqual(lorica.decompose(frames, faces, parts=6, keyframes=2).keyframes, [0, 8])
        with tempfile.TemporaryDirectory() as folder:
            parts.save(Path(folder) / "ring.lorica")
            other = lorica.load_parts(Path(folder) / "ring.lorica", frames[::-1], faces)
        self.assertEqual(other.hash, parts.hash)
        self.assertAlmostEqual(other.errors[8], parts.errors[0], 5)
        with self.assertRaises(IndexError):
            parts.frame(9)
        for settings in ({"keyframes": 0}, {"keyframes": 10}, {"hull_vertices": 8}, {"hull_planes": 8}):
            with self.subTest(settings):
                self.refuses("expected", frames, faces, **settings)

    def test_the_figures_of_the_paper_are_made_for_a_sequence(self):
        vertices, faces = torus(16, 8)
        frames = np.stack([vertices + [0, 0, 0.2] * np.sin(3 * vertices[:, :1] + k) for k in range(5)])
        script = Path(__file__).parents[3] / "docs" / "samples" / "sequence_figures.py"
        with tempfile.TemporaryDirectory() as folder:
            np.savez(Path(folder) / "ring.npz", vertices=frames, faces=faces)
            subprocess.run([sys.executable, script, "ring.npz", "out", "--parts", "4"], cwd=folder, check=True)
            with open(Path(folder) / "out" / "figures.csv") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual({row["figure"] for row in rows}, {"fig3", "fig8", "fig9", "fig10"})
            for figure in ("fig3", "fig8", "fig9", "fig10"):
                self.assertTrue((Path(folder) / "out" / f"{figure}.png").stat().st_size > 1000)
        parts = lorica.decompose(frames, faces, parts=4)
        told = [float(row["error"]) for row in rows if row["figure"] == "fig9" and "keyframes" in row["series"]]
        self.assertTrue(np.allclose(told, parts.errors))


if __name__ == "__main__":
    unittest.main()
