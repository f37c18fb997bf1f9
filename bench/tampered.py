#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Does the command find what is wrong with the clock or the rows of one stream?

    PCAVR_DATA=DATA bench/tampered.py --pcavr build/test/apps/pcavr/pcavr [--count 25]
                                      [--kinds frame,held,drift,step] [--seed 1]
                                      [--work out/tampered] [--verbose]

For each kind `--count` recordings are made, each from its own seed: pushes and presses by
`pcavr simulate`, other rigs' plants and pose streams of DATA where they are, and two streams of one
drawn motion. One stream of each is tampered with:

    frame   each row has the values of the row before: the source is one frame late
    held    stretches, or all, of the rows repeat a value, as a resampler of a slower source does
    drift   its clock is 50 ppm fast
    step    its clock is set once, ahead or back, by 20 to 300 ms

A user's command is asked about the recording as it was and as it is: `pcavr doctor RECORDING`, or
`pcavr calibrate clocks A B` for two streams. It has found the fault if a row that disagrees names
kind and stream; of two streams, if it states an offset that is another one than before by a frame,
a drift by more than four of its stds, a step of the size, or held rows. It has accused falsely if
it says such a thing of the recording as it was.

What the data can't show is counted apart, by the std that the command states of the recording as it
was: a frame of less than three of them; a drift that makes less than four of them over the record; a
step, which is the difference of two offsets of half the record each, of less than six of its.
50 ppm are 3 ms in a minute: contacts show it of ten minutes, the drawn streams last for 3 to 8.
A step in a rest is no such case: the stamps show it. Needs only python3.
"""
import argparse
import collections
import json
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "sweep"))
from calibration_stds import Draw, chain, pose_row, random_motion
from recorded_tables import Table, forget_counts, streams
from sound_rigs import change_some

PPM = 5e-5
SAID = {"frame": r"(later|earlier) than", "held": r"each value stands|repeat the one before",
        "drift": r"drifts against", "step": r"clock .*was set|is not after the previous"}
MIN_STDS = 4.0  # of a drift that counts as found
MIN_STEP_STDS = 6.0  # of a step: it is the best of many instants
TASKS = ("push", "probe", "turn", "press")
HEADER = "t,x,y,z,qx,qy,qz,qw"


# Sound recordings


class Rig:
    """A recording of pushes or presses, which `doctor` is asked about."""

    def __init__(self, path):
        self.path = path

    def tables(self, kind):
        found = streams(self.path)
        if kind == "frame":
            return {name: table for name, table in found.items() if name.startswith("tracking")}
        return found

    def copy(self, target):
        shutil.copytree(self.path, target, copy_function=shutil.copyfile)
        forget_counts(target)
        return Rig(target)

    def ask(self, pcavr):
        done = subprocess.run([pcavr, "doctor", self.path, "--json"], capture_output=True, text=True)
        if done.returncode not in (0, 3):
            raise RuntimeError(done.stderr)
        return json.loads(done.stdout)


class Streams:
    """Two streams of one body, which `calibrate clocks` is asked about."""

    def __init__(self, path):
        self.path = path

    def tables(self, kind):
        return {name: Table(self.path / f"{name}.csv") for name in "ab"}

    def copy(self, target):
        shutil.copytree(self.path, target, copy_function=shutil.copyfile)
        return Streams(target)

    def ask(self, pcavr):
        words = [pcavr, "calibrate", "clocks", self.path / "a.csv", self.path / "b.csv", "-o",
                 self.path / "clocks.yaml", "--force", "--json"]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode != 0:
            return {"refused": done.stderr.strip().splitlines()[-1], "notes": []}
        return json.loads(done.stdout)


def simulated(rng, folder, pcavr, kind):
    long = ("--duration", "600") if kind == "drift" else ()
    task = "push" if long else rng.choice(TASKS[:3] if kind == "frame" else TASKS)
    words = [pcavr, "simulate", task, "-o", folder, "--seed", str(rng.randint(1, 10**6)), "--no-images", *long]
    subprocess.run(words, capture_output=True, check=True)
    change_some(rng, folder)
    return Rig(folder), task


def plant(rng, folder, pcavr, kind):
    found = sorted(pathlib.Path(os.environ.get("PCAVR_DATA", "")).glob("plants/*-*"))
    if kind == "frame":
        found = [path for path in found if not path.name.startswith("press")]
    if not found:
        return None
    chosen = rng.choice(found)
    return Rig(chosen).copy(folder), chosen.name


def recorded_streams(rng, folder, pcavr, kind):
    found = sorted(pathlib.Path(os.environ.get("PCAVR_DATA", "")).glob("real/pose_streams/*/"))
    if not found:
        return None
    chosen = rng.choice(found)
    folder.mkdir(parents=True)
    # The slower one is that of a camera.
    files = sorted(chosen.glob("*.csv"), key=lambda file: -file.stat().st_size)
    for name, file in zip("ab", files):
        rows = [line.replace(" ", "") for line in file.read_text().splitlines() if line and line[0] not in "#t"]
        (folder / f"{name}.csv").write_text("\n".join([HEADER, *rows]) + "\n")
    return Streams(folder), chosen.name


def drawn_streams(rng, folder, pcavr, kind):
    draw = Draw(rng.random())
    at, world, body = random_motion(draw), draw.pose(1.0, 1.0), draw.pose(0.2, 1.0)
    duration = draw.uniform(180.0, 480.0) if kind == "drift" else draw.uniform(20.0, 60.0)
    noise, offset = 10.0 ** draw.uniform(-4.0, -3.0), draw.uniform(-0.2, 0.2)
    folder.mkdir(parents=True)
    for name, rate, place in (("a", draw.uniform(40, 100), lambda t: chain(world, at(t))),
                              ("b", draw.uniform(20, 40), lambda t: chain(at(t + offset), body))):
        rows = [[i / rate] + pose_row(chain(place(i / rate), draw.pose(noise, noise)))
                for i in range(int(duration * rate))]
        lines = [",".join(f"{x:.9g}" for x in row) for row in rows]
        (folder / f"{name}.csv").write_text("\n".join([HEADER, *lines]) + "\n")
    return Streams(folder), f"{duration:.0f} s"


SOURCES = {"simulated": simulated, "plant": plant, "drawn": drawn_streams, "recorded": recorded_streams}


# What is done to one stream


def frame(rng, table):
    """[s] by which it is late."""
    values = [row[1:] for row in table.rows]
    table.rows = [[row[0], *value] for row, value in zip(table.rows[1:], values)]
    gaps = sorted(b[0] - a[0] for a, b in zip(table.rows, table.rows[1:]))
    return gaps[len(gaps) // 2]


def held(rng, table):
    rows, count = table.rows, rng.randint(2, 8)
    if rng.random() < 0.4:
        stretches = [(0, len(rows))]
    else:
        length = max(4 * count, int(rng.uniform(0.05, 0.3) * len(rows)))
        first = rng.randrange(max(1, len(rows) - length))
        stretches = [(first, first + length)]
    for begin, end in stretches:
        for i in range(begin, min(end, len(rows))):
            rows[i] = [rows[i][0], *rows[i - (i - begin) % count][1:]]
    return count


def drift(rng, table):
    first = table.rows[0][0]
    table.rows = [[first + (row[0] - first) * (1.0 + PPM), *row[1:]] for row in table.rows]
    return table.rows[-1][0] - first


def step(rng, table):
    """[s] by which the clock is set ahead."""
    size = math.exp(rng.uniform(math.log(0.02), math.log(0.3))) * rng.choice((1.0, -1.0))
    first, last = table.rows[0][0], max(row[0] for row in table.rows)
    at = first + rng.uniform(0.2, 0.8) * (last - first)
    table.rows = [[row[0] + (size if row[0] > at else 0.0), *row[1:]] for row in table.rows]
    return size


KINDS = {"frame": frame, "held": held, "drift": drift, "step": step}


# What the command says


def accusations(report, kind):
    """Rows that disagree, or notes, which speak of this kind of fault."""
    rows = [f"{row['what']}: {row['figure']}; {row.get('likely', '')}" for row in report.get("disagrees", [])]
    rows += [note for note in report.get("notes", []) if "step" not in note]
    found = [row for row in rows if re.search(SAID[kind], row)]
    if kind == "step" and "step" in report:
        found.append(f"step of {1e3 * report['step']['size']:.0f} ms")
    if kind == "drift" and abs(report.get("drift", 0.0)) > MIN_STDS * report.get("drift_std", 1.0):
        found.append(f"drift of {1e6 * report['drift']:.0f} ppm")
    return found


def names(row, stream, size):
    """Whether a row is about the stream, or about its clock against another one's."""
    key = {"tool": "tool.csv", "force": "wrench.csv"}.get(stream, "track")
    return key in row.lower() or (key == "tool.csv" and "clock" in row)


