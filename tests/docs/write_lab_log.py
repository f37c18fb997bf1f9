#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Writes a recording's push of one object as a lab logs it: robot.csv (flange), ft.csv (load on the sensor, with a
bias), and a take of motion capture in a world of its own, mm and y up; with the object's mesh and bodies.yaml.

    write_lab_log.py RECORDING OBJECT LOG
"""
import csv
import math
import pathlib
import re
import shutil
import sys

FLANGE = 0.12  # [m] from the flange to the tip, along the tool's z
START_MS = 1741771234567  # 2025-03-12 09:20:34.567 UTC
BIAS = (1.2, -3.4, 12.6)  # [N]
WORLD = (0.1, 0.4, math.radians(25))  # of motion capture in base: x, y [m], turn about z


def product(a, b):
    """Of quaternions x y z w."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return (aw * bx + bw * ax + ay * bz - az * by, aw * by + bw * ay + az * bx - ax * bz,
            aw * bz + bw * az + ax * by - ay * bx, aw * bw - ax * bx - ay * by - az * bz)


def turned(q, v):
    x, y, z, _ = product(product(q, (*v, 0.0)), (-q[0], -q[1], -q[2], q[3]))
    return x, y, z


def inverse(q):
    return -q[0], -q[1], -q[2], q[3]


def rows_of(file):
    with file.open() as stream:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(stream)]


def orientation(row):
    return tuple(row[key] for key in ("qx", "qy", "qz", "qw"))


def write_robot(tool, file):
    lines = ["timestamp_ms,x,y,z,qx,qy,qz,qw"]
    for row in tool:
        lever = turned(orientation(row), (0.0, 0.0, -FLANGE))
        pose = [row[key] + shift for key, shift in zip("xyz", lever)] + list(orientation(row))
        lines.append(",".join([f"{START_MS + 1e3 * row['t']:.3f}", *(f"{each:.9f}" for each in pose)]))
    file.write_text("\n".join(lines) + "\n")


def write_forces(wrench, tool, file):
    """In the tool's axes, as they are at the first row: this tool does not turn."""
    lines = ["Timestamp [ms];Fx [N];Fy [N];Fz [N];Tx [Nm];Ty [Nm];Tz [Nm]"]
    to_tool = inverse(orientation(tool[0]))
    for row in wrench:
        load = turned(to_tool, [-row[key] for key in ("fx", "fy", "fz")])
        read = [f"{bias + each:.6f}" for bias, each in zip(BIAS, load)]
        lines.append(";".join([f"{START_MS + 1e3 * row['t']:.3f}", *read, "0", "0", "0"]))
    file.write_text("\n".join(lines) + "\n")


def write_take(tracked, body, file):
    x0, y0, turn = WORLD
    to_world = (0.0, 0.0, -math.sin(turn / 2), math.cos(turn / 2))
    lines = ["Format Version,1.23,Take Name,push,Capture Frame Rate,100,Export Frame Rate,100,Capture Start Time,"
             "2025-03-12 10.20.34.567 AM,Rotation Type,Quaternion,Length Units,Millimeters,Coordinate Space,Global", "",
             ",," + ",".join(["Rigid Body"] * 7), ",," + ",".join([body] * 7), ",," + ",".join(['"1"'] * 7),
             ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position", "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z"]
    for frame, line in enumerate(line for line in tracked.read_text().splitlines() if not line.startswith("#")):
        t, x, y, z, *q = map(float, line.split())
        x, y, z = (1e3 * each for each in turned(to_world, (x - x0, y - y0, z)))
        qx, qy, qz, qw = product(to_world, q)
        lines.append(f"{frame},{t:.6f},{qx:.9f},{qz:.9f},{-qy:.9f},{qw:.9f},{x:.6f},{z:.6f},{-y:.6f}")
    file.write_text("\n".join(lines) + "\n")


def main(recording, name, log):
    mass = re.search(rf"name: {name}\b.*?mass: ([\d.]+)", (recording / "recording.yaml").read_text(), re.DOTALL)[1]
    log.mkdir()
    tool = rows_of(recording / "tool.csv")
    write_robot(tool, log / "robot.csv")
    write_forces(rows_of(recording / "wrench.csv"), tool, log / "ft.csv")
    write_take(recording / "tracked" / "objects" / name / "tracked.txt", "block", log / "Take 2025-03-12.csv")
    shutil.copy(recording / "objects" / f"{name}.obj", log / "block.obj")
    (log / "bodies.yaml").write_text("format: pcavr-recording/1\nobjects:\n  - {name: block, mesh: block.obj, "
                                     f"mass: {mass}, movable: true}}\ntool: {{radius: 0.01}}\n")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3]))
