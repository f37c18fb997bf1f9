# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Sound recordings of random rigs: simulated, then put elsewhere, on another clock or recorded at another rate,
everything alike, so that nothing contradicts anything. None may be refused or have a disagreement."""
import math

from faults import replace_file
from recorded_tables import axis_turn, edit_manifest, forget_counts, pose_product, quaternion, tool, wrench
from wrong_recordings import log_uniform, map_force, map_tracks

# Tasks with their weights and the options that a case may have.
PUSHES = (("push", 6), ("probe", 6), ("turn", 4), ("press", 4), ("impact", 2), ("soft", 2), ("corner", 2), ("slot", 1),
          ("hole", 1), ("arm-press", 2))
SCENES = (("tabletop", 2), ("room", 1))


def push_case(rng):
    """Task and options of `simulate`, without images."""
    task = rng.choices([name for name, _ in PUSHES], [weight for _, weight in PUSHES])[0]
    options = ["--no-images"]
    if task in ("push", "probe", "turn") and rng.random() < 0.3:
        options.append("--wide")
    if task == "push" and rng.random() < 0.5:
        options += ["--objects", str(rng.randint(1, 4))]
    if task == "press" and rng.random() < 0.3:
        options.append("--immovable")
    if rng.random() < 0.2:
        options.append("--without-mass")
    return task, options


def scene_case(rng):
    task = rng.choices([name for name, _ in SCENES], [weight for _, weight in SCENES])[0]
    options = ["--frames-per-second", f"{rng.uniform(3.0, 6.0):.2f}"]
    if rng.random() < 0.5:
        options += ["--objects", str(rng.randint(1, 4))]
    if rng.random() < 0.3:
        options += ["--depth-size", "320x240"]
    return task, options


# Changes of a recording of pushes that leave it sound


def stand_elsewhere(rng, recording):
    """The whole rig, turned about the vertical and moved in the plane."""
    angle = rng.uniform(-math.pi, math.pi)
    turn = [rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0), rng.uniform(-0.5, 0.5)]
    turn += quaternion((0.0, 0.0, 1.0), angle)
    map_tracks(recording, lambda pose: pose_product(turn, pose))
    tool(recording).change(lambda row: [row[0], *pose_product(turn, row[1:8])])
    map_force(recording, axis_turn((0.0, 0.0, 1.0), angle))

    def moved(match):
        t, q = ([float(x) for x in match[group].split(",")] for group in (2, 3))
        pose = pose_product(turn, t + q)
        numbers = (", ".join(f"{x:.9f}" for x in values) for values in (pose[:3], pose[3:]))
        return match[1] + "{{t: [{}], q: [{}]}}".format(*numbers)

    edit_manifest(recording, r"(\n +pose: )\{t: \[([^\]]*)\], q: \[([^\]]*)\]\}", moved)
    return f"turned by {math.degrees(angle):.0f} degrees and moved"


def other_clock(rng, recording):
    """All stamps from another zero."""
    start = rng.choice((1.7e9, rng.uniform(0.0, 1e4)))
    for path in [*recording.glob("*.csv"), *recording.glob("tracked/objects/*/*")]:
        lines = path.read_text().splitlines()
        separator = "," if path.suffix == ".csv" else " "
        for i, line in enumerate(lines):
            stamp, found, rest = line.partition(separator)
            if found and stamp[:1].isdigit():
                lines[i] = f"{start + float(stamp):.6f}{separator}{rest}"
        replace_file(path, "\n".join(lines) + "\n")
    return f"stamps from {start:.0f} s on"


def slower_rates(rng, recording):
    """Tool and force with each second or third row."""
    kept = [rng.randint(1, 3) for _ in range(2)]
    for table, count in zip((tool(recording), wrench(recording)), kept):
        table.rows = table.rows[::count]
        table.save()
    return "each {} th row of tool, {} th of force".format(*kept)


def noisier(rng, recording):
    """By as much as the sensors have already; a tip by an arm's encoders has no sensor of its own."""
    force, position = log_uniform(rng, 0.01, 0.2), log_uniform(rng, 5e-6, 5e-5)
    wrench(recording).change(lambda row: [row[0], *(x + rng.gauss(0.0, force) for x in row[1:4]), *row[4:]])
    if recording.joinpath("joints.csv").exists():
        return f"noise of {force:.2g} N"
    tool(recording).change(lambda row: [row[0], *(x + rng.gauss(0.0, position) for x in row[1:4]), *row[4:]])
    return f"noise of {force:.2g} N and {1e6 * position:.0f} um"


def usual_bias(rng, recording):
    """Less than what is named."""
    bias = [rng.uniform(-0.5, 0.5) for _ in range(3)]
    wrench(recording).change(lambda row: [row[0], *(f + b for f, b in zip(row[1:4], bias)), *row[4:]])
    return "zero of the force off by " + " ".join(f"{x:.2f}" for x in bias) + " N"


CHANGES = (stand_elsewhere, other_clock, slower_rates, noisier, usual_bias)


def change_some(rng, recording):
    """Makes some of the changes, each at most once, and says which."""
    forget_counts(recording)
    chosen = [change for change in CHANGES if rng.random() < 0.5]
    return [change(rng, recording) for change in chosen]
