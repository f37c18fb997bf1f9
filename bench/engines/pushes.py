#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Does an engine with an exported world push with the measured force, on pushes that it has not seen?

    bench/engines/pushes.py --data DATA --pcavr build/test/apps/pcavr/pcavr
                            [--only REGEX] [--work out/engines] [--tests N] [--json FILE]

Below DATA are, as one of:
  OBJECT/train and OBJECT/test*   parameters from train (real/push_cmu/recordings)
  push-N, probe-N, offcentre-N    parameters from probe, tests push and offcentre (plants)
  recordings of one object        parameters from the others (real/push_mit_delrin)

Parameters are identified, each test is built and exported to MJCF, and MuJoCo replays the recorded
tool in it with each of the settings of mujoco_pushes.mjs. Printed per setting: the median over the
tests of the absolute error of the median force while the body slides [%], of the force's median
absolute difference from the measured one [%], of the end position [mm] and of the heading [deg];
the same per object with --verbose. Tests in which no sliding was measured are listed as left out.
Needs python3, node and npm, which installs the versions of package.json.
"""
import json
import pathlib
import re
import shutil
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from command import recordings_parser, run  # noqa: E402

FIGURES = [("error", 100.0), ("waveform", 100.0), ("end_mm", 1.0), ("turn_deg", 1.0)]
MIN_SAMPLES = 20  # rows of force while the body slides


def cases_in(data):
    """(name, recordings that give the parameters, recordings that are tests)."""
    for train in sorted(data.glob("*/train")):
        yield train.parent.name, [train], sorted(train.parent.glob("test*"))
    for probe in sorted(data.glob("probe-*")):
        seed = probe.name.split("-")[1]
        tests = [data / f"{case}-{seed}" for case in ("push", "offcentre")]
        yield f"body-{seed}", [probe], [test for test in tests if test.exists()]
    if not list(data.glob("probe-*")):
        recordings = sorted(file.parent for file in data.glob("*/recording.yaml"))
        for test in recordings:
            yield test.name, [each for each in recordings if each != test], [test]


class Bench:
    def __init__(self, arguments):
        self.arguments = arguments
        self.left_out = []
        self.tools = self.install()

    def install(self):
        """The folder with the engines."""
        tools = self.arguments.work / "tools"
        tools.mkdir(parents=True, exist_ok=True)
        shutil.copy(HERE / "package.json", tools)
        subprocess.run(["npm", "install", "--no-audit", "--no-fund", "--no-package-lock",
                        "--prefix", tools], check=True, stdout=subprocess.DEVNULL)
        return tools

    def world(self, test, parameters, work):
        """The exported world of a test, with these parameters."""
        work.mkdir(parents=True, exist_ok=True)
        scene, world = work / "scene", work / "world"
        run(self.arguments.pcavr, "build", test, "-o", scene, "--force")
        shutil.rmtree(world, ignore_errors=True)
        run(self.arguments.pcavr, "export", scene, "--parameters", parameters, "--to", "mjcf",
            "--motion", test, "-o", world)
        return world

    def judge(self, name, trains, tests):
        """The results of a case's tests by setting."""
        work = self.arguments.work / name
        work.mkdir(parents=True, exist_ok=True)
        parameters = work / "parameters.yaml"
        run(self.arguments.pcavr, "identify", "friction", *trains, "-o", parameters, "--force")
        results = []
        for test in tests[:self.arguments.tests]:
            try:
                world = self.world(test, parameters, work / test.name)
            except RuntimeError as error:
                self.left_out.append(f"{name}/{test.name}: {error}")
                continue
            done = subprocess.run(["node", HERE / "mujoco_pushes.mjs", self.tools, world, test],
                                  capture_output=True, text=True)
            if done.returncode != 0:
                self.left_out.append(f"{name}/{test.name}: {done.stderr.strip()[-200:]}")
                continue
            result = json.loads(done.stdout)
            if result["samples"] < MIN_SAMPLES:
                self.left_out.append(f"{name}/{test.name}: the body hardly slides")
                continue
            results.append({"case": name, "test": test.name, **result})
        return results


def medians(results):
    """Rows of the table: setting, tests, and the median of each figure's absolute value."""
    settings = [key for key in results[0] if isinstance(results[0][key], dict)]
    rows = []
    for setting in settings:
        row = [setting, len(results)]
        for figure, scale in FIGURES:
            row.append(statistics.median(abs(scale * each[setting][figure]) for each in results))
        rows.append(row)
    return rows


def print_table(title, results):
    print(f"{title:<28}{'tests':>6}{'force':>9}{'waveform':>10}{'end':>9}{'turn':>9}")
    for row in medians(results):
        print(f"  {row[0]:<26}{row[1]:>6}{row[2]:>7.1f} %{row[3]:>8.1f} %{row[4]:>6.2f} mm"
              f"{row[5]:>5.2f} deg", flush=True)


def main():
    parser = recordings_parser(__doc__, "out/engines")
    parser.add_argument("--tests", type=int, default=None, help="maximum number of tests of a case")
    parser.add_argument("--json", type=pathlib.Path, help="file for the results of all tests")
    parser.add_argument("--verbose", action="store_true", help="a table for each case, too")
    arguments = parser.parse_args()
    bench = Bench(arguments)
    results = []
    for name, trains, tests in cases_in(arguments.data):
        if not tests or not re.search(arguments.only, name):
            continue
        found = bench.judge(name, trains, tests)
        results += found
        if arguments.verbose and found:
            print_table(name, found)
    for line in bench.left_out:
        print(f"left out: {line}", file=sys.stderr)
    if not results:
        print("no test was judged", file=sys.stderr)
        return 1
    print_table("all", results)
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
