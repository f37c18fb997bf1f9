#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Both programs of a live session in real time, for longer than a window of samples lasts.

    bench/real_time_soak.py [--pcavr build/test/apps/pcavr/pcavr] [--minutes 25] [--work out/real_time_soak]

The simulated plant at the robot's site, the page without a visitor at the operator's. Prints sessions,
holds, late and longest cycles, and when this script, which only sleeps, was not run for 0.1 s: then other
programs have the processors, and interruptions at those times are not the sites'. Both reports are in
WORK/robot.json and WORK/operator.json. Exit code 1 if there is more than one session, or a hold: something
in the 1 kHz loop took longer than a session lasts without messages. Needs only python3, a built page, and
two processors for itself.
"""
import argparse
import json
import pathlib
import signal
import subprocess
import sys
import time

PORT = 47563
MAX_WAIT = 60.0  # [s] for the start and the end of a program
STALL = 0.1  # [s] less than half of what ends a session


def make_scene(pcavr, work):
    scene = work / "scene"
    if scene.exists():
        return scene
    subprocess.run([pcavr, "simulate", "push", "--seed", "1", "-o", work / "recording"], check=True)
    subprocess.run([pcavr, "build", work / "recording", "-o", scene], check=True)
    return scene


def start(*words):
    return subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE, text=True)


def stalls_while_sleeping(duration):
    """Sleeps for milliseconds, as the sites' loops do; returns when it was late, and by how much [s]."""
    stalls = []
    start = last = time.monotonic()
    while last - start < duration:
        time.sleep(0.001)
        now = time.monotonic()
        if now - last > STALL:
            stalls.append((last - start, now - last))
        last = now
    return stalls


def report_of(process):
    """The last object that it prints, after the line of its start."""
    process.send_signal(signal.SIGINT)
    text = process.communicate(timeout=MAX_WAIT)[0]
    decoder, reports, at = json.JSONDecoder(), [], 0
    while text[at:].strip():
        at += len(text[at:]) - len(text[at:].lstrip())
        report, length = decoder.raw_decode(text[at:])
        reports.append(report)
        at += length
    return reports[-1]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--pcavr", default="build/test/apps/pcavr/pcavr")
    parser.add_argument("--minutes", type=float, default=25.0)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/real_time_soak"))
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    scene = make_scene(arguments.pcavr, arguments.work)
    robot = start(arguments.pcavr, "robot-site", scene, "--plant", "push", "--seed", 1,
                  "--port", PORT, "--json")
    person = None
    try:
        person = start(arguments.pcavr, "operator-site", scene, "--port", PORT, "--page-port", 0,
                       "--forward-delay", 0.2, "--backward-delay", 0.2, "--json")
        stalls = stalls_while_sleeping(60.0 * arguments.minutes)
        operator = report_of(person)
        report = report_of(robot)
    finally:
        for process in (person, robot):
            if process and process.poll() is None:
                process.kill()
    (arguments.work / "robot.json").write_text(json.dumps(report, indent=1))
    (arguments.work / "operator.json").write_text(json.dumps(operator, indent=1))
    print(f"{arguments.minutes:g} min: {report['sessions']} sessions, {report['holds']} holds, "
          f"{report['late_cycles']} late cycles at the robot's site, {operator['late_cycles']} at the operator's\n"
          f"longest cycle: {1000 * report['max_correction_cpu_s']:.2f} ms of computing at the robot's site, "
          f"{1000 * operator['cycle_longest_s']:.2f} ms of time at the operator's\n"
          f"the machine did not run this script for over {STALL:g} s {len(stalls)} times")
    for interruption in operator["interruptions"]:
        print(f"  interrupted at {interruption['t']:.2f} s of the world, for {interruption['duration_s']:.2f} s")
    for begin, duration in stalls:
        print(f"  not run at {begin:.2f} s, for {duration:.2f} s")
    return 0 if report["sessions"] == 1 and report["holds"] == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
