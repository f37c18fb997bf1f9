#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Do the stated standard deviations of `pcavr identify` cover the truth?

    bench/coverage.py --plants PLANTS --pcavr build/test/apps/pcavr/pcavr [--kinds push,probe]
                      [--seeds 1-3] [--work out/coverage] [--each] [--also KEY=VALUE]
                      [--truth parameters]

PLANTS holds recordings named KIND-SEED, each with truth/parameters.yaml and, where it was tracked,
tracked/. For each kind of motion and each parameter: how often it was identified and withheld, the
median and the worst relative error, the share of truths within 1, 2 and 3 stated standard
deviations, the median and the worst |z|. `of n` is where the share within 1 lies in 95 of 100 cases if
the deviations are right, by the binomial distribution over the recordings: a share outside it is
marked with `-` (stated too small) or `+` (too large). `sliding_force` is the friction at each speed that the
report states, against mu m g + B v; `contact.penetration` the depth at the force that the report
states it for, against that of the true law there; `contact.force` the law's force at the
penetration that the true limiting friction causes (no standard deviation is stated for it).
Stiffness and damping of another law than the true one have another unit, so that they are compared
where the exponent was identified, too, and is not that of a linear law. `--also` gives what all
bodies have and their files do not state, such as tool_friction_coefficient=0.25. Needs only python3.

A std is that of the object's own value, for all pushes that there may be. Where friction scatters
from push to push and truth/parameters.yaml has the mean over the recorded pushes, that truth is
closer to the estimate than the std says, by the scatter over the root of their number. A plant that
has the object's own values in truth/population.yaml is judged by `--truth population`.

Choose constants on some seeds, judge on others, and say which.
"""
import argparse
import json
import math
import pathlib
import re
import statistics
import subprocess
import sys

GRAVITY = 9.80665  # [m/s^2]
WITHIN_ONE = math.erf(math.sqrt(0.5))  # of a normal distribution
PARAMETERS = ("mass", "limiting_static_friction", "sliding_friction_coefficient", "viscous_friction",
              "friction_radius", "tool_friction_coefficient", "contact.stiffness",
              "contact.damping", "contact.exponent")


def read_truth(file):
    """The parameters of a truth/parameters.yaml: by object, nested keys joined by a dot."""
    objects, stack = {}, []
    for line in file.read_text().splitlines():
        match = re.match(r"( *)([\w.]+): *([^#]*)", line)
        if not match:
            continue
        depth, key, value = len(match[1]) // 2, match[2], match[3].strip()
        stack = stack[:depth] + [key]
        if value and depth > 0 and re.fullmatch(r"[-+.\deE]+", value):  # no name of a law
            objects.setdefault(stack[0], {})[".".join(stack[1:])] = float(value)
    return objects


def binomial_range(count, share, confidence=0.95):
    """The shares that `count` draws of probability `share` give: the central interval."""
    below, low = 0.0, None
    for hits in range(count + 1):
        below += math.comb(count, hits) * share**hits * (1.0 - share) ** (count - hits)
        if low is None and below > 0.5 * (1.0 - confidence):
            low = hits / count
        if below >= 0.5 * (1.0 + confidence):
            return low, hits / count
    return low, 1.0


class Score:
    """One parameter's errors and z-scores over many recordings."""

    def __init__(self):
        self.errors, self.scores, self.withheld = [], [], 0

    def add(self, value, std, truth, where):
        self.errors.append((abs(value / truth - 1.0), where))
        if std is not None:
            distance = abs(value - truth)
            score = distance / std if std > 0.0 else math.inf if distance > 0.0 else 0.0
            self.scores.append((score, where))

    def row(self):
        cells = [f"{len(self.errors):>4}", f"{self.withheld:>4}"]
        if not self.errors:
            return " ".join(cells)
        worst, where = max(self.errors)
        cells += [f"{100 * statistics.median(error for error, _ in self.errors):>8.2f}",
                  f"{100 * worst:>8.1f} {where:<14}"]
        if not self.scores:
            return " ".join(cells)
        count = len(self.scores)
        for limit in (1, 2, 3):
            cells.append(f"{100 * sum(z < limit for z, _ in self.scores) / count:>5.0f}")
        cells.append(self.expected_within_one())
        worst, where = max(self.scores)
        cells.append(f"{statistics.median(z for z, _ in self.scores):>6.2f} {worst:>7.1f} {where}")
        return " ".join(cells)

    def expected_within_one(self):
        """The values of one recording share their errors: they count once."""
        recordings = len({where.split()[0] for _, where in self.scores})
        low, high = binomial_range(recordings, WITHIN_ONE)
        share = sum(z < 1.0 for z, _ in self.scores) / len(self.scores)
        mark = "-" if share < low else "+" if share > high else " "
        return f"{100 * low:>3.0f}-{100 * high:<3.0f}{mark}"


def identify(pcavr, recording, work):
    """The report of `pcavr identify friction`, and what it printed if it failed."""
    output = work / f"{recording.name}.yaml"
    words = [pcavr, "identify", "friction", recording, "-o", output, "--force"]
    if (recording / "tracked").exists():
        words += ["--tracked", recording / "tracked"]
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode != 0:
        return None, done.stderr.strip()
    return json.loads((work / f"{recording.name}.report" / "report.json").read_text()), ""


