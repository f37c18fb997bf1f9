# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""A free body on which the recorded force acts, without a tool: the experiment, and what the identified law alone makes of it."""
import itertools
import math
import statistics

from experiments import GRAVITY, STEP, X, Y, at_time, experiment, read_csv, rotate, sliding_friction

FREE_GAP = 4e-3  # [m] between tip and body: more than the error of pose and CAD, so that nothing touches
MIN_FREE_SAMPLES = 50  # whose median is the sensor's zero
FORCE_WINDOW = 10  # samples of force that are averaged
MAX_ITERATIONS = 50  # of Newton's method, which converges from below


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def turned(angle, x, y):
    return math.cos(angle) * x - math.sin(angle) * y, math.sin(angle) * x + math.cos(angle) * y


def outline(body):
    """Corners (x, y) of the body's convex hull seen from above, base axes of the recorded pose [Andrew's chain]."""
    points = sorted({tuple(round(v, 9) for v in rotate(body["quaternion"], p)[:2]) for p in body["points"]})
    chains = []
    for ordered in (points, points[::-1]):
        chain = []
        for x, y in ordered:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2:]
                if (bx - ax) * (y - by) > (by - ay) * (x - bx):
                    break
                chain.pop()
            chain.append((x, y))
        chains += chain[:-1]
    return chains


def nearest(corners, x, y):
    """The outline's point that is next to (x, y)."""
    candidates = []
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1]):
        dx, dy = bx - ax, by - ay
        s = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)))
        candidates.append((ax + s * dx, ay + s * dy))
    return min(candidates, key=lambda point: math.dist(point, (x, y)))


class DrivenBody:
    """The force of a recorded push, as a wrench on the tracked body."""

    def __init__(self, push, world):
        self.push, self.world, self.corners = push, world, outline(world["body"])
        self.tool = [[row[key] for key in ("t", "x", "y", "z")] for row in read_csv(push.recording / "tool.csv")]
        rows = [[row[key] for key in ("t", "fx", "fy", "fz")] for row in read_csv(push.recording / "wrench.csv")]
        half = FORCE_WINDOW // 2
        self.samples = []  # (t, mean force, contact, gap)
        for i in range(half, len(rows) - half, half):
            force = [statistics.fmean(column) for column in list(zip(*rows[i - half:i + half + 1]))[1:]]
            self.samples.append((rows[i][0], force, *self.contact(rows[i][0])))
        self.zeros = self.sensor_zeros()

    def contact(self, t):
        """The point of the tracked body's outline next to the tip, base, and the gap between them [m]."""
        _, x, y, yaw = at_time(self.push.track, t)
        _, *tip = at_time(self.tool, t)
        turn = yaw - self.push.track[0][3]
        local = turned(-turn, tip[0] - x, tip[1] - y)
        point = nearest(self.corners, *local)
        dx, dy = turned(turn, *point)
        return [x + dx, y + dy, tip[2]], math.dist(point, local) - self.world["tool_radius"]

    def sensor_zeros(self):
        """Rows (t, fx, fy, fz), the median of each interval without contact: sensors drift between pushes."""
        zeros = []
        for is_free, group in itertools.groupby(self.samples, key=lambda sample: sample[3] > FREE_GAP):
            part = list(group)
            if is_free and len(part) * FORCE_WINDOW // 2 >= MIN_FREE_SAMPLES:
                zeros.append([statistics.fmean(sample[0] for sample in part),
                              *(statistics.median(sample[1][axis] for sample in part) for axis in range(3))])
        return zeros or [[0.0] * 4]

    def centre(self, t):
        """[m] The tracked centre of mass, base."""
        body = self.world["body"]
        _, x, y, yaw = at_time(self.push.track, t)
        cx, cy, cz = rotate(body["quaternion"], body["centre_of_mass"])
        dx, dy = turned(yaw - self.push.track[0][3], cx, cy)
        return [x + dx, y + dy, body["position"][2] + cz]

    def experiment(self):
        """The force at the point of contact, about the centre of mass."""
        table = []
        for t, mean, point, gap in self.samples:
            zero = at_time(self.zeros, t)[1:]
            force = [0.0] * 3 if gap > FREE_GAP else [a - b for a, b in zip(mean, zero)]
            arm = [a - b for a, b in zip(point, self.centre(t))]
            table.append([t - self.push.start, *force, *cross(arm, force)])
        return experiment(table[-1][0], wrench=table)


def slip_multiplier(load, moment, c_linear, c_turning):
    """The l >= 0 with (load / (1 + l c))^2 + (moment / (1 + l c'))^2 = 1, for a load beyond the limit."""
    l = 0.0
    for _ in range(MAX_ITERATIONS):
        a, b = 1.0 + l * c_linear, 1.0 + l * c_turning
        value = (load / a) ** 2 + (moment / b) ** 2 - 1.0
        slope = -2.0 * (load ** 2 * c_linear / a ** 3 + moment ** 2 * c_turning / b ** 3)
        l -= value / slope
        if value < 1e-12:
            break
    return l


def rows_by_law(driven, world, known):
    """
    First and last row, as an engine's, of a body with the identified friction by slip speed and an ellipsoid
    as limit surface: implicit Euler's method, in which friction is the wrench that dissipates most.
    """
    body, radius = world["body"], known["friction_radius"]
    mass, inertia = known["mass"], body["inertia_z"]
    x = y = yaw = vx = vy = spin = 0.0
    table, row = driven["wrench"], 0
    for step in range(int(driven["duration"] / STEP)):
        t = step * STEP
        while row + 2 < len(table) and table[row + 1][0] <= t:
            row += 1
        _, fx, fy, _, _, _, torque = at_time(table[row:row + 2], t)
        force = sliding_friction(known, math.hypot(vx, vy, radius * spin))
        px, py = fx + mass * vx / STEP, fy + mass * vy / STEP
        turning = torque + inertia * spin / STEP
        load, moment = math.hypot(px, py) / force, turning / (force * radius)
        if math.hypot(load, moment) <= 1.0:
            vx = vy = spin = 0.0
            continue
        c_linear, c_turning = mass / (STEP * force ** 2), inertia / (STEP * (force * radius) ** 2)
        l = slip_multiplier(load, moment, c_linear, c_turning)
        vx, vy = (l * p / (1.0 + l * c_linear) / force ** 2 for p in (px, py))
        spin = l * turning / (1.0 + l * c_turning) / (force * radius) ** 2
        x, y, yaw = x + STEP * vx, y + STEP * vy, yaw + STEP * spin
    cx, cy, _ = rotate(body["quaternion"], body["centre_of_mass"])
    ax, ay = turned(yaw, -cx, -cy)
    first, last = [0.0] * 11, [0.0] * 11
    last[X], last[Y] = x + cx + ax, y + cy + ay
    return [first, last]
