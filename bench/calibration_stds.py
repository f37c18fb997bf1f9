#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Do the standard deviations that `pcavr calibrate` states cover the truth?

    bench/calibration_stds.py --pcavr build/test/apps/pcavr/pcavr [--kinds touch,force]
                              [--rigs 200] [--first 1] [--work out/calibration_stds]

For each kind, `--rigs` rigs are drawn at random, each from its own seed, beginning with `--first`:
frames, number of views, noise. What such a rig would have written is written as tables, with
noise, the command is run on them, and each value with a std is compared with the truth. Printed is
by kind and quantity: how many values, the share of them within 1, 2 and 3 stds, where the share
within 1 lies in 95 of 100 cases if the stds are right (by rigs: the values of one rig share their
errors), marked where it does not, and the largest |z| with its rig's seed. The exit code is 1 where more
than one rig in twenty is refused, or a value is more than 5 of its stds off.

The drawing shares no code with pcavr. `camera` needs pictures, which would take hours: its rigs
are drawn by the test CalibrateCamera.StatesStdsThatHold. Needs only python3.
"""
import argparse
import math
import pathlib
import random
import re
import sys

from command import run
from coverage import WITHIN_ONE, binomial_range

GRAVITY = 9.80665  # [m/s^2]
MAX_REFUSED = 0.05  # share of the rigs: a motion that repeats itself shows no offset of clocks
MAX_STDS = 5.0


# Vectors are lists, rotations quaternions (x, y, z, w), poses pairs (rotation, position).


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def scaled(factor, a):
    return [factor * x for x in a]


def norm(a):
    return math.sqrt(dot(a, a))


def turn(vector):
    """The rotation of a rotation vector [rad]."""
    angle = norm(vector)
    if angle == 0.0:
        return [0.0, 0.0, 0.0, 1.0]
    return scaled(math.sin(0.5 * angle) / angle, vector) + [math.cos(0.5 * angle)]


def vector_of(q):
    """The rotation vector [rad] of a rotation, of at most half a turn."""
    if q[3] < 0.0:
        q = scaled(-1.0, q)
    sine = norm(q[:3])
    return scaled(2.0 * math.atan2(sine, q[3]) / sine, q[:3]) if sine > 0.0 else [0.0, 0.0, 0.0]


def times(p, q):
    v = add(add(scaled(p[3], q[:3]), scaled(q[3], p[:3])), cross(p[:3], q[:3]))
    return v + [p[3] * q[3] - dot(p[:3], q[:3])]


def inverse_turn(q):
    return scaled(-1.0, q[:3]) + [q[3]]


def rotate(q, v):
    twice = scaled(2.0, cross(q[:3], v))
    return add(v, add(scaled(q[3], twice), cross(q[:3], twice)))


def chain(*poses):
    result = ([0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    for q, p in poses:
        result = (times(result[0], q), add(rotate(result[0], p), result[1]))
    return result


def inverse(pose):
    back = inverse_turn(pose[0])
    return back, scaled(-1.0, rotate(back, pose[1]))


class Draw(random.Random):
    """Numbers of one rig."""

    def vector(self, std):
        return [self.gauss(0.0, std) for _ in range(3)]

    def pose(self, position, rotation):
        return turn(self.vector(rotation)), self.vector(position)

    def noisy(self, pose, position, rotation):
        return times(turn(self.vector(rotation)), pose[0]), add(pose[1], self.vector(position))


def table(file, header, rows):
    lines = [header] + [",".join(repr(x) for x in row) for row in rows]
    file.write_text("\n".join(lines) + "\n")
    return file


def pose_row(pose):
    return pose[1] + pose[0]


def after(text, key):
    """Of a YAML text: what follows a key that stands alone."""
    return text[re.search(rf"\b{key}:", text).end():]


def numbers(text, key):
    return [float(x) for x in re.match(r"\s*\[(.*?)\]", after(text, key))[1].split(",")]


def covariance_stds(text):
    """The roots of the diagonal of the six rows after `covariance:`."""
    rows = re.findall(r"- \[(.*?)\]", after(text, "covariance"))[:6]
    return [math.sqrt(float(row.split(",")[i])) for i, row in enumerate(rows)]


def pose_scores(text, name, key, true_pose):
    """The twist of found to true pose in its stds: along and about the child's axes."""
    section = after(text, key)
    found = (numbers(section, "rotation"), numbers(section, "position"))
    q, p = chain(inverse(found), true_pose)
    stds = covariance_stds(section)
    scores = [error / std for error, std in zip(p + vector_of(q), stds)]
    return {f"{name}, position": scores[:3], f"{name}, rotation": scores[3:]}


