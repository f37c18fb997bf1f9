#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Ends the command at random instants, and checks what is left.

    tests/sweep/kills.py --pcavr build/dev/apps/pcavr/pcavr --seed 1 --count 200

A trial sends SIGKILL, SIGTERM, SIGINT or SIGHUP to a command that writes. It fails where the output
is there in part, where another signal than SIGKILL leaves an unfinished one behind, where the
command does not end, or where it can't be run again to its end. A session that `serve` records is
there as far as it went. The same seed and count give the same trials. Needs only python3.
"""
import argparse
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import sources

SIGNALS = [signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP]
MAX_WAIT = 30.0  # [s] for an end
SESSION = 1.5  # [s] of a recorded one
LATEST = 1.1  # [duration of the whole command] some kills come too late


class Case:
    """A command that writes. `is_sound`: whether its output is whole; `ends`: False for a server."""

    def __init__(self, name, args, output, is_sound, ends=True):
        self.name, self.args, self.output = name, [str(arg) for arg in args], output
        self.is_sound, self.ends = is_sound, ends
        self.duration = SESSION


def run(pcavr, args):
    return subprocess.run([pcavr, *map(str, args)], capture_output=True, text=True, timeout=120)


def make_cases(pcavr, folder):
    recording, scene = folder / "recording", folder / "scene"
    for args in (["simulate", "push", "--no-images", "--seed", 12, "-o", recording],
                 ["build", recording, "-o", scene]):
        done = run(pcavr, args)
        if done.returncode != 0:
            sys.exit(f"can't make sound inputs: {args}\n{done.stderr}")
    sources.write_bag(folder / "bag")
    output = folder / "output"
    key, public = output / "alice.key", output / "alice.pub"

    def passes_inspection():
        return run(pcavr, ["inspect", output]).returncode == 0

    def is_parameter_file():
        text = output.read_text()
        return text.endswith("\n") and "box_2" in text

    def is_pair():
        return key.exists() == public.exists() and (
            not key.exists() or key.stat().st_size > 40 <= public.stat().st_size)

    cases = [
        Case("simulate", ["simulate", "probe", "--no-images", "-o", output], output,
             passes_inspection),
        Case("build", ["build", recording, "-o", output], output, passes_inspection),
        Case("import", ["import", folder / "bag", "--tool-topic", "/tip", "--wrench-topic", "/ft",
                        "-o", output], output, passes_inspection),
        Case("replay", ["replay", recording, "--scene", scene, "--tracked", recording / "tracked",
                        "-o", output], output, passes_inspection),
        Case("identify", ["identify", "friction", recording, "--scene", scene, "--tracked",
                          recording / "tracked", "-o", output], output, is_parameter_file),
        Case("keygen", ["keygen", "alice", "-o", output], output, is_pair),
        Case("serve --record", ["serve", scene, "--port", 0, "--record", output], output,
             passes_inspection, ends=False)]
    return cases


def clear(folder, case):
    for path in folder.iterdir():
        if path.name.startswith("output") or ".partial" in path.name or ".pcavr" in path.name:
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    assert not case.output.exists()


def measure(pcavr, folder, case):
    clear(folder, case)
    if not case.ends:
        return
    start = time.monotonic()
    done = run(pcavr, case.args)
    case.duration = time.monotonic() - start
    if done.returncode != 0 or not case.is_sound():
        sys.exit(f"{case.name} does not work: {done.stderr}")


def leftovers(folder):
    return [path.name for path in folder.rglob("*") if ".partial" in path.name]


def faults_of(folder, case, number):
    faults = []
    if case.output.exists() and not case.is_sound():
        faults.append("an output that is there in part")
    if number != signal.SIGKILL and leftovers(folder):
        faults.append(f"left behind {leftovers(folder)[0]}")
    return faults


def kill_one(pcavr, folder, case, rng):
    """Returns what was done, and the faults."""
    number, delay = rng.choice(SIGNALS), rng.uniform(0.0, LATEST * case.duration)
    clear(folder, case)
    process = subprocess.Popen([pcavr, *case.args], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               stdin=subprocess.DEVNULL)
    time.sleep(delay)
    process.send_signal(number)
    what = f"{case.name}, {number.name} after {delay:.3f} s"
    try:
        _, errors = process.communicate(timeout=MAX_WAIT)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return what, ["does not end"]
    faults = faults_of(folder, case, number)
    if b"internal error" in errors:
        faults.append("internal error")
    if case.ends and not case.output.exists():
        again = run(pcavr, case.args)
        if again.returncode != 0 or not case.is_sound():
            faults.append(f"can't be run again: {again.stderr.strip()[-200:]}")
        elif leftovers(folder):
            faults.append(f"the next run leaves {leftovers(folder)[0]} behind")
    return what, faults


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pcavr", required=True, type=pathlib.Path, help="the command")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--count", type=int, default=200)
    arguments = parser.parse_args()
    pcavr = str(arguments.pcavr.resolve())
    failed = 0
    with tempfile.TemporaryDirectory(prefix="pcavr-kills-") as name:
        folder = pathlib.Path(name)
        cases = make_cases(pcavr, folder)
        for case in cases:
            measure(pcavr, folder, case)
        for i in range(arguments.count):
            what, faults = kill_one(pcavr, folder, cases[i % len(cases)],
                                    random.Random(f"{arguments.seed}/{i}"))
            failed += bool(faults)
            if faults:
                print(f"FAILED {i}: {what}: {'; '.join(faults)}", flush=True)
    print(f"seed {arguments.seed}: {arguments.count} kills, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
