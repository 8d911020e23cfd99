"""The demo's recording as a running camera, for tests."""
import os
import threading

import rosbag
import rospy
from sensor_msgs.msg import CameraInfo, Image

RECORDING = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'data', 'demo', 'recording.bag')
TOPICS = {'/camera/rgb/image_rect_color': Image, '/camera/depth_registered/image_raw': Image,
          '/camera/rgb/camera_info': CameraInfo}
COLOR, DEPTH, INFO = TOPICS


def recorded():
    """The recording's first message of each topic."""
    first = {}
    with rosbag.Bag(RECORDING) as bag:
        for topic, message, _ in bag.read_messages(topics=list(TOPICS)):
            first.setdefault(topic, message)
    return first


class Camera:
    """Publishes the recording's first frame at 5 Hz, as `spoil` leaves it: {topic: message} -> None.

    Under the recording's names, or those of another camera than `camera`."""

    def __init__(self, spoil=lambda frame: None, silent=(), camera='camera'):
        self.frame = recorded()
        self.spoil = spoil
        self.publishers = {
            topic: rospy.Publisher(topic.replace('/camera/', '/%s/' % camera, 1), kind, queue_size=1)
            for topic, kind in TOPICS.items() if topic not in silent}
        self.done = threading.Event()
        self.thread = threading.Thread(target=self.run)

    def run(self):
        while not self.done.wait(0.2):
            stamp = rospy.Time.now()
            for message in self.frame.values():
                message.header.stamp = stamp
            self.spoil(self.frame)
            for topic, publisher in self.publishers.items():
                publisher.publish(self.frame[topic])

    def __enter__(self):
        self.thread.start()

    def __exit__(self, *_):
        self.done.set()
        self.thread.join()
        for publisher in self.publishers.values():
            publisher.unregister()
