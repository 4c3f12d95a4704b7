"""Sends depth images to `lorica live --depth`: what the senders beside this file share. docs/FORMATS.md has the header.

    sender = Sender()  # to the program's first argument: [HOST:]PORT, a named pipe or socket with a / in its path, or -
    sender.send(depth, fx, fy, cx, cy, unit=0.001, time=0.0, distortion=(k1, k2, p1, p2, k3, k4, k5, k6))
"""
import os, socket, stat, struct, sys


def connect(to):
    if to == "-":
        return sys.stdout.buffer
    if "/" in to and stat.S_ISFIFO(os.stat(to).st_mode):
        return open(to, "wb")
    if "/" in to:
        stream = socket.socket(socket.AF_UNIX)
        stream.connect(to)
    else:
        host, _, port = to.rpartition(":")
        stream = socket.create_connection((host or "127.0.0.1", int(port)))
    return stream.makefile("wb")


class Sender:
    def __init__(self, to=None):
        self.stream = connect(to or (sys.argv[1] if len(sys.argv) > 1 else "7000"))

    def send(self, depth, fx, fy, cx, cy, unit=0.001, time=-1.0, distortion=()):
        """depth: an array of numpy, height x width, whole numbers of `unit` metres, 0 where nothing was measured;
        fx .. cy: in pixels, the first one's centre is 0, 0; time: of the camera's clock [s], below 0 if it has none."""
        height, width = depth.shape
        bent = (list(distortion) + 8 * [0.0])[:8]
        self.stream.write(struct.pack("<8s4I14d", b"LORDEPTH", 1, 2 * width * height, width, height, time, unit,
                                      fx, fy, cx, cy, *bent))
        self.stream.write(depth.astype("<u2").tobytes())
        self.stream.flush()