def calibrate(arguments, folder, *words):
    """What the command reports, and the file that it wrote."""
    output = folder / "out.yaml"
    found = run(arguments.pcavr, "calibrate", *words, "-o", output, "--force")
    return found, output.read_text()


def touch(draw, folder, arguments):
    T_base_world = draw.pose(0.5, 1.0)
    noise = 10.0 ** draw.uniform(-4.0, -2.7)  # [m]
    rows = []
    for _ in range(draw.randint(4, 12)):
        p = add([1.0, 0.5, 0.0], draw.vector(0.3))
        rows.append(p + add(chain(T_base_world, ([0, 0, 0, 1], p))[1], draw.vector(noise)))
    points = table(folder / "points.csv", "x,y,z,base_x,base_y,base_z", rows)
    _, text = calibrate(arguments, folder, "touch", points)
    return pose_scores(text, "world", "T_base_world", T_base_world)


def force(draw, folder, arguments):
    mass, sign, is_base = draw.uniform(0.5, 3.0), draw.choice([-1.0, 1.0]), draw.random() < 0.5
    sensor, bias, centre = turn(draw.vector(1.0)), draw.vector(10.0), draw.vector(0.05)
    noise = 10.0 ** draw.uniform(-1.7, -0.3)  # [N]
    rows = []
    for _ in range(draw.randint(10, 60)):
        R = turn(scaled(draw.uniform(0.3, 3.0) / math.sqrt(3.0), draw.vector(1.0)))
        weight = scaled(sign * mass, rotate(sensor, rotate(inverse_turn(R), [0, 0, -GRAVITY])))
        f, m = add(bias, weight), cross(centre, weight)
        if is_base:
            f, m = rotate(R, f), rotate(R, m)
        f, m = add(f, draw.vector(noise)), add(m, draw.vector(0.1 * noise))
        rows.append([0.5, 0.1, 0.4] + R + f + m)
    readings = table(folder / "forces.csv", "x,y,z,qx,qy,qz,qw,fx,fy,fz,tx,ty,tz", rows)
    found, _ = calibrate(arguments, folder, "force", readings)
    error = vector_of(times(inverse_turn(found["rotation"]), sensor))
    parts = {"load, mass": ([found["mass"] - mass], [found["mass_std"]]),
             "sensor, turn": (error, found["rotation_std"]),
             "force bias": (add(found["force_bias"], scaled(-1.0, bias)), found["force_bias_std"]),
             "load, centre": (add(found["centre"], scaled(-1.0, centre)), found["centre_std"])}
    return {name: [e / s for e, s in zip(*part)] for name, part in parts.items()}


def random_motion(draw):
    """A smooth motion of a body: its pose as a function of time [s]."""
    sizes = [(0.2 if i < 3 else 0.4, draw.uniform(0.7, 1.3) * (0.7 + 0.11 * i),
              draw.uniform(1.5, 2.9), draw.uniform(0, 6.28), draw.uniform(0, 6.28))
             for i in range(6)]

    def at(t):
        x = [size * (math.sin(pace * t + one) + 0.5 * math.sin(pace * more * t + two))
             for size, pace, more, one, two in sizes]
        return turn(x[3:]), x[:3]

    return at


