#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Do pushes predict other pushes of the same object, and does each half of a file say the same?

    bench/held_out_pushes.py --data DATA/real/push_cmu/recordings --pcavr build/test/apps/pcavr/pcavr
                             [--only REGEX] [--work out/held-out] [--config FILE]

Each folder below DATA with train/ and test*/ is one object. Parameters are identified from train
and from both of its halves in time, cut where the tool touches nothing. Each test is replayed open
loop from train's parameters: no corrections, no delay, nothing learnt. Printed per object: the
coefficient and the friction radius [mm]; the halves' parameters that differ by more than 2.5 of
their stds; and over the tests the median angle between the twists of the whole push, predicted and
tracked [deg] (rotations times the friction radius), and the median error of the end position [mm].
Needs only python3.
"""
import math
import re
import statistics
import sys

from command import recordings_parser, run

CLEAR_OF_CONTACT = 0.1  # of the largest force: less is a tool in the air
MAX_Z = 2.5
KEYS = ["sliding_friction_coefficient", "limiting_static_friction", "friction_radius",
        "viscous_friction"]


def rows(path):
    """The columns of a TUM file as numbers."""
    lines = path.read_text().splitlines()
    return [[float(x) for x in line.split()] for line in lines if line and line[0] not in "#"]


def parameters(path):
    """The numbers of the one object's file: KEY, KEY_std, and given."""
    text = path.read_text()
    found = {key: float(value) for key, value in re.findall(r"^  (\w+): ([-+.\deE]+)$", text, re.M)}
    forces = re.findall(r"speed: (\S+), force: (\S+), std: ([^\s}]+)", text)
    found["given"] = re.findall(r"\w+", "".join(re.findall(r"^  given: \[(.*)\]$", text, re.M)))
    found["sliding_force"] = [tuple(map(float, row)) for row in forces]
    return found


def heading(q):
    x, y, z, w = q
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def twist(first, last, centre, radius):
    """Displacement of the centre of mass and turn between two rows, rotations as lengths [m]."""
    points = []
    for row in (first, last):
        a = heading(row[4:8])
        points.append((row[1] + math.cos(a) * centre[0] - math.sin(a) * centre[1],
                       row[2] + math.sin(a) * centre[0] + math.cos(a) * centre[1], a))
    turn = math.remainder(points[1][2] - points[0][2], 2.0 * math.pi)
    return (points[1][0] - points[0][0], points[1][1] - points[0][1], radius * turn), points[1]


def angle(a, b):
    dot = sum(x * y for x, y in zip(a, b))
    size = math.sqrt(sum(x * x for x in a) * sum(y * y for y in b))
    return math.degrees(math.acos(max(-1.0, min(1.0, dot / size)))) if size > 0.0 else 180.0


def base_centre(mesh):
    """Centroid of the area of the mesh's lowest faces, in the object's frame [m]."""
    points, total, sums = [], 0.0, [0.0, 0.0]
    for line in mesh.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            a, b, c = (points[int(word.split("/")[0]) - 1] for word in words[1:4])
            area = abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            total += area
            for k in range(2):
                sums[k] += area * (a[k] + b[k] + c[k]) / 3.0
    return [value / total for value in sums]


def write_half(recording, folder, begin, end):
    """The rows of a recording with begin <= t < end [s], as a recording."""
    for file in [*recording.glob("*.csv"), *recording.glob("tracked/objects/*/tracked.txt")]:
        target = folder / file.relative_to(recording)
        target.parent.mkdir(parents=True, exist_ok=True)
        lines = file.read_text().splitlines()
        kept = [line for line in lines
                if not re.match(r"[-+\d]", line) or begin <= float(re.split(r"[ ,]", line)[0]) < end]
        target.write_text("\n".join(kept) + "\n")
    (folder / "objects").mkdir(exist_ok=True)
    for mesh in recording.glob("objects/*"):
        (folder / "objects" / mesh.name).write_bytes(mesh.read_bytes())
    pose = rows(next(folder.glob("tracked/objects/*/tracked.txt")))[0]
    text = re.sub(r"pose: \{.*\}", f"pose: {{t: {pose[1:4]}, q: {pose[4:8]}}}",
                  (recording / "recording.yaml").read_text())
    (folder / "recording.yaml").write_text(text)
    return folder


def middle_in_the_air(recording):
    """The time closest to the middle at which the force is that of a tool in the air [s]."""
    wrench = [[float(x) for x in line.split(",")]
              for line in (recording / "wrench.csv").read_text().splitlines()[1:]]
    sizes = [math.hypot(row[1], row[2]) for row in wrench]
    middle = 0.5 * (wrench[0][0] + wrench[-1][0])
    return min((abs(row[0] - middle), row[0]) for row, size in zip(wrench, sizes)
               if size < CLEAR_OF_CONTACT * max(sizes))[1]


