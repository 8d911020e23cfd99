#!/usr/bin/env python3
"""Models from one labelled view each: does one made in a cloud find its object in other clouds?

  scripts/measure_one_view.py CLOUDS_DIR OUT [--build built]

CLOUDS_DIR holds organised PCD files with fields label, x, y, z, rgba (object k has the labels 10 k + 10 to 10 k + 19,
the first k is 1). Every object of every cloud is trained from that view alone, and looked for in all others. Prints
one line a find: model (cloud and object), cloud, confidence. OUT/CLOUD_found are the pictures, for checking by eye
that a find is the same object.
"""
import argparse
import glob
import json
import os
import struct
import subprocess
import sys

import numpy

FOCAL, CENTRE = 525.0, (319.5, 239.5)


def lzf(data, size):
    out, i = bytearray(), 0
    while i < len(data):
        control = data[i]
        i += 1
        if control < 32:
            out += data[i:i + control + 1]
            i += control + 1
            continue
        length = control >> 5
        if length == 7:
            length += data[i]
            i += 1
        start = len(out) - ((control & 31) << 8) - data[i] - 1
        i += 1
        for k in range(length + 2):
            out.append(out[start + k])
    assert len(out) == size
    return bytes(out)


def read_cloud(file):
    data = open(file, 'rb').read()
    end = data.index(b'DATA ')
    header = dict(line.split(' ', 1) for line in data[:end].decode().splitlines() if not line.startswith('#'))
    body = data[data.index(b'\n', end) + 1:]
    assert header['FIELDS'].split() == ['label', 'x', 'y', 'z', 'rgba'], file
    width, height = int(header['WIDTH']), int(header['HEIGHT'])
    if b'compressed' in data[end:end + 30]:
        packed, size = struct.unpack('II', body[:8])
        columns = numpy.frombuffer(lzf(body[8:8 + packed], size), '<u4').reshape(5, height, width)
    else:
        columns = numpy.frombuffer(body, '<u4').reshape(height, width, 5).transpose(2, 0, 1)
    label, rgba = columns[0].astype(int), columns[4]
    return label, numpy.ascontiguousarray(columns[3]).view('<f4'), rgba


def write_pnm(file, array):
    kind, top = ('P6', 255) if array.ndim == 3 else ('P5', 65535 if array.dtype == numpy.uint16 else 255)
    with open(file, 'wb') as out:
        out.write(f'{kind}\n{array.shape[1]} {array.shape[0]}\n{top}\n'.encode())
        out.write(array.astype('>u2').tobytes() if array.dtype == numpy.uint16 else array.tobytes())


def convert(file, out):
    """Writes colour, depth and one mask an object; returns the objects."""
    label, z, rgba = read_cloud(file)
    name = os.path.join(out, os.path.splitext(os.path.basename(file))[0])
    rgb = numpy.stack([(rgba >> shift) & 255 for shift in (16, 8, 0)], -1).astype(numpy.uint8)
    write_pnm(name + '_color.ppm', rgb)
    write_pnm(name + '_depth.pgm', (1000.0 * numpy.nan_to_num(z)).round().astype(numpy.uint16))
    objects = sorted({value // 10 - 1 for value in numpy.unique(label) if value >= 20})
    for k in objects:
        write_pnm(f'{name}_mask{k}.pgm', ((label // 10 == k + 1) * 255).astype(numpy.uint8))
    return name, objects


def store_without(store, cloud):
    """A store of links to the models of all other clouds, since a view's own model explains it best."""
    others = f'{store}_without_{cloud}'
    os.makedirs(others, exist_ok=True)
    for model in os.listdir(store):
        link = os.path.join(others, model)
        if not model.startswith(('.', cloud + '_')) and not os.path.lexists(link):
            os.symlink(os.path.abspath(os.path.join(store, model)), link)
    return others


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('clouds')
    parser.add_argument('out')
    parser.add_argument('--build', default='built')
    arguments = parser.parse_args()
    tools = os.path.join(arguments.build, 'devel/lib/rgbd_recognition')
    os.makedirs(arguments.out, exist_ok=True)
    camera = os.path.join(arguments.out, 'camera.json')
    with open(camera, 'w') as file:
        json.dump({'0': {'cam_K': [FOCAL, 0, CENTRE[0], 0, FOCAL, CENTRE[1], 0, 0, 1], 'depth_scale': 1.0}}, file)
    store = os.path.join(arguments.out, 'store')
    views = [convert(file, arguments.out) for file in sorted(glob.glob(os.path.join(arguments.clouds, '*.pcd')))]
    for name, objects in views:
        for k in objects:
            subprocess.run([os.path.join(tools, 'train'), '--models', store, '--name', f'{os.path.basename(name)}_{k}',
                            '--color', name + '_color.ppm', '--depth', name + '_depth.pgm', '--camera', camera,
                            '--mask', f'{name}_mask{k}.pgm'], check=False)
    for name, _ in views:
        print(os.path.basename(name), flush=True)
        subprocess.run([os.path.join(tools, 'recognize'), '--models', store_without(store, os.path.basename(name)),
                        '--color', name + '_color.ppm', '--depth', name + '_depth.pgm', '--camera', camera,
                        '--out', f'{name}_found'], check=False)


if __name__ == '__main__':
    sys.exit(main())
