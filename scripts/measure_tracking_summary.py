#!/usr/bin/env python3
"""What scripts/measure_tracking measures, beside a launch file with tracking that runs already:

    scripts/measure_tracking_summary.py [--seconds 60] [--summary FILE] [--camera camera] [--namespace recognition]

Latency needs stamps of this machine's clock.
"""
import argparse
import json
import os
import threading

import rosgraph
import rospy
from rgbd_recognition.msg import DetectionArray, TrackArray
from sensor_msgs.msg import CameraInfo
from tf2_msgs.msg import TFMessage
from xmlrpc.client import ServerProxy


def quantile(values, share):
    values = sorted(values)
    return values[int(share * (len(values) - 1) + 0.5)] if values else float('nan')


def process_of(node):
    """Its number, as the node itself tells."""
    uri = rosgraph.Master(rospy.get_name()).lookupNode(node)
    code, message, pid = ServerProxy(uri).getPid(rospy.get_name())
    if code != 1:
        raise RuntimeError('%s does not tell its process: %s' % (node, message))
    return pid


def cpu_seconds(pid):
    with open('/proc/%d/stat' % pid) as file:
        fields = file.read().rsplit(')', 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


class Listener:
    """What the topics tell; callbacks come from rospy's threads."""

    def __init__(self, camera, namespace):
        self.lock = threading.Lock()
        self.restart()
        self.subscribers = [
            rospy.Subscriber('/%s/rgb/camera_info' % camera, CameraInfo, self.on_frame, queue_size=100),
            rospy.Subscriber('/%s/detections' % namespace, DetectionArray, self.on_detections, queue_size=100),
            rospy.Subscriber('/%s/tracks' % namespace, TrackArray, self.on_tracks, queue_size=100),
            rospy.Subscriber('/tf', TFMessage, self.on_tf, queue_size=100)]

    def restart(self):
        with self.lock:
            self.shown, self.answered, self.latency = set(), set(), []
            self.tracks, self.found, self.lost = [], 0, {}

    def on_frame(self, message):
        with self.lock:
            self.shown.add(message.header.stamp)

    def on_detections(self, message):
        with self.lock:
            self.answered.add(message.header.stamp)

    def on_tf(self, message):
        with self.lock:
            self.latency.append((rospy.Time.now() - message.transforms[0].header.stamp).to_sec())

    def on_tracks(self, message):
        with self.lock:
            self.tracks.append(len(message.tracks))
            self.found += len(message.found)
            for track in message.lost:
                self.lost[track.reason] = self.lost.get(track.reason, 0) + 1


def wait_for_tracks(listener, seconds):
    end = rospy.Time.now() + rospy.Duration(seconds)
    while not rospy.is_shutdown() and rospy.Time.now() < end:
        with listener.lock:
            if listener.tracks and listener.tracks[-1] > 0:
                return
        rospy.sleep(0.1)
    raise SystemExit('measure_tracking: no track within %d s; see roslaunch.log' % seconds)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--seconds', type=float, default=60)
    parser.add_argument('--summary', help='file for the figures, as JSON')
    parser.add_argument('--camera', default='camera')
    parser.add_argument('--namespace', default='recognition')
    parser.add_argument('--patience', type=float, default=180, help='seconds until the first track, at most')
    arguments = parser.parse_args(rospy.myargv()[1:])
    rospy.init_node('measure_tracking', anonymous=True)
    listener = Listener(arguments.camera, arguments.namespace)
    wait_for_tracks(listener, arguments.patience)
    rospy.sleep(2)
    pid = process_of('/%s/manager' % arguments.camera)
    listener.restart()
    before, start = cpu_seconds(pid), rospy.Time.now()
    rospy.sleep(arguments.seconds)
    cpu, seconds = cpu_seconds(pid) - before, (rospy.Time.now() - start).to_sec()
    with listener.lock:
        summary = {
            'rate_hz': round(len(listener.answered) / seconds, 2),
            'latency_ms_p50': round(1e3 * quantile(listener.latency, 0.5), 1),
            'latency_ms_p95': round(1e3 * quantile(listener.latency, 0.95), 1),
            'cpu_cores': round(cpu / seconds, 2),
            'lost_frames': len(listener.shown - listener.answered),
            'shown_frames': len(listener.shown),
            'tracks_median': quantile(listener.tracks, 0.5) if listener.tracks else 0,
            'tracks_found': listener.found,
            'tracks_lost': listener.lost}
    text = json.dumps(summary, indent=1)
    print(text)
    if arguments.summary:
        with open(arguments.summary, 'w') as file:
            file.write(text + '\n')


if __name__ == '__main__':
    main()
