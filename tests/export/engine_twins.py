#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""
Twins of recorded pushes, of a body that slides by a known law.

    engine_twins.py law               by the recorded force, without an engine: the distance slid (driven.py)
    engine_twins.py surface           by the recorded tool, without an engine: force and pose (quasi_static.py)
    engine_twins.py bullet|ode|dart   both in an engine with its best known settings; 77 where it is not installed

Engines' programs are built in the folder --work.
"""
import argparse
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "bench/engines"))
from driven import DrivenBody, rows_by_law  # noqa: E402
from engines import OPTIONS, answers_of, compiled  # noqa: E402
from experiments import FX, FY, GRAVITY, X, Y, YAW, RecordedPush, experiment  # noqa: E402
from quasi_static import LimitSurface, ellipsoid, quasi_static_rows  # noqa: E402
from sdf_world import BEST, with_setting  # noqa: E402

SKIPPED = 77
PUSH_LIMIT = 0.1  # of the force, and of its direction [rad]
ENGINE_LIMIT = 0.05  # of the distance: what 1 % of the friction changes, where the force is a fifth above it
MASS, INERTIA, RADIUS, TIP, HALF = 1.2, 1.6e-3, 0.03, 0.005, (0.05, 0.04, 0.02)
PLACE, HEADING = (0.4, 0.1), 0.4
STEP = 1e-4  # [s] of the twin, by Euler's explicit method
REGULAR = 1e-3  # [m/s] below which its friction is proportional to the slip
LAW = {"name": "body", "mass": MASS, "friction": 0.3, "static_friction": 0.3, "coulomb_friction": 0.3,
       "viscous": 20.0, "stribeck_speed": 0.0, "friction_radius": RADIUS}
CONTACT = (0.7, 2.1)  # [s] from when to when a force acts
# (place of the contact along the face [m], angle of the force from its normal)
PUSHES = [(0.0, 0.0), (0.006, 0.15)]


def turned(angle, x, y):
    return math.cos(angle) * x - math.sin(angle) * y, math.sin(angle) * x + math.cos(angle) * y


def ring():
    return [turned(math.pi / 4.0 * k, RADIUS, 0.0) for k in range(8)]


def friction_of_feet(vx, vy, spin, size):
    """Force and moment of eight feet with equal loads, each against its own slip; body axes."""
    total = [0.0, 0.0, 0.0]
    for x, y in ring():
        u, v = vx - spin * y, vy + spin * x
        share = size / 8.0 / max(math.hypot(u, v), REGULAR)
        total[0] -= share * u
        total[1] -= share * v
        total[2] -= share * (x * v - y * u)
    return total


def friction_of_ellipsoid(vx, vy, spin, size):
    share = size / max(math.hypot(vx, vy, RADIUS * spin), REGULAR)
    return [-share * vx, -share * vy, -share * RADIUS ** 2 * spin]


def force_at(t):
    """[N] A fifth over the body's friction for a second: it slides at 35 mm/s."""
    return 1.2 * 0.3 * MASS * GRAVITY * min(1.0, max(0.0, 5.0 * (t - CONTACT[0])), max(0.0, 5.0 * (CONTACT[1] - t)))


def twin(friction, along, angle):
    """Rows (t, x, y, yaw, force) of a body that is pushed at a point of its face at -x."""
    x = y = yaw = vx = vy = spin = 0.0
    arm, rows = (-HALF[0], along), []
    for step in range(int(3.0 / STEP)):
        t = step * STEP
        fx, fy = turned(angle, force_at(t), 0.0)
        if step % 20 == 0:
            rows.append((t, x, y, yaw, turned(yaw, fx, fy)))
        slip = math.hypot(vx, vy, RADIUS * spin)
        gx, gy = turned(-yaw, vx, vy)
        rx, ry, moment = friction(gx, gy, spin, 0.3 * MASS * GRAVITY + LAW["viscous"] * slip)
        ax, ay = turned(yaw, fx + rx, fy + ry)
        vx, vy = vx + STEP * ax / MASS, vy + STEP * ay / MASS
        spin += STEP * (arm[0] * fy - arm[1] * fx + moment) / INERTIA
        x, y, yaw = x + STEP * vx, y + STEP * vy, yaw + STEP * spin
    return rows


def write_recording(folder, rows, along):
    """As recorded: the sensor's zero drifts, the tool is clear of the body before and after."""
    tracked = folder / "tracked/objects/body"
    tracked.mkdir(parents=True)
    tool, wrench, track = ["t,x,y,z"], ["t,fx,fy,fz"], []
    for t, x, y, yaw, force in rows:
        cx, cy = turned(HEADING, x, y)
        gap = 0.0 if CONTACT[0] - 0.05 < t < CONTACT[1] + 0.05 else 0.01
        px, py = turned(HEADING + yaw, -HALF[0] - TIP - gap, along)
        base = PLACE[0] + cx, PLACE[1] + cy
        tool.append(f"{t:.4f},{base[0] + px:.9f},{base[1] + py:.9f},{HALF[2]:.4f}")
        fx, fy = turned(HEADING, *force)
        wrench.append(f"{t:.4f},{fx + 0.3 + 0.1 * t:.6f},{fy - 0.2:.6f},0.1")
        half = 0.5 * (HEADING + yaw)
        track.append(f"{t:.4f} {base[0]:.9f} {base[1]:.9f} {HALF[2]} 0 0 {math.sin(half):.9f} {math.cos(half):.9f}")
    (folder / "tool.csv").write_text("\n".join(tool) + "\n")
    (folder / "wrench.csv").write_text("\n".join(wrench) + "\n")
    (tracked / "tracked.txt").write_text("\n".join(track[::5]) + "\n")