def clocks(draw, folder, arguments):
    at = random_motion(draw)
    world, body = draw.pose(1.0, 1.0), draw.pose(0.2, 1.0)
    offset, drift = draw.uniform(-0.3, 0.3), draw.choice([0.0, draw.gauss(0.0, 1e-4)])
    duration, noise = draw.uniform(30.0, 90.0), 10.0 ** draw.uniform(-3.5, -2.3)

    def rows(rate, place):
        for i in range(int(duration * rate)):
            yield [i / rate] + pose_row(chain(place(i / rate), draw.pose(noise, noise)))

    header, middle = "t,x,y,z,qx,qy,qz,qw", 0.5 * duration
    a = table(folder / "a.csv", header, rows(draw.uniform(40, 120), lambda t: chain(world, at(t))))
    b = table(folder / "b.csv", header, rows(
        draw.uniform(20, 60), lambda t: chain(at(t + offset + drift * (t - middle)), body)))
    found, text = calibrate(arguments, folder, "clocks", a, b)
    at_middle = float(re.search(r"middle: ([-\d.e]+)", text)[1])
    true_offset = offset + drift * (at_middle - middle)
    scores = {"offset": [(found["offset"] - true_offset) / found["offset_std"]]}
    if "drift" in found:
        scores["drift"] = [(found["drift"] - drift) / found["drift_std"]]
    return scores


def hand_eye(draw, folder, arguments):
    is_on_arm = draw.random() < 0.5
    camera, board = draw.pose(0.05, 1.0), (turn(draw.vector(0.5)), [0.5, 0.1, 0.0])
    arm = (10.0 ** draw.uniform(-4, -3), 10.0 ** draw.uniform(-4, -3))  # [m, rad]
    across, depth, tilt = (10.0 ** draw.uniform(*span) for span in ((-4, -3), (-3.3, -2.3), (-3.3, -2.3)))
    robot_rows, camera_rows = [], []
    for index in range(draw.randint(12, 35)):
        far = draw.uniform(0.3, 0.9)
        shift = [0.1 * far * draw.gauss(0, 1), 0.1 * far * draw.gauss(0, 1), far]
        angles = [draw.uniform(-0.6, 0.6), draw.uniform(-0.6, 0.6), draw.uniform(-1, 1)]
        T_camera_board = (turn(angles), shift)
        flange = chain(board, inverse(T_camera_board), inverse(camera))
        if not is_on_arm:
            flange = inverse(flange)
        robot_rows.append([index] + pose_row(draw.noisy(flange, *arm)))
        distance = norm(shift)
        sight = scaled(1.0 / distance, shift)
        side = draw.vector(across * distance)
        error = add(add(side, scaled(-dot(side, sight), sight)),
                    scaled(depth * distance**2 * draw.gauss(0, 1), sight))
        seen = (times(turn(draw.vector(tilt)), T_camera_board[0]), add(shift, error))
        camera_rows.append([index] + pose_row(seen))
    header = "index,x,y,z,qx,qy,qz,qw"
    robot = table(folder / "robot.csv", header, robot_rows)
    seen = table(folder / "camera.csv", header, camera_rows)
    _, text = calibrate(arguments, folder, "hand-eye", robot, seen, "--splits", 0, "--camera-on",
                        "arm" if is_on_arm else "base")
    scores = pose_scores(text, "camera", "T_flange_camera" if is_on_arm else "T_base_camera", camera)
    scores.update(pose_scores(text, "board", "T_base_board" if is_on_arm else "T_flange_board", board))
    return scores


URDF = pathlib.Path(__file__).parent.parent / "calib/robots/pa10/pa10.urdf"


