#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""A plan of many short pushes: its time against single commands, and what `gather` makes of it.

    bench/many_pushes.py --pcavr build/bench/apps/pcavr/pcavr [--count 300] [--jobs 2] [--work out/many-pushes]

Simulates the pushes, and times `run --jobs 1` and `run --jobs N` against the same commands for some of them, one by
one in as many shells at once: processors that share a core are slower together. The ratios are those of processor
time, and of the time that passed, a recording each. Prints how many tasks took within 1.5 times of their estimates, scaled by their median,
and the bytes that a task writes, for the model of docs/scale.md. Needs only python3.
"""
import argparse
import concurrent.futures
import json
import pathlib
import resource
import shutil
import statistics
import subprocess
import sys
import time

from command import run

SAMPLES = 10  # recordings by single commands
MAX_FACTOR = 1.5
MAX_RATIO = 1.1  # of the time of a recording in a plan to that of single commands


def run_quietly(words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{words}: {done.stderr}")


def spent_since(before, start, shells=1):
    """Seconds that passed, times the shells, and of the processors."""
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (shells * (time.monotonic() - start),
            after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def timed(*words):
    """Seconds that passed, and of the processors, of a command with its children."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    run_quietly(words)
    return spent_since(before, start)


def simulate(pcavr, folder, count):
    for i in range(count):
        recording = folder / f"push_{i:03d}"
        if not (recording / "recording.yaml").exists():
            run(pcavr, "simulate", "push", "--no-images", "--seed", 12, "--duration", f"{5 + 0.01 * i:.2f}",
                "-o", recording, "--force")


def commands_of(pcavr, recording, folder):
    """The four commands, on one thread each."""
    threads = ("--threads", 1)
    return [(pcavr, "build", recording, "-o", folder / "scene", *threads),
            (pcavr, "identify", "friction", recording, "--scene", folder / "scene", "-o",
             folder / "parameters.yaml", *threads),
            (pcavr, "replay", recording, "--scene", folder / "scene", "--parameters",
             folder / "parameters.yaml", "-o", folder / "run", *threads),
            (pcavr, "evaluate", folder / "run", "--truth", recording / "truth", "-o", folder / "report", *threads)]


def single_commands(pcavr, recordings, folder, shells):
    """The passed time of a shell, and the processors' time, a recording: its commands one by one."""
    shutil.rmtree(folder, ignore_errors=True)
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()

    def one(recording):
        for words in commands_of(pcavr, recording, folder / recording.name):
            run_quietly(words)

    with concurrent.futures.ThreadPoolExecutor(shells) as pool:
        list(pool.map(one, recordings))
    return [total / len(recordings) for total in spent_since(before, start, shells)]


def records_of(plan):
    """Each task with what its record states."""
    graph = json.loads(plan.read_text())
    results = pathlib.Path(graph["results"])
    return [(task, json.loads((results / f"{task['name']}.json").read_text())) for task in graph["tasks"]]


def bytes_of(path):
    files = [path] if path.is_file() else path.rglob("*")
    return sum(file.stat().st_size for file in files if file.is_file())


def print_estimates(plan):
    by_stage = {}
    for task, record in records_of(plan):
        by_stage.setdefault(task["stage"], []).append((task, record))
    ratios = [record["seconds"] / task["seconds"] for tasks in by_stage.values() for task, record in tasks]
    typical = statistics.median(ratios)
    within = sum(typical / MAX_FACTOR <= ratio <= typical * MAX_FACTOR for ratio in ratios)
    print(f"{within} of {len(ratios)} tasks within {MAX_FACTOR} times of {typical:.2f} times their estimate")
    for stage, tasks in by_stage.items():
        written = statistics.median(sum(bytes_of(pathlib.Path(output)) for output in task["outputs"])
                                    for task, _ in tasks)
        print(f"{stage}: {statistics.median(record['seconds'] for _, record in tasks):.2f} s, "
              f"{statistics.median(record['cpu_seconds'] for _, record in tasks):.2f} s of a processor, "
              f"{statistics.median(record['memory'] for _, record in tasks) / 1e6:.0f} MB, "
              f"writes {written / 1e6:.2f} MB")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pcavr", required=True)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/many-pushes"))
    arguments = parser.parse_args()
    lab, plan = arguments.work / "lab" / "table", arguments.work / "pushes.json"
    simulate(arguments.pcavr, lab, arguments.count)
    recordings = sorted(lab.iterdir())[:arguments.count]
    chosen = recordings[::max(1, len(recordings) // SAMPLES)]
    made = run(arguments.pcavr, "plan", *recordings, "--chain", "build,identify,replay,evaluate", "-o", plan, "--force")
    for jobs in sorted({1, arguments.jobs}):
        shutil.rmtree(plan.with_suffix(""), ignore_errors=True)
        passed, processor = timed(arguments.pcavr, "run", plan, "--jobs", jobs, "--threads", 1)
        single = single_commands(arguments.pcavr, chosen, arguments.work / "single", jobs)
        print(f"{jobs} shells with single commands: {single[0]:.2f} s a recording, {single[1]:.2f} s of a processor\n"
              f"--jobs {jobs}: {made['tasks']} tasks in {passed:.1f} s; a recording against single commands: "
              f"{jobs * passed / len(recordings) / single[0]:.3f} of the time, "
              f"{processor / len(recordings) / single[1]:.3f} of the processor's (target: at most {MAX_RATIO})",
              flush=True)
    print_estimates(plan)
    again, _ = timed(arguments.pcavr, "run", plan)
    gathered, _ = timed(arguments.pcavr, "gather", plan, "-o", arguments.work / "summary", "--force", "--jobs",
                        arguments.jobs)
    print(f"a second run, with nothing to do: {again:.1f} s; gather: {gathered:.1f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