def pairs_of(halves):
    """(name, z) of each parameter that both halves give with its std."""
    first, second = halves
    pairs = []
    for key in KEYS:
        if any(key in half["given"] or f"{key}_std" not in half for half in halves):
            continue
        std = math.hypot(first[f"{key}_std"], second[f"{key}_std"])
        pairs.append((key, (first[key] - second[key]) / std))
    if first["sliding_force"] and second["sliding_force"]:
        # At the two closest of the speeds that occurred.
        a, b = min(((a, b) for a in first["sliding_force"] for b in second["sliding_force"]),
                   key=lambda pair: abs(pair[0][0] - pair[1][0]))
        pairs.append(("sliding_force", (a[1] - b[1]) / math.hypot(a[2], b[2])))
    return pairs


class Bench:
    def __init__(self, arguments):
        self.arguments = arguments
        self.command = [arguments.pcavr]
        if arguments.config:
            self.command += ["--config", arguments.config]

    def identify(self, recording, folder):
        folder.mkdir(parents=True, exist_ok=True)
        file = folder / "parameters.yaml"
        run(*self.command, "identify", "friction", recording, "-o", file, "--force")
        return parameters(file)

    def halves(self, train, work):
        middle = middle_in_the_air(train)
        ends = [("first", -math.inf, middle), ("second", middle, math.inf)]
        return [self.identify(write_half(train, work / name, begin, end), work / f"{name}-found")
                for name, begin, end in ends]

    def errors(self, test, work, file, radius):
        """The angle between the twists [deg], and the end position's error [mm], predicted by the
        parameters of a file."""
        scene, replay = work / "scene", work / "run"
        work.mkdir(parents=True, exist_ok=True)
        run(*self.command, "build", test, "-o", scene, "--force")
        run(*self.command, "replay", test, "--scene", scene, "-o", replay, "--force",
            "--no-corrections", "--keep-parameters", "--parameters", file,
            "--forward-delay", 0, "--backward-delay", 0)
        tracked = rows(next(test.glob("tracked/objects/*/tracked.txt")))
        predicted = rows(next(replay.glob("objects/*/predicted.txt")))
        centre = base_centre(next(test.glob("objects/*.obj")))
        true, true_end = twist(tracked[0], tracked[-1], centre, radius)
        found, end = twist(tracked[0], predicted[-1], centre, radius)
        return angle(found, true), 1e3 * math.hypot(end[0] - true_end[0], end[1] - true_end[1])

    def judge(self, folder):
        work = self.arguments.work / folder.name
        found = self.identify(folder / "train", work)
        pairs = pairs_of(self.halves(folder / "train", work))
        radius = found.get("friction_radius", 0.05)
        errors = [self.errors(test, work / test.name, work / "parameters.yaml", radius)
                  for test in sorted(folder.glob("test*"))]
        apart = [f"{key} {z:+.1f}" for key, z in pairs if abs(z) > MAX_Z]
        coefficient = found.get("sliding_friction_coefficient", math.nan)
        std = found.get("sliding_friction_coefficient_std", math.nan)
        print(f"{folder.name:<24}{coefficient:7.3f} +- {std:5.3f}{1e3 * radius:8.1f}"
              f"{len(pairs) - len(apart):4} of {len(pairs)}"
              f"{statistics.median(error[0] for error in errors):9.1f}"
              f"{statistics.median(error[1] for error in errors):8.2f}"
              f"{len(errors):6}  {', '.join(apart)}", flush=True)
        return pairs, errors


def main():
    parser = recordings_parser(__doc__, "out/held-out")
    parser.add_argument("--config", help="of pcavr")
    arguments = parser.parse_args()
    bench = Bench(arguments)
    print(f"{'object':<24}{'coefficient':>16}{'radius':>8}{'halves':>8}{'twist':>9}{'end':>8}"
          f"{'tests':>6}  halves apart [std]")
    folders = sorted(train.parent for train in arguments.data.glob("*/train"))
    done = [bench.judge(folder) for folder in folders if re.search(arguments.only, folder.name)]
    pairs = [pair for result in done for pair in result[0]]
    errors = [error for result in done for error in result[1]]
    print(f"halves agree in {sum(abs(z) <= MAX_Z for _, z in pairs)} of {len(pairs)} pairs; "
          f"twist {statistics.median(error[0] for error in errors):.1f} deg, "
          f"end {statistics.median(error[1] for error in errors):.2f} mm over {len(errors)} tests")


if __name__ == "__main__":
    sys.exit(main())
