import threading
import unittest

import lorica
import numpy as np
from shapes import FILES, l_shape, torus


class Threads(unittest.TestCase):
    def in_threads(self, work, count=2):
        results = [None] * count

        def run(index):
            results[index] = work()

        threads = [threading.Thread(target=run, args=(i,)) for i in range(count)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        return results

    def test_two_decompositions_at_once_are_those_of_one(self):
        alone = lorica.decompose(*torus(24, 12), parts=5)
        for parts in self.in_threads(lambda: lorica.decompose(*torus(24, 12), parts=5)):
            for a, b in zip(alone, parts):
                self.assertTrue(np.array_equal(a.vertices, b.vertices))

    def test_two_players_share_a_body(self):
        body = lorica.Character().load_body(FILES / "body.lorica")
        play = lambda: [frame.hulls[0].vertices for _, frame in zip(range(30), lorica.play("walk", body))]
        alone = play()
        for frames in self.in_threads(play):
            self.assertTrue(all(np.array_equal(a, b) for a, b in zip(alone, frames)))

    def test_two_threads_share_a_live_body(self):
        body = lorica.Character().load_body(FILES / "body.lorica")
        poses = [frame.world_from_joint for _, frame in zip(range(30), lorica.play("walk", body))]
        live = body.live()

        def move():
            for pose in poses:
                for hull in live.pose(pose).hulls:
                    self.assertTrue(np.isfinite(hull.vertices).all())
            return True

        self.assertEqual(self.in_threads(move), [True, True])

    def test_other_threads_run_meanwhile(self):
        counted = 0
        done = threading.Event()

        def count():
            nonlocal counted
            while not done.is_set():
                counted += 1
                done.wait(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        lorica.decompose(*torus(), parts=16)
        done.set()
        thread.join()
        self.assertGreater(counted, 20)

    def test_progress_is_called_in_the_callers_thread(self):
        callers = set()
        lorica.decompose(*l_shape(), parts=2, progress=lambda done, wanted: callers.add(threading.get_ident()))
        self.assertEqual(callers, {threading.get_ident()})


if __name__ == "__main__":
    unittest.main()
