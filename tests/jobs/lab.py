# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""A folder of short simulated pushes, a plan of them, and what its tasks wrote."""
import json
import pathlib
import subprocess
import sys

TIMEOUT = 120  # s of one command
CONTROL = (".lock", ".log")  # beside the results: what is not compared
RECORD = "pcavr-task/1"


def call(pcavr, *words, environment=None):
    """The command's JSON."""
    words = [str(word) for word in words]
    done = subprocess.run([pcavr, *words, "--json"], env=environment, capture_output=True, text=True,
                          timeout=TIMEOUT, check=False)
    if done.returncode != 0:
        sys.exit(f"pcavr {' '.join(words)}: exit code {done.returncode}\n{done.stderr}")
    return json.loads(done.stdout)


def record(pcavr, folder, count, first=6):
    """Recordings of the same boxes, each a second longer than the one before it."""
    for seconds in range(first, first + count):
        call(pcavr, "simulate", "push", "--no-images", "--seed", 12, "--duration", seconds,
             "-o", folder / "lab" / "table" / f"push_{seconds}")
    return folder / "lab" / "table"


def is_record(path):
    return path.suffix == ".json" and path.with_suffix(".lock").exists()


def outputs_of(results):
    """Name and bytes of every file that a task wrote, also of unfinished ones."""
    return {str(path.relative_to(results)): path.read_bytes() for path in sorted(results.rglob("*"))
            if path.is_file() and path.suffix not in CONTROL and not is_record(path) and "slurm" not in path.parts}


def is_unfinished(name):
    """Of an output that is not in place yet: its temporary name begins with a dot."""
    return any(part.startswith(".") for part in pathlib.PurePath(name).parts)


def faults_of(results, expected, is_complete):
    """What is wrong with the results: in part, another one, or (of complete ones) left behind or missing."""
    faults = []
    found = outputs_of(results)
    for name, content in found.items():
        if is_unfinished(name):
            if is_complete:
                faults.append(f"left behind {name}")
        elif expected.get(name) != content:
            faults.append(f"{name} differs")
    # An output folder is there as a whole or not at all.
    for name in expected:
        task_output = pathlib.PurePath(*pathlib.PurePath(name).parts[:3])
        if name not in found and (is_complete or (results / task_output).exists()):
            faults.append(f"{name} is missing")
    for path in results.rglob("*.json"):
        if is_record(path) and json.loads(path.read_text())["format"] != RECORD:
            faults.append(f"{path.name} is no record")
    return faults
