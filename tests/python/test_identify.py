# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Identification from arrays and from a recording."""
import math
import os

import numpy as np
import pytest

import pcavr

MU = "sliding_friction_coefficient"


@pytest.fixture(scope="module")
def found(box_1):
    return box_1.identify(name="box_1")


def test_arrays_give_the_truth_within_its_std(found, push_folder):
    truth = pcavr.read_parameters(push_folder / "truth" / "parameters.yaml")["box_1"]
    mu = found[MU]
    assert mu.is_excited and mu.unit == ""
    assert abs(mu.value - float(truth.sliding_friction_coefficient)) < 4 * mu.std
    assert found.name == "box_1"
    assert [each.name for each in found.findings].count(MU) == 1
    assert found.parameters.sliding_friction_coefficient.value == mu.value
    assert MU in repr(found)


def test_recording_gives_what_its_arrays_give(push_folder, box_1):
    recorded = pcavr.identify_recording(push_folder)
    assert set(recorded.objects) == {"box_1", "box_2"}
    # The other box is in the recording only: of both inputs, this one's pushes are the same.
    of_arrays = box_1.identify(name="box_1")[MU]
    of_recording = recorded.objects["box_1"][MU]
    assert of_arrays.value == pytest.approx(of_recording.value, rel=0.02)
    assert recorded.parameters["box_1"].known() == recorded.objects["box_1"].parameters.known()
    assert recorded.contacts > 0 and isinstance(recorded.contacts_left_out(), dict)
    assert isinstance(recorded.notes, list) and isinstance(recorded.warnings, list)


def test_same_arrays_give_the_same_bits(box_1, found):
    again = box_1.identify(name="box_1")
    assert again.parameters.known() == found.parameters.known()


@pytest.mark.parametrize("layout", [
    np.asfortranarray,
    lambda a: np.repeat(np.repeat(a, 2, axis=0), 2, axis=1)[::2, ::2],
    lambda a: a[::-1].copy()[::-1],
    lambda a: a.astype(">f8"),
    lambda a: a.tolist(),
])
def test_order_strides_and_bytes_do_not_matter(box_1, found, layout):
    same = box_1.identify(name="box_1", tool=(box_1.tool[0], layout(box_1.tool[1])),
                          wrench=(box_1.wrench[0], layout(box_1.wrench[1])))
    assert same[MU].value == found[MU].value


def test_readonly_arrays_are_read_and_stay_as_they_are(box_1, found):
    tool = box_1.tool[1].copy()
    tool.setflags(write=False)
    before = tool.copy()
    assert box_1.identify(name="box_1", tool=(box_1.tool[0], tool))[MU].value == found[MU].value
    assert np.array_equal(tool, before)


def test_positions_of_the_tip_and_torques(box_1, found):
    wrench = np.hstack([box_1.wrench[1], np.zeros_like(box_1.wrench[1])])
    of_tip = box_1.identify(name="box_1", tool=(box_1.tool[0], box_1.tool[1][:, :3]),
                            wrench=(box_1.wrench[0], wrench))
    assert of_tip[MU].value == pytest.approx(found[MU].value, rel=1e-3)


def test_mesh_as_arrays(box_1, found):
    lines = [line.split() for line in box_1.cad.read_text().splitlines()]
    vertices = np.array([line[1:4] for line in lines if line[:1] == ["v"]], dtype=float)
    triangles = np.array([[corner.split("/")[0] for corner in line[1:4]]
                          for line in lines if line[:1] == ["f"]], dtype=int) - 1
    assert box_1.identify(name="box_1", cad=(vertices, triangles))[MU].value == pytest.approx(
        found[MU].value, rel=1e-6)


def test_known_parameters_are_combined(box_1, found):
    both = box_1.identify(name="box_1", known=found.parameters)
    assert both[MU].value == pytest.approx(found[MU].value, rel=0.05)


def test_what_is_not_excited_has_no_value(box_1):
    still = box_1.identify(goal="contact")
    unexcited = [each for each in still.findings if not each.is_excited]
    assert all(math.isnan(each.value) and each.remark for each in unexcited)


def test_force_of_the_wrong_sign_is_found(box_1):
    with pytest.raises(pcavr.Error) as raised:
        box_1.identify(wrench=(box_1.wrench[0], -box_1.wrench[1]))
    assert "sign" in str(raised.value)


def test_options_change_the_result_and_are_checked(box_1):
    with pytest.raises(pcavr.Error, match="nearest known"):
        box_1.identify(options={"inputs.windw": 1.0})
    with pytest.raises(pcavr.Error, match="options"):
        box_1.identify(options={"window": 1.0})
    with pytest.raises(pcavr.Error):
        box_1.identify(options={"inputs.window": -1.0})
    with pytest.raises(TypeError):
        box_1.identify(options={"inputs.window": "wide"})
    with pytest.raises(TypeError):
        box_1.identify(options=[("inputs.window", 1.0)])


def test_report_is_written(push_folder, tmp_path):
    found = pcavr.identify_recording(push_folder, goal="contact")
    found.write_report(tmp_path / "report")
    assert (tmp_path / "report" / "report.json").exists()


def test_forked_process_identifies_the_same(box_1, found):
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.write(writer, repr(box_1.identify(name="box_1")[MU].value).encode())
        finally:
            os._exit(0)  # the tests are the parent's; without a value it fails
    os.close(writer)
    with os.fdopen(reader) as pipe:
        assert float(pipe.read()) == found[MU].value
    os.waitpid(child, 0)
