#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""A plan under Slurm, on two nodes of one core each: the bytes of a single process, also where a node is lost.

    tests/jobs/two_nodes.py --pcavr build/test/apps/pcavr/pcavr                       # some 20 s
    tests/jobs/two_nodes.py --pcavr ... --recordings 6 --kills 10 --seed 1            # at random instants
    tests/jobs/two_nodes.py --pcavr ... --recordings 20 --throughput                  # two nodes against one

A kill is SIGKILL of one of a node's tasks, of a node with its daemon and its task, or of the controller;
what was killed is started again. Exit code 77, skipped: Slurm is not installed. Needs only python3 and
slurm-wlm; all is in a temporary folder, on the loopback interface.
"""
import argparse
import contextlib
import os
import pathlib
import random
import shutil
import sys
import tempfile
import time

import cluster
import lab

SKIPPED = 77
PLAN_TIMEOUT = 60.0  # s, and for each task
TASK_TIMEOUT = 15.0
KINDS = ["node", "task", "controller"]
MIN_THROUGHPUT = 1.8  # of two nodes against one, on a machine with nothing else to do


def plan(pcavr, folder, recordings, chain="build,identify,replay,evaluate"):
    file = folder / "plan.json"
    made = lab.call(pcavr, "plan", recordings, "--chain", chain, "-o", file)
    return file, made["tasks"]


def submit(pcavr, nodes, file):
    if not lab.call(pcavr, "run", file, "--submit", "slurm", environment=nodes.environment)["submitted"]:
        sys.exit("the plan was not submitted")


def kill(nodes, kind, rng):
    """Returns what to start again."""
    if kind == "controller":
        nodes.kill("controller")
        return nodes.start_controller
    name = rng.choice(cluster.NODES)
    if kind == "node":
        nodes.kill(name)
        nodes.declare_lost(name)
        return lambda: nodes.start_node(name)
    tasks = [pid for pid in cluster.descendants(nodes.processes[name].pid) if is_task(pid)]
    if tasks:
        with contextlib.suppress(ProcessLookupError):  # it has ended meanwhile
            os.kill(rng.choice(tasks), 9)
    return lambda: None


def is_task(pid):
    try:
        return b"--task" in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return False


def run_with_kills(pcavr, nodes, file, kills, rng, timeout):
    """Returns how many times a submission was needed: a task that was killed ends its job."""
    submit(pcavr, nodes, file)
    for i in range(kills):
        time.sleep(rng.uniform(0.2, 3.0))
        start_again = kill(nodes, KINDS[i % len(KINDS)], rng)
        time.sleep(rng.uniform(0.0, 1.5 * cluster.NODE_TIMEOUT))
        start_again()
    submissions = 1

    def has_ended():
        nodes.skip_requeue_delays()
        return not nodes.queue()

    while True:
        nodes.wait_for(has_ended, timeout, "end of the queue")
        status = lab.call(pcavr, "status", file)
        if status["done"] == len(status["tasks"]) or submissions > kills:
            return submissions
        submit(pcavr, nodes, file)
        submissions += 1


def check_bytes(pcavr, folder, count, kills, seed):
    recordings = lab.record(pcavr, folder, count)
    file, tasks = plan(pcavr, folder, recordings)
    lab.call(pcavr, "run", file)
    results = file.with_suffix("")
    expected = lab.outputs_of(results)
    shutil.rmtree(results)
    with cluster.Cluster(folder / "slurm") as nodes:
        start = time.monotonic()
        submissions = run_with_kills(pcavr, nodes, file, kills, random.Random(seed),
                                     PLAN_TIMEOUT + TASK_TIMEOUT * tasks)
        seconds = time.monotonic() - start
    faults = lab.faults_of(results, expected, is_complete=kills == 0)
    left = lab.call(pcavr, "run", file)
    if left["ran"] > 0:
        faults.append(f"{left['ran']} tasks were left to do")
    print(f"{tasks} tasks on two nodes in {seconds:.1f} s, {kills} kills, {submissions} submissions; "
          f"{len(expected)} files: {'; '.join(faults[:5]) or 'the bytes of one process'}")
    return bool(faults)


def measure_throughput(pcavr, folder, count):
    recordings = lab.record(pcavr, folder, count)
    seconds = {}
    for names in (cluster.NODES[:1], cluster.NODES):
        work = folder / f"nodes-{len(names)}"
        work.mkdir()
        file, tasks = plan(pcavr, work, recordings)
        with cluster.Cluster(work / "slurm", names) as nodes:
            start = time.monotonic()
            submit(pcavr, nodes, file)
            nodes.wait_for(lambda: not nodes.queue(), PLAN_TIMEOUT + TASK_TIMEOUT * tasks, "end of the queue")
            seconds[len(names)] = time.monotonic() - start
        if lab.call(pcavr, "status", file)["done"] != tasks:
            sys.exit("not all tasks were done")
        print(f"{len(names)} nodes: {tasks} tasks in {seconds[len(names)]:.1f} s", flush=True)
    print(f"throughput of two nodes against one: {seconds[1] / seconds[2]:.2f} (target: at least {MIN_THROUGHPUT})")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pcavr", required=True, type=pathlib.Path, help="the command")
    parser.add_argument("--recordings", type=int, default=2)
    parser.add_argument("--kills", type=int, default=0)
    parser.add_argument("--seed", default="1")
    parser.add_argument("--throughput", action="store_true")
    arguments = parser.parse_args()
    if not cluster.is_installed():
        print("Slurm is not installed: scripts/install-packages --with-checks")
        return SKIPPED
    pcavr = str(arguments.pcavr.resolve())
    with tempfile.TemporaryDirectory(prefix="pcavr-slurm-") as name:
        folder = pathlib.Path(name)
        if arguments.throughput:
            measure_throughput(pcavr, folder, arguments.recordings)
            return 0
        return int(check_bytes(pcavr, folder, arguments.recordings, arguments.kills, arguments.seed))


if __name__ == "__main__":
    sys.exit(main())