def arm_pose(joints, positions):
    """Of a chain of revolute joints about their own z: (rotation, position) of its last link."""
    T = ([0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    for (position, roll), q in zip(joints, positions):
        T = chain(T, (turn([roll, 0.0, 0.0]), position), (turn([0.0, 0.0, q]), [0.0, 0.0, 0.0]))
    return T


def arm(draw, folder, arguments):
    """Hand-eye from joint positions, of an arm whose encoders are off."""
    origins = re.findall(r'type="revolute">.*?<origin xyz="(.*?)" rpy="(\S+) 0 0"/>',
                         URDF.read_text(), re.S)
    joints = [([float(x) for x in xyz.split()], float(roll)) for xyz, roll in origins]
    # What the first and the last joint are off by, board and camera make up for.
    offsets = [0.0] + [math.radians(draw.gauss(0.0, 0.3)) for _ in joints[2:]] + [0.0]
    camera, board = draw.pose(0.05, 0.5), (turn(draw.vector(0.5)), [0.5, 0.1, 0.1])
    noise = (10.0 ** draw.uniform(-4, -3), 10.0 ** draw.uniform(-3.5, -2.5))  # [m, rad]
    rest, read_rows, seen_rows = [0.0, 0.5, 0.0, 1.2, 0.0, 0.8, 0.0], [], []
    for index in range(draw.randint(20, 40)):
        q = [x + draw.uniform(-0.6, 0.6) for x in rest]
        read_rows.append([index] + add(q, scaled(-1.0, offsets)))
        T_camera_board = chain(inverse(chain(arm_pose(joints, q), camera)), board)
        seen_rows.append([index] + pose_row(chain(T_camera_board, draw.pose(*noise))))
    header = ",".join(["index"] + [f"q_joint{i + 1}" for i in range(len(joints))])
    read = table(folder / "joints.csv", header, read_rows)
    seen = table(folder / "camera.csv", "index,x,y,z,qx,qy,qz,qw", seen_rows)
    found, text = calibrate(arguments, folder, "hand-eye", read, seen, "--urdf", URDF, "--splits", 0)
    scores = pose_scores(text, "camera", "T_flange_camera", camera)
    scores["joint offset"] = [(one["offset"] - true) / one["std"]
                              for one, true in zip(found["joint_offsets"], offsets)
                              if not one["is_held"]]
    return scores


def facing(target, distance, tilt, around, roll):
    """A camera's pose in world that looks along its z at `target`, `tilt` from above."""
    q = times(times(turn([0, 0, around]), turn([math.pi - tilt, 0, 0])), turn([0, 0, roll]))
    return q, add(target, scaled(-distance, rotate(q, [0, 0, 1])))


def tags(draw, folder, arguments):
    fx, width, height = 600.0, 640, 480
    (folder / "camera.yaml").write_text(
        f"camera: {{width: {width}, height: {height}, fx: {fx}, fy: {fx}, cx: 319.5, cy: 239.5}}\n")
    placed = []
    for i in range(draw.randint(3, 5)):
        angle, radius = 1.57 * i + draw.uniform(-0.4, 0.4), 0.25 * draw.uniform(0.7, 1.3) + 0.02 * i
        q = turn([draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5), draw.uniform(-1.5, 1.5)])
        p = [radius * math.cos(angle), radius * math.sin(angle), draw.uniform(0.0, 0.15)]
        placed.append(((q, p), draw.uniform(0.06, 0.12)))
    noise, rows = 10.0 ** draw.uniform(-1.3, -0.3), []  # [px]
    for view in range(draw.randint(15, 40)):
        eye = facing([draw.uniform(-0.1, 0.1), draw.uniform(-0.1, 0.1), 0.0], draw.uniform(0.9, 1.5),
                     draw.uniform(0.2, 0.9), draw.uniform(0, 6.28), draw.uniform(-0.3, 0.3))
        for number, (pose, size) in enumerate(placed):
            T_camera_tag = chain(inverse(eye), pose)
            if dot(rotate(T_camera_tag[0], [0, 0, 1]), T_camera_tag[1]) > -0.3 * norm(T_camera_tag[1]):
                continue
            pixels = []
            for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                p = add(rotate(T_camera_tag[0], [0.5 * size * x, 0.5 * size * y, 0]), T_camera_tag[1])
                pixels += [fx * p[0] / p[2] + 319.5 + draw.gauss(0, noise),
                           fx * p[1] / p[2] + 239.5 + draw.gauss(0, noise)]
            if min(pixels) > 0 and max(pixels[::2]) < width - 1 and max(pixels[1::2]) < height - 1:
                rows.append([0.1 * view, number] + pixels)
    corners = table(folder / "corners.csv", "t,id,u0,v0,u1,v1,u2,v2,u3,v3", rows)
    markers = [f"  - {{family: tag36h11, id: {i}, size: {size!r}, role: base, pose: "
               f"{{t: {pose[1]}, q: {pose[0]}}}}}" for i, (pose, size) in enumerate(placed)]
    (folder / "layout.yaml").write_text("format: pcavr-recording/1\nmarkers:\n" + "\n".join(markers))
    _, text = calibrate(arguments, folder, "tags", corners, "--camera", folder / "camera.yaml",
                        "--layout", folder / "layout.yaml", "--fixed", 0)
    listed, accuracy = text.split("\naccuracy:")
    scores = {"tag, position": [], "tag, rotation": []}
    for i, (pose, _) in list(enumerate(placed))[1:]:
        entry = re.search(rf"\bid: {i}\n(.*?pose: [^\n]*)", listed, re.S)[1]
        found = (numbers(entry, "q"), numbers(entry, "t"))
        stds = covariance_stds(accuracy.split(f"tag: tag36h11:{i}\n")[1])
        q, p = chain(inverse(found), pose)
        z = [error / std for error, std in zip(p + vector_of(q), stds)]
        scores["tag, position"] += z[:3]
        scores["tag, rotation"] += z[3:]
    return scores


KINDS = {"hand-eye": hand_eye, "arm": arm, "tags": tags, "touch": touch, "force": force, "clocks": clocks}


def row(kind, name, scores):
    """`scores`: pairs of z and seed."""
    rigs = len({seed for _, seed in scores})
    low, high = binomial_range(rigs, WITHIN_ONE)
    shares = [sum(abs(z) < limit for z, _ in scores) / len(scores) for limit in (1, 2, 3)]
    mark = "-" if shares[0] < low else "+" if shares[0] > high else " "
    worst, seed = max((abs(z), seed) for z, seed in scores)
    return (f"{kind:<9} {name:<17} {rigs:>5} {len(scores):>6}  "
            + " ".join(f"{100 * share:>5.1f}" for share in shares)
            + f"  {100 * low:>3.0f}-{100 * high:<3.0f}{mark} {worst:>8.2f}  {seed}")


def judge(kind, arguments):
    scores, failures = {}, []
    for seed in range(arguments.first, arguments.first + arguments.rigs):
        folder = arguments.work / kind / str(seed)
        folder.mkdir(parents=True, exist_ok=True)
        try:
            found = KINDS[kind](Draw(f"{kind} {seed}"), folder, arguments)
        except RuntimeError as error:
            failures.append((seed, str(error).splitlines()[-1]))
            continue
        for name, values in found.items():
            scores.setdefault(name, []).extend((z, seed) for z in values)
    for name, values in scores.items():
        print(row(kind, name, values), flush=True)
    for seed, message in failures:
        print(f"{kind:<9} rig {seed}: {message}", flush=True)
    largest = max((abs(z) for values in scores.values() for z, _ in values), default=math.inf)
    return len(failures) <= MAX_REFUSED * arguments.rigs and largest <= MAX_STDS


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--pcavr", default="build/test/apps/pcavr/pcavr")
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--rigs", type=int, default=200)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/calibration_stds"))
    arguments = parser.parse_args()
    print(f"{'':<27} {'rigs':>5} {'values':>6}  {'<1':>5} {'<2':>5} {'<3':>5}  {'of n':<7} "
          f"{'max |z|':>9}  seed")
    sound = [judge(kind, arguments) for kind in arguments.kinds.split(",")]
    return 0 if all(sound) else 1


if __name__ == "__main__":
    sys.exit(main())
