# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Logs of the arm of `sources` that are wrong: as wrong_recordings, for `pcavr identify robot`."""
import math

from recorded_tables import Table
from wrong_recordings import Wrong, either_way, log_uniform, signed

TORQUE = ("torque", "tau", "lag", "late", "sign", "swapped", "exchanged", "inert", "scale", "unit", "gain", "mass")
POSITION = ("position", "q_", "degrees", "radian", "unit", "swapped", "sign", "repeat", "jump", "inert", "mass")
STAMPS = ("stamp", "rate", "clock", "unit", "gap", "repeat", "interval", "lag")


def log_of(recording):
    return Table(recording / "joints.csv")


def map_columns(recording, columns, function):
    log_of(recording).change(lambda row: [function(x) if i in columns else x for i, x in enumerate(row)])


def torque_scale(rng, recording, base):
    factor, joints = either_way(rng, 1.02, 3.0), rng.choice(((3,), (4,), (3, 4)))
    map_columns(recording, joints, lambda x: factor * x)
    return Wrong(f"torques of joints {[j - 2 for j in joints]} times {factor:.3g}", TORQUE, max(factor, 1.0 / factor))


def torque_sign(rng, recording, base):
    joints = rng.choice(((3,), (4,), (3, 4)))
    map_columns(recording, joints, lambda x: -x)
    return Wrong(f"torques of joints {[j - 2 for j in joints]} of the other sign", TORQUE, 2.0)


def torque_lag(rng, recording, base):
    shift = rng.choice((1, -1)) * rng.randint(1, 40)
    table = log_of(recording)
    last = len(table.rows) - 1
    table.rows = [[*row[:3], *table.rows[min(last, max(0, i - shift))][3:]] for i, row in enumerate(table.rows)]
    table.save()
    return Wrong(f"torques late by {shift} rows", TORQUE)


def torque_bias(rng, recording, base):
    bias, joint = signed(rng, 0.05, 5.0), rng.choice((3, 4))
    map_columns(recording, (joint,), lambda x: x + bias)
    return Wrong(f"torque of joint {joint - 2} not set to zero: {bias:.2g} N m", TORQUE)


def swapped_torques(rng, recording, base):
    log_of(recording).change(lambda row: [*row[:3], row[4], row[3]])
    return Wrong("torques of the joints exchanged", TORQUE, 2.0)


def swapped_positions(rng, recording, base):
    log_of(recording).change(lambda row: [row[0], row[2], row[1], *row[3:]])
    return Wrong("positions of the joints exchanged", POSITION, 2.0)


def degrees(rng, recording, base):
    map_columns(recording, (1, 2), math.degrees)
    return Wrong("positions in degrees", POSITION, 57.0)


def position_scale(rng, recording, base):
    factor, joint = either_way(rng, 1.02, 3.0), rng.choice((1, 2))
    map_columns(recording, (joint,), lambda x: factor * x)
    return Wrong(f"positions of joint {joint} times {factor:.3g}", POSITION + TORQUE, max(factor, 1.0 / factor))


def position_sign(rng, recording, base):
    joint = rng.choice((1, 2))
    map_columns(recording, (joint,), lambda x: -x)
    return Wrong(f"positions of joint {joint} of the other sign", POSITION + TORQUE, 2.0)


def position_offset(rng, recording, base):
    """Of the elbow: the shoulder's angle changes nothing."""
    offset = signed(rng, 0.02, 1.5)
    map_columns(recording, (2,), lambda x: x + offset)
    return Wrong(f"positions of joint 2 off by {offset:.2g} rad", POSITION + TORQUE)


def encoder_steps(rng, recording, base):
    step = log_uniform(rng, 1e-5, 5e-3)
    map_columns(recording, (1, 2), lambda x: round(x / step) * step)
    return Wrong(f"encoder steps of {step:.2g} rad", POSITION + ("step", "resolution", "noise"))


def log_stamps(rng, recording, base):
    unit, factor = rng.choice((("ms", 1e3), ("10 ms", 1e2), ("us", 1e6)))
    map_columns(recording, (0,), lambda t: factor * t)
    return Wrong(f"stamps in {unit}", STAMPS, factor)


def log_speed(rng, recording, base):
    factor = either_way(rng, 1.02, 3.0)
    map_columns(recording, (0,), lambda t: factor * t)
    return Wrong(f"clock times {factor:.3g}", STAMPS + TORQUE, max(factor, 1.0 / factor))


def log_hold(rng, recording, base):
    table, count = log_of(recording), rng.randint(2, 10)
    columns = rng.choice(((1, 2), (3, 4), (1, 2, 3, 4)))
    table.rows = [[table.rows[i // count * count][k] if k in columns else x for k, x in enumerate(row)]
                  for i, row in enumerate(table.rows)]
    table.save()
    return Wrong(f"columns {columns} hold each value for {count} rows", STAMPS + TORQUE)


def log_gap(rng, recording, base):
    table, length = log_of(recording), log_uniform(rng, 0.05, 4.0)
    first, last = table.span
    begin = rng.uniform(first, last - length)
    table.change(lambda row: None if begin < row[0] < begin + length else row)
    return Wrong(f"lacks {length:.2f} s", STAMPS)


def outliers(rng, recording, base):
    table, size = log_of(recording), log_uniform(rng, 0.1, 100.0)
    for i in rng.sample(range(len(table.rows)), rng.randint(1, 10)):
        table.rows[i][rng.randint(1, 4)] += rng.gauss(0.0, size)
    table.save()
    return Wrong(f"outliers of {size:.2g}", ("outlier", "jump", "spike", "position", "torque"))


FILE_ARMS = {"degrees": (1, degrees), "swapped torques": (1, swapped_torques),
             "swapped positions": (1, swapped_positions), "torque sign": (2, torque_sign),
             "position sign": (2, position_sign), "log stamps": (1, log_stamps)}
RIG_ARMS = {"torque scale": (3, torque_scale), "torque bias": (1, torque_bias), "position scale": (1, position_scale),
            "position offset": (2, position_offset)}
LOG_ARMS = {"torque lag": (3, torque_lag), "encoder steps": (2, encoder_steps), "log speed": (2, log_speed),
            "log hold": (2, log_hold), "log gap": (1, log_gap), "outliers": (1, outliers)}
