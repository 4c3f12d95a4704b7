"""OAK-D and other stereo cameras of Luxonis: pip install depthai numpy (version 3). Written after its documentation and
tried with a stand-in of the module, never with a camera."""
import depthai as dai
from lorica_depth import Sender

WIDTH, HEIGHT = 640, 400
with dai.Pipeline() as pipeline:
    stereo = pipeline.create(dai.node.StereoDepth)
    for socket, side in ((dai.CameraBoardSocket.CAM_B, stereo.left), (dai.CameraBoardSocket.CAM_C, stereo.right)):
        pipeline.create(dai.node.Camera).build(socket).requestOutput((WIDTH, HEIGHT)).link(side)
    images = stereo.depth.createOutputQueue(maxSize=1, blocking=False)
    # The depth is that of the right camera, rectified: it has no distortion.
    lens = pipeline.getDefaultDevice().readCalibration().getCameraIntrinsics(dai.CameraBoardSocket.CAM_C, WIDTH, HEIGHT)
    sender = Sender()
    pipeline.start()
    while pipeline.isRunning():
        image = images.get()
        sender.send(image.getFrame(), lens[0][0], lens[1][1], lens[0][2], lens[1][2], 0.001,
                    image.getTimestampDevice().total_seconds())
