#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Kills `pcavr run`, and its tasks, at random instants, and checks what is left.

    tests/jobs/kill_runs.py --pcavr build/dev/apps/pcavr/pcavr --seed 1 --count 30

A trial sends SIGKILL to the command, to one of its tasks, or to both of two that share the plan. It fails
where an output is there in part or with other bytes than without kills, where something is done twice that
was done, where a killed task is not named, or where the next `run` does not finish the plan. The same seed
and count give the same instants. Needs only python3.
"""
import argparse
import json
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import lab

KINDS = ["run", "task", "run", "task", "both"]
JOBS = 2


def children_of(process):
    path = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
    try:
        return [int(word) for word in path.read_text().split()]
    except OSError:
        return []


def kill(pid):
    try:
        subprocess.run(["kill", "-KILL", str(pid)], capture_output=True, check=False)
    except OSError:
        pass


class Trials:
    def __init__(self, pcavr, folder, recordings):
        self.killed = self.named = 0
        self.pcavr, self.plan = pcavr, folder / "plan.json"
        self.results = folder / "plan"
        lab.call(pcavr, "plan", lab.record(pcavr, folder, recordings), "--chain", "build,identify,replay,evaluate",
                 "-o", self.plan)
        start = time.monotonic()
        self.tasks = lab.call(pcavr, "run", self.plan, "--jobs", JOBS)["ran"]
        self.duration = time.monotonic() - start
        self.expected = lab.outputs_of(self.results)

    def start(self):
        return subprocess.Popen([self.pcavr, "run", self.plan, "--jobs", str(JOBS), "--json"],
                                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)

    def done(self):
        return lab.call(self.pcavr, "status", self.plan)["done"]

    def kill_once(self, kind, delay, choice):
        """Starts what is not done, and kills. Returns the faults; counts the tasks that were killed and named."""
        before = self.done()
        runs = [self.start() for _ in range(2 if kind == "both" else 1)]
        time.sleep(delay)
        killed = []
        if kind == "task":
            killed = children_of(runs[0])[:1] if choice < 0.5 else children_of(runs[0])[-1:]
            for pid in killed:
                kill(pid)
        else:
            for process in runs:
                process.send_signal(signal.SIGKILL)
        outputs = [process.communicate(timeout=lab.TIMEOUT)[0] for process in runs]
        faults = []
        if kind == "task":
            failed = json.loads(outputs[0])["failed"] if outputs[0] else []
            if runs[0].returncode not in (0, 1):
                faults.append(f"run ended with {runs[0].returncode}")
            # A child that had already ended, and was not yet collected, can't be killed.
            self.killed += len(killed)
            self.named += sum("signal 9" in task["reason"] for task in failed)
            if any("signal 9" not in task["reason"] for task in failed):
                faults.append(f"a task failed otherwise: {failed}")
        time.sleep(0.2)  # SIGTERM reaches the children of a killed one
        faults += lab.faults_of(self.results, self.expected, is_complete=False)
        if self.done() < before:
            faults.append("what was done is not done any more")
        return faults

    def finish(self):
        """Two at once do what is left, each task once."""
        left = self.tasks - self.done()
        runs = [self.start() for _ in range(2)]
        outputs = [json.loads(process.communicate(timeout=lab.TIMEOUT)[0]) for process in runs]
        faults = [f"run failed: {output['failed']}" for output in outputs if output["failed"]]
        ran = sum(output["ran"] for output in outputs)
        if ran != left:
            faults.append(f"{ran} tasks were run, and {left} were not done")
        return faults + lab.faults_of(self.results, self.expected, is_complete=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pcavr", required=True, type=pathlib.Path, help="the command")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--recordings", type=int, default=2)
    arguments = parser.parse_args()
    failed = rounds = 0
    with tempfile.TemporaryDirectory(prefix="pcavr-jobs-") as name:
        trials = Trials(str(arguments.pcavr.resolve()), pathlib.Path(name), arguments.recordings)
        shutil.rmtree(trials.results)
        for i in range(arguments.count):
            rng = random.Random(f"{arguments.seed}/{i}")
            kind, delay = KINDS[i % len(KINDS)], rng.uniform(0.0, 0.6 * trials.duration)
            faults = trials.kill_once(kind, delay, rng.random())
            # What is done stays for the next kill, so that late tasks are killed, too.
            if trials.done() == trials.tasks or i + 1 == arguments.count:
                rounds += 1
                faults += trials.finish()
                shutil.rmtree(trials.results)
            failed += bool(faults)
            if faults:
                print(f"FAILED {i}: {kind} after {delay:.3f} s: {'; '.join(faults[:4])}", flush=True)
        if trials.killed > 0 and trials.named == 0:
            failed += 1
            print(f"FAILED: of {trials.killed} tasks that were killed none was named", flush=True)
    print(f"seed {arguments.seed}: {arguments.count} kills in {rounds} rounds of {trials.tasks} tasks, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
