#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""A hall of 30 x 10 x 4 m with equal pillars, seen from 240 exactly known poses: are they kept, what does it take?

    bench/hall.py --pcavr build/bench/apps/pcavr/pcavr [--voxel 0.02] [--tiles 4] [--work out/hall]

Renders the recording, then builds it with --trust-poses and with --pose-std 0.001 (--trust-poses alone with
--tiles): prints for each the poses that moved, the largest displacement, time and peak memory; exit code 1 where
one moved by more than 5 stds.
Needs python3 and numpy.
"""
import argparse
import os
import pathlib
import struct
import subprocess
import sys
import time
import zlib

import numpy as np

SIZE = np.array([30.0, 10.0, 4.0])  # m
VIEWS = 240
WIDTH, HEIGHT, FOCAL = 320, 240, 262.5  # px
PILLAR, SPACING = 0.4, 3.0  # m
MAX_DEPTH = 5.0  # m
DEPTH_SCALE = 1000
STD = 0.001  # m, rad: of the given poses


def boxes():
    """Pillars in two rows, (low, high) corners: views of two of them look alike."""
    centres = [(x, y) for x in np.arange(1.5, SIZE[0], SPACING) for y in (2.5, 7.5)]
    half = PILLAR / 2
    return [(np.array([x - half, y - half, 0.0]), np.array([x + half, y + half, SIZE[2]])) for x, y in centres]


def view(i):
    """Position, and the camera's axes in base as columns: along the hall, turning about z, at 1.6 m."""
    round_trip = 2 * i / VIEWS
    x = 1.0 + 28.0 * (round_trip if round_trip < 1 else 2 - round_trip)
    y = 5.0 + (1.2 if round_trip < 1 else -1.2)
    yaw = 2.4 * i
    forward = np.array([np.cos(yaw) * 0.98, np.sin(yaw) * 0.98, -0.2])
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    return np.array([x, y, 1.6]), np.stack([right, np.cross(forward, right), forward], axis=1)


def quaternion(r):
    w = np.sqrt(max(0.0, 1.0 + np.trace(r))) / 2
    if w > 1e-3:
        return np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], 4 * w * w]) / (4 * w)
    i = int(np.argmax(np.diag(r)))
    j, k = (i + 1) % 3, (i + 2) % 3
    q = np.zeros(4)
    root = np.sqrt(1.0 + r[i, i] - r[j, j] - r[k, k])
    q[i], q[j], q[k], q[3] = root / 2, (r[j, i] + r[i, j]) / (2 * root), (r[k, i] + r[i, k]) / (2 * root), \
        (r[k, j] - r[j, k]) / (2 * root)
    return q


def render(position, axes):
    """Depth [m] along the optical axis and a grey value by pixel."""
    u, v = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    rays = np.stack([(u - (WIDTH - 1) / 2) / FOCAL, (v - (HEIGHT - 1) / 2) / FOCAL, np.ones(u.shape)], axis=-1)
    directions = rays @ axes.T
    with np.errstate(divide="ignore"):
        inverse = 1.0 / directions
    distance = np.min(np.maximum(-position * inverse, (SIZE - position) * inverse), axis=-1)
    for low, high in boxes():
        a, b = (low - position) * inverse, (high - position) * inverse
        near, far = np.max(np.minimum(a, b), axis=-1), np.min(np.maximum(a, b), axis=-1)
        hit = (near < far) & (near > 0)
        distance = np.where(hit & (near < distance), near, distance)
    point = position + directions * distance[..., None]
    grey = 110 + 40 * (np.floor(point / 0.5).astype(int).sum(axis=-1) % 2)
    return np.where(distance <= MAX_DEPTH, distance, 0.0), grey.astype(np.uint8)


def write_png(path, rows, bits, color_type):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    lines = b"".join(b"\0" + row.tobytes() for row in rows)
    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, bits, color_type, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines, 1))
                     + chunk(b"IEND", b""))


def write_recording(folder):
    for name in ("rgb", "depth"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    lists = {"rgb": [], "depth": []}
    poses = []
    for i in range(VIEWS):
        position, axes = view(i)
        depth, grey = render(position, axes)
        stamp = f"{0.1 * i:.6f}"
        write_png(folder / "depth" / f"{stamp}.png", np.round(depth * DEPTH_SCALE).astype(">u2"), 16, 0)
        write_png(folder / "rgb" / f"{stamp}.png", np.repeat(grey[..., None], 3, axis=2).reshape(HEIGHT, -1), 8, 2)
        for name in lists:
            lists[name].append(f"{stamp} {name}/{stamp}.png")
        poses.append(" ".join([stamp, *(f"{x:.9f}" for x in [*position, *quaternion(axes)])]))
    for name, rows in lists.items():
        (folder / f"{name}.txt").write_text("\n".join(rows) + "\n")
    (folder / "groundtruth.txt").write_text("\n".join(poses) + "\n")
    (folder / "recording.yaml").write_text(
        "format: pcavr-recording/1\n"
        f"camera: {{width: {WIDTH}, height: {HEIGHT}, fx: {FOCAL}, fy: {FOCAL}, cx: {(WIDTH - 1) / 2}, "
        f"cy: {(HEIGHT - 1) / 2}, depth_scale: {DEPTH_SCALE}}}\n")


def positions(path):
    rows = [line.split() for line in path.read_text().splitlines() if line and line[0] != "#"]
    return {round(float(row[0]), 4): np.array(row[1:4], dtype=float) for row in rows}


def build(pcavr, recording, scene, options):
    """Exit code, last error line, s, s of a processor, peak memory [bytes]."""
    start = time.monotonic()
    with subprocess.Popen([pcavr, "build", recording, "-o", scene, "--force", *options],
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        errors = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    lines = [line for line in errors.splitlines() if line.startswith("pcavr: ")]
    return process.returncode, lines[-1] if lines else "", time.monotonic() - start, \
        usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pcavr", required=True)
    parser.add_argument("--voxel", default="0.02")
    parser.add_argument("--tiles", help="edge of a tile [m]")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/hall"))
    arguments = parser.parse_args()
    recording = arguments.work / "recording"
    if not (recording / "recording.yaml").exists():
        write_recording(recording)
    given = positions(recording / "groundtruth.txt")
    worst = 0.0
    by_tiles = [["--trust-poses", "--tiles", arguments.tiles]]
    for options in by_tiles if arguments.tiles else (["--trust-poses"], ["--pose-std", str(STD)]):
        scene = arguments.work / f"scene{options[0]}"
        status, error, seconds, processor, memory = build(arguments.pcavr, recording, scene,
                                                          ["--voxel", arguments.voxel, *options])
        if status != 0:
            sys.exit(f"{' '.join(options)}: {error}")
        found = positions(scene / "camera_trajectory.txt")
        moved = [np.linalg.norm(found[t] - given[t]) for t in found if t in given]
        worst = max(worst, *moved)
        print(f"{' '.join(options)}, voxel {arguments.voxel} m: {len(moved)} of {VIEWS} poses used, the largest "
              f"displacement {1e3 * max(moved):.2f} mm; {seconds:.0f} s, {processor:.0f} s of a processor, "
              f"{memory / 1e9:.2f} GB", flush=True)
    return int(worst > 5 * STD)


if __name__ == "__main__":
    sys.exit(main())
