"""RealSense (D400, L500): pip install pyrealsense2 numpy. Written after its documentation and tried with a stand-in of
the module, never with a camera."""
import numpy
import pyrealsense2 as rs
from lorica_depth import Sender

pipeline, config = rs.pipeline(), rs.config()
config.enable_stream(rs.stream.depth, 848, 480, rs.format.z16, 30)
profile = pipeline.start(config)
unit = profile.get_device().first_depth_sensor().get_depth_scale()
lens = profile.get_stream(rs.stream.depth).as_video_stream_profile().get_intrinsics()
sender = Sender()
while True:
    frame = pipeline.wait_for_frames().get_depth_frame()
    sender.send(numpy.asanyarray(frame.get_data()), lens.fx, lens.fy, lens.ppx, lens.ppy, unit,
                frame.get_timestamp() / 1000, lens.coeffs)
