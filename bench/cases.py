#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Accuracy of identification, prediction and correction over many simulated pushes.

    bench/cases.py --pcavr build/bench/apps/pcavr/pcavr --seeds 5001-5020 --work out/cases
                   [--plants DIR | --wide]

Each seed makes its own pair of boxes (size, mass, friction, stiffness, pressure). Parameters are
identified from `probe` and evaluated on another recording, `push`, three times: open-loop
prediction, corrected over delays of 200 + 200 ms, and corrected from wrong parameters and a start
pose that is 10 mm off; `press` evaluates the estimators. The last table counts the parameters that
probes and presses did not identify. Needs only python3.

--plants takes the recordings DIR/probe-SEED, DIR/push-SEED and DIR/press-SEED instead of simulating
them: those of another plant, or of a laboratory that knows the truth. --wide simulates a workshop.
"""
import argparse
import json
import pathlib
import re
import statistics
import subprocess
import sys

from command import run
from coverage import PARAMETERS, reported_key


# metric: (unit, required, target); both are upper limits.
METRICS = {
    "limiting friction, bias of the mean": ("%", 2.0, 0.5),
    "limiting friction, std over the pushes": ("% of F_M", None, None),
    "mass, error": ("%", 5.0, 2.0),
    "sliding friction, force at standstill, error": ("%", 3.0, 0.5),
    "sliding friction, coefficient, error": ("%", 3.0, 0.5),
    "contact force at F_M's penetration, from presses, error": ("%", None, None),
    "contact force at F_M's penetration, from probes, error": ("%", None, None),
    "contact force while pressed, steady error": ("%", 2.0, 0.2),
    "contact force while static, error of the mean": ("%", None, None),
    "open-loop prediction, sliding, rms": ("mm", 1.0, 0.5),
    "open-loop prediction, sliding, max": ("mm", 4.0, 2.0),
    "200 + 200 ms, in contact or moving, median": ("mm", 1.5, 0.8),
    "200 + 200 ms, in contact or moving, p95": ("mm", 4.0, 2.0),
    "200 + 200 ms, whole run, max": ("mm", None, None),
    "from wrong parameters, corrections until under 3 mm": ("", 2.0, 1.0),
    "from wrong parameters, objects never under 3 mm": ("", 0.0, 0.0),
    "from wrong parameters, corrections until settled": ("", None, None),
    "from wrong parameters, in contact or moving, p95": ("mm", None, None),
    "phase boundaries measured, median": ("ms", 60.0, 25.0),
    "phase boundaries measured, p95": ("ms", None, None),
    "phase boundaries predicted, median": ("ms", 60.0, 25.0),
    "phase boundaries predicted, p95": ("ms", None, None),
    "phases predicted, missed and surplus": ("", None, None),
    "corrections, share of streaming": ("%", 3.0, 1.0),
}


class Cases:
    """Runs the command for each seed and collects the metrics."""

    def __init__(self, arguments):
        self.pcavr = arguments.pcavr
        self.work = arguments.work
        self.plants = arguments.plants
        self.simulate_options = ["--wide"] if arguments.wide else []
        self.samples = {metric: [] for metric in METRICS}
        self.withheld = {}  # (case, parameter): [objects without it, all objects]

    def run(self, *words):
        return run(self.pcavr, *words)

    def add(self, metric, value, where):
        if value is not None:
            self.samples[metric].append((value, str(where)))

    def prepare(self, case, seed):
        """A recording without images and its scene."""
        recording = (self.plants or self.work) / f"{case}-{seed}"
        scene = self.work / f"{case}-{seed}-scene"
        if not self.plants:
            self.run("simulate", case, "--seed", seed, "--no-images", "-o", recording, "--force",
                     *self.simulate_options)
        self.run("build", recording, "-o", scene, "--force")
        return recording, scene

    def identify(self, goal, case, seed):
        """The parameter file, and the folder of its report."""
        recording, scene = self.prepare(case, seed)
        parameters = self.work / f"{case}-{seed}.yaml"
        self.run("identify", goal, recording, "--scene", scene, "--tracked", recording / "tracked",
                 "-o", parameters, "--force")
        self.count_withheld(case, parameters)
        return parameters, recording

    def count_withheld(self, case, parameters):
        report = json.loads((parameters.with_suffix(".report") / "report.json").read_text())
        names = {match[1] for match in (re.match(r"object\.(\w+)\.contact\.stiffness\.", key)
                                        for key in report) if match}
        for name in names:
            for key in PARAMETERS:
                is_excited = report.get(f"{reported_key(report, name, key)}.is_excited")
                if is_excited is None:
                    continue
                count = self.withheld.setdefault((case, key), [0, 0])
                count[0] += not is_excited
                count[1] += 1

    def evaluate_identification(self, parameters, recording, seed):
        report = self.run("evaluate", parameters, "--truth", recording / "truth", "-o",
                          self.work / f"probe-{seed}-report", "--force")
        self.add_mass_errors(parameters, report, seed)
        words = {"sliding_friction_coefficient": "sliding friction, coefficient, error",
                 "limiting_static_friction": "limiting friction, bias of the mean",
                 "contact.force": "contact force at F_M's penetration, from probes, error"}
        for key, value in report.items():
            match = re.fullmatch(r"parameters\.(\w+)\.([\w.]+)\.error_relative", key)
            if match and match[2] in words:
                self.add(words[match[2]], 1e2 * abs(value), f"{seed} {match[1]}")
            match = re.fullmatch(r"parameters\.(\w+)\.sliding_friction_coefficient\.error_relative", key)
            if match:
                # A given mass has no error.
                mass_error = report.get(f"parameters.{match[1]}.mass.error_relative", 0.0)
                force = (1.0 + value) * (1.0 + mass_error) - 1.0
                self.add("sliding friction, force at standstill, error", 1e2 * abs(force),
                         f"{seed} {match[1]}")
            match = re.fullmatch(r"parameters\.(\w+)\.limiting_static_friction\.std", key)
            if match:
                limit = report[key[: -len("std")] + "truth"]
                self.add("limiting friction, std over the pushes", 1e2 * value / limit,
                         f"{seed} {match[1]}")

    def add_mass_errors(self, parameters, evaluation, seed):
        """Of the mass by accelerations alone, where a weighed one is in the file."""
        report = json.loads((parameters.with_suffix(".report") / "report.json").read_text())
        for key, truth in evaluation.items():
            match = re.fullmatch(r"parameters\.(\w+)\.mass\.truth", key)
            if not match:
                continue
            found = f"object.{match[1]}.mass"
            if f"object.{match[1]}.inertial_mass.is_excited" in report:
                found = f"object.{match[1]}.inertial_mass"
            if report.get(f"{found}.is_excited"):
                self.add("mass, error", 1e2 * abs(report[found] / truth - 1.0), f"{seed} {match[1]}")

    def evaluate_presses(self, seed):
        parameters, recording = self.identify("contact", "press", seed)
        evaluation = self.run("evaluate", parameters, "--truth", recording / "truth", "-o",
                          self.work / f"press-{seed}-report", "--force")
        for key, value in evaluation.items():
            match = re.fullmatch(r"parameters\.(\w+)\.contact\.force\.error_relative", key)
            if match:
                self.add("contact force at F_M's penetration, from presses, error", 1e2 * abs(value),
                         f"{seed} {match[1]}")
        report = json.loads((parameters.with_suffix(".report") / "report.json").read_text())
        words = {"steady_error": "contact force while pressed, steady error",
                 "held_error": "contact force while static, error of the mean"}
        for key, value in report.items():
            match = re.fullmatch(r"object\.(\w+)\.estimator\.affRLS\.(\w+)", key)
            if match and match[2] in words:
                self.add(words[match[2]], 1e2 * value, f"{seed} {match[1]}")

    def replay(self, label, recording, scene, parameters, *words):
        run = self.work / f"{recording.name}-{label}"
        self.run("replay", recording, "--scene", scene, "--parameters", parameters, "--tracked",
                 recording / "tracked", "-o", run, "--force", *words)
        return self.run("evaluate", run, "--truth", recording / "truth", "-o",
                        self.work / f"{recording.name}-{label}-report", "--force")

    def evaluate(self, seed):
        self.evaluate_presses(seed)
        parameters, probe = self.identify("friction", "probe", seed)
        self.evaluate_identification(parameters, probe, seed)
        recording, scene = self.prepare("push", seed)
        alone = self.replay("alone", recording, scene, parameters, "--no-corrections",
                            "--keep-parameters")
        sliding = "predicted.phase.sliding.translation."
        self.add("open-loop prediction, sliding, rms", 1e3 * alone[sliding + "rmse_m"], seed)
        self.add("open-loop prediction, sliding, max", 1e3 * alone[sliding + "max_m"], seed)
        self.evaluate_corrected(self.replay("corrected", recording, scene, parameters), seed)
        wrong = self.replay("wrong", recording, with_shifted_objects(scene, 0.010),
                            wrong_parameters(parameters))
        self.add("from wrong parameters, objects never under 3 mm",
                 wrong.get("corrections.never_good"), seed)
        self.add("from wrong parameters, in contact or moving, p95",
                 1e3 * wrong["predicted.touched.translation.p95_m"], seed)
        metrics = {"good": "from wrong parameters, corrections until under 3 mm",
                   "settled": "from wrong parameters, corrections until settled"}
        for key, value in wrong.items():
            match = re.fullmatch(r"corrections\.object\.(\w+)\.until_(\w+)\.count", key)
            if match:
                self.add(metrics[match[2]], value, f"{seed} {match[1]}")

    def evaluate_corrected(self, report, seed):
        touched = "predicted.touched.translation."
        self.add("200 + 200 ms, in contact or moving, median", 1e3 * report[touched + "median_m"], seed)
        self.add("200 + 200 ms, in contact or moving, p95", 1e3 * report[touched + "p95_m"], seed)
        self.add("200 + 200 ms, whole run, max",
                 1e3 * report["predicted.all.translation.max_m"], seed)
        for side in ("measured", "predicted"):
            boundary = f"phases.{side}.boundary."
            self.add(f"phase boundaries {side}, median", 1e3 * report[boundary + "median_s"], seed)
            self.add(f"phase boundaries {side}, p95", 1e3 * report[boundary + "p95_s"], seed)
        self.add("phases predicted, missed and surplus",
                 report[boundary + "missed"] + report[boundary + "surplus"], seed)
        self.add("corrections, share of streaming",
                 1e2 * report["corrections.share_of_streaming"], seed)


def with_shifted_objects(scene, distance):
    """The scene with its objects' start poses shifted."""
    other = scene.with_name(scene.name + "-shifted")
    subprocess.run(["rm", "-rf", other], check=True)
    subprocess.run(["cp", "-r", scene, other], check=True)
    file = other / "scene.yaml"
    text = file.read_text()

    def shift(match):
        x, rest = match[2].split(",", 1)
        return f"{match[1]}{float(x) + distance:.9f},{rest}"

    text, count = re.subn(r"(start: *\{t: *\[)([^\]]*)", shift, text)
    if count == 0:
        raise RuntimeError(f"{file}: no start pose to shift")
    file.write_text(text)
    return other


