"""A stand-in of libfreenect's module."""
import scene

DEPTH_MM = 5


def sync_get_depth(index=0, format=0):
    assert (index, format) == (0, DEPTH_MM)
    return scene.depth(640, 480), scene.count() * 2000000
