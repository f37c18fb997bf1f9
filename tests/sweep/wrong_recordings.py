# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings of pushes and presses whose rig, files or clocks are wrong: each function changes a private copy of
a sound recording by a random amount, small ones too, and returns what is wrong. Nothing here is unreadable:
what is wrong shows, if at all, where the data contradict each other."""
import collections
import dataclasses
import math

from recorded_tables import (axis_turn, edit_manifest, inverse, pose_product, product, quaternion, random_axis, rotate,
                             scale_meshes, streams, times, tool, tracks, wrench)

CLOCK = ("late", "early", "clock", "stamps")
FORCE_AXES = ("turned", "axes", "mirror", "sign", "degrees")
PLACE = ("surface", "place", "pose", "mesh", "start", "unit", "metres", "away", "none of")
UNITS = ("unit", "millimetres", "metres", "1000", "newton", "inch", "times")


@dataclasses.dataclass
class Wrong:
    what: str
    words: tuple  # one of them in an error or a warning names it
    factor: float = 1.0  # by which data contradict each other
    unchecked: str = ""  # where the data do not show it: the row of `doctor` that says that it was not checked


def log_uniform(rng, low, high):
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def either_way(rng, low, high):
    """A factor above or below 1."""
    return log_uniform(rng, low, high) ** rng.choice((1.0, -1.0))


def signed(rng, low, high):
    return rng.choice((1.0, -1.0)) * log_uniform(rng, low, high)


def map_force(recording, matrix):
    wrench(recording).change(lambda row: [row[0], *times(matrix, row[1:4]), *times(matrix, row[4:7])])


def map_tracks(recording, function, only=None):
    """Poses become `function(pose)`, of seven numbers."""
    found = tracks(recording)
    for table in found if only is None else [found[only]]:
        table.change(lambda row: [row[0], *function(row[1:8])])


# Rigs: what is mounted, calibrated or measured wrongly


def force_scale(rng, recording, base):
    factor = either_way(rng, 1.02, 2.2)
    wrench(recording).change(lambda row: [row[0], *(factor * x for x in row[1:])])
    return Wrong(f"force times {factor:.3g}", ("mass", "force is", "friction over"), max(factor, 1.0 / factor),
                 "" if base.excites_mass else "the force's scale")


def force_turn(rng, recording, base):
    angle = signed(rng, 2.0, 180.0)
    map_force(recording, axis_turn((0.0, 0.0, 1.0), math.radians(angle)))
    return Wrong(f"force turned by {angle:.0f} degrees about z", FORCE_AXES)


def force_tilt(rng, recording, base):
    angle, heading = signed(rng, 2.0, 90.0), rng.uniform(0.0, 2.0 * math.pi)
    map_force(recording, axis_turn((math.cos(heading), math.sin(heading), 0.0), math.radians(angle)))
    return Wrong(f"force tilted by {angle:.0f} degrees", FORCE_AXES)


def force_mirror(rng, recording, base):
    axis = rng.randrange(3)
    map_force(recording, [[float(i == j) * (-1.0 if i == axis else 1.0) for j in range(3)] for i in range(3)])
    return Wrong(f"f{'xyz'[axis]} of the other sign", FORCE_AXES)


def force_sign(rng, recording, base):
    map_force(recording, [[-float(i == j) for j in range(3)] for i in range(3)])
    return Wrong("force of the other sign", FORCE_AXES)


def cross_talk(rng, recording, base):
    size = log_uniform(rng, 0.01, 0.15)
    map_force(recording, [[float(i == j) or rng.gauss(0.0, size) for j in range(3)] for i in range(3)])
    return Wrong(f"cross-talk of {100 * size:.0f} %", FORCE_AXES)


def force_bias(rng, recording, base):
    bias = [log_uniform(rng, 0.1, 30.0) * x for x in random_axis(rng)]
    wrench(recording).change(lambda row: [row[0], *(f + b for f, b in zip(row[1:4], bias)), *row[4:]])
    return Wrong("force not set to zero: " + " ".join(f"{x:.2g}" for x in bias) + " N",
                 ("without contact", "zero", "at rest"))


def force_drift(rng, recording, base):
    table, size = wrench(recording), log_uniform(rng, 0.1, 3.0)
    axis = random_axis(rng)
    first, last = table.span
    table.change(lambda row: [row[0], *(f + size * (row[0] - first) / (last - first) * x
                                        for f, x in zip(row[1:4], axis)), *row[4:]])
    return Wrong(f"force drifts by {size:.2g} N", ("without contact", "zero", "drift"))


def tip_offset(rng, recording, base):
    shift = [log_uniform(rng, 0.2, 40.0) * 1e-3 * x for x in random_axis(rng)]
    tool(recording).change(lambda row: [row[0], *(p + s for p, s in zip(row[1:4], shift)), *row[4:]])
    return Wrong("tip off by " + " ".join(f"{1e3 * x:.1f}" for x in shift) + " mm", PLACE)


def tip_radius(rng, recording, base):
    factor = either_way(rng, 1.1, 3.0)
    edit_manifest(recording, r"(radius: *)([\d.]+)", lambda m: f"{m[1]}{float(m[2]) * factor:.5g}")
    return Wrong(f"radius of the tip times {factor:.2g}", PLACE + ("radius",))


def tracked_frame(rng, recording, base):
    """The tracker's body is not the CAD body."""
    size = log_uniform(rng, 0.5, 40.0)
    offset = [size * 1e-3 * x for x in random_axis(rng)] + quaternion((0.0, 0.0, 1.0), math.radians(rng.uniform(-10, 10)))
    map_tracks(recording, lambda pose: pose_product(pose, offset))
    return Wrong(f"tracked frame {size:.1f} mm off the CAD body's", PLACE + ("track",))


