# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Each bad array is one clear exception that names its argument, and never a crash."""
import numpy as np
import pytest

import pcavr


def with_value(array, index, value):
    changed = np.array(array, dtype=float)
    changed[index] = value
    return changed


# Each case: how the argument of identify() is changed, and what the Error names.
BAD_VALUES = {
    "nan position": (lambda t, a: (t, with_value(a, (5, 1), np.nan)), r"\[5, 1\]"),
    "infinite time": (lambda t, a: (with_value(t, 7, np.inf), a), r" t\[7\]"),
    "nan time": (lambda t, a: (with_value(t, 7, np.nan), a), r" t\[7\]"),
    "times descend": (lambda t, a: (t[::-1], a), r" t\[1\]"),
    "time repeats": (lambda t, a: (with_value(t, 3, t[2]), a), r" t\[3\]"),
    "time in nanoseconds": (lambda t, a: (t * 1e9 + 1e18, a), r" t\[0\]"),
    "fewer rows": (lambda t, a: (t, a[:-1]), "shape"),
    "more rows": (lambda t, a: (t[:-1], a), "shape"),
    "transposed": (lambda t, a: (t, a.T), "shape"),
    "one dimension": (lambda t, a: (t, a[:, 0]), "shape"),
    "three dimensions": (lambda t, a: (t, a[None]), "shape"),
    "five columns": (lambda t, a: (t, np.ones((len(t), 5))), "shape"),
    "times of two dimensions": (lambda t, a: (t[:, None], a), "shape"),
}


@pytest.mark.parametrize("argument", ["tool", "wrench", "tracked"])
@pytest.mark.parametrize("case", BAD_VALUES)
def test_bad_values_and_shapes(box_1, argument, case):
    change, named = BAD_VALUES[case]
    series = getattr(box_1, argument)
    with pytest.raises(pcavr.Error, match=named) as raised:
        box_1.identify(**{argument: change(*series)})
    assert raised.value.place.startswith(argument)


BAD_TYPES = {
    "texts": lambda t, a: (t, a.astype(str)),
    "objects": lambda t, a: (t, a.astype(object)),
    "complex numbers": lambda t, a: (t, a.astype(complex)),
    "bools": lambda t, a: (t, a > 0),
    "no rows": lambda t, a: (t, None),
    "no times": lambda t, a: (None, a),
    "an array alone": lambda t, a: a,
    "three parts": lambda t, a: (t, a, a),
    "a number": lambda t, a: 3,
    "ragged rows": lambda t, a: (t, [[1.0, 2.0], [3.0]]),
    "dates": lambda t, a: (t.astype("datetime64[s]"), a),
}


@pytest.mark.filterwarnings("ignore::numpy.VisibleDeprecationWarning")
@pytest.mark.parametrize("argument", ["tool", "wrench", "tracked"])
@pytest.mark.parametrize("case", BAD_TYPES)
def test_bad_types(box_1, argument, case):
    with pytest.raises((TypeError, ValueError), match=f"{argument}|inhomogeneous"):
        box_1.identify(**{argument: BAD_TYPES[case](*getattr(box_1, argument))})


def test_quaternion_that_is_not_a_rotation(box_1):
    poses = box_1.tracked[1].copy()
    poses[4, 3:] = 0.0
    with pytest.raises(pcavr.Error) as raised:
        box_1.identify(tracked=(box_1.tracked[0], poses))
    assert raised.value.place == "tracked[4]"


@pytest.mark.parametrize("argument", ["tool", "wrench"])
def test_empty_series(box_1, argument):
    with pytest.raises(pcavr.Error):
        box_1.identify(**{argument: (np.zeros(0), np.zeros((0, 3)))})


def test_without_tracking_or_pose(box_1):
    with pytest.raises(pcavr.Error, match="pose"):
        box_1.identify(tracked=None, pose=None)


@pytest.mark.parametrize("changed, named", [
    ({"goal": "speed"}, "goal"), ({"mass": -1.0}, "mass"), ({"mass": float("nan")}, "mass"),
    ({"tool_radius": 0.0}, "tool_radius"), ({"tool_radius": float("inf")}, "tool_radius"),
    ({"tracked_std": (-1.0, 0.0)}, "tracked_std"), ({"pose": [0, 0, 0]}, "pose"),
    ({"pose": [0, 0, 0, 0, 0, 0, 0]}, "pose"),
])
def test_bad_numbers(box_1, changed, named):
    with pytest.raises(pcavr.Error) as raised:
        box_1.identify(**changed)
    assert raised.value.place.startswith(named)


def test_bad_meshes(box_1, cube, tmp_path):
    vertices, triangles = cube
    bad = [(vertices, triangles[:-1]), (vertices, triangles + 1), (vertices, triangles - 1),
           (vertices * np.nan, triangles), (vertices[:, :2], triangles), (vertices, triangles[:, :2]),
           (np.zeros((0, 3)), np.zeros((0, 3), int)), tmp_path / "absent.obj", tmp_path]
    for cad in bad:
        with pytest.raises(pcavr.Error):
            box_1.identify(cad=cad)
    for cad in [(vertices, triangles.astype(float)), (vertices,), None, 3]:
        with pytest.raises(TypeError, match="cad"):
            box_1.identify(cad=cad)


def test_mesh_indices_beyond_32_bits(box_1, cube):
    vertices, triangles = cube
    with pytest.raises(pcavr.Error, match="vertices"):
        box_1.identify(cad=(vertices, triangles + 2**32))
    with pytest.raises(pcavr.Error, match="vertices"):
        box_1.identify(cad=(vertices, triangles.astype(np.uint64) + np.uint64(2**63)))
