# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Kinematics and dynamics of an arm from URDF."""
import numpy as np
import pytest

import pcavr
from conftest import SOURCE

ARM = SOURCE / "tests" / "fuzz" / "corpus" / "urdf" / "six_axes.urdf"


@pytest.fixture(scope="module")
def arm():
    return pcavr.Robot(ARM)


@pytest.fixture
def states(arm):
    return np.random.default_rng(1).uniform(-1.0, 1.0, (3, arm.dof))


def test_description(arm):
    assert arm.dof == len(arm.joints) == 6 and arm.position_limits.shape == (6, 2)
    assert len(arm.links) > 6 and isinstance(arm.warnings, list) and "6" in repr(arm)


def test_jacobian_is_the_derivative_of_the_pose(arm, states):
    q, link, step = states[0], arm.links[-1], 1e-6
    jacobian = arm.jacobian(q, link)
    for i in range(arm.dof):
        ahead, behind = q.copy(), q.copy()
        ahead[i] += step
        behind[i] -= step
        slope = (arm.pose(ahead, link)[:3] - arm.pose(behind, link)[:3]) / (2 * step)
        assert np.allclose(jacobian[:3, i], slope, atol=1e-8)


def test_dynamics_agree_with_each_other(arm, states):
    q, dq, ddq = states
    tau = arm.inverse_dynamics(q, dq, ddq)
    assert np.allclose(arm.forward_dynamics(q, dq, tau), ddq)
    zero = np.zeros(arm.dof)
    gravity = arm.gravity_torque(q)
    assert np.allclose(arm.inverse_dynamics(q, zero, ddq), arm.mass_matrix(q) @ ddq + gravity)
    assert arm.regressor(q, dq, ddq).shape == (6, 60)


def test_inverse_kinematics_reaches_a_pose(arm, states):
    link = arm.links[-1]
    target = arm.pose(states[0] * 0.5, link)
    solution = arm.inverse_kinematics(target, link, start=states[0] * 0.4)
    assert solution.is_reached and np.allclose(arm.pose(solution.q, link)[:3], target[:3], atol=1e-4)
    far = arm.inverse_kinematics([100.0, 0, 0, 0, 0, 0, 1], link)
    assert not far.is_reached and far.position_error > 10.0


def test_bad_arguments(arm, tmp_path):
    link = arm.links[-1]
    for q in [np.zeros(5), np.zeros((6, 1)), [np.nan] * 6]:
        with pytest.raises(pcavr.Error, match="q"):
            arm.pose(q, link)
    for q in [None, "joints", np.zeros(6, complex)]:
        with pytest.raises(TypeError, match="q"):
            arm.mass_matrix(q)
    with pytest.raises(KeyError):
        arm.pose(np.zeros(6), "tail")
    with pytest.raises(pcavr.Error):
        arm.inverse_kinematics(np.zeros(7), link)
    with pytest.raises(pcavr.Error):
        pcavr.Robot(tmp_path / "absent.urdf")
    with pytest.raises(pcavr.Error):
        pcavr.Robot(ARM.with_name("loop.urdf"))


FRICTION = {"viscous": 2.0, "coulomb": 1.5}  # of each joint


@pytest.fixture(scope="module")
def log(arm):
    """(t, q, tau) of 15 s in which all joints swing to and fro."""
    t = np.arange(0.0, 15.0, 0.01)
    phase = 2 * np.pi * np.outer(t, [0.31, 0.47, 0.23])[:, None, :] + np.arange(6)[:, None] * [1.0, 2.0, 0.5]
    weight = np.array([0.35, 0.2, 0.4])
    rate = 2 * np.pi * np.array([0.31, 0.47, 0.23])
    q, dq = np.sin(phase) @ weight, np.cos(phase) @ (weight * rate)
    ddq = -np.sin(phase) @ (weight * rate**2)
    tau = np.array([arm.inverse_dynamics(*row) for row in zip(q, dq, ddq)])
    noise = np.random.default_rng(3).normal(0.0, 0.02, tau.shape)
    return t, q, tau + FRICTION["viscous"] * dq + FRICTION["coulomb"] * np.sign(dq) + noise


def test_friction_of_joints_is_identified(arm, log, tmp_path):
    found = pcavr.identify_robot(ARM, log)
    assert [joint.name for joint in found.joints] == arm.joints and found.is_physical
    assert any(each.is_excited for each in found.base_parameters) and found.payload is None
    for joint in found.joints:
        assert joint.held_out_relative < 0.1
        for term, truth in FRICTION.items():
            value, std = joint.equivalent[term]
            assert value == pytest.approx(truth, rel=0.1) and 0.0 < std < truth
    found.write_report(tmp_path / "report")
    assert (tmp_path / "report" / "report.json").exists()
    with pytest.raises(pcavr.Error):
        found.write_report(tmp_path / "report")


def test_bad_logs(log):
    t, q, tau = log
    hole = tau.copy()
    hole[7, 2] = np.nan
    for bad, named in [((t, q[:, :5], tau), "log"), ((t, q, tau[:-1]), "log tau"), ((t, q, hole), "log tau"),
                       ((t[::-1], q, tau), "log t"), ((t[:20], q[:20], tau[:20]), "log")]:
        with pytest.raises(pcavr.Error) as raised:
            pcavr.identify_robot(ARM, bad)
        assert raised.value.place.startswith(named), str(raised.value)
    for wrong in [(t, q), 3, (t, q, None)]:
        with pytest.raises(TypeError, match="log"):
            pcavr.identify_robot(ARM, wrong)
    with pytest.raises(pcavr.Error):
        pcavr.identify_robot(ARM, log, gains=[1.0])