def exported_world():
    """As of read_world: the box on eight feet."""
    a, b, h = HALF
    foot = {"radius": 2e-3, "friction": 0.3, "stiffness": 7e4, "damping": 200.0}
    body = {"position": [*PLACE, h], "quaternion": [0.0, 0.0, math.sin(HEADING / 2), math.cos(HEADING / 2)],
            "mass": MASS, "centre_of_mass": [0.0, 0.0, 0.0], "inertia": [1e-3, 1e-3, INERTIA],
            "inertia_quaternion": [0.0, 0.0, 0.0, 1.0], "inertia_z": INERTIA, "friction": 0.2, "stiffness": 2e4,
            "damping": 50.0, "static_ratio": 1.0, "bullet_friction": 0.3,
            "points": [[x, y, z] for x in (-a, a) for y in (-b, b) for z in (-h, h)],
            "triangles": [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6],
                          [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]],
            "feet": [{"centre": [x, y, 2e-3 - h - 1e-4], **foot} for x, y in ring()]}
    return {"gravity": [0.0, 0.0, -GRAVITY], "tool_radius": TIP, "partner_friction": 10.0, "tip_friction": 10.0,
            "bullet_support_friction": 1.0, "bullet_tip_friction": 0.2 / 0.3, "body": body,
            "supports": [{"position": [0.0, 0.0, -0.025 - 1e-4], "quaternion": [0.0, 0.0, 0.0, 1.0],
                          "size": [2.0, 2.0, 0.05]}]}


def slid_errors(friction, rows_of):
    """Of the distances slid, against the twins'."""
    errors = []
    for along, angle in PUSHES:
        with tempfile.TemporaryDirectory() as folder:
            recording = pathlib.Path(folder)
            write_recording(recording, twin(friction, along, angle), along)
            push, world = RecordedPush(recording, "body"), exported_world()
            errors.append(push.slid_error(rows_of(DrivenBody(push, world).experiment(), world)))
    return errors


def engine_rows(name, program, work):
    def rows_of(driven, world):
        job = {"id": ["driven"], "options": OPTIONS[name][BEST], "experiment": driven,
               "world": with_setting(world, {"bodies": [LAW]}, BEST)}
        return answers_of([program], [job], work / f"{name}.jsonl")[("driven",)]
    return rows_of


def push(beside):
    """A tool that pushes the face at 2 mm/s, beside its middle [m]."""
    begin, velocity = turned(HEADING, -HALF[0] - TIP, beside), turned(HEADING, 2e-3, 0.0)
    return experiment(5.0, tool=[[t, *(p + b + v * t for p, b, v in zip(PLACE, begin, velocity)), HALF[2], *velocity, 0.0]
                                 for t in (0.0, 5.0)])


def surface_rows(pushed):
    world = exported_world()
    return quasi_static_rows(pushed, world, LimitSurface(*ellipsoid(LAW), LAW, world["body"]))


def surface_errors():
    """Of force and distance, and the turn, of a push through the centre; one beside it needs less force, and turns it."""
    rows = surface_rows(push(0.0))
    moved = math.hypot(rows[-1][X] - PLACE[0], rows[-1][Y] - PLACE[1])
    beside = surface_rows(push(0.015))[-1]
    share = math.hypot(beside[FX], beside[FY]) / (0.3 * MASS * GRAVITY)
    return [math.hypot(rows[-1][FX], rows[-1][FY]) / (0.3 * MASS * GRAVITY) - 1.0, moved / 0.01 - 1.0,
            rows[-1][YAW] - HEADING, 0.0 if share < 1.0 and beside[YAW] < HEADING else 1.0]


def push_errors(name, program, work):
    """Of the force beside the body's middle, relative, and of its direction [rad], against the limit surface."""
    pushed = push(0.015)
    law = {**LAW, "viscous": 0.0}
    job = {"id": ["push"], "options": OPTIONS[name][BEST], "experiment": pushed,
           "world": with_setting(exported_world(), {"bodies": [law]}, BEST)}
    engine, wanted = answers_of([program], [job], work / f"{name}.jsonl")[("push",)], surface_rows(pushed)

    def force(rows):
        sliding = [row for row in rows if row[0] > 1.0]
        return (statistics.median(math.hypot(row[FX], row[FY]) for row in sliding),
                statistics.median(math.atan2(row[FY], row[FX]) - row[YAW] for row in sliding))
    (a, direction), (b, right) = force(engine), force(wanted)
    return [a / b - 1.0, direction - right]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("what", choices=["law", "surface", "bullet", "ode", "dart"])
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/driven-bodies"))
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    if arguments.what == "surface":
        errors = [(error, 0.005) for error in surface_errors()]
    elif arguments.what == "law":
        errors = [(error, 0.01) for error in slid_errors(
            friction_of_ellipsoid, lambda driven, world: rows_by_law(driven, world, LAW))]
    else:
        if subprocess.run(["pkg-config", "--exists", arguments.what]).returncode != 0:
            print(f"skipped: {arguments.what} is not installed")
            return SKIPPED
        program = compiled(arguments.what, arguments.work)
        rows_of = engine_rows(arguments.what, program, arguments.work)
        errors = [(error, ENGINE_LIMIT) for error in slid_errors(friction_of_feet, rows_of)]
        errors += [(error, PUSH_LIMIT) for error in push_errors(arguments.what, program, arguments.work)]
    print(arguments.what, " ".join(f"{100.0 * error:+.2f} %" for error, _ in errors))
    return 0 if all(abs(error) < limit for error, limit in errors) else 1


if __name__ == "__main__":
    sys.exit(main())
