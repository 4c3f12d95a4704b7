"""ROS 2: any camera that publishes sensor_msgs/Image in 16UC1 or 32FC1, with its CameraInfo beside it. The second
argument is the topic of the image. Written after its documentation and tried with a stand-in of rclpy, never with a
camera."""
import sys
import numpy
import rclpy
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, Image
from lorica_depth import Sender

rclpy.init()
node, sender, lens = rclpy.create_node("lorica_depth"), Sender(), []
topic = sys.argv[2] if len(sys.argv) > 2 else "/camera/camera/depth/image_rect_raw"

def learn(info):  # of a rectified image P holds, and no distortion is left
    straight = "rect" in topic.rsplit("/", 1)[1]
    lens[:] = [info.p[0], info.p[5], info.p[2], info.p[6], ()] if straight else [*info.k[0:5:4], *info.k[2:6:3], info.d]

def send(image):
    if lens:
        kind = (">" if image.is_bigendian else "<") + ("f4" if image.encoding == "32FC1" else "u2")
        depth = numpy.frombuffer(image.data, kind).reshape(image.height, -1)[:, :image.width]
        if kind.endswith("f4"):  # metres
            depth = (numpy.nan_to_num(depth, posinf=0) * 1000).clip(0, 65535).round()
        time = image.header.stamp
        sender.send(depth, *lens[:4], 0.001, time.sec + time.nanosec * 1e-9, lens[4])

node.create_subscription(CameraInfo, topic.rsplit("/", 1)[0] + "/camera_info", learn, qos_profile_sensor_data)
node.create_subscription(Image, topic, send, qos_profile_sensor_data)
rclpy.spin(node)
