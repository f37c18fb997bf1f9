# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""The experiments of the table of engines: what is asked of an engine, and the figure that its rows give."""
import bisect
import csv
import math
import statistics

STEP = 1e-3  # [s] of all engines
GRAVITY = 9.80665  # [m/s^2]
SLIDING_SPEED = 1e-3  # [m/s] of the body: faster is sliding
SETTLE = 0.3  # [s]
WINDOW = 0.4  # [s] over which the tracked body's speed is taken
BIAS_TIME = 0.5  # [s] without contact at a recording's start
MIN_FORCE_SHARE = 0.3  # of the maximum: the tool is in contact
MIN_SAMPLES = 20
# Columns of the engines' rows.
T, X, Y, Z, YAW, VX, VY, WZ, FX, FY, FZ = range(11)


def experiment(duration, every=5, **more):
    return {"dt": STEP, "settle": SETTLE, "duration": duration, "every": every, "twist": None,
            "wrench": None, "tool": None, **more}


def speed_of(row):
    return math.hypot(row[VX], row[VY])


def start_speed(manifest):
    """[m/s] of a body that is released: twice the reference speed, so that its mean is that one."""
    return 2.0 * next(each["value"] for each in manifest["numbers"] if each["key"] == "reference_speed")


def canonical(world, manifest):
    """The experiments on a body alone, by name."""
    known, body = manifest["bodies"][0], world["body"]
    static = known["static_friction"] * known["mass"] * GRAVITY
    ramp = [[0.0] * 7, [4.0, 2.0 * static, 0, 0, 0, 0, 0]]
    half = [[0.0] * 7, [0.5, 0.5 * static, 0, 0, 0, 0, 0], [9.0, 0.5 * static, 0, 0, 0, 0, 0]]
    top = top_of(body)
    x, y = centre_in_base(body)
    radius, depth = world["tool_radius"], known["press_depths"][0]
    press = [[t, x, y, top + radius - d, 0, 0, v] for t, d, v in
             ((0.0, -2e-4, -(2e-4 + 1.5 * depth) / 2.0), (2.0, 1.5 * depth, 0.0))]
    speed = start_speed(manifest)
    return {"turn": experiment(0.5, 1, twist=[0, 0, speed / known["friction_radius"]]),
            "slide": experiment(0.5, twist=[speed, 0, 0]),
            "breakaway": experiment(4.0, 2, wrench=ramp), "creep": experiment(4.0, 20, wrench=half),
            "press": experiment(2.0, 2, tool=press)}


def rotate(q, v):
    x, y, z, w = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2],
            v[2] + w * t[2] + x * t[1] - y * t[0]]


def top_of(body):
    """[m] Height of the body's highest point, recorded pose, base."""
    return max(rotate(body["quaternion"], p)[2] for p in body["points"]) + body["position"][2]


def centre_in_base(body):
    turned = rotate(body["quaternion"], body["centre_of_mass"])
    return turned[0] + body["position"][0], turned[1] + body["position"][1]


def slope(xs, ys):
    mx, my = statistics.fmean(xs), statistics.fmean(ys)
    spread = sum((x - mx) ** 2 for x in xs)
    return sum((x - mx) * (y - my) for x, y in zip(xs, ys)) / spread if spread > 0.0 else math.nan


def turning_error(rows, world, manifest):
    """Torque while it turns from 90 to 20 % of the speed, against the identified limit surface."""
    spin = start_speed(manifest) / manifest["bodies"][0]["friction_radius"]
    part = [row for row in rows if 0.2 * spin < row[WZ] < 0.9 * spin]
    if len(part) < 3:
        return math.nan
    torque = -world["body"]["inertia_z"] * slope([row[T] for row in part], [row[WZ] for row in part])
    wanted = next(each["wanted"] for each in manifest["residuals"] if each["what"] == "turning torque")
    return torque / wanted - 1.0


def sliding_friction(known, speed):
    """[N] The identified law: Coulomb and viscous friction, and what a slow speed adds."""
    weight, slow = known["mass"] * GRAVITY, known["stribeck_speed"]
    rise = math.exp(-(speed / slow) ** 2) if slow > 0.0 else float(speed < SLIDING_SPEED)  # as the engines' law
    return (known["coulomb_friction"] * weight + known["viscous"] * speed
            + (known["static_friction"] - known["coulomb_friction"]) * weight * rise)


def slide_error(rows, _, manifest):
    """Distance slid from a speed to rest, against the identified law's (midpoint rule over the speed)."""
    known = manifest["bodies"][0]
    count = 1000
    step = start_speed(manifest) / count
    speeds = [(i + 0.5) * step for i in range(count)]
    wanted = sum(known["mass"] * v * step / sliding_friction(known, v) for v in speeds)
    first = STEP * speed_of(rows[0])  # the rows begin after a step
    return (first + math.hypot(rows[-1][X] - rows[0][X], rows[-1][Y] - rows[0][Y])) / wanted - 1.0


def breakaway_error(rows, _, manifest):
    """Force of a slow ramp at which the body goes for good, against F_M."""
    known = manifest["bodies"][0]
    static = known["static_friction"] * known["mass"] * GRAVITY
    rests = [row[T] for row in rows if speed_of(row) < SLIDING_SPEED]
    return (rests[-1] if rests else 0.0) * 2.0 * static / 4.0 / static - 1.0


