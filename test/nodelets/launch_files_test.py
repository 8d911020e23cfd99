#!/usr/bin/env python3
"""Every launch file loads with every set of topics, and what it names exists."""
import glob
import os
import unittest
import xml.etree.ElementTree as ElementTree

import roslaunch
import rospkg
import yaml

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
NEEDED = {'recognition': ['models:=/store'], 'replay': ['models:=/store', 'bag:=/a.bag'], 'demo': ['models:=/store'],
          'kinect': ['models:=/store'], 'sharded': ['models:=/store'], 'training': ['models:=/store'], 'openni2': []}
TOPICS = ['openni', 'challenge', 'realsense', 'azure']


def load(name, arguments):
    config = roslaunch.config.ROSLaunchConfig()
    file = os.path.join(PACKAGE, 'launch', name + '.launch')
    roslaunch.XmlLoader(resolve_anon=False).load(file, config, argv=arguments, verbose=False)
    return config


def config_file(name):
    return os.path.join(PACKAGE, 'config', name + '.yaml')


def shipped_values(name):
    with open(config_file(name)) as file:
        groups = yaml.safe_load(file)
    return {group + '/' + key: value for group, values in groups.items() for key, value in values.items()}


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

    def test_the_demo_tracks_a_film(self):
        film = load('demo', ['models:=/store', 'source:=sequence', 'film:=/film'])
        self.assertIn('tracking', nodes_named(film))
        self.assertEqual(film.params['/camera/driver/device_id'].value, 'virtual:/film')

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

    def test_what_watches_continuously_tracks(self):
        for name, tracks in (('recognition', True), ('kinect', True), ('replay', False), ('demo', False)):
            with self.subTest(launch=name):
                nodes = nodes_named(load(name, NEEDED[name]))
                self.assertEqual('tracking' in nodes, tracks)
                remaps = dict(nodes['reprojection_verification'].remap_args)
                self.assertEqual(remaps.get('detections'), 'reprojection_verification/detections' if tracks else None)
                self.assertEqual(dict(nodes['on_demand'].remap_args).get('detections'), remaps.get('detections'))
        self.assertNotIn('tracking', nodes_named(load('recognition', ['models:=/store', 'on_demand:=true'])))

    def test_one_nodelet_publishes_tf(self):
        for name in ('recognition', 'kinect'):
            for tracking in (True, False):
                with self.subTest(launch=name, tracking=tracking):
                    params = load(name, ['models:=/store', 'tracking:=%s' % str(tracking).lower()]).params
                    stage = params['/recognition/reprojection_verification/publish_tf'].value
                    self.assertIs(stage, not tracking)
                    self.assertEqual('/recognition/tracking/publish_tf' in params, tracking)

    def test_tf_can_be_prefixed_or_switched_off(self):
        for name in ('recognition', 'kinect'):
            with self.subTest(launch=name):
                stage = '/%s/tracking/'
                alone = load(name, ['models:=/store']).params
                self.assertEqual(alone[stage % 'recognition' + 'tf_prefix'].value, '')
                self.assertIs(alone[stage % 'recognition' + 'publish_tf'].value, True)
                left = load(name, ['models:=/store', 'namespace:=recognition_left', 'publish_tf:=false']).params
                self.assertEqual(left[stage % 'recognition_left' + 'tf_prefix'].value, 'recognition_left/')
                self.assertIs(left[stage % 'recognition_left' + 'publish_tf'].value, False)

    def test_load_can_be_limited(self):
        for name in ('recognition', 'kinect'):
            with self.subTest(launch=name):
                params = load(name, ['models:=/store', 'on_demand:=true', 'max_rate:=2', 'rest:=5']).params
                self.assertIs(params['/recognition/segmentation/enabled'].value, False)
                self.assertEqual(params['/recognition/segmentation/max_rate'].value, 2)
                self.assertEqual(params['/recognition/segmentation/rest'].value, 5)

    def test_relative_paths_are_the_shells(self):
        os.environ['PWD'] = '/shell'
        os.environ['HOME'] = '/home/user'
        for given, meant in (('store', '/shell/store'), ('~/store', '/home/user/store'), ('/store', '/store')):
            with self.subTest(given=given):
                self.assertEqual(load('recognition', ['models:=' + given]).params['/recognition/models'].value, meant)
                self.assertEqual(load('kinect', ['models:=' + given]).params['/recognition/models'].value, meant)
                training = load('training', ['models:=' + given]).params
                self.assertEqual(training['/training/models'].value, meant)
                self.assertEqual(training['/training/folder'].value, '/shell')
                player = nodes_named(load('replay', ['models:=/store', 'bag:=' + given]))['player']
                self.assertEqual(player.args.split()[-1], meant)
        for given, meant in (('virtual:scene', 'virtual:/shell/scene'), ('virtual:/scene', 'virtual:/scene'),
                             ('a.oni', '/shell/a.oni'), ('/a.oni', '/a.oni'), ('#1', '#1'), ('virtual:', 'virtual:')):
            with self.subTest(given=given):
                params = load('openni2', ['device_id:=' + given]).params
                self.assertEqual(params['/camera/driver/device_id'].value, meant)

    def test_a_stage_that_refuses_to_start_ends_the_launch(self):
        for name, watcher in (('recognition', 'watch_start'), ('kinect', 'watch_start'),
                              ('training', 'watch_training_start')):
            with self.subTest(launch=name):
                self.assertTrue(nodes_named(load(name, ['models:=/store']))[watcher].required)
                self.assertFalse(nodes_named(load(name, ['models:=/store', 'required:=false']))[watcher].required)
                self.assertNotIn(watcher, nodes_named(load(name, ['models:=/store', 'respawn:=true'])))

    def test_what_an_earlier_launch_left_on_the_master_is_cleared(self):
        wanted = {'recognition': {'/recognition/' + stage + '/' for stage in (
            'segmentation', 'feature_extraction', 'hypothesis_generation', 'reprojection_verification')},
                  'openni2': {'/camera/driver/'}, 'training': {'/training/'}}
        for name, namespaces in wanted.items():
            with self.subTest(launch=name):
                self.assertLessEqual(namespaces, set(load(name, NEEDED[name]).clear_params))
        self.assertIn('/camera/driver/', load('kinect', NEEDED['kinect']).clear_params)

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

    def test_advanced_parameters_are_loaded_below_the_config(self):
        shipped = {**shipped_values('advanced'), **shipped_values('default')}
        for name, namespace in (('recognition', '/recognition/'), ('training', '/training/parameters/')):
            with self.subTest(launch=name):
                params = load(name, ['models:=/store']).params
                self.assertEqual({key: params[namespace + key].value for key in shipped}, shipped)
                paper = shipped_values('paper')
                params = load(name, ['models:=/store', 'config:=' + config_file('paper')]).params
                self.assertEqual({key: params[namespace + key].value for key in paper}, paper)
                self.assertEqual(set(paper), set(shipped))

    def test_config_files_load(self):
        for file in glob.glob(os.path.join(PACKAGE, 'config', '*.yaml')):
            with self.subTest(file=file):
                config = load('recognition', ['models:=/store', 'config:=' + file])
                self.assertIn('/recognition/models', config.params)


if __name__ == '__main__':
    unittest.main()
