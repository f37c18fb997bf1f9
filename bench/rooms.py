#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Copies of a simulated room in a row, with exact poses: built at once and by tiles.

    bench/rooms.py --pcavr build/bench/apps/pcavr/pcavr [--rooms 8] [--voxel 0.005] [--tiles 12] [--rate 5]
                   [--occupancy 0.05] [--work out/rooms]

Prints the largest distance between the two meshes' vertices, times and peak memory; exit code 1 where it exceeds
0.1 mm, the tiles' memory a quarter of the whole's, or their time 1.3 times. Needs python3 and numpy.
"""
import argparse
import pathlib
import shutil
import subprocess
import sys

import numpy as np

import hall

SPACING = 12.0  # m, along x: no room sees another
PAUSE = 1.0     # s, between the visits


def stamped(path, columns):
    rows = [line.split() for line in path.read_text().splitlines() if line and line[0] != "#"]
    return [row for row in rows if len(row) >= columns]


def shifted(rows, base, offset):
    return [[f"{float(row[0]) - base + offset:.6f}", *row[1:]] for row in rows]


def write_rooms(pcavr, folder, rooms, seconds, rate):
    """One room's images at several places: poses are moved, files are linked."""
    room = folder.parent / "room"
    subprocess.run([pcavr, "simulate", "room", "--seed", "3", "--duration", str(seconds), "--frames-per-second",
                    str(rate), "-o", room, "--force"], check=True, stdout=subprocess.DEVNULL)
    shutil.rmtree(folder, ignore_errors=True)  # of a run that was broken off
    folder.mkdir(parents=True)
    for name in ("rgb", "depth"):
        (folder / name).symlink_to((room / name).resolve())
    lists = {name: stamped(room / f"{name}.txt", 2) for name in ("rgb", "depth")}
    poses = stamped(room / "truth" / "camera.txt", 8)
    base = float(poses[0][0])
    period = float(poses[-1][0]) - base + PAUSE
    for name, rows in lists.items():
        copies = [row for i in range(rooms) for row in shifted(rows, base, i * period)]
        (folder / f"{name}.txt").write_text("".join(" ".join(row) + "\n" for row in copies))
    moved = [[row[0], str(float(row[1]) + i * SPACING), *row[2:]]
             for i in range(rooms) for row in shifted(poses, base, i * period)]
    (folder / "groundtruth.txt").write_text("".join(" ".join(row) + "\n" for row in moved))
    manifest = (room / "recording.yaml").read_text().splitlines()
    kept, is_camera = ["format: pcavr-recording/1"], False
    for line in manifest:
        is_camera = line.startswith("camera:") or (is_camera and line.startswith(" "))
        if is_camera:
            kept.append(line)
    (folder / "recording.yaml").write_text("\n".join(kept) + "\n")


def vertices(path):
    """Of a PLY file as `build` writes it."""
    with open(path, "rb") as file:
        count, size = 0, 0
        for line in iter(file.readline, b"end_header\n"):
            words = line.split()
            if words[:2] == [b"element", b"vertex"]:
                count = int(words[2])
            if words[0] == b"property" and words[1] != b"list":
                size += 4 if words[1] == b"float" else 1
        rows = np.frombuffer(file.read(count * size), dtype=np.uint8).reshape(count, size)
    return np.ascontiguousarray(rows[:, :12]).view("<f4")


def largest_distance(a, b):
    """Of vertices in their order by position [m]; infinite where there are not as many."""
    if a.shape != b.shape:
        return np.inf
    a, b = (rows[np.lexsort(rows.T)] for rows in (a, b))
    return float(np.max(np.linalg.norm(a.astype(float) - b, axis=1)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pcavr", required=True)
    parser.add_argument("--rooms", type=int, default=8)
    parser.add_argument("--voxel", default="0.005")
    parser.add_argument("--tiles", default=str(int(SPACING)), help="edge [m]: here a room a tile")
    parser.add_argument("--occupancy", default="0.05", help="cell [m]: one map has the free space of all tiles")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rate", type=float, default=5.0)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/rooms"))
    arguments = parser.parse_args()
    recording = arguments.work / f"{arguments.rooms}-rooms-{arguments.seconds:g}-s-{arguments.rate:g}-Hz"
    if not (recording / "recording.yaml").exists():
        arguments.work.mkdir(parents=True, exist_ok=True)
        write_rooms(arguments.pcavr, recording, arguments.rooms, arguments.seconds, arguments.rate)
    figures = {}
    for name, options in (("whole", []), ("tiled", ["--tiles", arguments.tiles])):
        figures[name] = hall.build(arguments.pcavr, recording, arguments.work / name,
                                   ["--voxel", arguments.voxel, "--occupancy-resolution", arguments.occupancy,
                                    "--trust-poses", *options])
        status, error, seconds, processor, memory = figures[name]
        if status != 0:
            sys.exit(f"{name}: {error}")
        print(f"{name}: {seconds:.0f} s, {processor:.0f} s of a processor, {memory / 1e9:.2f} GB", flush=True)
    distance = largest_distance(*(vertices(arguments.work / name / "mesh.ply") for name in figures))
    time_ratio = figures["tiled"][3] / figures["whole"][3]
    memory_ratio = figures["tiled"][4] / figures["whole"][4]
    print(f"vertices within {1e3 * distance:.4f} mm; processor time x {time_ratio:.2f}, memory x {memory_ratio:.2f}")
    return int(distance > 1e-4 or time_ratio > 1.3 or memory_ratio > 0.25)


if __name__ == "__main__":
    sys.exit(main())
