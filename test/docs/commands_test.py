#!/usr/bin/env python3
"""Every command of the pages is run, or checked against the programs' own --help.

A block of commands is marked by an HTML comment in front of it: "run" runs it in a folder of its own; "check" checks that
programs, files, options and arguments exist, as does "check: a camera", which says what a run would need; "output" is
what a program writes. BUILD names the build's folder, and CTEST the program ctest.
"""
import ast
import functools
import glob
import importlib
import os
import re
import shlex
import subprocess
import tempfile
import unittest

import yaml

from pages import PACKAGE, PAGES, blocks, name_of, text_of

BUILD = os.environ['BUILD']
TOOLS = os.path.join(BUILD, 'devel', 'lib', 'rgbd_recognition')
DEMO = os.path.join(PACKAGE, 'test', 'data', 'demo')
PLACEHOLDERS = {'STORE': os.path.join(BUILD, 'test', 'recognizer', 'store'), 'MODELS_DIR': os.path.join(DEMO, 'models'),
                'SPLIT': os.path.join(DEMO, 'test_primesense')}
# Programs that are not the package's, and shell words; what follows "parallel" or stands in --wrap is checked by itself.
FOREIGN = {'catkin_make', 'cd', 'cp', 'done', 'export', 'for', 'ln', 'mkdir', 'perf', 'python3', 'rosbag', 'rostopic', 'sed',
           'seq', 'source', 'sudo'}
FOREIGN_PACKAGES = {'image_view', 'nodelet', 'rviz', 'tf', 'tf2_ros'}
SERVICES = {'detect': 'Detect', 'train_object': 'TrainObject'}


