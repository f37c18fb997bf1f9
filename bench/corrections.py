#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Is replay with corrections ever worse than without?

    bench/corrections.py --data DATA --pcavr build/test/apps/pcavr/pcavr [--only REGEX]
                         [--work out/corrections] [--keep-without] [-- REPLAY OPTIONS]

Replays every recording below DATA that has a truth/ and poses of its objects (tracked/), with and
without corrections, from the same parameters (the scene's and defaults, or --parameters), and prints
the position errors of the predicted objects side by side: mean and 95 % over the times in contact
or moving, maximum over the whole run [mm]. Worse is what exceeds the error without corrections by
more than --tolerance (the truth's noise: 0.05 mm and 2 %). The last columns are the errors of what is
seen and felt as shares of those of a plainly delayed display. Needs only python3.

--keep-without uses the runs without corrections that an earlier call left in the work folder: they
depend on the prediction alone.
"""
import json
import re
import sys

from command import recordings_parser, run
from displayed_errors import share_of_delayed

METRICS = {"mean": "predicted.touched.translation.mean_m",
           "p95": "predicted.touched.translation.p95_m",
           "max": "predicted.all.translation.max_m"}


ROUND_TRIP = 0.4  # [s] of the defaults of replay


def percent(share):
    return "" if share is None else f"{100 * share:.0f}"


class Comparison:
    def __init__(self, arguments):
        self.arguments = arguments

    def scene_of(self, recording, folder):
        scene = folder / "scene"
        if not (scene / "scene.yaml").exists():
            run(self.arguments.pcavr, "build", recording, "-o", scene, "--force")
        return scene

    def errors(self, recording, folder, label, more):
        """The metrics [mm] of one replay, and the number of its corrections."""
        stored = folder / f"{label}.json"
        if label == "without" and self.arguments.keep_without and stored.exists():
            return json.loads(stored.read_text())
        replay = folder / label
        words = ["--parameters", self.arguments.parameters] if self.arguments.parameters else []
        run(self.arguments.pcavr, "replay", recording, "--scene", self.scene_of(recording, folder),
            "-o", replay, "--force", "--threads", 1, *words, *more, *self.arguments.options)
        report = run(self.arguments.pcavr, "evaluate", replay, "--truth", recording / "truth", "-o",
                     folder / f"{label}-report", "--force")
        errors = {name: 1e3 * report[key] for name, key in METRICS.items() if key in report}
        errors["count"] = report.get("corrections.count", 0)
        errors["of_delayed"] = share_of_delayed(replay, recording / "truth", ROUND_TRIP)
        stored.write_text(json.dumps(errors))
        return errors

    def compare(self, recording):
        """A row of the table, and the metrics that are worse."""
        name = str(recording.relative_to(self.arguments.data))
        folder = self.arguments.work / name
        folder.mkdir(parents=True, exist_ok=True)
        without = self.errors(recording, folder, "without", ["--no-corrections"])
        corrected = self.errors(recording, folder, "with", [])
        worse = [metric for metric in METRICS if metric in without and
                 corrected[metric] > without[metric] * (1.0 + self.arguments.tolerance[1])
                 + self.arguments.tolerance[0]]
        cells = "".join(f"{without.get(metric, 0.0):>9.3f}{corrected.get(metric, 0.0):>8.3f}"
                        for metric in METRICS)
        short = name.replace("real/", "").replace("recordings/", "")
        print(f"{short:<38}{cells}{corrected['count']:>6.0f}"
              f"{''.join(f'{percent(share):>5}' for share in corrected['of_delayed'])}"
              f"  {' '.join(worse)}", flush=True)
        return worse


def recordings_below(data, only):
    found = [file.parent for file in data.rglob("recording.yaml")
             if (file.parent / "truth" / "objects").is_dir() and (file.parent / "tracked").is_dir()]
    return sorted(folder for folder in found if re.search(only, str(folder.relative_to(data))))


def main():
    parser = recordings_parser(__doc__, "out/corrections")
    parser.add_argument("--parameters", help="a parameter file, for all recordings")
    parser.add_argument("--keep-without", action="store_true")
    parser.add_argument("--tolerance", type=float, nargs=2, default=(0.05, 0.02),
                        help="[mm], and relative")
    parser.add_argument("options", nargs="*", help="of replay, after --")
    arguments = parser.parse_args()
    comparison = Comparison(arguments)
    print(f"{'without, with [mm]':<38}" + "".join(f"{metric:>17}" for metric in METRICS) +
          f"{'sent':>6} seen felt  worse")
    recordings = recordings_below(arguments.data, arguments.only)
    worse = [recording for recording in recordings if comparison.compare(recording)]
    print(f"{len(worse)} of {len(recordings)} are worse with corrections")
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main())