def creep(rows, *_):
    """[um/s] at half of F_M, which should be 0."""
    a, b = (min(rows, key=lambda row: abs(row[T] - t)) for t in (2.0, 4.0))
    return 1e6 * math.hypot(b[X] - a[X], b[Y] - a[Y]) / (b[T] - a[T])


def stiffness_error(rows, world, manifest):
    """Slope of force over depth about the working depth, against the identified law's."""
    body, known = world["body"], manifest["bodies"][0]
    depth = known["press_depths"][0]
    top, radius, before = top_of(body), world["tool_radius"], body["position"][2]
    tool = canonical(world, manifest)["press"]["tool"]
    points = []
    for row in rows:
        height = tool[0][3] + (tool[1][3] - tool[0][3]) * row[T] / tool[1][0]
        penetration = top + row[Z] - before + radius - height
        if 0.85 * depth < penetration < 1.15 * depth:
            points.append((penetration, -row[FZ]))
    return slope(*zip(*points)) / body["stiffness"] - 1.0 if len(points) > 5 else math.inf


FIGURES = {"turn": turning_error, "slide": slide_error, "breakaway": breakaway_error, "creep": creep,
           "press": stiffness_error}


def read_csv(file):
    with open(file, newline="") as stream:
        return [{key.strip(): float(value) for key, value in row.items()} for row in csv.DictReader(stream)]


def read_poses(file):
    """(t, x, y, yaw) of a TUM file."""
    rows = [[float(word) for word in line.split()] for line in file.read_text().splitlines()
            if line and line[0] != "#"]
    poses = []
    for row in rows:
        yaw = 2.0 * math.atan2(row[6], row[7])
        last = poses[-1][3] if poses else yaw
        poses.append((row[0], row[1], row[2], yaw - math.tau * round((yaw - last) / math.tau)))  # without jumps
    return poses


def push_experiment(folder):
    """The recorded tool, from an exported world's motion.csv."""
    motion = read_csv(folder / "motion.csv")
    table = [[row[key] for key in ("t", "x", "y", "z", "vx", "vy", "vz")] for row in motion]
    return experiment(table[-1][0], tool=table)


def at_time(rows, t):
    """A row of a table whose first column is the time, between the two next to it."""
    after = min(bisect.bisect_right(rows, t, key=lambda row: row[0]), len(rows) - 1)
    a, b = rows[max(0, after - 1)], rows[after]
    s = min(1.0, max(0.0, (t - a[0]) / (b[0] - a[0]))) if b[0] > a[0] else 0.0
    return [x + s * (y - x) for x, y in zip(a, b)]


class RecordedPush:
    """What was measured in a recording: force while the body slides, and where it ends."""

    def __init__(self, recording, body):
        self.recording = recording
        wrench = read_csv(recording / "wrench.csv")
        self.track = read_poses(recording / "tracked/objects" / body / "tracked.txt")
        truth = recording / "truth/objects" / f"{body}.txt"
        self.end = (read_poses(truth) if truth.exists() else self.track)[-1]
        self.start = read_csv(recording / "tool.csv")[0]["t"]
        first = [row for row in wrench if row["t"] < wrench[0]["t"] + BIAS_TIME]
        bias = [statistics.median(row[axis] for row in first) for axis in ("fx", "fy")]
        forces = [(row["t"], math.hypot(row["fx"] - bias[0], row["fy"] - bias[1])) for row in wrench]
        sizes = sorted(force for _, force in forces)
        high = sizes[int(0.99 * len(sizes))]  # sensors have spikes
        self.samples = [(t, force) for t, force in forces[::5]
                        if force > MIN_FORCE_SHARE * high and self.slides(t)]

    def slides(self, t):
        a = next((row for row in self.track if row[0] >= t - WINDOW / 2), None)
        b = next((row for row in self.track if row[0] >= t + WINDOW / 2), None)
        return bool(a and b and b[0] > a[0]
                    and math.hypot(b[1] - a[1], b[2] - a[2]) / (b[0] - a[0]) > SLIDING_SPEED)

    def slid_error(self, rows):
        """Distance from begin to end, against the tracked one."""
        distance = math.hypot(rows[-1][X] - rows[0][X], rows[-1][Y] - rows[0][Y])
        first, last = self.track[0], self.track[-1]
        return distance / math.hypot(last[1] - first[1], last[2] - first[2]) - 1.0

    def figures(self, rows):
        """Errors of force and waveform (relative), end [mm] and heading [deg]."""
        step = rows[1][T] - rows[0][T]
        found = []
        for t, _ in self.samples:
            row = rows[min(len(rows) - 1, max(0, round((t - self.start) / step)))]
            found.append(math.hypot(row[FX], row[FY]))
        wanted = statistics.median(force for _, force in self.samples)
        waveform = statistics.median(abs(a - force) for a, (_, force) in zip(found, self.samples))
        last = rows[-1]
        return {"force": statistics.median(found) / wanted - 1.0, "waveform": waveform / wanted,
                "end": 1e3 * math.hypot(last[X] - self.end[1], last[Y] - self.end[2]),
                "heading": math.degrees(math.remainder(last[YAW] - self.end[3], 2.0 * math.pi))}
