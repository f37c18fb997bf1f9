#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Scaling benchmark: time and peak memory of build, identify and replay over the input size.

    bench/scale.py --pcavr build/bench/apps/pcavr/pcavr --work out/scale [--quick] [--only objects]

Simulates recordings that differ in one parameter (frames, objects, triangles of the CAD bodies,
voxel, image size), runs the commands on each, and prints a row: elapsed and user CPU seconds and
the peak resident memory of each step, user CPU in milliseconds per frame, and the tracking error
of the worst object against the truth (rms), so that a speed-up at the cost of accuracy is visible.
Only compare rows of one run on one machine. Needs only python3.
"""
import argparse
import bisect
import json
import math
import os
import pathlib
import platform
import subprocess
import sys
import time

SECONDS = 10.0      # of a recording, unless the number of frames varies
RATE = 12.0         # frames per second, as in the case push
IMAGE = "640x480"
VOXEL = 0.005       # [m], the command's default


def row(axis, **changes):
    """A recording and its processing options; the others have their defaults."""
    base = {"axis": axis, "duration": SECONDS, "rate": RATE, "objects": 2, "subdivisions": 1,
            "voxel": VOXEL, "image": IMAGE, "depth": None}
    base.update(changes)
    return base


def rows(quick):
    """The matrix. `subdivisions` n divides each triangle of a body's mesh into n x n."""
    if quick:
        frames, objects, subdivisions, voxels = [5.0, 10.0], [2, 20], [1, 64], [0.01, 0.005]
        images = [("640x480", None), ("1280x720", None)]
    else:
        frames, objects = [5.0, 10.0, 20.0, 40.0], [1, 2, 5, 10, 20]
        subdivisions, voxels = [1, 8, 64, 256, 512], [0.01, 0.005, 0.0025]
        images = [("640x480", None), ("1280x720", None), ("1920x1080", None),
                  ("4096x3072", "1024x768")]
    matrix = [row("frames", duration=seconds) for seconds in frames]
    matrix += [row("objects", objects=count) for count in objects]
    matrix += [row("CAD triangles", subdivisions=n) for n in subdivisions]
    matrix += [row("voxel", voxel=size) for size in voxels]
    matrix += [row("image", duration=2.0, rate=4.0, image=image, depth=depth)
               for image, depth in images]
    return matrix


def subdivided(obj, n):
    """The text of an OBJ mesh with each triangle divided into n x n, without duplicate vertices."""
    if n == 1:
        return obj
    corners, triangles = [], []
    for line in obj.splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            corners.append(tuple(float(word) for word in words[1:4]))
        elif words[:1] == ["f"]:
            triangles.append([int(word.split("/")[0]) - 1 for word in words[1:4]])
    lines, faces, on_edges = [], [], {}

    def vertex(point, is_on_edge):
        if is_on_edge:
            key = tuple(round(x, 7) for x in point)  # the same in both triangles of an edge
            if key not in on_edges:
                lines.append("v %.9g %.9g %.9g" % point)
                on_edges[key] = len(lines)
            return on_edges[key]
        lines.append("v %.9g %.9g %.9g" % point)
        return len(lines)

    for triangle in triangles:
        a, b, c = (corners[i] for i in triangle)
        grid = []
        for i in range(n + 1):
            along = []
            for j in range(n + 1 - i):
                u, v = i / n, j / n
                point = tuple(p + u * (q - p) + v * (r - p) for p, q, r in zip(a, b, c))
                along.append(vertex(point, i == 0 or j == 0 or i + j == n))
            grid.append(along)
        for i in range(n):
            for j in range(n - i):
                faces.append("f %d %d %d" % (grid[i][j], grid[i + 1][j], grid[i][j + 1]))
                if i + j + 1 < n:
                    faces.append("f %d %d %d" % (grid[i + 1][j], grid[i + 1][j + 1], grid[i][j + 1]))
    return "\n".join(lines + faces) + "\n"


