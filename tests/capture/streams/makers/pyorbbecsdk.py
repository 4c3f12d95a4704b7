"""A stand-in: sometimes there are no frames, or none of depth."""
import scene

OBSensorType = scene.Values(DEPTH_SENSOR=3)
SIZE = 640, 576
LENS = scene.Values(fx=505.0, fy=505.0, cx=319.5, cy=287.5, width=640, height=576)
BENT = scene.Values(k1=0.0, k2=0.0, k3=0.0, k4=0.0, k5=0.0, k6=0.0, p1=0.0, p2=0.0)
PROFILE = scene.Values(get_intrinsic=lambda: LENS, get_distortion=lambda: BENT)


class Config:
    def enable_stream(self, profile):
        assert profile is PROFILE


class Pipeline:
    asked = 0

    def get_stream_profile_list(self, sensor):
        assert sensor == OBSensorType.DEPTH_SENSOR
        return scene.Values(get_default_video_stream_profile=lambda: PROFILE)

    def start(self, config):
        assert isinstance(config, Config)

    def wait_for_frames(self, timeout_ms):
        self.asked += 1
        if self.asked == 1:
            return None
        if self.asked == 2:
            return scene.Values(get_depth_frame=lambda: None)
        number = scene.count()
        frame = scene.Values(get_data=lambda: scene.depth(*SIZE).tobytes(), get_width=lambda: SIZE[0],
                             get_height=lambda: SIZE[1], get_depth_scale=lambda: 1.0,
                             get_timestamp=lambda: int(1000 * number / 30))
        return scene.Values(get_depth_frame=lambda: frame)
