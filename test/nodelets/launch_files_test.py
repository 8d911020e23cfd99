#!/usr/bin/env python3
"""Every launch file loads with every set of topics, and what it names exists."""
import glob
import os
import unittest
import xml.etree.ElementTree as ElementTree

import roslaunch
import rospkg

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
NEEDED = {'recognition': ['models:=/store'], 'replay': ['models:=/store', 'bag:=/a.bag'], 'demo': ['models:=/store'],
          'kinect': ['models:=/store'], 'sharded': ['models:=/store'], 'training': ['models:=/store'], 'openni2': []}
TOPICS = ['openni', 'challenge', 'realsense', 'azure']


def load(name, arguments):
    config = roslaunch.config.ROSLaunchConfig()
    file = os.path.join(PACKAGE, 'launch', name + '.launch')
    roslaunch.XmlLoader(resolve_anon=False).load(file, config, argv=arguments, verbose=False)
    return config


def declared_nodelets():
    classes = ElementTree.parse(os.path.join(PACKAGE, 'nodelet_plugins.xml')).getroot().iter('class')
    return {entry.get('name') for entry in classes}


def nodes_named(config):
    return {node.name: node for node in config.nodes}


class LaunchFilesTest(unittest.TestCase):
    def test_all_are_tested(self):
        found = glob.glob(os.path.join(PACKAGE, 'launch', '*.launch'))
        files = {os.path.splitext(os.path.basename(file))[0] for file in found}
        self.assertEqual(files, set(NEEDED))

    def test_nodelets_and_packages_exist(self):
        packages = rospkg.RosPack()
        for name, arguments in NEEDED.items():
            for node in load(name, arguments).nodes:
                with self.subTest(launch=name, node=node.name):
                    packages.get_path(node.package)
                    words = node.args.split()
                    if words and words[0] == 'load' and words[1].startswith('rgbd_recognition/'):
                        self.assertIn(words[1], declared_nodelets())

    def test_the_demo_has_two_sources(self):
        recording = nodes_named(load('demo', ['models:=/store']))
        virtual = load('demo', ['models:=/store', 'source:=virtual'])
        self.assertIn('player', recording)
        self.assertNotIn('player', nodes_named(virtual))
        folder = virtual.params['/camera/driver/device_id'].value
        self.assertTrue(os.path.isdir(folder[len('virtual:'):]), folder)

    def test_topics_of_each_camera_reach_the_pipeline(self):
        for topics in TOPICS:
            with self.subTest(topics=topics):
                arguments = ['models:=/store', 'topics:=' + topics, 'camera:=left', 'namespace:=recognition_left']
                config = load('recognition', arguments)
                nodes = nodes_named(config)
                remaps = dict(nodes['segmentation'].remap_args)
                self.assertTrue(remaps['rgb/image_rect_color'].startswith('/left/'))
                self.assertEqual('points_to_depth' in nodes, topics == 'challenge')
                self.assertEqual(nodes['segmentation'].namespace, '/recognition_left/')

    def test_depth_can_come_from_points(self):
        nodes = nodes_named(load('recognition', ['models:=/store', 'use_points:=true']))
        self.assertEqual(dict(nodes['points_to_depth'].remap_args)['points'], '/camera/depth_registered/points')
        self.assertEqual(dict(nodes['segmentation'].remap_args)['depth_registered/image_raw'], 'points_to_depth/depth')

    def test_arguments_do_what_they_say(self):
        nodes = nodes_named(load('recognition', ['models:=/store', 'external_manager:=true', 'manager:=/camera/manager',
                                                 'rviz:=true', 'respawn:=true', 'diagnostics:=true']))
        self.assertNotIn('manager', nodes)
        self.assertIn('/camera/manager', nodes['segmentation'].args)
        self.assertTrue(nodes['segmentation'].respawn)
        watched = nodes['watch_nodelets'].args.split()
        self.assertEqual(watched[0], '/camera/manager')
        self.assertGreaterEqual(set(watched[1:]), {name for name, node in nodes.items() if node.package == 'nodelet'})
        self.assertIn('recognition.rviz', nodes['rviz'].args)
        self.assertEqual(nodes['diagnostics'].package, 'diagnostic_aggregator')

    def test_results_can_be_had_in_another_frame_and_on_demand(self):
        for name in ('recognition', 'kinect'):
            with self.subTest(launch=name):
                arguments = ['models:=/store', 'target_frame:=base_link', 'budget_ms:=500', 'enabled:=false']
                params = load(name, arguments).params
                self.assertEqual(params['/recognition/reprojection_verification/target_frame'].value, 'base_link')
                self.assertEqual(params['/recognition/reprojection_verification/budget_ms'].value, 500)
                self.assertIs(params['/recognition/segmentation/enabled'].value, False)

    def test_the_manager_can_run_on_another_machine(self):
        config = roslaunch.config.ROSLaunchConfig()
        file = os.path.join(PACKAGE, 'launch', 'recognition.launch')
        text = ('<launch><machine name="robot" address="192.0.2.1"/><include file="%s">'
                '<arg name="models" value="/store"/><arg name="machine" value="robot"/></include></launch>' % file)
        roslaunch.XmlLoader(resolve_anon=False).load_string(text, config, verbose=False)
        self.assertEqual(nodes_named(config)['manager'].machine_name, 'robot')
        self.assertFalse(nodes_named(load('recognition', ['models:=/store']))['manager'].machine_name)

    def test_shards_run_where_told(self):
        config = load('sharded', ['models:=/store', 'machine:=helper', 'address:=10.0.0.2'])
        nodes = nodes_named(config)
        self.assertEqual(nodes['hypothesis_generation_1'].machine_name, 'helper')
        self.assertEqual(config.machines['helper'].address, '10.0.0.2')
        self.assertEqual(config.params['/recognition/hypothesis_generation/shards'].value, 2)
        self.assertEqual(config.params['/recognition/hypothesis_generation_1/shard'].value, 1)

    def test_config_files_load(self):
        for file in glob.glob(os.path.join(PACKAGE, 'config', '*.yaml')):
            with self.subTest(file=file):
                config = load('recognition', ['models:=/store', 'config:=' + file])
                self.assertIn('/recognition/models', config.params)


if __name__ == '__main__':
    unittest.main()
