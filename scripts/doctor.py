#!/usr/bin/env python3
"""Why is nothing detected? Looks at a running recognition and its camera, and says in plain words what to do.

Exits 0 if all is well, 1 if something is wrong, 2 if there is no ROS master.
"""
import argparse
import math
import os
import struct
import sys
import threading
import time

import rosgraph
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from rgbd_recognition.msg import DetectionArray, SceneFeatures, Segmentation
from sensor_msgs.msg import CameraInfo, Image

COLOR_ENCODINGS = ('rgb8', 'bgr8', 'rgba8', 'bgra8', 'mono8', '8UC1', '8UC3', '8UC4', 'rgb16', 'bgr16', 'rgba16', 'bgra16',
                   'mono16', 'yuv422', 'yuv422_yuy2') + tuple(
                       'bayer_%s%d' % (name, bits) for name in ('rggb', 'bggr', 'gbrg', 'grbg') for bits in (8, 16))
DEPTH_ENCODINGS = ('16UC1', 'mono16', '32FC1')
STAGES = ('segmentation', 'feature_extraction', 'hypothesis_generation', 'reprojection_verification')
SLOWEST_CAMERA = 1.0  # Hz; slower than this is told
LARGEST_AGE = 1.0  # seconds between an image's stamp and its arrival
LARGEST_FUTURE = 0.1  # seconds that a stamp may be ahead
LARGEST_INTERVAL = 0.02  # seconds; ~max_interval of segmentation
FEW_FEATURES = 50
REASONS = {  # Detection.rejection
    'consistency': 'colour or depth do not agree with the model: is the light like in training, is depth registered?',
    'indistinct': 'the object looks the same a little beside this pose: come nearer, or turn a textured side to the camera',
    'too_little_seen': 'too little of the object is visible: is it occluded or at the edge of the image?',
    'free_space': 'the camera sees through where the object should be: is the model the size of the object?',
    'consensus': 'too few features agree: come nearer, or train with more views',
    'out_of_view': 'the pose lies outside the image'}


class Verdict:
    """Lines for the user; each trouble comes with what to do."""

    def __init__(self):
        self.lines = []
        self.notes = 0
        self.troubles = 0

    def good(self, text):
        self.lines.append('  ok    ' + text)

    def note(self, text, advice):
        self.notes += 1
        self.lines.append('  note  %s\n        -> %s' % (text, advice))

    def bad(self, text, advice):
        self.troubles += 1
        self.lines.append('  WRONG %s\n        -> %s' % (text, advice))

    def section(self, title):
        self.lines.append(title)


class Listener:
    """Keeps what a topic brings."""

    def __init__(self, topic, message_type):
        self.topic = topic
        self.messages = []
        self.arrivals = []
        self.lock = threading.Lock()
        self.subscriber = rospy.Subscriber(topic, message_type, self.receive, queue_size=10)

    def receive(self, message):
        with self.lock:
            self.messages.append(message)
            self.arrivals.append(rospy.get_rostime())

    def last(self):
        with self.lock:
            return self.messages[-1] if self.messages else None

    def rate(self, seconds):
        return len(self.messages) / seconds


def check_type(topic, wanted, types, verdict):
    """Whether the topic is published, with the right type."""
    if topic not in types:
        similar = sorted(name for name, kind in types.items() if kind == wanted)
        verdict.bad('nobody publishes %s' % topic,
                    'start the camera, or name its topics (recognition.launch topics:= color:= depth:= '
                    'camera_info:=); of this type there are: %s' % (', '.join(similar) or 'none'))
        return False
    if types[topic] != wanted:
        verdict.bad('%s is a %s, not a %s' % (topic, types[topic], wanted),
                    'name another topic; for clouds use_points:=true')
        return False
    return True


def check_stream(listener, seconds, verdict):
    """Rate and stamps of one topic; its last message, or None."""
    message = listener.last()
    if message is None:
        verdict.bad('%s is advertised, but no message came in %.0f s' % (listener.topic, seconds),
                    'look at the camera driver: is the camera plugged in, does it stream (rostopic hz)?')
        return None
    rate = listener.rate(seconds)
    if rate < SLOWEST_CAMERA:
        verdict.note('%s comes at %.2f Hz only' % (listener.topic, rate), 'a live camera gives 15 to 30 Hz')
    age = (listener.arrivals[-1] - message.header.stamp).to_sec()
    if message.header.stamp.is_zero():
        verdict.bad('%s has no time stamps' % listener.topic,
                    'the driver must stamp its messages; without stamps nothing can be paired')
    elif age > LARGEST_AGE or age < -LARGEST_FUTURE:
        verdict.note("%s's stamps are %.1f s %s this machine's clock" % (
            listener.topic, abs(age), 'behind' if age > 0 else 'ahead of'),
            'detections come, but tf is asked for that time, and finds nothing; two machines: synchronise their clocks '
            '(chrony); recording: play it with --clock and use_sim_time')
    verdict.good('%s at %.1f Hz' % (listener.topic, rate))
    return message


