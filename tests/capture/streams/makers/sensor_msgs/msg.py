class Image:
    pass


class CameraInfo:
    pass
