"""A stand-in: L500's unit of a quarter of a millimetre."""
import scene

stream, format = scene.Values(depth="depth"), scene.Values(z16="z16")


class config:
    def enable_stream(self, which, width, height, form, rate):
        assert (which, form, rate) == ("depth", "z16", 30)
        self.size = width, height


class pipeline:
    def start(self, config):
        self.size = config.size
        lens = scene.Values(width=self.size[0], height=self.size[1], ppx=self.size[0] / 2 - 0.5,
                            ppy=self.size[1] / 2 - 0.5, fx=425.0, fy=426.0, coeffs=[0.0] * 5)
        profile = scene.Values(get_intrinsics=lambda: lens)
        sensor = scene.Values(get_depth_scale=lambda: 0.00025)
        return scene.Values(get_device=lambda: scene.Values(first_depth_sensor=lambda: sensor),
                            get_stream=lambda which: scene.Values(as_video_stream_profile=lambda: profile))

    def wait_for_frames(self, timeout_ms=5000):
        number = scene.count()
        frame = scene.Values(get_data=lambda: 4 * scene.depth(*self.size),
                             get_timestamp=lambda: 1000 * number / 30)
        return scene.Values(get_depth_frame=lambda: frame)