def contact_force(law, depth):
    return law["contact.stiffness"] * depth ** law.get("contact.exponent", 1.0)


def reported_key(report, name, key):
    """Where a parameter stands in the report: a mass that was weighed is no result, but the one by
    accelerations alone is."""
    inertial = f"object.{name}.inertial_mass"
    return inertial if key == "mass" and f"{inertial}.is_excited" in report else f"object.{name}.{key}"


def score_object(report, name, truth, where, scores):
    found = {}
    for key in PARAMETERS:
        full = reported_key(report, name, key)
        if full in report:
            found[key] = report[full]
        if key not in truth:
            continue
        score = scores.setdefault(key, Score())
        if key in ("contact.stiffness", "contact.damping") and not has_true_unit(report, name):
            score.withheld += 1
            continue
        if report.get(f"{full}.is_excited") and full in report:
            score.add(report[full], report.get(f"{full}_std"), truth[key], where)
        else:
            score.withheld += 1
    score_sliding_force(report.get(f"object.{name}.sliding_force", []), truth, where, scores)
    score_penetration(report, f"object.{name}.contact.penetration", truth, where, scores)
    score = scores.setdefault("contact.force", Score())
    if report.get(f"object.{name}.contact.penetration.is_excited"):
        force = truth["limiting_static_friction"]
        depth = (force / truth["contact.stiffness"]) ** (1.0 / truth["contact.exponent"])
        score.add(contact_force(found, depth), None, force, where)
    else:
        score.withheld += 1


def has_true_unit(report, name):
    key = f"object.{name}.contact.exponent"
    return report.get(f"{key}.is_excited", False) and report[key] > 1.0


def score_penetration(report, key, truth, where, scores):
    score = scores.setdefault("contact.penetration", Score())
    if not report.get(f"{key}.is_excited"):
        score.withheld += 1
        return
    force = report[f"{key}_force"]
    depth = (force / truth["contact.stiffness"]) ** (1.0 / truth["contact.exponent"])
    score.add(report[key], report[f"{key}_std"], depth, where)


def score_sliding_force(rows, truth, where, scores):
    score = scores.setdefault("sliding_force", Score())
    score.withheld += not rows
    coulomb = truth["sliding_friction_coefficient"] * truth["mass"] * GRAVITY
    for row in rows:
        force = coulomb + truth["viscous_friction"] * row["speed"]
        score.add(row["force"], row["std"], force, f"{where} {1e3 * row['speed']:.0f} mm/s")


def print_table(kind, scores):
    print(f"\n{kind}\n{'parameter':<30} {'n':>4} {'none':>4} {'median %':>8} {'worst %':>8} {'at':<14} "
          f"{'<1s':>5} {'<2s':>5} {'<3s':>5} {'of n':>8} {'med z':>6} {'worst z':>7}")
    for key, score in scores.items():
        print(f"{key:<30} {score.row()}")


def seeds_of(text):
    first, _, last = text.partition("-")
    return range(int(first), int(last or first) + 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--plants", type=pathlib.Path, required=True)
    parser.add_argument("--pcavr", default="build/test/apps/pcavr/pcavr")
    parser.add_argument("--kinds", default="push,probe,press,offcentre")
    parser.add_argument("--seeds", type=seeds_of, help="such as 1-3; all without it")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/coverage"))
    parser.add_argument("--also", type=lambda text: text.split("="), action="append", default=[])
    parser.add_argument("--truth", default="parameters", help="file in truth/, without .yaml")
    parser.add_argument("--each", action="store_true", help="print each recording's values")
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    failures = []
    for kind in arguments.kinds.split(","):
        scores = {}
        folders = [folder for folder in arguments.plants.glob(f"{kind}-*")
                   if re.fullmatch(rf"{re.escape(kind)}-\d+", folder.name)]
        for folder in sorted(folders, key=lambda path: int(path.name.rpartition("-")[2])):
            if arguments.seeds and int(folder.name.rpartition("-")[2]) not in arguments.seeds:
                continue
            report, error = identify(arguments.pcavr, folder, arguments.work)
            if report is None:
                failures.append(f"{folder.name}: {error}")
                continue
            for name, truth in read_truth(folder / "truth" / f"{arguments.truth}.yaml").items():
                truth.update({key: float(value) for key, value in arguments.also})
                score_object(report, name, truth, folder.name, scores)
                if arguments.each:
                    print_values(folder.name, report, name, truth)
        print_table(kind, scores)
    for failure in failures:
        print(failure)
    return 1 if failures else 0


def print_values(where, report, name, truth):
    for key in PARAMETERS:
        full = reported_key(report, name, key)
        if key in truth and report.get(f"{full}.is_excited"):
            print(f"{where:<14} {key:<30} {report[full]:>10.5g} +- {report.get(full + '_std', 0):<9.3g} "
                  f"truth {truth[key]:.5g}")
    for row in report.get(f"object.{name}.sliding_force", []):
        force = truth["sliding_friction_coefficient"] * truth["mass"] * GRAVITY
        force += truth["viscous_friction"] * row["speed"]
        print(f"{where:<14} sliding_force {1e3 * row['speed']:>10.1f} mm/s {row['force']:>10.5g} "
              f"+- {row['std']:<9.3g} truth {force:.5g}")


if __name__ == "__main__":
    sys.exit(main())
