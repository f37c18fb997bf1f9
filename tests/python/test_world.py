# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""The predictor, step by step."""
import time

import numpy as np
import pytest

import pcavr

START = [0.0, 0.0, 0.05, 0.0, 0.0, 0.0, 1.0]


def known_box():
    box = pcavr.Parameters()
    box.mass = pcavr.Value(1.0)
    box.sliding_friction_coefficient = pcavr.Value(0.3)
    box.limiting_static_friction = pcavr.Value(3.2)
    return box


def make_world(cube, **changed):
    body = pcavr.Body("box", cube, START, known_box())
    return pcavr.World([body], [-0.1, 0.0, 0.05], tool_radius=0.01, **changed)


def push_along_x(world, steps=1000, speed=0.1):
    for i in range(steps):
        world.step([-0.1 + speed * 0.001 * (i + 1), 0.0, 0.05])


def test_pushed_box_slides_with_coulomb_friction(cube):
    world = make_world(cube)
    assert world.phase("box") == "free" and world.names == ["box"]
    push_along_x(world)
    # The tip ends at x = 0; the box's face is a radius further.
    assert world.pose("box")[0] == pytest.approx(0.06, abs=0.002)
    assert world.phase("box") == "sliding"
    assert world.force("box")[0] == pytest.approx(0.3 * 9.80665, rel=0.1)
    assert world.now == pytest.approx(1.0)


def test_same_inputs_give_the_same_bits(cube):
    worlds = [make_world(cube) for _ in range(2)]
    for world in worlds:
        push_along_x(world)
    assert np.array_equal(worlds[0].pose("box"), worlds[1].pose("box"))


def test_correction_of_the_past_moves_the_present(cube):
    world = make_world(cube)
    push_along_x(world, 400)
    moved = np.array(START)
    moved[1] = 0.02
    assert world.correct("box", 0.2, pose=moved)
    push_along_x(make_world(cube), 1)
    for _ in range(500):
        world.step([-0.06, 0.0, 0.05])
    assert world.pose("box")[1] == pytest.approx(0.02, abs=1e-3)
    before = world.pose("box")
    assert not world.correct("box", -100.0, pose=START)
    assert np.array_equal(world.pose("box"), before)
    assert world.correct("box", world.now - 0.01, parameters=known_box())


def test_defaults_are_named(cube):
    assert "mass" in pcavr.Body("box", cube, START).assumed
    assert "mass" not in pcavr.Body("box", cube, START, known_box()).assumed


def test_immovable_body_keeps_its_pose(cube):
    world = pcavr.World([pcavr.Body("box", cube, START, movable=False)], [-0.1, 0.0, 0.05])
    push_along_x(world, 600)
    assert np.allclose(world.pose("box"), START)
    assert world.force("box")[0] > 1.0


@pytest.mark.parametrize("tip", [[0.0, 0.0], [0.0] * 4, [np.nan, 0.0, 0.0], [np.inf, 0.0, 0.0],
                                 np.zeros((3, 1)), np.array([0.0, np.nan, 0.0])])
def test_bad_tips_are_errors_and_no_steps(cube, tip):
    world = make_world(cube)
    with pytest.raises(pcavr.Error) as raised:
        world.step(tip)
    assert raised.value.place.startswith("tip") and world.now == 0.0


@pytest.mark.parametrize("tip", [None, "here", [1, 2, "3"], np.zeros(3, complex), {}])
def test_tips_of_other_types(cube, tip):
    with pytest.raises(TypeError, match="tip"):
        make_world(cube).step(tip)


def test_tips_of_any_layout_are_equal(cube):
    tips = [[-0.055, 0.0, 0.05], np.array([-0.055, 0.0, 0.05]), np.array([-0.055, 9, 0.0, 9, 0.05])[::2],
            np.array([-0.055, 0.0, 0.05]).astype(">f8")]
    worlds = [make_world(cube) for _ in tips]
    for world, tip in zip(worlds, tips):
        for _ in range(50):
            world.step(tip)
    assert len({tuple(world.pose("box")) for world in worlds}) == 1


def test_bad_worlds(cube):
    body = pcavr.Body("box", cube, START)
    for changed in [{"tool_radius": 0.0}, {"dt": 0.0}, {"start": np.nan}, {"tip": [0.0, 0.0]},
                    {"static_mesh": (cube[0], cube[1] + 100)}]:
        with pytest.raises(pcavr.Error):
            pcavr.World(**{"bodies": [body], "tip": [0.0, 0.0, 1.0], **changed})
    with pytest.raises(KeyError):
        make_world(cube).pose("sphere")
    heavy = pcavr.Parameters()
    heavy.mass = pcavr.Value(1e9)
    with pytest.raises(pcavr.Error, match="mass"):
        pcavr.Body("box", cube, START, heavy)
    with pytest.raises(pcavr.Error, match="pose"):
        pcavr.Body("box", cube, START[:6])


def test_run_is_the_same_as_single_steps(cube):
    tips = np.linspace([-0.1, 0.0, 0.05], [-0.02, 0.003, 0.05], 700)
    single, together = make_world(cube), make_world(cube)
    for tip in tips:
        single.step(tip)
    together.run(np.asfortranarray(tips))
    assert np.array_equal(single.pose("box"), together.pose("box")) and single.now == together.now
    for bad in [tips[:, :2], tips.T, np.where(tips == tips[9, 0], np.nan, tips)]:
        with pytest.raises(pcavr.Error, match="tips"):
            together.run(bad)
    assert together.now == single.now


def seconds_per_step(step_all, steps):
    """CPU time of the shortest of seven runs: other work on the machine only adds to it."""
    times = []
    for _ in range(7):
        begin = time.process_time()
        step_all()
        times.append((time.process_time() - begin) / steps)
    return min(times)


@pytest.mark.parametrize("kind", [np.array, list])
def test_step_costs_little_beside_that_of_the_library(cube, kind, record_property):
    """At most 2 us a call: less than a step itself."""
    world, steps, tip = make_world(cube), 20000, kind([-0.1, 0.0, 0.05])

    def step_all():
        for _ in range(steps):
            world.step(tip)

    tips = np.tile([-0.1, 0.0, 0.05], (steps, 1))
    alone = seconds_per_step(lambda: world.run(tips), steps)
    overhead = seconds_per_step(step_all, steps) - alone
    print(f"step: {1e6 * alone:.2f} us in the library, {1e6 * overhead:.2f} us more from Python")
    record_property("overhead", overhead)
    assert overhead < 2e-6
