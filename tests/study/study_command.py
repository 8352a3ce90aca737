#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The study command as a program: the same figures twice, a progress bar on a terminal, and nothing lost when interrupted.

usage: study_command.py FIRSTLIGHT SOURCE_DIR
"""
import csv
import json
import os
import pty
import re
import signal
import subprocess
import sys
import tempfile

PROGRAM, SOURCE = sys.argv[1], sys.argv[2]
TIMED = {"cpu_s", "wall_s", "load"}
failures = []


def expect(truth, what):
    print(("ok: " if truth else "FAIL: ") + what)
    if not truth:
        failures.append(what)


def command(scene, out, *more):
    return [PROGRAM, "study", os.path.join(SOURCE, "tests/study", scene), "--out", out, *more]


def rows(out):
    with open(os.path.join(out, "study.csv"), encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def figures(out):
    with open(os.path.join(out, "study.json"), encoding="utf-8") as file:
        return json.load(file)


def untimed(x):
    """Without what a clock decides: times, ratios of times, the front."""
    clocks = TIMED | {"machine", "seconds", "build_s", "cpu", "mse_times_cpu", "pareto_front", "sentences", "summary",
                      "command"}
    if isinstance(x, dict):
        return {k: untimed(v) for k, v in x.items() if k not in clocks}
    return [untimed(v) for v in x] if isinstance(x, list) else x


def repeats(folder):
    small = ["--size", "24x24", "--samples", "8", "--repeats", "2", "--quiet"]
    a, b = os.path.join(folder, "a"), os.path.join(folder, "b")
    subprocess.run(command("glass.txt", a, *small, "-j", "1"), check=True)
    subprocess.run(command("glass.txt", b, *small, "-j", "2"), check=True)
    left = [{k: v for k, v in row.items() if k not in TIMED} for row in rows(a)]
    right = [{k: v for k, v in row.items() if k not in TIMED} for row in rows(b)]
    expect(len(left) > 100 and left == right, f"{len(left)} rows of study.csv are the same twice")
    expect(untimed(figures(a)) == untimed(figures(b)), "study.json is the same twice")
    expect(all(int(row["invalid_samples"]) == 0 and float(row["flip"]) > 0 for row in left), "every row has its FLIP")
    expect(figures(a)["reference"]["share_of_best"] <= 0.1, "references are good to a tenth of the best measured")
    with open(os.path.join(a, "index.html"), encoding="utf-8") as file:
        page = file.read()
    links = re.findall(r"(?:src|href)='?\"?([^'\" >]{0,20})", page)
    expect(len(links) > 20 and all(link.startswith("data:image/") for link in links), "the page stands alone")


def on_terminal(arguments, until):
    """Run with standard error on a terminal; SIGINT when `until` was printed. Exit code and what was printed."""
    master, slave = pty.openpty()
    process = subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=slave)
    os.close(slave)
    text = b""
    try:
        while until not in text:
            text += os.read(master, 4096)
        process.send_signal(signal.SIGINT)
        while True:
            text += os.read(master, 4096)
    except OSError:  # The other end is closed.
        pass
    os.close(master)
    return process.wait(), text.decode()


def interrupted(folder):
    out = os.path.join(folder, "interrupted")
    code, text = on_terminal(command("lens.txt", out, "--size", "48x48", "--samples", "64", "--repeats", "64", "--sweep",
                                     "sampler,depth"), b"round 3 of 64")
    expect(code == 130, "an interrupt ends with 130")
    expect(re.search(r"\[#*\.*\] +\d+ % round 2 of 64, [a-z=0-9-]+", text) is not None, "progress names the round and the setting")
    expect("s left" in text, "progress says how long it will take")
    data = figures(out)
    expect(data["interrupted"] and 2 <= data["rounds"] < 64, f"{data['rounds']} complete rounds are kept")
    expect(len(rows(out)) >= 2 * 7 * len(data["configs"]), "so are their pictures' figures")
    with open(os.path.join(out, "index.html"), encoding="utf-8") as file:
        expect("Interrupted" in file.read(), "the page says that it was interrupted")


def out_of_budget(folder):
    out = os.path.join(folder, "budget")
    subprocess.run(command("lens.txt", out, "--samples", "1024", "--repeats", "64", "--budget", "1", "--quiet"), check=True)
    expect(figures(out)["out_of_budget"], "a budget ends a study")


def nowhere(folder):
    """What cannot be written is said before it is measured: this study would take hours."""
    out = os.path.join(folder, "no", "where")
    done = subprocess.run(command("lens.txt", out, "--samples", "65536", "--repeats", "64"), stderr=subprocess.PIPE,
                          text=True, timeout=60)
    expect(done.returncode == 4 and "no/where" in done.stderr, "a missing folder is said at once")


def noiseless(folder):
    """A scene without any error still has its page and plots."""
    out = os.path.join(folder, "noiseless")
    done = subprocess.run(command("furnace.txt", out, "--size", "16x16", "--samples", "8", "--repeats", "2", "--quiet"),
                          stderr=subprocess.PIPE, text=True)
    expect(done.returncode == 0 and done.stderr == "", "a scene without noise is no trouble for the plots")
    with open(os.path.join(out, "index.html"), encoding="utf-8") as file:
        expect(not re.search(r"</h2>\s*<h2>", file.read()), "no heading stands over nothing")


def main():
    with tempfile.TemporaryDirectory() as folder:
        repeats(folder)
        interrupted(folder)
        out_of_budget(folder)
        noiseless(folder)
        nowhere(folder)
    sys.exit(1 if failures else 0)


main()