def run(words):
    """Runs a command: elapsed and user CPU [s], peak memory [MB], or the error message."""
    begin = time.monotonic()
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    message = process.stderr.read().decode(errors="replace")
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    result = {"elapsed": time.monotonic() - begin, "user": usage.ru_utime,
              "system": usage.ru_stime, "memory": usage.ru_maxrss / 1024.0}
    if process.returncode != 0:
        lines = message.strip().splitlines()
        result["error"] = lines[-1] if lines else f"exit code {process.returncode}"
    return result


def trajectory(path):
    poses = []
    for line in path.read_text().splitlines():
        if line and not line.startswith("#"):
            poses.append([float(word) for word in line.split()])
    return poses


def position_at(poses, t):
    """Linear interpolation between the two poses around t."""
    at = min(max(bisect.bisect_left([pose[0] for pose in poses], t), 1), len(poses) - 1)
    before, after = poses[at - 1], poses[at]
    share = min(max((t - before[0]) / (after[0] - before[0]), 0.0), 1.0)
    return [p + share * (q - p) for p, q in zip(before[1:4], after[1:4])]


def tracking_errors(recording, output):
    """By object, the rms error of the tracked positions [mm], and the number of tracked frames."""
    errors = {}
    for truth_file in sorted((recording / "truth/objects").glob("*.txt")):
        tracked_file = output / "objects" / truth_file.stem / "tracked.txt"
        tracked = trajectory(tracked_file) if tracked_file.exists() else []
        truth = trajectory(truth_file)
        squares = [math.dist(pose[1:4], position_at(truth, pose[0])) ** 2 for pose in tracked]
        rms = 1e3 * math.sqrt(sum(squares) / len(squares)) if squares else math.nan
        errors[truth_file.stem] = (rms, len(squares))
    return errors


def measure(pcavr, case, recording, work):
    """One row of the table."""
    scene, output = work / "scene", work / "run"
    frames = len([line for line in (recording / "rgb.txt").read_text().splitlines()
                  if line and not line.startswith("#")])
    commands = {
        "build": ["build", recording, "-o", scene, "--voxel", case["voxel"], "--force"],
        "identify": ["identify", "friction", recording, "--scene", scene,
                     "-o", work / "parameters.yaml", "--force"],
        "replay": ["replay", recording, "--scene", scene, "-o", output, "--force"],
    }
    result = dict(case, frames=frames)
    for name, words in commands.items():
        result[name] = run([pcavr] + [str(word) for word in words])
        if "error" in result[name] and name == "build":
            return result
    errors = tracking_errors(recording, output)
    result["triangles"] = 12 * case["subdivisions"] ** 2
    result["tracked"] = errors
    result["worst_rms"] = max((rms for rms, _ in errors.values()), default=math.nan)
    result["fewest_frames"] = min((count for _, count in errors.values()), default=0)
    return result


def simulate(pcavr, case, recording):
    """The recording of a row; shared by rows that differ only in processing options."""
    words = [pcavr, "simulate", "push", "--seed", "1", "--threads", str(os.cpu_count() or 1),
             "--duration", f"{case['duration']:g}", "--objects", str(case["objects"]),
             "--frames-per-second", f"{case['rate']:g}", "--image-size", case["image"],
             "-o", str(recording), "--force"]
    if case["depth"]:
        words += ["--depth-size", case["depth"]]
    done = run(words)
    if "error" in done:
        raise RuntimeError(done["error"])
    for mesh in (recording / "objects").glob("*.obj"):
        mesh.write_text(subdivided(mesh.read_text(), case["subdivisions"]))