def tracker_turn(rng, recording, base):
    angle = signed(rng, 1.0, 180.0)
    turn = [0.0, 0.0, 0.0] + quaternion((0.0, 0.0, 1.0), math.radians(angle))
    map_tracks(recording, lambda pose: pose_product(turn, pose))
    return Wrong(f"tracker's world turned by {angle:.0f} degrees", PLACE + ("track",))


def weighed_mass(rng, recording, base):
    factor = either_way(rng, 1.02, 2.5)
    edit_manifest(recording, r"( mass: *)([\d.]+)", lambda m: f"{m[1]}{float(m[2]) * factor:.6g}")
    return Wrong(f"weighed mass times {factor:.3g}", ("mass", "force is"), max(factor, 1.0 / factor),
                 "" if base.excites_mass else "the force's scale")


RIGS = {"force scale": (3, force_scale), "force turn": (3, force_turn), "force tilt": (2, force_tilt),
        "force mirror": (1, force_mirror), "force sign": (1, force_sign), "cross-talk": (2, cross_talk),
        "force bias": (2, force_bias), "force drift": (1, force_drift), "tip offset": (2, tip_offset),
        "tip radius": (1, tip_radius), "tracked frame": (2, tracked_frame), "tracker turn": (1, tracker_turn),
        "weighed mass": (2, weighed_mass)}


# Files: units, orders and frames of other programs


def tool_unit(rng, recording, base):
    name, factor = rng.choice((("mm", 1e3), ("cm", 1e2), ("inches", 1.0 / 0.0254)))
    tool(recording).change(lambda row: [row[0], *(factor * x for x in row[1:4]), *row[4:]])
    return Wrong(f"tool in {name}", UNITS + PLACE, factor)


def force_unit(rng, recording, base):
    name, factor = rng.choice((("lbf", 1.0 / 4.44822), ("kgf", 1.0 / 9.80665), ("mN", 1e3), ("ozf", 1.0 / 0.278)))
    wrench(recording).change(lambda row: [row[0], *(factor * x for x in row[1:])])
    return Wrong(f"force in {name}", ("unit", "friction over", "mass", "force is", "no contact"),
                 max(factor, 1.0 / factor), "" if base.excites_mass else "the force's scale")


def tracked_unit(rng, recording, base):
    name, factor = rng.choice((("mm", 1e3), ("cm", 1e2), ("inches", 1.0 / 0.0254)))
    map_tracks(recording, lambda pose: [factor * x for x in pose[:3]] + pose[3:])
    return Wrong(f"tracking in {name}", UNITS + PLACE, factor)


def tracked_w_first(rng, recording, base):
    map_tracks(recording, lambda pose: pose[:3] + [pose[6], *pose[3:6]])
    return Wrong("tracked quaternions w first", ("quaternion", "w first", "tilt", "order"))