def is_found(kind, stream, size, sound, report):
    if "offset" not in sound:  # of `doctor`
        return any(names(row, stream, size) for row in accusations(report, kind))
    if "refused" in report:
        return False
    if kind == "frame":
        change = (report["offset"] - sound["offset"]) * (-1.0 if stream == "b" else 1.0)
        std = math.hypot(report["offset_std"], sound["offset_std"])
        return abs(change - size) < 3.0 * std
    if kind == "step":
        found = report.get("step")
        return bool(found) and abs(abs(found["size"]) - abs(size)) < max(5.0 * found["size_std"], 0.1 * abs(size))
    return bool(accusations(report, kind))


def stated_std(kind, stream, sound):
    """[s], or [1] of a drift: what the command says of the sound recording; infinite: nothing."""
    if "offset" in sound:
        return sound.get("drift_std", math.inf) if kind == "drift" else sound["offset_std"]
    if "refused" in sound:
        return math.inf
    for row in sound["agrees"]:
        if kind == "frame" and row["what"].startswith("clock of the tracking against tool.csv"):
            match = re.search(r"\+- ([\d.]+) ms$", row["figure"])
            if match:
                return 1e-3 * float(match[1])
        key = "wrench.csv" if stream == "force" else "tracking"
        if kind == "drift" and re.match(f"clock of (the )?{key}.* over time", row["what"]):
            match = re.search(r"drift of [-\d]+ \+- (\d+) ppm", row["figure"])
            if match:
                return 1e-6 * float(match[1])
    return math.inf


