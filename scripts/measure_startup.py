#!/usr/bin/env python3
"""Time from roslaunch to the first detection, by kinect.launch and a virtual Kinect, with the first models of a store:

    scripts/measure_startup.py --models STORE --count 35 --scene test/data/demo/test_primesense/000001

Each line is an event's time since roslaunch was called, in seconds: of all runs the least and the median.
"""
import argparse
import os
import statistics
import subprocess
import tempfile
import threading
import time

PORT = '11441'
os.environ['ROS_MASTER_URI'] = 'http://localhost:' + PORT
import rosgraph
import rospy
from rgbd_recognition.msg import DetectionArray, StageTiming
from sensor_msgs.msg import CameraInfo

LONGEST = 120.0  # seconds


def some_models(store, count, folder):
    names = sorted(name for name in os.listdir(store) if os.path.isdir(os.path.join(store, name)) and name[0] != '.')
    for name in names[:count]:
        os.symlink(os.path.join(os.path.abspath(store), name), os.path.join(folder, name))


class Events:
    """When each event was seen first; callbacks come from rospy's threads."""

    def __init__(self):
        self.begin = time.monotonic()
        self.lock = threading.Lock()
        self.times = {}
        self.detected = threading.Event()

    def note(self, event):
        with self.lock:
            self.times.setdefault(event, time.monotonic() - self.begin)

    def listen(self):
        rospy.Subscriber('/camera/rgb/camera_info', CameraInfo, lambda _: self.note('camera: first frame'))
        rospy.Subscriber('/recognition/timing', StageTiming, lambda message: self.note(message.stage + ': first frame'))
        rospy.Subscriber('/recognition/detections', DetectionArray, self.on_detections)

    def on_detections(self, message):
        self.note('first answer')
        if message.detections:
            self.note('first detection')
            self.detected.set()


def wait_for(condition):
    end = time.monotonic() + LONGEST
    while not condition():
        if time.monotonic() > end:
            raise RuntimeError('nothing came within %.0f s' % LONGEST)
        time.sleep(0.02)


def run_once(arguments):
    """Prints the events of one start, as it is a process of its own: rospy knows one master in its life."""
    with tempfile.TemporaryDirectory() as folder:
        store = os.path.join(folder, 'store')
        os.mkdir(store)
        some_models(arguments.models, arguments.count, store)
        events = Events()
        log = open(os.path.join(folder, 'roslaunch.txt'), 'w')
        launch = subprocess.Popen(['roslaunch', '-p', PORT, 'rgbd_recognition', 'kinect.launch', 'models:=' + store,
                                   'device_id:=virtual:' + os.path.abspath(arguments.scene), *arguments.launch],
                                  stdout=log, stderr=log, env=dict(os.environ, ROS_HOME=folder))
        try:
            wait_for(rosgraph.is_master_online)
            events.note('master')
            rospy.init_node('measure_startup', anonymous=True, disable_signals=True)
            events.listen()
            wait_for(events.detected.is_set)
        except RuntimeError as error:
            raise SystemExit('%s; roslaunch says:\n%s' % (error, open(log.name).read()))
        finally:
            launch.terminate()
            launch.wait()
    for event, seconds in events.times.items():
        print('%s\t%.3f' % (event, seconds))


def report(runs):
    print('load %.1f %.1f %.1f, %d runs' % (*os.getloadavg(), len(runs)))
    for event in sorted(runs[0], key=runs[0].get):
        times = [run[event] for run in runs if event in run]
        print('%-42s %6.1f %6.1f' % (event, min(times), statistics.median(times)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--models', required=True, help='store')
    parser.add_argument('--count', type=int, default=4, help='models of it, by name')
    parser.add_argument('--scene', required=True, help='BOP scene that the virtual Kinect plays')
    parser.add_argument('--runs', type=int, default=5)
    parser.add_argument('--launch', nargs='*', default=[], help="kinect.launch's arguments, e.g. tracking:=false")
    parser.add_argument('--once', action='store_true', help='one run, event by event')
    arguments = parser.parse_args()
    if arguments.once:
        return run_once(arguments)
    runs = []
    for _ in range(arguments.runs):
        command = [__file__, '--once', '--models', arguments.models, '--count', str(arguments.count),
                   '--scene', arguments.scene, '--launch', *arguments.launch]
        told = subprocess.run(command, stdout=subprocess.PIPE, universal_newlines=True, check=True).stdout
        runs.append({event: float(seconds) for event, seconds in (line.split('\t') for line in told.splitlines())})
    report(runs)


if __name__ == '__main__':
    main()