def wrong_parameters(parameters):
    """The file with twice the mass and half the friction."""
    factors = {"mass": 2.0, "limiting_static_friction": 0.5, "sliding_friction_coefficient": 0.25,
               "viscous_friction": 0.5}
    lines = []
    for line in parameters.read_text().splitlines():
        match = re.fullmatch(r"(  (\w+): )(\S+)", line)
        if match and match[2] in factors:
            line = f"{match[1]}{float(match[3]) * factors[match[2]]:.9g}"
        lines.append(line)
    other = parameters.with_suffix(".wrong.yaml")
    other.write_text("\n".join(lines) + "\n")
    return other


def verdict(value, required, target):
    if required is None:
        return ""
    return "target" if value <= target else "required" if value <= required else "FAILED"


def table(samples):
    print(f"{'metric':<52} {'unit':<9} {'required':>8} {'target':>6} {'n':>3} {'median':>9} {'worst':>9}"
          "  worst at          verdict of the worst")
    for metric, (unit, required, target) in METRICS.items():
        if not samples[metric]:
            continue
        worst, where = max(samples[metric])
        middle = statistics.median(value for value, _ in samples[metric])
        limits = ["" if limit is None else f"{limit:g}" for limit in (required, target)]
        print(f"{metric:<52} {unit:<9} {limits[0]:>8} {limits[1]:>6} {len(samples[metric]):>3} "
              f"{middle:>9.3g} {worst:>9.3g}  {where:<17} {verdict(worst, required, target)}")


def print_withheld(withheld):
    print(f"\n{'not identified':<52} {'of':<9}")
    for (case, key), (count, of) in sorted(withheld.items()):
        if count:
            print(f"{case + ': ' + key:<52} {count} of {of}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--pcavr", default="build/bench/apps/pcavr/pcavr")
    parser.add_argument("--seeds", default="5001-5020")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/cases"))
    parser.add_argument("--plants", type=pathlib.Path, help="folder of recordings CASE-SEED")
    parser.add_argument("--wide", action="store_true", help="simulate with --wide")
    arguments = parser.parse_args()
    first, _, last = arguments.seeds.partition("-")
    arguments.work.mkdir(parents=True, exist_ok=True)
    cases = Cases(arguments)
    failures = []
    for seed in range(int(first), int(last or first) + 1):
        print(f"seed {seed}", file=sys.stderr, flush=True)
        try:
            cases.evaluate(seed)
        except (RuntimeError, OSError) as error:
            failures.append(f"seed {seed}: {error}")
            print(failures[-1], file=sys.stderr, flush=True)
    table(cases.samples)
    print_withheld(cases.withheld)
    for failure in failures:
        print(failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
