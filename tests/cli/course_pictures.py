#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Course scenes under --dialect-exact against pictures rendered by the courses' own programs.

usage: course_pictures.py FIRSTLIGHT WILD_DIR        exit 77: the material is not here

Every picture must agree within 1/255 on at least 99.9 % of its bytes. Pictures of depth and of normals are left out.
"""
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

# Staff pictures made with options or rules that a scene alone does not ask for.
SKIPPED = {
    "_staff/mit2004/output2_05.png": "rendered with -shade_back",
    "_staff/mit2004/output2_07.png": "rendered with -shade_back",
}


def read_bmp(data):
    offset, = struct.unpack_from("<I", data, 10)
    width, height = struct.unpack_from("<ii", data, 18)
    stride = (width * 3 + 3) // 4 * 4
    rows = []
    for y in range(abs(height)):
        row = data[offset + y * stride:offset + y * stride + width * 3]
        rows.append(bytes(row[i + 2 - 2 * (i % 3)] if i % 3 != 1 else row[i] for i in range(width * 3)))
    return width, abs(height), b"".join(reversed(rows) if height > 0 else rows)


def read_png(data):
    at, idat = 8, b""
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack_from(">IIBB", body)
        elif kind == b"PLTE":
            palette = body
        elif kind == b"IDAT":
            idat += body
        at += length + 12
    channels = {0: 1, 2: 3, 3: 1, 6: 4}[color]
    step = max(1, channels * depth // 8)
    raw, stride = zlib.decompress(idat), (width * channels * depth + 7) // 8
    rows, before = [], bytearray(stride)
    for y in range(height):
        kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            a = row[i - step] if i >= step else 0
            b, c = before[i], before[i - step] if i >= step else 0
            if kind == 1:
                row[i] = (row[i] + a) & 255
            elif kind == 2:
                row[i] = (row[i] + b) & 255
            elif kind == 3:
                row[i] = (row[i] + (a + b) // 2) & 255
            elif kind == 4:
                p = a + b - c
                pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
                row[i] = (row[i] + (a if pa <= pb and pa <= pc else b if pb <= pc else c)) & 255
        rows.append(row)
        before = row
    if depth < 8:
        mask = (1 << depth) - 1
        rows = [[row[x * depth // 8] >> (8 - depth - x * depth % 8) & mask for x in range(width)] for row in rows]
    if depth == 16:
        rows = [row[::2] for row in rows]
    pixels = b"".join(bytes(r) for r in rows)
    if color == 3:
        pixels = b"".join(palette[3 * v:3 * v + 3] for v in pixels)
    elif channels == 1:
        pixels = bytes(v * 255 // ((1 << depth) - 1) for v in pixels for _ in range(3))
    if channels == 4:
        pixels = bytes(v for i, v in enumerate(pixels) if i % 4 != 3)
    return width, height, pixels


def read_picture(path):
    data = open(path, "rb").read()
    return read_bmp(data) if data[:2] == b"BM" else read_png(data)


def lay_out(wild, scene, tree):
    """Copy the scene and what it names to where its references resolve."""
    place = os.path.join(tree, scene)
    os.makedirs(os.path.dirname(place), exist_ok=True)
    shutil.copy(os.path.join(wild, scene), place)
    for line in open(os.path.join(wild, "RESOLVE.tsv"), encoding="utf-8").read().splitlines()[1:]:
        name, written, _, _, have = line.split("\t")[:5]
        if name == scene and not have.startswith("MISSING"):
            target = os.path.join(os.path.dirname(place), written)
            os.makedirs(os.path.dirname(target), exist_ok=True)
            shutil.copy(os.path.join(wild, have), target)
    return place


def main():
    program, wild = os.path.abspath(sys.argv[1]), sys.argv[2]
    if not os.path.isdir(wild):
        print("skipped: no", wild)
        return 77
    failed = passed = 0
    table = open(os.path.join(wild, "reference/REFERENCE.tsv"), encoding="utf-8").read().splitlines()[1:]
    for line in table:
        image, scene, _, width, height = line.split("\t")[:5]
        name = os.path.basename(image)
        if name.startswith(("depth", "normals")) or name[:-4].endswith(("d", "n")) and "2016" in image or image in SKIPPED:
            continue
        dialect = "pa1" if "pa1" in image else "m04" if "2004" in image else "m12"
        with tempfile.TemporaryDirectory() as tree:
            place, out = lay_out(wild, scene, tree), os.path.join(tree, "out.bmp")
            run = subprocess.run([program, "render", place, "--dialect", dialect, "--dialect-exact", "-n", "1", "--size",
                                  f"{width}x{height}", "-o", out, "--quiet"], capture_output=True, text=True, check=False)
            if run.returncode:
                print(f"FAIL {image}: exit {run.returncode}\n{run.stderr}")
                failed += 1
                continue
            _, _, got = read_bmp(open(out, "rb").read())
            w, h, want = read_picture(os.path.join(wild, "reference", image))
        if (w, h) != (int(width), int(height)):
            print(f"FAIL {image}: the reference is {w}x{h}")
            failed += 1
            continue
        off = [abs(a - b) for a, b in zip(got, want)]
        wrong, largest = sum(d > 1 for d in off), max(off)
        ok = len(got) == len(want) and wrong <= len(want) // 1000
        print(f"{'ok  ' if ok else 'FAIL'} {image}: {100 - 100 * wrong / len(want):.4f} % of bytes within 1/255, largest difference {largest}")
        passed, failed = passed + ok, failed + (not ok)
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


sys.exit(main())
