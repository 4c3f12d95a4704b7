import os
import signal
import subprocess
import sys
import time
import unittest

import lorica
from shapes import l_shape, torus

ENDLESS = """
import lorica, sys
from shapes import torus
told = False
def tell(done, wanted):
    global told
    if not told: print("started", flush=True)
    told = True
try:
    while True: lorica.decompose(*torus(200, 100), parts=400, threads=1, progress=tell)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


class Progress(unittest.TestCase):
    def test_it_ends_with_all_parts(self):
        calls = []
        lorica.decompose(*torus(24, 12), parts=5, progress=lambda *call: calls.append(call))
        self.assertEqual(calls[-1], (5, 5))
        self.assertEqual(calls, sorted(calls))

    def test_false_cancels(self):
        calls = []

        def stop(done, wanted):
            calls.append(done)
            return done < 2

        with self.assertRaises(lorica.Cancelled):
            lorica.decompose(*torus(24, 12), parts=8, progress=stop)
        self.assertEqual(calls[-1], 2)

    def test_none_does_not_cancel(self):
        self.assertEqual(len(lorica.decompose(*l_shape(), parts=2, progress=lambda done, wanted: None)), 2)

    def test_its_exceptions_come_through(self):
        def fail(done, wanted):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            lorica.decompose(*l_shape(), parts=2, progress=fail)

    def test_bodies_can_be_cancelled(self):
        with self.assertRaises(lorica.Cancelled):
            lorica.Character().body(3, progress=lambda done, wanted: False)


class CtrlC(unittest.TestCase):
    def test_it_is_an_interrupt_within_seconds(self):
        child = subprocess.Popen([sys.executable, "-c", ENDLESS], stdout=subprocess.PIPE, text=True, env=os.environ)
        with child:
            self.assertEqual(child.stdout.readline(), "started\n")
            time.sleep(0.3)
            child.send_signal(signal.SIGINT)
            sent = time.monotonic()
            self.assertEqual(child.stdout.readline(), "interrupted\n")
            self.assertEqual(child.wait(), 0)
        self.assertLess(time.monotonic() - sent, 60)


if __name__ == "__main__":
    unittest.main()
