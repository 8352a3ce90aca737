#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Words that do not fit together, names that no text or format can hold, files in each other's way, signals.

usage: command_line.py FIRSTLIGHT SOURCE_DIR
"""
import json
import os
import shlex
import signal
import struct
import subprocess
import sys
import tempfile
import zlib

PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
counts = [0, 0]
SCENE = """firstlight 1
PerspectiveCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 30 width 32 height 24 }
Lights { numLights 1 PointLight { position 2 3 4 color 1 1 1 } }
Materials { numMaterials 1 Material { diffuseColor 0.8 0.5 0.2 %s } }
Group { numObjects 1 MaterialIndex 0 Sphere { center 0 0 0 radius 1 } }
"""


def expect(truth, what, detail=""):
    counts[not truth] += 1
    if not truth:
        print(f"FAIL: {what}\n    {detail}")


def run(*words, **more):
    return subprocess.run([PROGRAM, *words], capture_output=True, timeout=120, stdin=subprocess.DEVNULL, check=False, **more)


def exits(code, pattern, *words):
    """Exit code, and a piece of standard error."""
    done = run(*words)
    said = done.stderr.decode(errors="replace")
    expect(done.returncode == code and pattern in said, f"{words}: exit {code} and '{pattern}'",
           f"exit {done.returncode}: {said}")
    return done


def write(name, text):
    with open(name, "wb") as file:
        file.write(text if isinstance(text, bytes) else text.encode())


def usage():
    """All refused with exit 2 before anything is rendered."""
    picture = ("-n", "1", "-o", "a.png")
    for pattern, words in (
            ("from 12 to 100000000", ("bench", "sphere:-5")),
            ("from 12 to 100000000", ("bench", "sphere:0")),
            ("from 12 to 100000000", ("bench", "sphere:4294967308")),
            ("from 12 to 100000000", ("bench", "good.txt", "sphere:1e3")),
            ("makes its own scenes", ("bench", "--growth", "good.txt")),
            ("makes its own scenes", ("study", "--extremes", "good.txt")),
            ("--extremes does not go with --out", ("study", "--extremes", "--out", "d")),
            ("nothing without --extremes", ("study", "good.txt", "--out", "d", "--all")),
            ("nothing without --output", ("render", "good.txt", "--aov", "depth", "--json")),
            ("nothing without --accel octree", ("render", "good.txt", "--octree-height", "3", *picture)),
            ("nothing without --accel octree", ("info", "good.txt", "--octree-height", "3", "--accel", "bvh")),
            ("one scene, got 2", ("bench", "--source-comparison", "--octree-height", "3", "good.txt", "good.txt")),
            ("nothing without --revolve-solver newton", ("render", "good.txt", "--revolve-starts", "3", *picture)),
            ("does not go with --report", ("check", "good.txt", "--update", "--report", "d")),
            ("does not go with --adaptive on", ("render", "good.txt", "--checkpoint", "c", "--adaptive", "on", *picture)),
            ("expected one topic", ("help", "scene", "keys")),
            ("did you mean 'scene'", ("help", "scnee")),
            ("unknown option '-z'", ("render", "-qzn1", "good.txt", "-o", "a.png")),
            ("'info' takes no option -n", ("info", "good.txt", "-n", "3")),
            ("option '-o' needs a value", ("render", "good.txt", "-qo")),
            ("--samples, --sampler", ("render", "good.txt", "--samp", "3", "-o", "a.png")),
            ("--json takes no value", ("render", "good.txt", "--json=3")),
            ("to 1e+300, or inf", ("render", "good.txt", "--focus", "0", *picture)),
            ("to 1e+300, or inf", ("render", "good.txt", "--focus", "1e303", *picture)),
            ("from 1 to 16384", ("render", "good.txt", "--size", "99999x1", *picture)),
            ("ten finite numbers", ("render", "good.txt", "--camera", "1 2 3", *picture)),
            (".png .exr", ("render", "good.txt", "-o", "a.jpg")),
            ("did you mean 'depth'", ("render", "good.txt", "--aov", "deph", *picture)),
            ("must lie inside the 32x24", ("render", "good.txt", "--crop", "100,0,4,4", *picture)),
            ("179 degrees", ("render", "good.txt", "--camera", "0 0 5 0 0 0 0 1 0 180", *picture)),
            ("16384x16384", ("render", "good.txt", "--scale", "9999", *picture)),
            ("must know the number of samples", ("render", "good.txt", "--sampler", "stratified", "--time", "1", "-o", "a.png"))):
        exits(2, pattern, *words)
    expect(not os.path.exists("a.png") and not os.path.exists("c"), "nothing was written")
    # What the scene says itself is wrong input, and has a place.
    write("far.txt", SCENE.replace("center 0 0 5", "aperture 1e39 center 1e39 0 5") % "")
    exits(3, "far.txt:2:30: error: 'aperture'", "render", "far.txt", *picture)
    exits(3, "far.txt:2:42: error: 'center'", "render", "far.txt", *picture)
    write("lens.txt", SCENE.replace("angle 30", "angle 30 aperture 1e10 focus 1") % "")
    exits(3, "lens.txt: error: 'aperture' must be at most", "render", "lens.txt", *picture)
    write("top.txt", "firstlight 1\nsphere { radius 1 }\n")
    exits(3, "'Sphere' stands in 'Group'", "info", "top.txt")
    # A file needs no ending to be opened.
    write("noext", SCENE % "")
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = run("noext", env=environment)
    expect(done.returncode == 4 and b"no display" in done.stderr, "a scene without an ending", done.stderr)


def places():
    """What cannot be written, or must not be written over, is said before the render."""
    os.mkdir("folder.png")
    hours = ("-n", "1000000000")
    exits(4, "no such folder", "render", "good.txt", *hours, "-o", "nodir/a.png")
    exits(4, "it is a folder", "render", "good.txt", *hours, "-o", "folder.png")
    exits(4, "no such folder", "render", "good.txt", *hours, "-o", "a.png", "--checkpoint", "nodir/ck")
    exits(4, "Not a directory", "render", "good.txt", *hours, "-o", "good.txt/a.png")
    exits(4, "Not a directory", "check", "good.txt", "--report", "good.txt")
    exits(4, "no such folder", "convert", "good.txt", "nodir/c.txt")
    if os.getuid() != 0:
        os.mkdir("readonly", 0o555)
        exits(4, "Permission denied", "render", "good.txt", *hours, "-o", "readonly/a.png")
    exits(0, "", "render", "good.txt", "-n", "1", "-o", "tex.png", "-q")
    write("textured.txt", SCENE % "texture tex.png")
    os.symlink("tex.png", "link.png")
    with open("tex.png", "rb") as file:
        texture = file.read()
    for words in (("-o", "tex.png"), ("-o", "link.png"), ("-o", "./tex.png"), ("--json", "--checkpoint", "textured.txt")):
        exits(2, "the scene reads it", "render", "textured.txt", *hours, *words)
    exits(2, "written twice", "render", "good.txt", *hours, "-o", "z.png", "--checkpoint", "z.png")
    exits(2, "written twice", "render", "good.txt", *hours, "-o", "z.png", "-o", "./z.png")
    exits(2, "written twice", "render", "good.txt", *hours, "-o", "z.png", "-o", "z.depth.exr", "--aov", "depth")
    exits(2, "would replace the picture", "check", "tex.png", "--update")
    os.rename("textured.txt", "tex.txt")
    exits(3, "would replace one that the scene reads", "check", "tex.txt", "--update")
    with open("tex.png", "rb") as file:
        expect(file.read() == texture, "the texture is what it was")


def names():
    """Names and texts that are not UTF-8 still give JSON."""
    name = b"b\xff.txt"
    write(name, SCENE % "")
    for words in (("render", name, "-n", "1", "--json", "-q"), ("info", name, "--json")):
        line = json.loads(run(*words).stdout)
        expect(line["scene"] == "b\ufffd.txt", f"{words[0]} --json of a name that is not UTF-8", line)
    for text in ((SCENE % "").encode("utf-16"), b"firstlight 1\nGr\xfcn { }\n" + b"K\xe9 " * 9):
        write("other.txt", text)
        line = json.loads(run("info", "other.txt", "--json").stdout)
        expect(line["diagnostics"] and line["diagnostics"][0]["severity"] == "error", "info --json of a text that is not UTF-8", line)
    write("long.txt", "firstlight 1\nG" + "\u00e4" * 600 + " { }\n")  # cut inside a character
    line = run("info", "long.txt", "--json").stdout.decode()
    expect(json.loads(line)["diagnostics"] and "\ufffd" not in line, "a message is cut between characters", line)


def damage_settings(path, out, before, after):
    """Another text in a PNG, with its checksum right."""
    with open(path, "rb") as file:
        data = file.read()
    at, pieces = 8, [data[:8]]
    while at < len(data):
        length = struct.unpack(">I", data[at:at + 4])[0]
        kind, body = data[at + 4:at + 8], data[at + 8:at + 8 + length].replace(before, after)
        pieces.append(struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body)))
        at += 12 + length
    write(out, b"".join(pieces))
    expect(b"".join(pieces) != data, "the settings were changed")


def pictures():
    """Saved pictures that are opened again."""
    exits(0, "", "render", "good.txt", "-n", "1", "-o", "saved.png", "-q")
    damage_settings("saved.png", "crafted.png", b"sampler 0 ", b"sampler 4294967295 ")
    for words in (("info", "crafted.png"), ("study", "crafted.png", "--out", "d", "--sweep", "sampler")):
        exits(3, "keys of this picture are damaged", *words)
    exits(0, "", "render", "good.txt", "-n", "1", "--crop", "20,10,8,8", "-o", "crop.png", "-q")
    exits(0, "", "render", "crop.png", "-n", "1", "--size", "16x12", "-o", "small.png", "-q")
    exits(0, "", "render", "good.txt", "-n", "1", "--size", "400x300", "--crop", "300,200,8,8", "-o", "large.png", "-q")
    exits(0, "", "study", "large.png", "--out", "d", "--sweep", "sampler", "--samples", "1", "--repeats", "1", "-q")
    # A study says how to repeat it.
    options = ["--samples", "1", "--repeats", "1", "--sampler", "random", "--exposure", "1.5", "--camera",
               "0 0 5 0 0 0 0 1 0 40", "--focus", "inf", "--light-samples", "auto", "--accel", "octree", "--sweep", "sampler"]
    write("it's here.txt", SCENE % "")
    exits(0, "", "study", "it's here.txt", "--out", "d d", "-q", *options)
    with open("d d/study.json", encoding="utf-8") as file:
        words = shlex.split(json.load(file)["command"])
    expect(words[:3] == ["firstlight", "study", "it's here.txt"] and words[words.index("--out") + 1] == "d d", "quoted", words)
    for name, value in zip(options[::2], options[1::2]):
        expect(name in words and words[words.index(name) + 1] == value, f"the study's command has {name} {value}", words)
    expect(run(*words[1:]).returncode == 0, "the study's command runs", words)


def checks():
    """Nothing checked is no success, and every scene is counted."""
    os.mkdir("empty")
    exits(3, "no scenes", "check", "empty")
    os.makedirs("one/sub")
    os.makedirs("two")
    for folder in ("one", "two"):
        write(f"{folder}/<b>.txt", SCENE % "")
    write("one/broken.txt", "firstlight 1\nGroup {\n")
    done = exits(3, "broken.txt", "check", "one", "--json")
    expect(json.loads(done.stdout.splitlines()[-1]) == {"passed": 0, "failed": 1, "errors": 1}, "counts", done.stdout)
    os.remove("one/broken.txt")
    exits(0, "", "check", "one", "--update")
    done = exits(0, "", "check", "one", "--quiet")
    expect(done.stdout == b"", "quiet", done.stdout)
    done = exits(1, "", "check", "one", "two", "--report", "page")
    expect(b"0/255" not in done.stdout, "no difference from what is not there", done.stdout)
    with open("page/index.html", encoding="utf-8") as file:
        page = file.read()
    expect("<b>" not in page and "&#60;b&#62;" in page, "names are text", page)
    expect(len([name for name in os.listdir("page") if name.endswith(".new.png")]) == 2, "a picture for each", os.listdir("page"))
    expect(page.count("0/255") == 1, "a difference only where there are two", page)


def lenient():
    """What a strict reader refuses says that there is a lenient one."""
    write("slip.txt", SCENE.replace("numObjects 1", "numObjects 7") % "colour 1")
    for words in (("info", "slip.txt"), ("convert", "slip.txt", "-")):
        exits(3, "2 of these errors are known slips of course files: --lenient warns instead", *words)
    exits(0, "", "info", "slip.txt", "--lenient")
    write("wrong.txt", SCENE.replace("radius 1", "radius -1") % "")
    done = exits(3, "radius", "info", "wrong.txt")
    expect(b"lenient" not in done.stderr, "no slip, no word about it", done.stderr)


def convert():
    """In another folder the same files are meant."""
    os.makedirs("in/pictures")
    os.makedirs("out/deep")
    exits(0, "", "render", "good.txt", "-n", "1", "-o", "in/pictures/t.png", "-q")
    write("in/c.txt", SCENE % "texture pictures/t.png # kept\n")
    hashes = set()
    for out in ("in/d.txt", "out/d.txt", "out/deep/d.txt", os.path.abspath("out/e.txt")):
        exits(0, "", "convert", "in/c.txt", out)
        done = exits(0, "", "render", out, "-n", "1", "--json", "-q")
        hashes.add(json.loads(done.stdout)["film_sha256"] if done.stdout else out)
    expect(len(hashes) == 1, "the same picture from everywhere", hashes)
    with open("in/d.txt", encoding="utf-8") as file:
        expect("texture pictures/t.png # kept" in file.read(), "beside the old one names stay")
    with open("out/deep/d.txt", encoding="utf-8") as file:
        text = file.read()
    expect("texture ../../in/pictures/t.png # kept" in text, "elsewhere they are relative", text)
    os.makedirs("white space/p")
    os.rename("in/pictures/t.png", "white space/p/t.png")
    write("white space/c.txt", SCENE % "texture p/t.png")
    exits(0, "out/w.txt:24:17: warning: 'p/t.png' is left as it was written", "convert", "white space/c.txt", "out/w.txt")


def signals_of(process, row):
    with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
        mask = [int(line.split()[1], 16) for line in file if line.startswith(row)][0]
    return {number for number in range(1, 65) if mask >> (number - 1) & 1}


def start(*words, **more):
    """A program that catches signals by now."""
    process = subprocess.Popen([PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, **more)
    while process.poll() is None and signal.SIGTERM not in signals_of(process, "SigCgt"):
        pass
    return process


def interrupted(what, process):
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=120)
    expect(process.returncode == 130, f"{what}: exit 130", f"exit {process.returncode}: {err.decode()}")
    return out.decode(), err.decode()


def signals():
    write("long.log", "firstlight-log 1 64x64 good.txt\n0 snapshot first.png 2\n5 snapshot second.png 1000000\n9 quit\n")
    out, _ = interrupted("replay", start("replay", "long.log", "--json", "-q"))
    line = json.loads(out)
    expect(line["interrupted"] and "latency_ms" in line and len(line["snapshots"]) <= 1, "the replay's report so far", line)
    # A million shadow rays a pixel: not even the first few pixels are there by then.
    write("heavy.txt", (SCENE % "").replace("PointLight {", "DiskLight { direction -2 -3 -4 radius 1"))
    _, err = interrupted("before the first sample", start(
        "render", "heavy.txt", "--size", "512x512", "--light-samples", "1000000", "-j", "1", "-o", "none.png", "-q"))
    expect("interrupted before" in err and not os.path.exists("none.png"), "it is said that there is no picture", err)
    interrupted("info --noise-split", start("info", os.path.join(SOURCE, "scenes/shadow-soft.txt"), "--noise-split",
                                            "--size", "2048x2048", "--light-samples", "64"))
    process = start("render", "good.txt", "-n", "1000000000", "-o", "nohup.png", "-q",
                    preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    while len(os.listdir(f"/proc/{process.pid}/task")) < 2:  # handlers stand before the first thread
        pass
    expect(signal.SIGHUP in signals_of(process, "SigIgn"), "nohup is respected")
    interrupted("nohup", process)


def main():
    for part in (usage, places, names, pictures, checks, lenient, convert, signals):
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            write("good.txt", SCENE % "")
            part()
            os.chdir("/")
    print(f"{counts[0]} passed, {counts[1]} failed")
    return counts[1] > 0


sys.exit(main())
