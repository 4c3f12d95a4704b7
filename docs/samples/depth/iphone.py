"""iPhone or iPad with LiDAR, by cable from the app Record3D: pip install record3d numpy. Written after its
documentation and tried with a stand-in of the module, never with a phone."""
from threading import Event
import numpy
from record3d import Record3DStream
from lorica_depth import Sender

session, came = Record3DStream(), Event()
session.on_new_frame = came.set
session.connect(Record3DStream.get_connected_devices()[0])
sender = Sender()
while True:
    came.wait()
    came.clear()
    depth, lens = session.get_depth_frame(), session.get_intrinsic_mat()  # metres; the lens is the colour image's
    less = depth.shape[1] / session.get_rgb_frame().shape[1]
    millimetres = (numpy.nan_to_num(depth) * 1000).clip(0, 65535).round()
    sender.send(millimetres, lens.fx * less, lens.fy * less, (lens.tx + 0.5) * less - 0.5,
                (lens.ty + 0.5) * less - 0.5)
