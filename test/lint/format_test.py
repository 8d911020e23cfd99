#!/usr/bin/env python3
"""C++ files are as .clang-format has them."""
import os
import re
import subprocess
import sys

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FOLDERS = ('examples', 'include', 'src', 'test')


def sources():
    for folder in FOLDERS:
        for path, _, names in os.walk(os.path.join(PACKAGE, folder)):
            for name in names:
                if name.endswith(('.h', '.cpp')):
                    yield os.path.relpath(os.path.join(path, name), PACKAGE)


def differing(files):
    program = os.environ.get('CLANG_FORMAT', 'clang-format')
    done = subprocess.run([program, '--dry-run', *files], cwd=PACKAGE, stderr=subprocess.PIPE, universal_newlines=True,
                          check=True)
    return set(re.findall(r'^([^:\n]+):\d+:\d+: warning: code should be clang-formatted', done.stderr, re.MULTILINE))


def main():
    found = differing(sorted(sources()))
    for name in sorted(found):
        print('%s is not formatted: clang-format -i %s' % (name, name))
    return 1 if found else 0


if __name__ == '__main__':
    sys.exit(main())