@functools.lru_cache(maxsize=None)
def options_of(*program):
    """All --options that the program's --help names."""
    done = subprocess.run([*program, '--help'], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    return set(re.findall(r'(--?[a-zA-Z][\w-]*)', done.stdout))


@functools.lru_cache(maxsize=None)
def text_of_build_files():
    files = glob.glob(os.path.join(PACKAGE, '**', 'CMakeLists.txt'), recursive=True)
    return ''.join(text_of(file) for file in files if os.sep + 'built' not in file)


@functools.lru_cache(maxsize=None)
def test_names():
    return subprocess.run([os.environ['CTEST'], '--test-dir', BUILD, '-N'], stdout=subprocess.PIPE,
                          universal_newlines=True).stdout


def simple_commands(line):
    """The words of each command of a line."""
    line = re.sub(r'[\[\]]', ' ', re.sub(r'\$\([^()]*\)', 'value', line))
    commands, words = [], []
    for word in shlex.split(line.replace(';', ' ; '), comments=True):
        if word in ('&&', '|', ';'):
            commands, words = commands + [words], []
        elif word not in ('do',) and not (not words and re.match(r'\w+=', word)):
            words.append(word)
    return [words for words in commands + [words] if words]


class CommandsTest(unittest.TestCase):
    def check_options(self, known, words):
        for word in words:
            if re.match(r'--?[a-zA-Z]', word):
                self.assertIn(word.partition('=')[0], known)

    def check_tool(self, tool, arguments):
        path = os.path.join(TOOLS, tool)
        self.assertTrue(os.path.exists(path), path)
        arguments = [word for word in arguments if ':=' not in word]
        commands = [word for word in arguments[:1] if tool == 'simulate']
        self.check_options(options_of(path, *commands), arguments)

    def check_script(self, script, arguments):
        path = os.path.join(PACKAGE, script)
        self.assertTrue(os.access(path, os.X_OK), script + ' is not executable')
        self.assertTrue(text_of(path).startswith('#!'), script + ' does not say by what it is run')
        if script.endswith('.py'):
            self.check_options(set(re.findall(r"'(--[\w-]+)'", text_of(path))), arguments)

    def check_benchmark(self, benchmark, arguments):
        source = text_of(os.path.join(PACKAGE, 'src', 'benchmarks', benchmark + '.cpp'))
        known = set(re.findall(r'(--[\w-]+)', source))
        self.check_options(known, [word for word in arguments if not word.startswith('--benchmark_')])

    def check_launch(self, package, file, *arguments):
        self.assertEqual(package, 'rgbd_recognition')
        declared = set(re.findall(r'<arg name="(\w+)"', text_of(os.path.join(PACKAGE, 'launch', file))))
        self.assertLessEqual({word.partition(':=')[0] for word in arguments if ':=' in word}, declared)

    def check_service(self, verb, name, *request):
        self.assertEqual(verb, 'call')
        if request:
            service = SERVICES[name.rpartition('/')[2]]
            fields = getattr(importlib.import_module('rgbd_recognition.srv'), service + 'Request').__slots__
            self.assertLessEqual(set(yaml.safe_load(request[0])), set(fields))

    def check_build(self, program, arguments):
        if program == 'cmake':
            for option in re.findall(r'-D(RGBD_\w+)', ' '.join(arguments)):
                self.assertIn(option, text_of_build_files())
        if program == 'ninja':
            self.assertRegex(text_of_build_files(), r'\(%s\b' % arguments[-1])
        if program == 'ctest':
            self.assertRegex(test_names(), arguments[arguments.index('-R') + 1])

    def check(self, words):
        program, arguments = words[0], words[1:]
        if program == 'rosrun' and arguments[0] == 'rgbd_recognition':
            program, arguments = arguments[1], arguments[2:]
        elif program == 'rosrun':
            self.assertIn(arguments[0], FOREIGN_PACKAGES)
            return
        base = os.path.basename(program)
        if program.startswith('scripts/'):
            self.check_script(program, arguments)
        elif program == 'roslaunch':
            self.check_launch(*arguments)
        elif program == 'rosservice':
            self.check_service(*arguments)
        elif program in ('cmake', 'ctest', 'ninja'):
            self.check_build(program, arguments)
        elif program == 'parallel':
            self.check(arguments)
        elif program in ('sbatch', 'array=$(sbatch'):
            if '--wrap' in arguments:
                self.check(shlex.split(arguments[arguments.index('--wrap') + 1]))
        elif base.startswith('benchmark_'):
            self.check_benchmark(base, arguments)
        elif base.startswith('test_'):
            self.assertIn(base, text_of_build_files())
        elif program not in FOREIGN:
            self.check_tool(base, arguments)

    def test_every_block_is_marked(self):
        for block in blocks():
            if not block.language:
                with self.subTest(page=block.page, block=block.text[:60]):
                    self.assertRegex(block.mark or 'no mark', r'^(run|check|check: .*|output)$')

    def test_commands_exist(self):
        for block in blocks():
            if block.language or (block.mark or '') == 'output':
                continue
            for line in block.lines():
                for words in simple_commands(line):
                    with self.subTest(page=block.page, command=' '.join(words)):
                        self.check(words)

    def test_commands_between_the_lines_exist(self):
        tools = 'train|recognize|evaluate|simulate|print_board|parameter_table|benchmark_\\w+|rosrun|roslaunch|scripts/[\\w.]+'
        for page in PAGES:
            text = re.sub(r'```.*?```', '', text_of(page), flags=re.DOTALL)
            for command in re.findall(r'`((?:%s) [^`]* [^`]*)`' % tools, text):
                for words in simple_commands(command.replace('\\|', '\\\\|').replace('\n', ' ')):
                    with self.subTest(page=name_of(page), command=command):
                        self.check(words)

    def test_python_is_python(self):
        for block in blocks():
            if block.language == 'python':
                with self.subTest(page=block.page):
                    ast.parse(block.text)

    def test_names_of_the_library_exist(self):
        headers = glob.glob(os.path.join(PACKAGE, 'include', '**', '*.h'), recursive=True)
        declared = ' '.join(text_of(header) for header in headers)
        for block in blocks():
            if block.language == 'cpp':
                for name in re.findall(r'recognition::(\w+)', block.text):
                    with self.subTest(page=block.page, name=name):
                        self.assertRegex(declared, r'(class|struct) %s\b' % name)

    def test_what_can_be_run_runs(self):
        run = [block for block in blocks() if block.mark == 'run']
        self.assertGreaterEqual(len(run), 3)
        for block in run:
            with self.subTest(page=block.page, block=block.text), tempfile.TemporaryDirectory() as folder:
                text = re.sub(r'\b(%s)\b' % '|'.join(PLACEHOLDERS), lambda word: PLACEHOLDERS[word.group()], block.text)
                environment = dict(os.environ, HOME=folder, ROS_HOME=folder, PATH=TOOLS + ':' + os.environ['PATH'],
                                   ROS_PACKAGE_PATH=PACKAGE + ':' + os.environ.get('ROS_PACKAGE_PATH', ''))
                done = subprocess.run(['bash', '-euo', 'pipefail', '-c', text], cwd=folder, env=environment,
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
                self.assertEqual(done.returncode, 0, done.stdout)


if __name__ == '__main__':
    unittest.main()
