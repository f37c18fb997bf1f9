# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""What the identified limit surface alone makes of a recorded push, without an engine: how near an engine can come."""
import math
import re
import statistics

from driven import DrivenBody, nearest, outline, turned
from experiments import GRAVITY, MIN_FORCE_SHARE, STEP, YAW, at_time, rotate, top_of

# Powers of the components of u = (fx / F, fy / F, m / (F L)), in the order of the coefficients.
EXPONENTS = [(a, b, 4 - a - b) for a in range(4, -1, -1) for b in range(4 - a, -1, -1)]
STEEP = 0.5  # cosine of 60 degrees: a steeper x axis is replaced by y, as in limit_surface of parameters
WRENCHES, DIRECTIONS = 3000, 24  # of which the mean force is 0.1 % too small at most
BISECTIONS = 30  # of the angle of the tip's force: to 1e-9 of its friction cone
EVERY = 5  # steps of an engine per step: 0.01 mm of a push at 2 mm/s


def identified_surface(parameters):
    """(L, coefficients) of the file of one object's parameters; None where no turning was identified."""
    found = re.search(r"limit_surface:\s*force: \S+\s*length: (\S+)\s*coefficients: \[(.*?)\]", parameters.read_text(), re.S)
    return found and (float(found[1]), [float(word) for word in found[2].split(",")])


def ellipsoid(known):
    return known["friction_radius"], [1.0 if max(e) == 4 else 2.0 if sorted(e) == [0, 2, 2] else 0.0 for e in EXPONENTS]


class LimitSurface:
    """In the axes of the body's recorded pose, about its centre of mass; its mean sliding force is the exported one."""

    def __init__(self, length, coefficients, known, body):
        self.length, self.force = length, 1.0
        self.terms = [(c, e) for c, e in zip(coefficients, EXPONENTS) if c != 0.0]
        x, y = (rotate(body["quaternion"], axis) for axis in ([1, 0, 0], [0, 1, 0]))
        axis = x if math.hypot(x[0], x[1]) >= STEEP else y
        self.heading = math.atan2(axis[1], axis[0])
        self.force = known["friction"] * known["mass"] * GRAVITY / self.mean_sliding_force()

    def mean_sliding_force(self):
        """Over the directions in which the body moves without turning: the largest power of the wrenches it bears."""
        golden, points = math.pi * (3.0 - math.sqrt(5.0)), []
        for i in range(WRENCHES):  # a Fibonacci spiral over the sphere of wrenches
            turning = 1.0 - (2.0 * i + 1.0) / WRENCHES
            across = math.sqrt(1.0 - turning * turning)
            wrench = across * math.cos(golden * i), across * math.sin(golden * i), turning * self.length
            level = self.level(*wrench)[0]
            points.append((wrench[0] / level, wrench[1] / level))
        angles = [math.tau * k / DIRECTIONS for k in range(DIRECTIONS)]
        return statistics.fmean(max(x * math.cos(a) + y * math.sin(a) for x, y in points) for a in angles)

    def level(self, fx, fy, moment):
        """1 on the surface, proportional to the wrench; and the direction of the twist it causes (vx, vy, spin)."""
        x, y = turned(-self.heading, fx / self.force, fy / self.force)
        u = (x, y, moment / (self.force * self.length))
        powers = [(1.0, p, p * p, p ** 3, p ** 4) for p in u]
        value, gradient = 0.0, [0.0, 0.0, 0.0]
        for c, exponents in self.terms:
            factors = [powers[i][e] for i, e in enumerate(exponents)]
            value += c * factors[0] * factors[1] * factors[2]
            for i, e in enumerate(exponents):
                if e > 0:
                    others = factors[(i + 1) % 3] * factors[(i + 2) % 3]
                    gradient[i] += c * e * powers[i][e - 1] * others
        vx, vy = turned(self.heading, gradient[0], gradient[1])
        return max(value, 0.0) ** 0.25, (vx, vy, gradient[2] / self.length)


def velocity_at(point, twist):
    return twist[0] - twist[2] * point[1], twist[1] + twist[2] * point[0]


def angle_between(a, b):
    return math.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1])


def response(surface, point, normal, angle):
    """Of a force at an angle from the normal: level and twist of a unit force, its direction, and the heading of the point."""
    force = turned(angle, *normal)
    level, twist = surface.level(*force, point[0] * force[1] - point[1] * force[0])
    return level, twist, force, angle + angle_between(force, velocity_at(point, twist))


