"""A stand-in of version 3."""
import datetime
import scene

CameraBoardSocket = scene.Values(CAM_B=1, CAM_C=2)


class StereoDepth:
    def __init__(self):
        self.left, self.right, self.depth, self.linked = "left", "right", self, []

    def createOutputQueue(self, maxSize, blocking):
        return self

    def get(self):
        number = scene.count()
        return scene.Values(getFrame=lambda: scene.depth(640, 400),
                            getTimestampDevice=lambda: datetime.timedelta(seconds=number / 30))


class Camera:
    linked = []

    def build(self, socket):
        self.socket = socket
        return self

    def requestOutput(self, size):
        assert size == (640, 400)
        return self

    def link(self, side):
        Camera.linked.append((self.socket, side))


node = scene.Values(StereoDepth=StereoDepth, Camera=Camera)


class Pipeline:
    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def create(self, kind):
        return kind()

    def getDefaultDevice(self):
        lens = [[450.0, 0, 319.5], [0, 450.0, 199.5], [0, 0, 1]]
        calibration = scene.Values(getCameraIntrinsics=lambda socket, width, height: lens)
        return scene.Values(readCalibration=lambda: calibration)

    def start(self):
        assert Camera.linked == [(1, "left"), (2, "right")]

    def isRunning(self):
        return True