def tracked_inverse(rng, recording, base):
    map_tracks(recording, inverse)
    return Wrong("tracked poses inverted", PLACE + ("invert", "track"))


def tracked_mirror(rng, recording, base):
    axis = rng.randrange(2)
    map_tracks(recording, lambda pose: [-x if i == axis else x for i, x in enumerate(pose[:3])] + pose[3:])
    return Wrong(f"tracked {'xy'[axis]} of the other sign", PLACE + ("track", "mirror"))


def tracked_axes(rng, recording, base):
    map_tracks(recording, lambda pose: [pose[1], pose[0], *pose[2:]])
    return Wrong("tracked x and y exchanged", PLACE + ("track", "axes"))


def tracked_y_up(rng, recording, base):
    turn = [0.0, 0.0, 0.0] + quaternion((1.0, 0.0, 0.0), -0.5 * math.pi)
    map_tracks(recording, lambda pose: pose_product(turn, pose))
    return Wrong("tracked world y up", PLACE + ("track", "upright", "tilt"))


def tracked_heading(rng, recording, base):
    """Turns the other way, as from a left-handed program."""
    map_tracks(recording, lambda pose: pose[:3] + conjugate_heading(pose[3:]))
    return Wrong("tracked headings of the other sign", PLACE + ("track", "turn", "heading"))


def conjugate_heading(q):
    return [q[0], q[1], -q[2], q[3]]


def swapped_tracks(rng, recording, base):
    found = tracks(recording)
    if len(found) < 2:
        return None
    found[0].rows, found[1].rows = found[1].rows, found[0].rows
    for table in found:
        table.save()
    return Wrong("tracks of two objects exchanged", PLACE + ("track", "exchanged"))


def tool_mirror(rng, recording, base):
    axis = rng.randrange(2)
    tool(recording).change(lambda row: [-x if i == 1 + axis else x for i, x in enumerate(row)])
    return Wrong(f"tool's {'xy'[axis]} of the other sign", PLACE)


def force_columns(rng, recording, base):
    a, b = rng.sample(range(3), 2)
    matrix = [[float(i == j) for j in range(3)] for i in range(3)]
    matrix[a], matrix[b] = matrix[b], matrix[a]
    map_force(recording, matrix)
    return Wrong(f"f{'xyz'[a]} and f{'xyz'[b]} exchanged", FORCE_AXES)


def force_in_tool_axes(rng, recording, base):
    """By the tool's logged orientation, after its mounting was turned."""
    mounting = quaternion(random_axis(rng), rng.uniform(-math.pi, math.pi))
    tool(recording).change(lambda row: [*row[:4], *product(mounting, row[4:8])])
    back = [-mounting[0], -mounting[1], -mounting[2], mounting[3]]
    wrench(recording).change(lambda row: [row[0], *rotate(back, row[1:4]), *rotate(back, row[4:7])])
    return Wrong("force in the tool's axes", FORCE_AXES + ("tool's axes",))


def mesh_size(rng, recording, base):
    factor = rng.choice((1e-3, 1e3, 25.4, 0.0254, either_way(rng, 1.01, 1.5)))
    if not scale_meshes(recording, factor):
        return None
    return Wrong(f"meshes times {factor:.3g}", UNITS + PLACE + ("size", "deep"), max(factor, 1.0 / factor))


def mesh_origin(rng, recording, base):
    shift = [log_uniform(rng, 0.5, 40.0) * 1e-3 * x for x in random_axis(rng)]
    if not scale_meshes(recording, 1.0, shift):
        return None
    return Wrong("origin of the meshes off by " + " ".join(f"{1e3 * x:.1f}" for x in shift) + " mm", PLACE)


def coarse_numbers(rng, recording, base):
    """Tables written with few decimals."""
    name, table = rng.choice(list(streams(recording).items()))
    decimals = rng.choice((1, 2)) if name == "force" else rng.choice((3, 4))
    table.change(lambda row: [row[0], *(round(x, decimals) for x in row[1:4]), *row[4:]])
    return Wrong(f"{name} with {decimals} decimals", ("resolution", "noise", "steps"))


