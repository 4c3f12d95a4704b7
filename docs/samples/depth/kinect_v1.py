"""Kinect v1 (Xbox 360), without OpenNI2: libfreenect's module `freenect` and numpy. Written after its documentation and
tried with a stand-in of the module, never with a camera."""
import freenect
from lorica_depth import Sender

sender = Sender()
while True:
    depth, _ = freenect.sync_get_depth(format=freenect.DEPTH_MM)  # its clock is of no known unit
    sender.send(depth, 575.8, 575.8, 319.5, 239.5)
