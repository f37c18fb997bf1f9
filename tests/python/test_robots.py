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
