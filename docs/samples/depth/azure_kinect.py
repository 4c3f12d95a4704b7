"""Azure Kinect, and Femto Bolt or Mega with Orbbec's k4a wrapper: pip install pyk4a numpy. Written after its
documentation and tried with a stand-in of the module, never with a camera."""
from pyk4a import CalibrationType, ColorResolution, Config, DepthMode, PyK4A
from lorica_depth import Sender

camera = PyK4A(Config(color_resolution=ColorResolution.OFF, depth_mode=DepthMode.NFOV_UNBINNED,
                      synchronized_images_only=False))
camera.start()
lens = camera.calibration.get_camera_matrix(CalibrationType.DEPTH)
bent = camera.calibration.get_distortion_coefficients(CalibrationType.DEPTH)
sender = Sender()
while True:
    image = camera.get_capture()
    if image.depth is not None:
        sender.send(image.depth, lens[0][0], lens[1][1], lens[0][2], lens[1][2], 0.001,
                    image.depth_timestamp_usec / 1e6, bent)
