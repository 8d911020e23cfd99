#!/usr/bin/env python3
"""What the pages name exists: links, pictures, programs, launch arguments."""
import glob
import os
import re
import subprocess
import tempfile
import unittest

from pages import PACKAGE, PAGES, text_of


def anchors(page):
    titles = re.findall(r'^#+ (.*)$', text_of(page), re.MULTILINE)
    return {re.sub(r'[^a-z0-9 -]', '', title.lower()).replace(' ', '-') for title in titles}


class DocsTest(unittest.TestCase):
    def test_links(self):
        for page in PAGES:
            for target in re.findall(r'\]\(([^)]+)\)', text_of(page)):
                if target.startswith('http'):
                    continue
                file, _, anchor = target.partition('#')
                path = os.path.normpath(os.path.join(os.path.dirname(page), file)) if file else page
                with self.subTest(page=os.path.relpath(page, PACKAGE), link=target):
                    self.assertTrue(os.path.exists(path))
                    if anchor:
                        self.assertIn(anchor, anchors(path))

    def test_programs(self):
        with open(os.path.join(PACKAGE, 'src', 'tools', 'CMakeLists.txt')) as file:
            tools = set(re.findall(r'rgbd_add_tool\((\w+)', file.read()))
        tools |= {'collision_objects', 'doctor', 'write_kinect_dump'}
        for page in PAGES:
            for program in re.findall(r'rosrun rgbd_recognition (\w+)', text_of(page)):
                with self.subTest(page=os.path.relpath(page, PACKAGE), program=program):
                    self.assertIn(program, tools)
            for script in re.findall(r'`(?:scripts/)([\w.]+)', text_of(page)):
                with self.subTest(page=os.path.relpath(page, PACKAGE), script=script):
                    self.assertTrue(os.path.exists(os.path.join(PACKAGE, 'scripts', script)))

    def test_launch_arguments(self):
        for page in PAGES:
            for name, arguments in re.findall(r'roslaunch rgbd_recognition (\w+\.launch)([^\n`#\[]*)', text_of(page)):
                file = os.path.join(PACKAGE, 'launch', name)
                with self.subTest(page=os.path.relpath(page, PACKAGE), launch=name):
                    declared = set(re.findall(r'<arg name="(\w+)"', text_of(file)))
                    self.assertLessEqual(set(re.findall(r'(\w+):=', arguments)), declared)

    def test_rosrun_finds_what_the_scripts_build_in_a_clone(self):
        folder = re.search(r'build=\$\{BUILD:-(\w+)\}', text_of(os.path.join(PACKAGE, 'scripts', 'build'))).group(1)
        with tempfile.TemporaryDirectory() as clone:
            tools = os.path.join(clone, folder, 'devel', 'lib', 'some_package')
            os.makedirs(tools)
            with open(os.path.join(clone, 'package.xml'), 'w') as file:
                file.write('<package><name>some_package</name><version>0.0.0</version><description/>'
                           '<maintainer email="nobody@example.org">nobody</maintainer><license>BSD</license>'
                           '</package>')
            with open(os.path.join(tools, 'tool'), 'w') as file:
                file.write('#!/bin/sh\necho found\n')
            os.chmod(os.path.join(tools, 'tool'), 0o755)
            done = subprocess.run(['rosrun', 'some_package', 'tool'], stdout=subprocess.PIPE, universal_newlines=True,
                                  env=dict(os.environ, ROS_PACKAGE_PATH=clone, ROS_HOME=clone))
        self.assertEqual(done.stdout, 'found\n')

    def test_scripts_parse(self):
        for script in glob.glob(os.path.join(PACKAGE, 'scripts', '*')):
            if os.path.isfile(script) and not script.endswith('.py'):
                with self.subTest(script=script):
                    subprocess.run(['bash', '-n', script], check=True)
            elif script.endswith('.py'):
                with self.subTest(script=script):
                    compile(text_of(script), script, 'exec')


if __name__ == '__main__':
    unittest.main()
