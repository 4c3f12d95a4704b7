"""A stand-in: the lens of a narrow Azure Kinect without its distortion; the first capture has no depth."""
import numpy
import scene

CalibrationType = scene.Values(DEPTH=0, COLOR=1)
ColorResolution = scene.Values(OFF=0)
DepthMode = scene.Values(NFOV_UNBINNED=2)


class Config:
    def __init__(self, color_resolution, depth_mode, synchronized_images_only):
        assert (color_resolution, depth_mode, synchronized_images_only) == (0, 2, False)


class PyK4A:
    captured = False

    def __init__(self, config):
        self.calibration = scene.Values(
            get_camera_matrix=lambda which: numpy.array([[504.0, 0, 319.5], [0, 504.0, 287.5], [0, 0, 1]]),
            get_distortion_coefficients=lambda which: numpy.zeros(8))

    def start(self):
        pass

    def get_capture(self):
        if not self.captured:
            self.captured = True
            return scene.Values(depth=None)
        return scene.Values(depth_timestamp_usec=1000000 * scene.count() // 30, depth=scene.depth(640, 576))