FILES = {"tool unit": (2, tool_unit), "force unit": (2, force_unit), "tracked unit": (1, tracked_unit),
         "tracked w first": (2, tracked_w_first), "tracked inverse": (1, tracked_inverse),
         "tracked mirror": (1, tracked_mirror), "tracked axes": (1, tracked_axes), "tracked y up": (1, tracked_y_up),
         "tracked heading": (1, tracked_heading), "swapped tracks": (2, swapped_tracks), "tool mirror": (1, tool_mirror),
         "force columns": (2, force_columns), "force in tool axes": (2, force_in_tool_axes),
         "mesh size": (2, mesh_size), "mesh origin": (2, mesh_origin), "coarse numbers": (2, coarse_numbers)}


# Logs: clocks, rates, filters and losses


def lag(rng, recording, base):
    name, table = rng.choice(list(streams(recording).items()))
    shift = signed(rng, 0.003, 1.5)
    table.change(lambda row: [row[0] + shift, *row[1:]])
    return Wrong(f"{name} late by {1e3 * shift:.0f} ms", CLOCK)


def clock_drift(rng, recording, base):
    name, table = rng.choice(list(streams(recording).items()))
    share = signed(rng, 2e-4, 0.02)
    first, _ = table.span
    table.change(lambda row: [first + (row[0] - first) * (1.0 + share), *row[1:]])
    return Wrong(f"clock of {name} fast by {100 * share:.2g} %", CLOCK)


def gap(rng, recording, base):
    name, table = rng.choice(list(streams(recording).items()))
    first, last = table.span
    length = log_uniform(rng, 0.05, 3.0)
    begin = rng.uniform(first, last - length)
    table.change(lambda row: None if begin < row[0] < begin + length else row)
    return Wrong(f"{name} lacks {length:.2f} s", ("gap", "missing", "lacks"))


def held_samples(rng, recording, base):
    name, table = rng.choice(list(streams(recording).items()))
    count, state = rng.randint(2, 20), {"row": 0, "held": None}

    def hold(row):
        if state["row"] % count == 0:
            state["held"] = row[1:]
        state["row"] += 1
        return [row[0], *state["held"]]

    table.change(hold)
    return Wrong(f"{name} holds each value for {count} rows", ("repeat", "held", "hold"))


def fewer_rows(rng, recording, base):
    name, table = rng.choice(list(streams(recording).items()))
    count = rng.randint(2, 25)
    table.rows = table.rows[::count]
    table.save()
    return Wrong(f"{name} with each {count}th row", ("rate", "rows", "samples"))


def jitter(rng, recording, base):
    name, table = rng.choice(list(streams(recording).items()))
    size = log_uniform(rng, 0.1, 3.0) * table.interval
    stamps = sorted(row[0] + rng.gauss(0.0, size) for row in table.rows)
    table.rows = [[stamp, *row[1:]] for stamp, row in zip(stamps, table.rows)]
    table.rows = [row for i, row in enumerate(table.rows) if i == 0 or row[0] > table.rows[i - 1][0] + 1e-6]
    table.save()
    return Wrong(f"stamps of {name} scatter by {1e3 * size:.1f} ms", CLOCK)