def pushed(surface, point, normal, friction, velocity):
    """Twist of the body and force of the tip on it [Mason 1986, Lynch & Mason 1996], as pcavr's push_at_point."""
    approach = normal[0] * velocity[0] + normal[1] * velocity[1]
    if approach <= 0.0:
        return (0.0, 0.0, 0.0), (0.0, 0.0)
    def heading_at(angle):
        return response(surface, point, normal, angle)[3]

    heading, high = angle_between(normal, velocity), math.atan(friction)
    low = -high
    if heading <= heading_at(low):
        high = low  # it slips along the edge of the friction cone
    elif heading >= heading_at(high):
        low = high
    for _ in range(BISECTIONS if low < high else 0):
        middle = 0.5 * (low + high)
        if heading_at(middle) < heading:
            low = middle
        else:
            high = middle
    level, twist, force, _ = response(surface, point, normal, 0.5 * (low + high))
    vx, vy = velocity_at(point, twist)
    scale = approach / (normal[0] * vx + normal[1] * vy)
    return tuple(scale * v for v in twist), tuple(f / level for f in force)


class PushedBody:
    """A body that the tool pushes, without inertia: its pose by the limit surface."""

    def __init__(self, world, surface):
        self.body, self.radius = world["body"], world["tool_radius"]
        self.surface, self.corners = surface, outline(self.body)
        self.friction = self.body["friction"]  # at the tip, whose own one drops out
        self.top = top_of(self.body)
        self.arm = rotate(self.body["quaternion"], self.body["centre_of_mass"])[:2]
        self.yaw, self.twist = 0.0, (0.0, 0.0, 0.0)
        self.centre = [p + q for p, q in zip(self.body["position"], self.arm)]

    def step(self, before, after, dt):
        """The force on the body of a tip that moves between two points."""
        self.twist = (0.0, 0.0, 0.0)
        tip = turned(-self.yaw, after[0] - self.centre[0], after[1] - self.centre[1])
        place = tip[0] + self.arm[0], tip[1] + self.arm[1]
        point = nearest(self.corners, *place)
        gap = math.dist(point, place)
        if not 0.0 < gap < self.radius or after[2] > self.top:
            return 0.0, 0.0
        normal = [(p - q) / gap for p, q in zip(point, place)]
        shift = turned(-self.yaw, after[0] - before[0], after[1] - before[1])
        along = shift[1] * normal[0] - shift[0] * normal[1]
        depth = self.radius - gap  # by which the body gives way
        motion = depth * normal[0] - along * normal[1], depth * normal[1] + along * normal[0]
        moved, force = pushed(self.surface, [p - q for p, q in zip(point, self.arm)], normal, self.friction, motion)
        dx, dy = turned(self.yaw, *moved[:2])
        fx, fy = turned(self.yaw, *force)
        self.centre = [self.centre[0] + dx, self.centre[1] + dy]
        self.yaw += moved[2]
        self.twist = dx / dt, dy / dt, moved[2] / dt
        return fx, fy

    def row(self, t, force):
        """As an engine's."""
        ax, ay = turned(self.yaw, *self.arm)
        return [t, self.centre[0] - ax, self.centre[1] - ay, self.body["position"][2], self.yaw, *self.twist, *force, 0.0]


def quasi_static_rows(experiment, world, surface):
    """Rows, as an engine's, of the body under the recorded tool, with the exported coefficient."""
    tool, dt = experiment["tool"], EVERY * STEP
    body = PushedBody(world, surface)
    _, _, z, w = world["body"]["quaternion"]
    rows, before = [], tool[0][1:4]
    for step in range(int(tool[-1][0] / dt)):
        _, *after = at_time(tool, (step + 1) * dt)[:4]
        row = body.row(step * dt, body.step(before, after, dt))
        row[YAW] += 2.0 * math.atan2(z, w)
        rows.append(row)
        before = after
    return rows


def surface_error(push, world, surface):
    """The surface's force over the measured one - 1, median while the body slides: with the force at the measured contact."""
    driven = DrivenBody(push, world)
    high = max(force for _, force in push.samples)
    errors = []
    for t, mean, point, _ in driven.samples:
        fx, fy, _ = (a - b for a, b in zip(mean, at_time(driven.zeros, t)[1:]))
        if math.hypot(fx, fy) < MIN_FORCE_SHARE * high or not push.slides(t):
            continue
        turn = at_time(push.track, t)[3] - push.track[0][3]
        fx, fy = turned(-turn, fx, fy)
        ax, ay = turned(-turn, *(p - c for p, c in zip(point[:2], driven.centre(t))))
        errors.append(1.0 / surface.level(fx, fy, ax * fy - ay * fx)[0] - 1.0)
    return statistics.median(errors)
