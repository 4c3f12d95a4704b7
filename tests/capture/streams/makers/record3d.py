"""A stand-in: depth in metres, with holes that are not a number; the lens is that of a colour image thrice as large."""
import threading
import time
import numpy
import scene


class Record3DStream:
    @staticmethod
    def get_connected_devices():
        return ["phone"]

    def connect(self, device):
        assert device == "phone"
        threading.Thread(target=self.tell, daemon=True).start()

    def tell(self):
        while True:
            self.on_new_frame()
            time.sleep(0.001)

    def get_depth_frame(self):
        scene.count()
        metres = scene.depth(256, 192).astype(numpy.float32) / 1000
        metres[0, 0] = numpy.nan
        return metres

    def get_intrinsic_mat(self):
        return scene.Values(fx=660.0, fy=660.0, tx=383.5, ty=287.5)

    def get_rgb_frame(self):
        return numpy.zeros((576, 768, 3), numpy.uint8)
