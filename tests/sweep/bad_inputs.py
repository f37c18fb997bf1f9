#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Fuzzes the command with random bad inputs, and checks its behaviour.

    tests/sweep/bad_inputs.py --pcavr build/dev/apps/pcavr/pcavr --seed 1 --count 300

A trial fails where the command crashes, computes for over 20 s, takes over 6 GB, reports an internal
error, prints its error in other than one line or with control characters, writes a number that is
not finite, changes an input, leaves a partial output, or succeeds without a warning on data that
contradict each other by a factor of 1.5 or more. The same seed and count give
the same trials; `--only 17` runs the 17th alone and keeps its files. Needs only python3.
"""
import argparse
import collections
import concurrent.futures
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

import faults
import hostile
import sources
import trial

FRAMES = 8  # of the recording with images: enough to track, quick to build


def run(*args):
    done = subprocess.run([str(arg) for arg in args], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"can't make sound inputs: {' '.join(map(str, args))}\n{done.stderr}")


def thin_lists(recording, count):
    """Keeps `count` images of each list, evenly spread."""
    for name in ("rgb.txt", "depth.txt"):
        rows = [r for r in (recording / name).read_text().split("\n") if r and r[0] != "#"]
        keep = [rows[i * (len(rows) - 1) // (count - 1)] for i in range(count)]
        (recording / name).write_text("\n".join(keep) + "\n")
    (recording / "written.yaml").unlink()  # the lists are changed: their rows must not be checked


def make_sound_inputs(pcavr, folder):
    sound = faults.Sound(folder)
    run(pcavr, "simulate", "tabletop", "-o", sound.images, "--seed", "11")
    thin_lists(sound.images, FRAMES)
    listed = {row.split()[1] for name in ("rgb.txt", "depth.txt")
            for row in (sound.images / name).read_text().split("\n") if row}
    for path in faults.files_of(sound.images, ".png", ".jpg"):
        if str(path.relative_to(sound.images)) not in listed:
            path.unlink()
    run(pcavr, "build", sound.images, "-o", sound.images_scene)
    run(pcavr, "simulate", "push", "--no-images", "-o", sound.push, "--seed", "12")
    run(pcavr, "build", sound.push, "-o", sound.push_scene)
    run(pcavr, "identify", "friction", sound.push, "--scene", sound.push_scene, "--tracked",
        sound.push / "tracked", "-o", sound.parameters)
    shutil.rmtree(folder / "parameters.report", ignore_errors=True)
    run(pcavr, "replay", sound.push, "--scene", sound.push_scene, "--tracked",
        sound.push / "tracked", "--parameters", sound.parameters, "-o", sound.run)
    sound.bag, sound.arm, sound.arm_report = (folder / name for name in ("bag", "arm", "arm-report"))
    sources.write_bag(sound.bag)
    sound.arm.mkdir()
    (sound.arm / "arm.urdf").write_text(sources.arm_urdf())
    (sound.arm / "joints.csv").write_text(sources.arm_log(random.Random(13)))
    run(pcavr, "identify", "robot", sound.arm / "joints.csv", "--robot", sound.arm / "arm.urdf",
        "-o", sound.arm_report)
    run(pcavr, "import", sound.bag, "-o", folder / "imported", "--tool-topic", "/tip",
        "--wrench-topic", "/ft")
    return sound


def draw(rng, sound, work):
    kinds = faults.FAULTS | hostile.HOSTILE
    name = rng.choices(list(kinds), [weight for weight, _ in kinds.values()])[0]
    return name, kinds[name][1](rng, sound, work)


def run_one(pcavr, sound, work, seed, number, keep):
    rng = random.Random(f"{seed}/{number}")
    private = work / str(number)
    private.mkdir()
    kind, bad_trial = draw(rng, sound, private)
    outcome = trial.run_trial(pcavr, bad_trial)
    if not keep and not outcome.faults:
        shutil.rmtree(private, ignore_errors=True)
    return number, kind, outcome


def print_outcome(number, kind, outcome, is_verbose):
    if outcome.faults:
        args = " ".join(f"'{arg}'" for arg in outcome.trial.args)
        print(f"FAILED {number} [{kind}] {outcome.trial.name}: {'; '.join(outcome.faults)}\n"
              f"  {outcome.trial.prefix} pcavr {args}\n  {outcome.last_line[:300]}", flush=True)
    elif is_verbose:
        print(f"ok {number} [{kind}] {outcome.trial.name}: exit {outcome.exit_code}, "
              f"{outcome.seconds:.1f} s: {outcome.last_line[:240]}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pcavr", required=True, type=pathlib.Path, help="the command")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--only", type=int, help="run this trial alone and keep its files")
    parser.add_argument("--work", type=pathlib.Path, help="folder for files; default: temporary")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--verbose", action="store_true")
    arguments = parser.parse_args()

    work = arguments.work or pathlib.Path(tempfile.mkdtemp(prefix="pcavr-sweep-"))
    work.mkdir(parents=True, exist_ok=True)
    pcavr = arguments.pcavr.resolve()
    (work / "sound").mkdir()
    sound = make_sound_inputs(pcavr, work / "sound")
    before = trial.state_of(sound.folder)

    numbers = [arguments.only] if arguments.only is not None else range(arguments.count)
    failed = 0
    kinds = collections.Counter()
    longest = 0.0
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        futures = [pool.submit(run_one, pcavr, sound, work, arguments.seed, number,
                               arguments.only is not None) for number in numbers]
        for done in futures:
            number, kind, outcome = done.result()
            kinds[kind] += 1
            longest = max(longest, outcome.seconds)
            failed += bool(outcome.faults)
            print_outcome(number, kind, outcome, arguments.verbose or arguments.only is not None)
    if trial.state_of(sound.folder) != before:
        print("FAILED: the sound inputs were changed")
        failed += 1
    print(", ".join(f"{kind}: {count}" for kind, count in sorted(kinds.items())))
    print(f"seed {arguments.seed}; longest run {longest:.1f} s")
    print(f"{len(list(numbers)) - failed} passed, {failed} failed")
    if failed == 0 and arguments.work is None and arguments.only is None:
        shutil.rmtree(work, ignore_errors=True)
    else:
        print(f"files: {work}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