def check_images(topic, color, depth, info, verdict):
    """Whether last messages, with colour from `topic`, make up an RGB-D frame."""
    if color.encoding not in COLOR_ENCODINGS:
        verdict.bad("colour has encoding '%s'" % color.encoding,
                    'allowed are %s: take another topic, or convert (image_proc debayers)' % ', '.join(COLOR_ENCODINGS))
    if depth.encoding not in DEPTH_ENCODINGS:
        verdict.bad("depth has encoding '%s'" % depth.encoding, 'allowed are %s' % ', '.join(DEPTH_ENCODINGS))
    if not color.header.frame_id.strip('/'):
        verdict.bad('colour has no frame_id', "set it in the camera's driver: results would have no frame")
    elif color.header.frame_id.lstrip('/') != depth.header.frame_id.lstrip('/'):
        verdict.bad("depth is in frame '%s', colour in '%s': depth is not registered" % (
            depth.header.frame_id, color.header.frame_id),
            'turn on depth registration (openni2: depth_registration, RealSense: align_depth, Azure: depth_to_rgb)')
    elif depth.width == 0 or color.width % depth.width != 0:
        verdict.bad('depth is %dx%d, colour %dx%d: no whole multiple' % (
            depth.width, depth.height, color.width, color.height),
            'choose modes of one field of view, and registered depth')
    if (info.width, info.height) != (color.width, color.height):
        verdict.bad('camera info is for %dx%d, the image has %dx%d' % (
            info.width, info.height, color.width, color.height),
            'calibrate for this mode, or take the camera info that belongs to the colour topic')
    if not info.P[0] > 0.0:
        verdict.bad('camera info has no calibration (P is zero)',
                    'calibrate (camera_calibration), or take the camera info of another topic')
    else:
        check_centre(info, verdict)
    if any(value != 0.0 for value in info.D) and 'rect' not in topic:
        verdict.note('the lens distorts (D is not zero), and %s does not look rectified' % topic,
                     'use image_proc: rgb/image_rect_color')
    check_depth(depth, verdict)


def check_centre(info, verdict):
    """The bounds of src/core/frame_check.cpp."""
    x, y = (info.P[2] + 0.5) / max(1, info.width), (info.P[6] + 0.5) / max(1, info.height)
    is_outside = not (0.0 <= x <= 1.0 and 0.0 <= y <= 1.0)
    if info.roi.width == 0 and (is_outside or max(x, y) < 0.3 or min(x, y) > 0.7):
        verdict.bad('the principal point (%.0f, %.0f) is %s the %dx%d picture' % (
            info.P[2], info.P[6], 'outside of' if is_outside else 'in a corner of', info.width, info.height),
            'take the camera info of this resolution, or calibrate for it')


