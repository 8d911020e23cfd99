#!/usr/bin/env python3
"""What recognition costs a robot's computer: processor time of kinect.launch's manager with a virtual Kinect, in each
of the ways to limit it, while a tf listener is there:

    scripts/measure_load.py --models STORE --scene test/data/demo/test_primesense/000001

Processor time hardly depends on what else runs, but for what waits: a pipeline at work takes all the time that it gets.
"""
import argparse
import os
import subprocess
import tempfile
import time

PORT = '11443'
ENVIRONMENT = dict(os.environ, ROS_MASTER_URI='http://localhost:' + PORT)
WAYS = (['tracking:=false'], ['tracking:=true'], ['tracking:=false', 'publish_tf:=false'], ['on_demand:=true'],
        ['tracking:=false', 'max_rate:=2'], ['tracking:=false', 'rest:=5'])
SECONDS_TO_START = 25.0
TICKS = os.sysconf('SC_CLK_TCK')


def manager():
    """Process id of the camera's nodelet manager, in which all stages are."""
    for pid in filter(str.isdigit, os.listdir('/proc')):
        try:
            with open('/proc/%s/cmdline' % pid) as file, open('/proc/%s/environ' % pid) as environment:
                if 'nodelet\0manager\0' in file.read() and ':' + PORT in environment.read():
                    return pid
        except OSError:  # ended meanwhile, or another user's
            pass
    raise SystemExit('there is no manager: see what roslaunch says')


def processor_seconds(pid):
    with open('/proc/%s/stat' % pid) as file:
        fields = file.read().rpartition(')')[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def measure(way, arguments):
    """Share of one processor."""
    with tempfile.TemporaryDirectory() as folder, open(os.path.join(folder, 'told.txt'), 'w') as told:
        environment = dict(ENVIRONMENT, ROS_HOME=folder)
        processes = [subprocess.Popen(command, stdout=told, stderr=told, env=environment) for command in (
            ['roslaunch', '-p', PORT, 'rgbd_recognition', 'kinect.launch',
             'models:=' + os.path.abspath(arguments.models), 'device_id:=virtual:' + os.path.abspath(arguments.scene), *way],
            ['sh', '-c', 'until rostopic list >/dev/null 2>&1; do sleep 1; done; exec rostopic echo /tf'])]
        try:
            time.sleep(SECONDS_TO_START)
            pid = manager()
            before, begin = processor_seconds(pid), time.monotonic()
            time.sleep(arguments.seconds)
            return (processor_seconds(pid) - before) / (time.monotonic() - begin)
        finally:
            for process in reversed(processes):
                process.terminate()
                process.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--models', required=True, help='store')
    parser.add_argument('--scene', required=True, help='BOP scene that the virtual Kinect plays')
    parser.add_argument('--seconds', type=float, default=20)
    arguments = parser.parse_args()
    for way in WAYS:
        share = 100 * measure(way, arguments)
        print('%-36s %5.0f %% of a processor (load %.1f)' % (' '.join(way), share, os.getloadavg()[0]), flush=True)


if __name__ == '__main__':
    main()
