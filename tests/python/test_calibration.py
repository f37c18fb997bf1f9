# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Calibrations from arrays."""
import numpy as np
import pytest

import pcavr


def product(a, b):
    """Of two quaternions x y z w."""
    vector = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.append(vector, a[3] * b[3] - a[:3] @ b[:3])


def turned(q, v):
    return v + 2 * np.cross(q[:3], np.cross(q[:3], v) + q[3] * v)


def compose(a, b):
    return np.concatenate([a[:3] + turned(a[3:], b[:3]), product(a[3:], b[3:])])


def inverse(a):
    q = a[3:] * [-1, -1, -1, 1]
    return np.concatenate([-turned(q, a[:3]), q])


def random_pose(rng, size):
    q = rng.normal(size=4)
    return np.concatenate([rng.uniform(-size, size, 3), q / np.linalg.norm(q)])


CAMERA = np.array([0.03, -0.05, 0.08, 0.0, 0.0, np.sin(0.4), np.cos(0.4)])  # in the flange
BOARD = np.array([0.6, 0.1, 0.02, 0.0, 0.0, 0.0, 1.0])  # in base
NOISE = 5e-4  # [m]


@pytest.fixture
def views():
    """Poses of the flange and of the board in the camera, half a metre in front of the board."""
    rng = np.random.default_rng(5)
    flange, board = [], []
    for _ in range(20):
        axis = rng.uniform(-0.5, 0.5, 3)
        tilt = np.append(axis / 2, np.sqrt(1 - axis @ axis / 4))
        seen = np.concatenate([[*rng.uniform(-0.05, 0.05, 2), 0.5], product(np.array([1.0, 0, 0, 0]), tilt)])
        flange.append(compose(BOARD, compose(inverse(seen), inverse(CAMERA))))
        board.append(seen + np.append(rng.normal(0.0, NOISE, 3), np.zeros(4)))
    return np.array(flange), np.array(board)


def test_camera_on_an_arm(views):
    found = pcavr.calibrate_hand_eye(*views)
    assert np.linalg.norm(found.camera.pose[:3] - CAMERA[:3]) < 1e-3
    assert np.all(np.abs(found.camera.pose[:3] - CAMERA[:3]) < 4 * found.camera.position_std)
    assert abs(found.camera.pose[3:] @ CAMERA[3:]) > np.cos(0.005)
    assert np.linalg.norm(found.board.pose[:3] - BOARD[:3]) < 1e-3
    assert found.position_rms < 3 * NOISE < 3 * found.leave_one_out_rms and found.outliers == []
    assert found.held_out_rms is not None and found.cause and isinstance(found.notes, list)
    again = pcavr.calibrate_hand_eye(*views)
    assert np.array_equal(again.camera.pose, found.camera.pose) and again.held_out_rms == found.held_out_rms


def test_wrong_view_is_named(views):
    flange, board = views
    board[7, :3] += [0.0, 0.08, 0.0]
    assert pcavr.calibrate_hand_eye(flange, board).outliers == [7]


def test_views_that_can_not_be(views):
    flange, board = views
    for changed, place in [((flange[:2], board[:2]), ""), ((flange, board[:-1]), "board"),
                           ((flange[:, :3], board), "flange"), ((flange * np.nan, board), "flange"),
                           ((flange, 2 * board), "board[0]")]:
        with pytest.raises(pcavr.Error) as raised:
            pcavr.calibrate_hand_eye(*changed)
        assert raised.value.place.startswith(place), str(raised.value)
    with pytest.raises(pcavr.Error, match="camera_on"):
        pcavr.calibrate_hand_eye(flange, board, camera_on="head")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="flange"):
        pcavr.calibrate_hand_eye(None, board)


def swinging(t):
    """Poses of a body that turns to and fro about three axes, ever faster."""
    half = 0.3 * np.column_stack([np.sin(1.7 * t + 0.03 * t**2), np.sin(2.3 * t + 1), np.sin(0.9 * t + 0.02 * t**2)])
    w = np.sqrt(1 - (half**2).sum(axis=1))
    return np.column_stack([0.1 * np.sin(t), 0.05 * np.cos(1.3 * t), 0 * t, half, w])


def test_clock_that_is_late():
    t = np.arange(0.0, 40.0, 0.02)
    found = pcavr.calibrate_clocks((t, swinging(t)), (t, swinging(t + 0.137)), drift=False)
    assert found.is_observable and found.offset == pytest.approx(0.137, abs=2e-3)
    assert found.drift is None and found.corrected(1.0) == pytest.approx(1.0 + found.offset)
    resting = np.tile(swinging(np.zeros(1)), (len(t), 1))
    still = pcavr.calibrate_clocks((t, swinging(t)), (t, resting))
    assert not still.is_observable and still.reason


def test_force_sensor_with_a_load():
    rng = np.random.default_rng(2)
    bias, mass, turn = np.array([1.2, -3.4, 12.6]), 1.3, np.array([0.0, 0.0, np.sin(0.25), np.cos(0.25)])
    flange = np.array([random_pose(rng, 0.5) for _ in range(30)])
    weight = np.array([0.0, 0.0, -9.80665 * mass])
    force = np.array([bias + turned(turn, turned(pose[3:] * [-1, -1, -1, 1], weight)) for pose in flange])
    found = pcavr.calibrate_force(flange, force + rng.normal(0.0, 0.05, force.shape))
    assert found.mass == pytest.approx(mass, abs=4 * found.mass_std) and found.mass_std < 0.02
    assert np.allclose(found.force_bias, bias, atol=0.1) and found.axes == "sensor" and found.sign == 1.0
    assert np.allclose(found.rotation @ [1.0, 0, 0], turned(turn, np.array([1.0, 0, 0])), atol=0.02)
    assert found.centre is None and found.description
    with pytest.raises(pcavr.Error, match="wrench"):
        pcavr.calibrate_force(flange, force[:-1])
    with pytest.raises(pcavr.Error):
        pcavr.calibrate_force(np.tile(flange[0], (30, 1)), force)
    with pytest.raises(pcavr.Error, match="up"):
        pcavr.calibrate_force(flange, force, up=[0, 0, 0])
    for wrong in [None, "force", [[1.0], [2.0, 3.0]]]:
        with pytest.raises((TypeError, ValueError)):
            pcavr.calibrate_force(flange, wrong)


def test_touched_points():
    rng = np.random.default_rng(4)
    world = np.array([[0, 0, 0], [0.4, 0, 0], [0, 0.3, 0], [0.4, 0.3, 0], [0.2, 0.1, 0.2]], float)
    truth = random_pose(rng, 0.5)
    base = np.array([truth[:3] + turned(truth[3:], point) for point in world])
    found = pcavr.calibrate_touch(world, base + rng.normal(0.0, 2e-4, base.shape))
    assert np.allclose(found.pose[:3], truth[:3], atol=1e-3) and found.rms < 1e-3
    assert found.scale == pytest.approx(1.0, abs=0.01)
    with pytest.raises(pcavr.Error):
        pcavr.calibrate_touch(np.outer(np.arange(5.0), [0.1, 0, 0]), np.outer(np.arange(5.0), [0, 0.1, 0]))
    with pytest.raises(pcavr.Error):
        pcavr.calibrate_touch(world * [1, 1, -1], base)
