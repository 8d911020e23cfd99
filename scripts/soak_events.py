#!/usr/bin/env python3
"""What goes on around a running kinect.launch in a long time, and whether it bears that: see scripts/soak."""
import argparse
import os
import random
import shutil
import subprocess
import sys
import threading
import time
import xmlrpc.client

import rosgraph
import rospy
from dynamic_reconfigure.srv import Reconfigure, ReconfigureRequest
from dynamic_reconfigure.msg import DoubleParameter
from rgbd_recognition.msg import DetectionArray
from rgbd_recognition.srv import Detect
from sensor_msgs.msg import Image
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

MANAGER = '/camera/manager'
NAMESPACE = '/recognition/'
LARGEST_GROWTH = 0.05  # of the median resident memory, at the end against warm
LARGEST_SLOWING = 1.5  # of the median latency while nothing is trained, last third against first
TRAINED = 'trained_in_the_soak'
FIRST_ANSWER = 120.0  # seconds
MEMORY_PERIOD = 1.0  # seconds
WARM, LATE = (0.2, 0.3), (0.9, 1.0)  # shares of the time whose memory is compared
OUTPUTS = [('annotated', Image), ('markers', MarkerArray), ('rejected_markers', MarkerArray),
           ('hypotheses', DetectionArray), ('segmentation/overlay', Image), ('segmentation/depth', Image)]


def manager_pid():
    node = rosgraph.Master('/soak').lookupNode(MANAGER)
    return xmlrpc.client.ServerProxy(node).getPid('/soak')[2]


def resident_megabytes(pid):
    with open('/proc/%d/statm' % pid) as file:
        return int(file.read().split()[1]) * os.sysconf('SC_PAGESIZE') / 1e6


def foreign_cpu_seconds(pid):
    """Processor time since the machine started of all but the manager and what this script runs."""
    with open('/proc/stat') as file:
        fields = [int(field) for field in file.readline().split()[1:9]]
    with open('/proc/%d/stat' % pid) as file:
        manager = [int(field) for field in file.read().rsplit(')', 1)[1].split()[11:13]]
    all_busy = sum(fields) - fields[3] - fields[4]  # without idle, waiting
    return (all_busy - sum(manager)) / os.sysconf('SC_CLK_TCK') - sum(os.times()[:4])


def quantile(values, share):
    """The value that `share` of them stay under."""
    values = sorted(values)
    return values[int(share * (len(values) - 1))] if values else float('nan')


class Answers:
    """Every answer with its latency."""

    def __init__(self):
        self.lock = threading.Lock()
        self.stamps = {}  # guarded by lock
        self.twice = 0
        self.latencies = []  # (wall time, seconds, whether an object was being trained)
        self.training = lambda: False
        rospy.Subscriber(NAMESPACE + 'detections', DetectionArray, self.receive, queue_size=50)

    def receive(self, message):
        with self.lock:
            stamp = message.header.stamp.to_nsec()
            self.twice += stamp in self.stamps
            self.stamps[stamp] = len(message.detections)
            seconds = (rospy.Time.now() - message.header.stamp).to_sec()
            self.latencies.append((time.time(), seconds, self.training()))

    def latency(self, share, begin, end, training=None):
        """From the device's stamp to the answer, with which tf goes out; training: only while so, or not."""
        with self.lock:
            inside = [seconds for at, seconds, trained in self.latencies
                      if begin <= at < end and training in (None, trained)]
        return quantile(inside, share)


class Memory:
    """The manager's, all the time."""

    def __init__(self):
        self.samples = []  # (wall time, MB)
        self.pids = set()
        self.failure = None
        threading.Thread(target=self.watch, daemon=True).start()

    def watch(self):
        pid, asked = None, 0.0
        while True:
            now = time.time()
            try:
                if now > asked + 10.0:
                    pid, asked = manager_pid(), now
                    self.pids.add(pid)
                self.samples.append((now, resident_megabytes(pid)))
            except (OSError, rosgraph.MasterException, xmlrpc.client.Error) as error:
                self.failure = error
            time.sleep(MEMORY_PERIOD)

    def between(self, begin, end):
        return [megabytes for at, megabytes in list(self.samples) if begin <= at < end]


