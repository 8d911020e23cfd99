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
LARGEST_GROWTH = 0.05  # of the resident memory, after the warm-up
LARGEST_SLOWING = 1.5  # of the median latency, last third against first
TRAINED = 'trained_in_the_soak'
FIRST_ANSWER = 120.0  # seconds
WARM_UP = 0.25  # share of the time in which memory may still grow
OUTPUTS = [('annotated', Image), ('markers', MarkerArray), ('rejected_markers', MarkerArray),
           ('hypotheses', DetectionArray), ('segmentation/overlay', Image), ('segmentation/depth', Image)]


def manager_pid():
    node = rosgraph.Master('/soak').lookupNode(MANAGER)
    return xmlrpc.client.ServerProxy(node).getPid('/soak')[2]


def resident_megabytes(pid):
    with open('/proc/%d/statm' % pid) as file:
        return int(file.read().split()[1]) * os.sysconf('SC_PAGESIZE') / 1e6


class Answers:
    """Every answer with its latency."""

    def __init__(self):
        self.lock = threading.Lock()
        self.stamps = {}  # guarded by lock
        self.twice = 0
        self.latencies = []  # (wall time, seconds)
        rospy.Subscriber(NAMESPACE + 'detections', DetectionArray, self.receive, queue_size=50)

    def receive(self, message):
        with self.lock:
            stamp = message.header.stamp.to_nsec()
            self.twice += stamp in self.stamps
            self.stamps[stamp] = len(message.detections)
            self.latencies.append((time.time(), (rospy.Time.now() - message.header.stamp).to_sec()))

    def latency(self, share, begin, end):
        """From the device's stamp to the answer, with which tf goes out: the value that `share` of them stay under."""
        with self.lock:
            inside = sorted(seconds for at, seconds in self.latencies if begin <= at < end)
        return inside[int(share * (len(inside) - 1))] if inside else float('nan')


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
        if self.training and self.training.poll() is None:
            return
        self.end_training()
        self.training = subprocess.Popen(
            [self.tool, '--models', self.store, '--mesh', self.mesh, '--unit', '0.001',
             '--name', TRAINED, '--descriptors', 'surf64'], stdout=subprocess.DEVNULL)

    def end_training(self):
        if not self.training:
            return
        if self.training.wait() != 0:
            self.failures.append('train: ended with %d' % self.training.returncode)
        shutil.rmtree(os.path.join(self.store, TRAINED), ignore_errors=True)

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


def judge(answers, memory, events, begin, end, pids):
    third = (end - begin) / 3
    first, last = answers.latency(0.5, begin, begin + third), answers.latency(0.5, end - third, end)
    warm = next(megabytes for at, megabytes in memory if at >= begin + WARM_UP * (end - begin))
    growth = memory[-1][1] / warm - 1.0
    print('answers        %d, %d of them twice, %.1f objects each' % (
        len(answers.stamps), answers.twice, sum(answers.stamps.values()) / max(1, len(answers.stamps))))
    print('latency        median %.3f s, p95 %.3f s; median %.3f s in the first third, %.3f s in the last' % (
        answers.latency(0.5, begin, end), answers.latency(0.95, begin, end), first, last))
    print('memory         %.0f MB at first, %.0f MB warm, %.0f MB at the end (%+.1f %%), at most %.0f MB' % (
        memory[0][1], warm, memory[-1][1], 100.0 * growth, max(megabytes for _, megabytes in memory)))
    print('events         ' + ', '.join('%s %d' % item for item in sorted(events.counts.items())))
    for failure in events.failures:
        print('failed         ' + failure)
    good = {'answers came': len(answers.stamps) > 0, 'no frame was answered twice': answers.twice == 0,
            'the manager lived': len(pids) == 1, 'memory is flat': growth <= LARGEST_GROWTH,
            'latency is stable': last <= LARGEST_SLOWING * first, 'every call was answered': not events.failures}
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
    started = time.time()
    while not answers.stamps:
        if time.time() > started + FIRST_ANSWER:
            sys.exit('no answer in %.0f s: see roslaunch.log' % FIRST_ANSWER)
        time.sleep(0.1)
    begin, memory, pids = time.time(), [], set()
    end = begin + 60.0 * arguments.minutes
    while time.time() < end:
        pids.add(manager_pid())
        memory.append((time.time(), resident_megabytes(manager_pid())))
        kind = events.one(rng)
        time.sleep(rng.uniform(1.0, 4.0))
        if arguments.verbose:
            now = time.time() - begin
            print('%6.1f s %7.1f MB after %s' % (now, resident_megabytes(manager_pid()), kind), flush=True)
    events.end_training()
    memory.append((time.time(), resident_megabytes(manager_pid())))
    return 0 if judge(answers, memory, events, begin, end, pids) else 1


if __name__ == '__main__':
    sys.exit(main())
