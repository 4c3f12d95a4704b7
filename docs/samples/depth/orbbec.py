"""Orbbec (Femto Bolt and Mega, Gemini, Astra 2): pip install pyorbbecsdk2 numpy. Written after its documentation and
tried with a stand-in of the module, never with a camera."""
import numpy
from pyorbbecsdk import Config, OBSensorType, Pipeline
from lorica_depth import Sender

pipeline, config = Pipeline(), Config()
profile = pipeline.get_stream_profile_list(OBSensorType.DEPTH_SENSOR).get_default_video_stream_profile()
config.enable_stream(profile)
pipeline.start(config)
lens, bent = profile.get_intrinsic(), profile.get_distortion()
sender = Sender()
while True:
    frames = pipeline.wait_for_frames(1000)
    frame = frames.get_depth_frame() if frames else None
    if frame is None:
        continue
    depth = numpy.frombuffer(frame.get_data(), "<u2").reshape(frame.get_height(), frame.get_width())
    sender.send(depth, lens.fx, lens.fy, lens.cx, lens.cy, frame.get_depth_scale() / 1000, frame.get_timestamp() / 1000,
                (bent.k1, bent.k2, bent.p1, bent.p2, bent.k3, bent.k4, bent.k5, bent.k6))