def print_row(result):
    size = result["image"] + (f" depth {result['depth']}" if result["depth"] else "")
    line = (f"{result['axis']:14}{result['frames']:7}{result['objects']:8}"
            f"{12 * result['subdivisions'] ** 2:10}{1e3 * result['voxel']:7.1f}  {size:24}")
    for name in ("build", "identify", "replay"):
        step = result.get(name)
        if step is None or "error" in step:
            line += f"{'failed':>29}"
            continue
        per_frame = 1e3 * step["user"] / result["frames"]
        line += (f"{step['elapsed']:8.1f}{step['user']:7.1f}{per_frame:7.1f}"
                 f"{step['memory']:7.0f}")
    if "worst_rms" in result:
        line += f"{result['worst_rms']:8.2f}{result['fewest_frames']:8}"
    print(line, flush=True)


def print_growth(results):
    """Ratios of user CPU within one axis, over the growth of the input."""
    def user(result, name):
        step = result.get(name, {})
        return None if "error" in step or not step else step["user"]

    for axis, size in (("objects", lambda r: r["objects"]), ("image", megapixels)):
        group = [result for result in results if result["axis"] == axis]
        if axis == "objects":
            group = [result for result in group if result["objects"] >= 2]
        for name in ("build", "replay"):
            times = [(size(r), user(r, name) / r["frames"]) for r in group if user(r, name)]
            if len(times) < 2:
                continue
            first = times[0]
            for later in times[1:]:
                unit = "times the objects" if axis == "objects" else "times the pixels"
                print(f"{name}: {later[0] / first[0]:.1f} {unit}, "
                      f"{later[1] / first[1]:.2f} times the user CPU per frame")


def megapixels(result):
    width, height = (int(word) for word in result["image"].split("x"))
    return 1e-6 * width * height


def machine(pcavr):
    model = platform.processor() or platform.machine()
    info = pathlib.Path("/proc/cpuinfo")
    if info.exists():
        names = [line.split(":", 1)[1].strip() for line in info.read_text().splitlines()
                 if line.startswith("model name")]
        model = names[0] if names else model
    version = subprocess.run([pcavr, "--version"], capture_output=True, text=True).stdout.strip()
    return {"version": version, "processor": model, "threads": os.cpu_count(),
            "system": platform.platform()}


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--pcavr", default="build/bench/apps/pcavr/pcavr")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/scale"))
    parser.add_argument("--quick", action="store_true", help="a small matrix, a few minutes")
    parser.add_argument("--only", choices=sorted({case["axis"] for case in rows(True)}),
                        help="only the rows of one parameter")
    parser.add_argument("--json", type=pathlib.Path, help="also write the results to this file")
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    info = machine(arguments.pcavr)
    print(f"{info['version']}; {info['processor']}, {info['threads']} threads; {info['system']}")
    print(f"{'':69}{'build':^29}{'identify':^29}{'replay':^29}{'tracked':^16}")
    step = f"{'s':>8}{'user s':>7}{'ms/fr':>7}{'MB':>7}"
    print(f"{'parameter':14}{'frames':>7}{'objects':>8}{'triangles':>10}{'mm':>7}  {'image':23}"
          f" {3 * step}{'mm rms':>8}{'frames':>8}")
    results, failures = [], []
    last = None
    for case in rows(arguments.quick):
        if arguments.only and case["axis"] != arguments.only:
            continue
        recording = arguments.work / "recording"
        source = {key: value for key, value in case.items() if key not in ("axis", "voxel")}
        try:
            if source != last:
                simulate(arguments.pcavr, case, recording)
            last = source
            results.append(measure(arguments.pcavr, case, recording, arguments.work))
        except (RuntimeError, OSError) as error:
            last = None
            failures.append(f"{case['axis']}: {error}")
            continue
        print_row(results[-1])
        failures += [f"{case['axis']}: {name}: {results[-1][name]['error']}"
                     for name in ("build", "identify", "replay")
                     if "error" in results[-1].get(name, {})]
    print_growth(results)
    for failure in failures:
        print(failure)
    if arguments.json:
        arguments.json.write_text(json.dumps({"machine": info, "rows": results}, indent=1) + "\n")
    return 1 if any(": build:" in failure or ": replay:" in failure for failure in failures) else 0


if __name__ == "__main__":
    sys.exit(main())
