#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Logs of long pushes as a laboratory keeps them: does friction rank, and predict other pushes?

    bench/raw_pushes.py --data DATA/real/push_mit --pcavr build/test/apps/pcavr/pcavr
                        [--only REGEX] [--work out/raw-pushes]

Each folder below DATA has the runs of one block as CSV files: tip, motion capture in a world frame
of its own, force in the tool's axes with its offset. The world's pose in base and the tool's delay
are found from the first half of the runs and hold for all. The blocks' sizes and the finger's
radius are not documented: they are those with which tip and sides are closest over all runs
(bodies below); the masses are guessed from steel, aluminium and plastic of 13 mm.

Printed per block: the gap between tip and sides [mm], the medians of the limiting and the sliding
friction that its runs give [N]; and over the runs after the first, replayed open loop, the median
error of the end position [mm] by the first run's parameters, and by the mass and a guessed
coefficient of 0.5. Needs only python3.
"""
import math
import pathlib
import re
import statistics
import sys

from command import recordings_parser, run
from held_out_pushes import Bench

#: Half the side, the middle in the tracker's frame [m], mass [kg], tip above the lower end [m].
BODIES = {
    "St_block": {"half": 0.0500, "middle": (0.0, 0.0), "mass": 1.02, "reach": 0.16},
    "Al_block": {"half": 0.0500, "middle": (0.0009, 0.0018), "mass": 0.351, "reach": 0.23},
    "Plastic_block": {"half": 0.0547, "middle": (0.0022, 0.0088), "mass": 0.187, "reach": 0.09},
}
HEIGHT = 0.013  # [m]
FACES = ["1 3 2", "1 4 3", "5 6 7", "5 7 8", "1 2 6", "1 6 5", "2 3 7", "2 7 6", "3 4 8", "3 8 7",
         "4 1 5", "4 5 8"]
GUESS = "format: pcavr-parameters/2\nblock:\n  mass: {mass}\n  sliding_friction_coefficient: 0.5\n"


def write_body(body, folder):
    """A recording.yaml with the block and the finger, for import."""
    (folder / "objects").mkdir(parents=True, exist_ok=True)
    corners = [(body["middle"][0] + x * body["half"], body["middle"][1] + y * body["half"], z)
               for z in (0.0, HEIGHT) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in corners] + [f"f {f}" for f in FACES]
    (folder / "objects" / "block.obj").write_text("\n".join(lines) + "\n")
    (folder / "recording.yaml").write_text(
        "format: pcavr-recording/1\nobjects:\n"
        f"  - {{name: block, mesh: objects/block.obj, mass: {body['mass']}}}\ntool: {{radius: 0.00475}}\n")
    return folder / "recording.yaml"


def runs_of(folder):
    """What the names of each run's files begin with, by number."""
    names = {str(file)[:-len("_tip.csv")] for file in folder.glob("*_tip.csv")}
    return sorted(names, key=lambda name: int(re.search(r"\d+$", name).group()))


class Block:
    def __init__(self, folder, arguments):
        self.bench, self.work = Bench(arguments), arguments.work / folder.name
        self.body, self.runs = BODIES[folder.name], runs_of(folder)
        self.options = ["--tool-topic", "tip", "--wrench-topic", "ft", "--wrench-frame", "tool",
                        "--invert-wrench", "--tare", 0.2, "--object", "block=obj",
                        "--tool-offset", 0, 0, self.body["reach"],
                        "--manifest", write_body(self.body, self.work / "body"), "--force"]

    def find_world(self):
        """The options that place the tracker's world, and the gap between tip and sides [m]."""
        half = self.runs[:len(self.runs) // 2]
        report = run(*self.bench.command, "import", half[0], *self.options, "-o",
                     self.work / "found", "--find-world", "--world-runs", *half[1:])["world"]
        return (["--T-base-world", *report["T_base_world"], "--tool-delay",
                 report["tool_delay_s"]], report["residual_m"])

    def judge(self):
        world, gap = self.find_world()
        recordings = []
        for name in self.runs:
            recordings.append(self.work / pathlib.Path(name).name)
            run(*self.bench.command, "import", name, *self.options, *world, "-o", recordings[-1])
        found = [self.bench.identify(recording, self.work / f"{recording.name}-found")
                 for recording in recordings]
        guess = self.work / "guess.yaml"
        guess.write_text(GUESS.format(**self.body))
        files = [self.work / f"{recordings[0].name}-found" / "parameters.yaml", guess]
        ends = [statistics.median(self.bench.errors(test, self.work / f"{test.name}-test", file,
                                                    self.body["half"])[1]
                                  for test in recordings[1:]) for file in files]
        limits = [one["limiting_static_friction"] for one in found
                  if "limiting_static_friction" in one]
        slides = [force for one in found for _, force, _ in one["sliding_force"]]
        return gap, limits, slides, ends


def middle(values):
    return statistics.median(values) if values else math.nan


def main():
    parser = recordings_parser(__doc__, "out/raw-pushes")
    parser.add_argument("--config", help="of pcavr")
    arguments = parser.parse_args()
    print(f"{'block':<16}{'gap':>6}{'limiting':>10}{'sliding':>9}{'end':>8}{'guessed':>9}")
    for name in BODIES:
        if not re.search(arguments.only, name):
            continue
        gap, limits, slides, ends = Block(arguments.data / name, arguments).judge()
        print(f"{name:<16}{1e3 * gap:6.2f}{middle(limits):10.2f}{middle(slides):9.2f}"
              f"{ends[0]:8.1f}{ends[1]:9.1f}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
