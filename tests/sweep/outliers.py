#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Puts one to five random outliers into a column of a recording's inputs, and compares the result.

    tests/sweep/outliers.py RECORDING --pcavr build/dev/apps/pcavr/pcavr --seed 1 --count 100

RECORDING has tool.csv, wrench.csv and tracked/. A trial fails where `pcavr identify friction`
crashes, writes a number that is not finite, or a parameter that is off the undisturbed one by more
than 3 of its stds. An error in one line is no failure. The same seed and count give the same trials.
Needs python3 with PyYAML.
"""
import argparse
import math
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

import yaml

MAX_STDS = 3.0


def streams_of(recording):
    tracked = sorted(recording.glob("tracked/objects/*/tracked.txt"))
    return [recording / "tool.csv", recording / "wrench.csv", *tracked]


def disturb(path, rng):
    """Adds outliers of any size to one column; a quaternion is replaced by another one."""
    separator = "," if path.suffix == ".csv" else " "
    rows = path.read_text().split("\n")
    data = [i for i, row in enumerate(rows) if row and row[0] not in "#t"]
    column = rng.randrange(1, len(rows[data[0]].split(separator)))
    for i in rng.sample(data, rng.randint(1, 5)):
        cells = rows[i].split(separator)
        if len(cells) == 8 and column >= 4:
            q = [rng.gauss(0.0, 1.0) for _ in range(4)]
            norm = math.sqrt(sum(value * value for value in q))
            cells[4:] = [f"{value / norm:.9f}" for value in q]
        else:
            outlier = float(cells[column]) + rng.gauss(0.0, 1.0) * 10.0 ** rng.uniform(-2.0, 2.0)
            cells[column] = f"{outlier:.6f}"
        rows[i] = separator.join(cells)
    path.write_text("\n".join(rows))
    return f"{path.name} column {column}"


def numbers_of(entry, prefix=""):
    """Parameters as (value, std), by their key."""
    found = {}
    for key, value in entry.items():
        if isinstance(value, dict):
            found.update(numbers_of(value, f"{prefix}{key}."))
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            found[prefix + key] = float(value)
    return found


def identify(pcavr, recording, output):
    done = subprocess.run([pcavr, "identify", "friction", str(recording), "-o", str(output)],
                          capture_output=True, text=True, timeout=120)
    return done, numbers_of(yaml.safe_load(output.read_text())) if output.exists() else None


def failure_of(done, found, sound):
    if done.returncode not in (0, 1):
        return f"exit code {done.returncode}"
    if done.returncode == 1 or found is None:
        return "" if len(done.stderr.strip().split("\n")) == 1 else "an error of several lines"
    for key, value in found.items():
        if not math.isfinite(value):
            return f"{key} is {value}"
        std = max(found.get(key + "_std", 0.0), sound.get(key + "_std", 0.0))
        if std > 0.0 and key in sound and abs(value - sound[key]) > MAX_STDS * std:
            return f"{key} is {value}, undisturbed {sound[key]}, std {std}"
    return ""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("recording", type=pathlib.Path)
    parser.add_argument("--pcavr", required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=100)
    arguments = parser.parse_args()
    failures = 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        _, sound = identify(arguments.pcavr, arguments.recording, folder / "sound")
        if sound is None:
            sys.exit("the undisturbed recording is not identified")
        for i in range(arguments.count):
            rng = random.Random(f"{arguments.seed}/{i}")
            shutil.copytree(arguments.recording, folder / "copy")
            what = disturb(rng.choice(streams_of(folder / "copy")), rng)
            done, found = identify(arguments.pcavr, folder / "copy", folder / "found")
            problem = failure_of(done, found, sound)
            if problem:
                failures += 1
                print(f"trial {i}: {what}: {problem}", flush=True)
            shutil.rmtree(folder / "copy")
            (folder / "found").unlink(missing_ok=True)
    print(f"{arguments.count} trials, {failures} failed")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
