#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# usage: equal_error.py FOLDER SCENE      the table of render.sh, from the pictures and times that it left in FOLDER
import array, collections, math, statistics, sys

folder, scene = sys.argv[1:]


def picture(name):
    with open("%s/%s-%s.ppm" % (folder, scene, name), "rb") as file:
        words = []
        while len(words) < 4:
            words += file.readline().split(b"#")[0].split()
        values = array.array("H", file.read())
    if sys.byteorder == "little":
        values.byteswap()
    return [v / 65535 for v in values]


def rmse(a, b):
    return math.sqrt(sum((x - y) ** 2 for x, y in zip(a, b)) / len(a))


seconds = collections.defaultdict(list)
for line in open("%s/%s.times" % (folder, scene)):
    who, setting, time = line.split()
    seconds[who, setting].append(float(time))

converged = {"pov": picture("pov"), "ours": picture("ours")}
means = {who: sum(p) / len(p) for who, p in converged.items()}
print("%s: converged pictures: mean %.4f POV-Ray, %.4f ours, mean difference %.4f, rms %.4f" % (
    scene, means["pov"], means["ours"],
    sum(abs(x - y) for x, y in zip(converged["pov"], converged["ours"])) / len(converged["pov"]),
    rmse(converged["pov"], converged["ours"])))
points = collections.defaultdict(list)  # who: (error, CPU seconds, setting)
for (who, setting), times in seconds.items():
    error = rmse(picture("%s-%s" % (who, setting)), converged["pov" if who == "pov" else "ours"])
    points[who].append((error, statistics.median(times), setting))
for who in points:
    for error, time, setting in points[who]:
        print("  %-8s %-6s %8.3f CPU s   rmse %.5f" % (who, setting, time, error))


def time_for(error, curve):
    """CPU seconds that a curve needs for an error, between its points or along its last two."""
    curve = sorted(curve)
    for (e0, t0, _), (e1, t1, _) in zip(curve, curve[1:]):
        if e1 >= error:
            break
    slope = math.log(t1 / t0) / math.log(e1 / e0)
    return t0 * (error / e0) ** slope


for who in points:
    if who == "pov":
        continue
    for error, time, setting in sorted(points["pov"]):
        equal = time_for(error, points[who])
        print("  POV-Ray %-5s %.3f s, %s %.3f s for the same error: x%.1f" % (setting, time, who, equal, time / equal))