def bursts(rng, recording, base):
    """Stamps of when blocks of samples arrived."""
    name, table = rng.choice(list(streams(recording).items()))
    count, step = rng.randint(3, 20), table.interval
    table.rows = [[table.rows[i // count * count][0] + 1e-5 * (i % count) + (count - 1) * step, *row[1:]]
                  for i, row in enumerate(table.rows)]
    table.save()
    return Wrong(f"{name} stamped in blocks of {count}", CLOCK + ("blocks",))


def low_pass(rng, recording, base):
    """A filter of first order, and its delay, of the force."""
    table, cutoff = wrench(recording), log_uniform(rng, 5.0, 100.0)
    share = 1.0 - math.exp(-2.0 * math.pi * cutoff * table.interval)
    state = list(table.rows[0][1:])

    def filtered(row):
        for i, value in enumerate(row[1:]):
            state[i] += share * (value - state[i])
        return [row[0], *state]

    table.change(filtered)
    return Wrong(f"force behind a low pass of {cutoff:.1f} Hz", CLOCK + ("filter",))


def moving_average(rng, recording, base):
    """The mean of the newest samples of the force."""
    table, count = wrench(recording), rng.randint(3, 60)
    newest = collections.deque(maxlen=count)

    def averaged(row):
        newest.append(row[1:])
        return [row[0], *(sum(column) / len(newest) for column in zip(*newest))]

    table.change(averaged)
    return Wrong(f"force as the mean of {count} samples", CLOCK + ("filter", "average"))


def butterworth(rng, recording, base):
    """A filter of second order, as filter designs for sampled signals have it, of the force."""
    table, cutoff = wrench(recording), log_uniform(rng, 8.0, 80.0)
    k = math.tan(math.pi * min(cutoff * table.interval, 0.4))
    scale = 1.0 + math.sqrt(2.0) * k + k * k
    first, second = 2.0 * (k * k - 1.0) / scale, (1.0 - math.sqrt(2.0) * k + k * k) / scale
    start = list(table.rows[0][1:])
    states = [[start, start], [start, start]]  # inputs, outputs: newest first

    def filtered(row):
        (x1, x2), (y1, y2) = states
        found = [k * k / scale * (x + 2.0 * a + b) - first * c - second * d
                 for x, a, b, c, d in zip(row[1:], x1, x2, y1, y2)]
        states[:] = [[row[1:], x1], [found, y1]]
        return [row[0], *found]

    table.change(filtered)
    return Wrong(f"force behind a Butterworth filter of {cutoff:.1f} Hz", CLOCK + ("filter",))


def noise(rng, recording, base):
    name, table = rng.choice(list(streams(recording).items()))
    size = log_uniform(rng, 0.1, 2.0) if name == "force" else log_uniform(rng, 5e-5, 2e-3)
    table.change(lambda row: [row[0], *(x + rng.gauss(0.0, size) for x in row[1:4]), *row[4:]])
    return Wrong(f"noise of {size:.2g} in {name}", ("noise",))


def saturation(rng, recording, base):
    table = wrench(recording)
    largest = max(abs(x) for row in table.rows for x in row[1:4])
    limit = largest * rng.uniform(0.3, 0.95)
    table.change(lambda row: [row[0], *(max(-limit, min(limit, x)) for x in row[1:4]), *row[4:]])
    return Wrong(f"force saturates at {limit:.1f} N", ("saturat",))


def dropouts(rng, recording, base):
    name, table = rng.choice(list(streams(recording).items()))
    lost = set(rng.sample(range(len(table.rows)), rng.randint(1, 20)))
    zero = [0.0, 0.0, 0.0] if name != "force" else [0.0] * 6
    table.rows = [[row[0], *zero, *row[1 + len(zero):]] if i in lost else row for i, row in enumerate(table.rows)]
    table.save()
    return Wrong(f"{len(lost)} rows of {name} are zeros", ("outlier", "jump", "spike", "left out"))


def frozen(rng, recording, base):
    name, table = rng.choice(list(streams(recording).items()))
    first, last = table.span
    length = log_uniform(rng, 0.2, 4.0)
    begin = rng.uniform(first, last - length)
    state = {"held": None}

    def freeze(row):
        if begin < row[0] < begin + length:
            state["held"] = state["held"] or row[1:]
            return [row[0], *state["held"]]
        return row

    table.change(freeze)
    return Wrong(f"{name} frozen for {length:.2f} s", ("repeat", "frozen", "constant", "jump", "gap"))


def stamp_unit(rng, recording, base):
    name, table = rng.choice(list(streams(recording).items()))
    unit, factor = rng.choice((("ms", 1e3), ("ticks of 10 ms", 1e2)))
    for one in streams(recording).values() if rng.random() < 0.5 else [table]:
        one.change(lambda row: [factor * row[0], *row[1:]])
    return Wrong(f"stamps in {unit}, of {name} at least", CLOCK + UNITS + ("overlap", "ticks"), factor)


LOGS = {"lag": (5, lag), "clock drift": (2, clock_drift), "gap": (2, gap), "held samples": (2, held_samples),
        "fewer rows": (2, fewer_rows), "jitter": (2, jitter), "bursts": (2, bursts), "low pass": (2, low_pass),
        "moving average": (1, moving_average), "butterworth": (1, butterworth),
        "noise": (2, noise), "saturation": (1, saturation), "dropouts": (1, dropouts), "frozen": (1, frozen),
        "stamp unit": (1, stamp_unit)}
