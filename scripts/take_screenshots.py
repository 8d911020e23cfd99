"""Takes pictures of a running demo: images of its topics, and rviz's window; or of a training. Needs a display."""
import argparse
import os
import subprocess
import tempfile
import threading

import rospy
from compare_with_truth import write_ppm
from rgbd_recognition.msg import DetectionArray
from rgbd_recognition.srv import TrainObject, TrainObjectRequest
from sensor_msgs.msg import Image

FEWEST = 3  # objects in a frame that is worth a picture
RVIZ = {'rviz': [], 'rejected': ['Rejected hypotheses']}  # picture: displays to switch on
SECONDS_TO_DRAW = 16.0  # without a graphics card; a frame must last longer
SECONDS_TO_START = 15.0


class Frames:
    """The newest images, and which frames hold enough objects."""

    def __init__(self):
        self.changed = threading.Condition()
        self.stamp = None  # of the newest answer with enough objects; guarded by changed
        self.images = {}
        rospy.Subscriber('/recognition/detections', DetectionArray, self.on_detections, queue_size=5)
        for name, topic in (('annotated', 'annotated'), ('segments', 'segmentation/overlay'), ('why', 'why')):
            rospy.Subscriber('/recognition/' + topic, Image, self.on_image, name, queue_size=5)

    def on_detections(self, message):
        with self.changed:
            self.stamp = message.header.stamp if len(message.detections) >= FEWEST else None
            self.changed.notify_all()

    def on_image(self, message, name):
        with self.changed:
            self.images[name] = message
            self.changed.notify_all()

    def wait(self, names=(), seconds=300.0):
        """Until a frame with enough objects is the newest, with the images of these names; returns the images."""
        def there():
            return self.stamp and all(name in self.images and self.images[name].header.stamp == self.stamp
                                      for name in names)
        with self.changed:
            if not self.changed.wait_for(there, seconds):
                raise RuntimeError('no frame with %d objects in %.0f s' % (FEWEST, seconds))
            return dict(self.images)


def save(image, file):
    with tempfile.TemporaryDirectory() as folder:
        ppm = os.path.join(folder, 'image.ppm')
        write_ppm(image, ppm)
        subprocess.run(['convert', ppm, '-quality', '88', file], check=True)
    print('written:', file)


def with_displays(config, displays):
    lines = open(config).read().split('\n')
    for i, line in enumerate(lines):
        if any(line.strip() == 'Name: ' + name for name in displays):
            lines[i + 1] = lines[i + 1].replace('false', 'true')
    return '\n'.join(lines)


def photograph_rviz(config, arguments, until_ready, file):
    """The window as it is a while after `until_ready` has returned."""
    rviz = subprocess.Popen(['rosrun', 'rviz', 'rviz', '-d', config] + arguments,
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        rospy.rostime.wallsleep(SECONDS_TO_START)
        until_ready()
        rospy.rostime.wallsleep(SECONDS_TO_DRAW)
        subprocess.run(['import', '-window', 'root', '-resize', '1100', '-quality', '88', file], check=True)
        print('written:', file)
    finally:
        rviz.terminate()
        rviz.wait()


def photograph_demo(config, folder):
    frames = Frames()
    for name, image in frames.wait(('annotated', 'segments', 'why')).items():
        save(image, os.path.join(folder, name + '.jpg'))

    def next_frame():
        with frames.changed:
            frames.stamp = None
        frames.wait()

    for name, displays in RVIZ.items():
        with tempfile.NamedTemporaryFile('w', suffix='.rviz') as changed:
            changed.write(with_displays(config, displays))
            changed.flush()
            photograph_rviz(changed.name, ['-f', 'camera_rgb_optical_frame', '__ns:=/recognition'], next_frame,
                            os.path.join(folder, name + '.jpg'))


def photograph_training(config, bag, name, folder):
    service = rospy.ServiceProxy('/training/train_object', TrainObject)
    service.wait_for_service(60.0)

    def train():
        answer = service(TrainObjectRequest(name=name, source=TrainObjectRequest.BAG, file=bag,
                                            existing=TrainObjectRequest.OVERWRITE))
        if not answer.success:
            raise RuntimeError(answer.message)

    photograph_rviz(config, [], train, os.path.join(folder, 'training.jpg'))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--rviz', required=True, help='its configuration')
    parser.add_argument('--out', required=True, help='folder for the pictures')
    parser.add_argument('--train', nargs=2, metavar=('BAG', 'NAME'), help='trains this before training.launch')
    arguments = parser.parse_args()
    rospy.init_node('screenshots', anonymous=True, disable_signals=True)
    if arguments.train:
        photograph_training(arguments.rviz, *arguments.train, arguments.out)
    else:
        photograph_demo(arguments.rviz, arguments.out)


if __name__ == '__main__':
    main()