def is_observable(kind, stream, size, sound):
    if kind == "frame":
        return size > 3.0 * stated_std(kind, stream, sound)
    if kind == "drift":
        return PPM > MIN_STDS * stated_std(kind, stream, sound)
    if kind == "step" and "offset" in sound:
        return abs(size) > MIN_STEP_STDS * 2.0 * sound["offset_std"]
    return "refused" not in sound


def run_one(arguments, kind, number):
    """A line of the result: source, stream, whether found, false accusations, whether observable."""
    rng = random.Random(f"{arguments.seed}/{kind}/{number}")
    folder = arguments.work / kind / str(number)
    shutil.rmtree(folder, ignore_errors=True)
    chosen = arguments.sources.split(",")
    source = SOURCES[chosen[number % len(chosen)]]
    made = source(rng, folder / "sound", arguments.pcavr, kind) or simulated(rng, folder / "sound", arguments.pcavr, kind)
    sound, name = made
    tampered = sound.copy(folder / "tampered")
    stream, table = rng.choice(list(tampered.tables(kind).items()))
    size = KINDS[kind](rng, table)
    table.save()
    before, after = sound.ask(arguments.pcavr), tampered.ask(arguments.pcavr)
    false = [row for one in KINDS if one != "frame" or "offset" not in before for row in accusations(before, one)]
    found = is_found(kind, stream, size, before, after)
    observable = found or is_observable(kind, stream, size, before)
    if found and not arguments.keep:
        shutil.rmtree(folder)
    what = f"{source.__name__} {name}, {stream}, {size:.4g}"
    return what, found, observable, false, after


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pcavr", default="build/test/apps/pcavr/pcavr", type=pathlib.Path)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--sources", default=",".join(SOURCES), help="recordings, in turns")
    parser.add_argument("--count", type=int, default=25)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/tampered"))
    parser.add_argument("--verbose", action="store_true", help="a line for each recording")
    parser.add_argument("--keep", action="store_true", help="keep the files of faults that are found, too")
    arguments = parser.parse_args()
    total = collections.Counter()
    for kind in arguments.kinds.split(","):
        counts = collections.Counter()
        for number in range(arguments.count):
            what, found, observable, false, after = run_one(arguments, kind, number)
            counts.update({"found": found, "not observable": not observable, "missed": observable and not found,
                           "false": bool(false)})
            if arguments.verbose or false or not found:
                print(f"{kind} {number}: {what}: {'found' if found else 'missed' if observable else 'not observable'}"
                      + "".join(f"\n    false: {row}" for row in false), flush=True)
            if not found and observable:
                said = [f"{row['what']}: {row['figure']}" for row in after.get("disagrees", [])]
                said += [after[key] for key in ("refused",) if key in after]
                print("".join(f"    said: {row}\n" for row in said), end="", flush=True)
        total.update(counts)
        print(f"{kind}: " + ", ".join(f"{count} {name}" for name, count in counts.items()), flush=True)
    recordings = arguments.count * len(arguments.kinds.split(","))
    print(f"{total['found']} of {recordings} found, {total['not observable']} not observable, {total['missed']} missed; "
          f"{total['false']} of {recordings} sound ones accused")
    return 0 if total["missed"] <= 0.05 * recordings and total["false"] <= 0.02 * recordings else 1


if __name__ == "__main__":
    sys.exit(main())
