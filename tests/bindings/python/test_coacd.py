import unittest

import lorica
import lorica.coacd_compatible as coacd
import numpy as np
from shapes import farthest_outside, box, l_shape, torus


class CoacdCompatible(unittest.TestCase):
    def test_its_calls_work(self):
        coacd.set_log_level("error")
        parts = coacd.run_coacd(coacd.Mesh(*l_shape()), threshold=0.05, max_convex_hull=8)
        self.assertEqual(len(parts), 2)
        for vertices, faces in parts:
            self.assertEqual((vertices.dtype, faces.dtype), (np.float64, np.int32))
            self.assertLess(faces.max(), len(vertices))

    def test_the_threshold_is_a_share_of_half_of_the_longest_side(self):
        vertices, faces = torus(24, 12)
        whole = lorica.decompose(vertices, faces, max_concavity=0.1)
        for scale in (1, 1000):
            self.assertEqual(len(coacd.run_coacd(coacd.Mesh(vertices * scale, faces), threshold=0.1)), len(whole))
        self.assertEqual(len(coacd.run_coacd(coacd.Mesh(vertices, faces), 0.13, real_metric=True)), len(whole))

    def test_hulls_and_vertices_are_limited(self):
        mesh = coacd.Mesh(*torus(24, 12))
        self.assertEqual(len(coacd.run_coacd(mesh, threshold=0.01, max_convex_hull=3)), 3)
        few = coacd.run_coacd(mesh, threshold=0.2, decimate=True, max_ch_vertex=16)
        self.assertLessEqual(max(len(vertices) for vertices, _ in few), 16)

    def test_what_it_cannot_do_is_a_sentence(self):
        mesh = coacd.Mesh(*box())
        for settings in ({"extrude": True}, {"apx_mode": "box"}, {"preprocess_mode": "no"}, {"threshold": 0}):
            with self.subTest(settings), self.assertRaises(ValueError):
                coacd.run_coacd(mesh, **settings)
        with self.assertRaisesRegex(ValueError, "vertices: found shape"):
            coacd.run_coacd(coacd.Mesh([1, 2, 3], [[0, 1, 2]]))


if __name__ == "__main__":
    unittest.main()