class Events:
    """One of these happens every few seconds; what it broke is mended before the next."""

    KINDS = ('listen', 'reconfigure', 'remove_model', 'train', 'unplug', 'stop', 'detect')

    def __init__(self, bus, store, tool, mesh, kinds):
        self.bus, self.store, self.tool, self.mesh, self.kinds = bus, store, tool, mesh, kinds
        self.training = None  # the process
        self.counts = {}
        self.failures = []

    def one(self, rng):
        kind = rng.choice(self.kinds)
        self.counts[kind] = self.counts.get(kind, 0) + 1
        try:
            getattr(self, kind)(rng)
        except (rospy.ServiceException, rospy.ROSException) as error:
            self.failures.append('%s: %s' % (kind, error))
        return kind

    def listen(self, rng):
        topic, kind = rng.choice(OUTPUTS)
        subscriber = rospy.Subscriber(NAMESPACE + topic, kind, lambda message: None, queue_size=1)
        time.sleep(rng.uniform(0.0, 3.0))
        subscriber.unregister()

    def reconfigure(self, rng):
        request = ReconfigureRequest()
        request.config.doubles = [DoubleParameter('surf_hessian_threshold', rng.uniform(4.0, 8.0))]
        rospy.ServiceProxy(NAMESPACE + 'feature_extraction/set_parameters', Reconfigure)(request)

    def remove_model(self, rng):
        name = rng.choice([entry for entry in sorted(os.listdir(self.store)) if not entry.startswith('.')
                           and entry != TRAINED and os.path.isdir(os.path.join(self.store, entry))])
        away = self.store + '_' + name
        shutil.move(os.path.join(self.store, name), away)
        time.sleep(rng.uniform(1.0, 3.0))
        shutil.move(away, os.path.join(self.store, name))
        rospy.ServiceProxy(NAMESPACE + 'reload', Trigger)()

    def train(self, _rng):
        """Begins, and goes on beside other events; what it has trained is removed by the next one."""
        if self.is_training():
            return
        self.end_training()
        self.training = subprocess.Popen(
            [self.tool, '--models', self.store, '--mesh', self.mesh, '--unit', '0.001',
             '--name', TRAINED, '--descriptors', 'surf64'], stdout=subprocess.DEVNULL)

    def is_training(self):
        training = self.training  # read once, as other threads ask
        return training is not None and training.poll() is None

    def end_training(self):
        if not self.training:
            return
        if self.training.wait() != 0:
            self.failures.append('train: ended with %d' % self.training.returncode)
        shutil.rmtree(os.path.join(self.store, TRAINED), ignore_errors=True)
        self.training = None

    def unplug(self, rng):
        plugs = os.listdir(self.bus)
        file = os.path.join(self.bus, plugs[0])
        shutil.move(file, self.bus + '_away')
        time.sleep(rng.uniform(0.5, 3.0))
        shutil.move(self.bus + '_away', file)
        time.sleep(2.0)

    def stop(self, rng):
        rospy.ServiceProxy(NAMESPACE + 'stop', Trigger)()
        time.sleep(rng.uniform(0.0, 2.0))
        rospy.ServiceProxy(NAMESPACE + 'start', Trigger)()

    def detect(self, rng):
        answer = rospy.ServiceProxy(NAMESPACE + 'detect', Detect)([], 20.0)
        if not answer.success:
            self.failures.append('detect: ' + answer.message)


def judge(answers, memory, events, begin, end, foreign):
    third = (end - begin) / 3
    first, last = answers.latency(0.5, begin, begin + third, False), answers.latency(0.5, end - third, end, False)
    warm, late = [quantile(memory.between(*(begin + share * (end - begin) for share in shares)), 0.5)
                  for shares in (WARM, LATE)]
    growth = late / warm - 1.0
    print('answers        %d, %d of them twice, %.1f objects each' % (
        len(answers.stamps), answers.twice, sum(answers.stamps.values()) / max(1, len(answers.stamps))))
    print('latency        median %.3f s, p95 %.3f s; %.3f s while an object was trained' % (
        answers.latency(0.5, begin, end), answers.latency(0.95, begin, end), answers.latency(0.5, begin, end, True)))
    print('               while none was: median %.3f s in the first third, %.3f s in the last' % (first, last))
    print('memory         median %.0f MB when warm, %.0f MB at the end (%+.1f %%), at most %.0f MB' % (
        warm, late, 100.0 * growth, max(memory.between(begin, end))))
    print('events         ' + ', '.join('%s %d' % item for item in sorted(events.counts.items())))
    print('beside it      other processes used %.2f cores: times are fair if that is little' % foreign)
    for failure in events.failures:
        print('failed         ' + failure)
    good = {'answers came': len(answers.stamps) > 0, 'no frame was answered twice': answers.twice == 0,
            'the manager lived': len(memory.pids) == 1 and not memory.failure,
            'memory is flat': growth <= LARGEST_GROWTH, 'latency is stable': last <= LARGEST_SLOWING * first,
            'every call was answered': not events.failures}
    for text, is_so in good.items():
        print('%s %s' % ('ok   ' if is_so else 'WRONG', text))
    return all(good.values())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--minutes', type=float, required=True)
    parser.add_argument('--bus', required=True, help='folder of the virtual Kinects')
    parser.add_argument('--store', required=True, help='the models in use')
    parser.add_argument('--train', required=True, help='the tool')
    parser.add_argument('--mesh', required=True, help='of an object to train, in millimetres')
    parser.add_argument('--events', nargs='+', choices=Events.KINDS, default=Events.KINDS, help='only these')
    parser.add_argument('--verbose', action='store_true', help='memory after each event')
    parser.add_argument('--seed', type=int, default=1)
    arguments = parser.parse_args()
    rospy.init_node('soak', anonymous=True, disable_signals=True)
    rospy.wait_for_service(NAMESPACE + 'detect', 60.0)
    events = Events(arguments.bus, arguments.store, arguments.train, arguments.mesh, arguments.events)
    rng = random.Random(arguments.seed)
    answers = Answers()
    answers.training = events.is_training
    started = time.time()
    while not answers.stamps:
        if time.time() > started + FIRST_ANSWER:
            sys.exit('no answer in %.0f s: see roslaunch.log' % FIRST_ANSWER)
        time.sleep(0.1)
    pid, begin, memory = manager_pid(), time.time(), Memory()
    foreign = foreign_cpu_seconds(pid)
    end = begin + 60.0 * arguments.minutes
    while time.time() < end and not memory.failure:
        kind = events.one(rng)
        time.sleep(rng.uniform(1.0, 4.0))
        if arguments.verbose:
            print('%6.1f s %7.1f MB after %s' % (time.time() - begin, resident_megabytes(pid), kind), flush=True)
    events.end_training()
    foreign = (foreign_cpu_seconds(pid) - foreign) / (time.time() - begin) if not memory.failure else float('nan')
    return 0 if judge(answers, memory, events, begin, time.time(), foreign) else 1


if __name__ == '__main__':
    sys.exit(main())