def check_depth(depth, verdict):
    """Whether enough is measured, and in the range of a camera: the bounds of src/core/frame_check.cpp."""
    values, total = depth_values(depth)
    if total == 0:
        return
    share = len(values) / total
    if share < 0.1:
        verdict.bad('only %.0f %% of the depth image is measured' % (100.0 * share),
                    'the scene should be 0.5 to 2 m away, out of sunlight; uncover the projector')
    if not values:
        return
    values.sort()
    near, far = values[len(values) // 20], values[-1 - len(values) // 20]
    if near > 4.0 or far < 0.2:
        verdict.bad('depth is from %.2g to %.2g m, where nothing is recognised' % (near, far),
                    'is its unit right? 16UC1 is in millimetres, 32FC1 in metres')


def depth_values(depth):
    """Measured depth in metres from every 50th pixel, and how many were looked at; 0 if it cannot be told."""
    size, code = (4, 'f') if depth.encoding == '32FC1' else (2, 'H')
    if depth.encoding not in DEPTH_ENCODINGS or len(depth.data) < depth.step * depth.height:
        return [], 0
    order = '>' if depth.is_bigendian else '<'
    scale = 1.0 if depth.encoding == '32FC1' else 0.001
    values, total = [], 0
    for v in range(0, depth.height, 10):
        for u in range(0, depth.width, 5):
            value = struct.unpack_from(order + code, depth.data, v * depth.step + u * size)[0]
            if math.isfinite(value) and value > 0:
                values.append(scale * value)
            total += 1
    return values, total


def check_pairing(color, depth, verdict):
    interval = nearest_interval(color, depth)
    if interval is not None and interval > LARGEST_INTERVAL:
        verdict.bad('stamps of colour and depth differ by %.0f ms' % (1e3 * interval),
                    'turn on colour-depth synchronisation, or raise segmentation/max_interval (default %.0f ms)' % (
                        1e3 * LARGEST_INTERVAL))


def nearest_interval(color, depth):
    """Median distance in time from a colour image to its nearest depth image, seconds; None without messages."""
    stamps = [message.header.stamp.to_sec() for message in depth.messages]
    if not stamps:
        return None
    distances = sorted(min(abs(message.header.stamp.to_sec() - stamp) for stamp in stamps)
                       for message in color.messages)
    return distances[len(distances) // 2] if distances else None


def check_camera(listeners, types, seconds, verdict):
    wanted = {'color': 'sensor_msgs/Image', 'depth': 'sensor_msgs/Image', 'camera_info': 'sensor_msgs/CameraInfo'}
    messages = {}
    for name, listener in listeners.items():
        if check_type(listener.topic, wanted[name], types, verdict):
            messages[name] = check_stream(listener, seconds, verdict)
    if all(messages.get(name) for name in wanted):
        check_images(listeners['color'].topic, messages['color'], messages['depth'], messages['camera_info'], verdict)
        check_pairing(listeners['color'], listeners['depth'], verdict)


def check_store(store, verdict):
    if store is None:
        verdict.bad('no folder of models is set', 'recognition.launch models:=FOLDER')
        return
    if not os.path.isdir(store):
        verdict.note('%s is no folder on this machine' % store,
                     'if recognition runs on another machine all may be well')
        return
    names = sorted(name for name in os.listdir(store) if os.path.isfile(os.path.join(store, name, 'model.yaml')))
    if names:
        verdict.good('%d models in %s: %s' % (
            len(names), store, ', '.join(names[:8]) + (' ...' if len(names) > 8 else '')))
    else:
        verdict.bad('%s holds no models' % store,
                    'train some: rosrun rgbd_recognition train --models %s --bop FOLDER' % store)


def stages_of(diagnostics, namespace):
    """{stage: (level, message, {key: value})}, the last told."""
    stages = {}
    for array in diagnostics.messages:
        for status in array.status:
            name = status.name.split(':')[0].strip('/')
            for stage in STAGES:
                if name.endswith(namespace.strip('/') + '/' + stage):
                    values = {value.key: value.value for value in status.values}
                    stages[stage] = (ord(status.level) if isinstance(status.level, bytes) else status.level,
                                     status.message, values)
    return stages


def check_stages(stages, verdict):
    for stage in STAGES:
        if stage not in stages:
            verdict.bad('stage %s does not run' % stage,
                        'look at the launch output: its FATAL line names a parameter or the models')
            continue
        level, message, values = stages[stage]
        text = '%s: %s (%s frames, %s dropped, %s bad inputs)' % (
            stage, message, values.get('frames processed'), values.get('frames dropped'), values.get('bad inputs'))
        if message == 'stopped':
            verdict.note(text, 'call the service start, or detect')
        elif level == 0:
            verdict.good(text)
        else:
            verdict.bad(text, 'last bad input: %s' % (values.get('last bad input') or '-'))
        if 'model skipped' in values:
            verdict.bad('a model is skipped: %s' % values['model skipped'], 'train it again')


def check_features(features, verdict):
    with_depth, without = len(features.image.x), len(features.without_depth.x)
    if with_depth >= FEW_FEATURES:
        verdict.good('%d features in the last frame' % with_depth)
    elif without >= FEW_FEATURES:
        verdict.bad('only %d of %d features in the last frame have depth' % (with_depth, with_depth + without),
                    'depth is missing where the texture is: see what is said of depth above; shiny, black and glass '
                    'things give none')
    else:
        verdict.bad('only %d features in the last frame' % with_depth,
                    'more light, sharper images, a higher colour resolution, or come nearer')


def check_results(results, camera_is_good, verdict):
    segmentation = results['segmentation'].last()
    features = results['features'].last()
    detections = results['detections'].last()
    if segmentation is not None:
        if segmentation.patches:
            verdict.good('%d patches in the last frame' % len(segmentation.patches))
        else:
            verdict.bad('no patch in the depth image',
                        'objects must stand clear of walls, 0.5 to 2 m away, and be as large as a trained one'
                        if camera_is_good else 'first mend what is wrong with the camera, above')
    if features is not None and (segmentation is None or segmentation.patches):
        check_features(features, verdict)  # without patches nobody looks for any
    if detections is None:
        verdict.bad('no answer to any frame', 'see above; stages that do not run, or the camera')
        return
    names = ['%s (%.2f)' % (detection.object, detection.confidence) for detection in detections.detections]
    if names:
        verdict.good('found in the last frame: ' + ', '.join(names))
    else:
        explain_rejections(results['hypotheses'].last(), verdict)
    for text in detections.left_out:
        verdict.note('left out for want of time: ' + text,
                     'raise budget_ms (of the pipeline, of hypothesis_generation), or train fewer objects')


def explain_rejections(hypotheses, verdict):
    rejected = sorted(hypotheses.detections if hypotheses else [], key=lambda d: d.confidence, reverse=True)
    if not rejected:
        verdict.bad('nothing found, and no hypothesis either',
                    'is a trained object in view? Was the store trained for this descriptor?')
        return
    best = rejected[0]
    verdict.bad("nothing found; nearest to it was %s (confidence %.2f, consensus %d), rejected: %s" % (
        best.object, best.confidence, best.consensus, best.rejection),
        REASONS.get(best.rejection, 'see doc/troubleshooting.md'))


def camera_topics(arguments, stages):
    """As the pipeline itself tells, else as the arguments do."""
    values = stages.get('segmentation', (0, '', {}))[2]
    told = [values.get(key, '').split(' ')[0] for key in ('colour', 'depth', 'camera info')]
    given = (arguments.color, arguments.depth, arguments.camera_info)
    return {name: value or tell or standard for name, value, tell, standard in zip(
        ('color', 'depth', 'camera_info'), given, told,
        ('/camera/rgb/image_rect_color', '/camera/depth_registered/image_raw', '/camera/rgb/camera_info'))}


def examine(arguments):
    namespace = rosgraph.names.make_global_ns('/' + arguments.namespace.strip('/'))
    diagnostics = Listener('/diagnostics', DiagnosticArray)
    results = {'detections': Listener(namespace + 'detections', DetectionArray),  # also what wakes a lazy pipeline
               'hypotheses': Listener(namespace + 'hypotheses', DetectionArray),
               'segmentation': Listener(namespace + 'hypothesis_generation/segmentation', Segmentation),
               'features': Listener(namespace + 'hypothesis_generation/features', SceneFeatures)}
    time.sleep(arguments.seconds)  # of the wall: a recording's clock may stand still
    stages = stages_of(diagnostics, namespace)
    kinds = {'color': Image, 'depth': Image, 'camera_info': CameraInfo}
    listeners = {name: Listener(topic, kinds[name]) for name, topic in camera_topics(arguments, stages).items()}
    time.sleep(arguments.seconds)
    stages = stages_of(diagnostics, namespace)
    types = dict(rospy.get_published_topics())

    verdict = Verdict()
    verdict.section('camera')
    check_camera(listeners, types, arguments.seconds, verdict)
    camera_is_good = verdict.troubles == 0
    verdict.section('models')
    check_store(rospy.get_param(namespace + 'models', None), verdict)
    verdict.section('stages in %s' % namespace)
    if stages:
        check_stages(stages, verdict)
        verdict.section('results')
        check_results(results, camera_is_good, verdict)
    else:
        verdict.bad('recognition does not run in %s' % namespace,
                    'roslaunch rgbd_recognition recognition.launch models:=FOLDER, or give --namespace')
    return verdict


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--namespace', default='recognition', help='of the pipeline (default: recognition)')
    parser.add_argument('--color', help="colour topic, if not the pipeline's or openni's")
    parser.add_argument('--depth', help='registered depth image')
    parser.add_argument('--camera-info', help='of the colour camera')
    parser.add_argument('--seconds', type=float, default=5.0, help='to look at the topics, twice (default: 5)')
    arguments = parser.parse_args(rospy.myargv()[1:])
    if not rosgraph.is_master_online():
        print('WRONG no ROS master at %s\n      -> start roscore or a launch file, or set ROS_MASTER_URI' %
              os.environ.get('ROS_MASTER_URI'))
        return 2
    rospy.init_node('doctor', anonymous=True, disable_signals=True)
    verdict = examine(arguments)
    print('\n'.join(verdict.lines))
    if verdict.troubles:
        print('%d thing%s to do' % (verdict.troubles, '' if verdict.troubles == 1 else 's'))
    elif verdict.notes:
        print('it works, with %d thing%s to mind, noted above' % (verdict.notes, '' if verdict.notes == 1 else 's'))
    else:
        print('all is well')
    return 1 if verdict.troubles else 0


if __name__ == '__main__':
    sys.exit(main())
