# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings, read as views and written from arrays."""
import gc
import shutil

import numpy as np
import pytest

import pcavr


def address_of(array):
    return array.__array_interface__["data"][0]


@pytest.mark.parametrize("series, attributes", [
    ("tool", ["stamps", "positions", "quaternions"]), ("wrench", ["stamps", "forces", "torques"])])
def test_series_are_views_of_one_memory(push, series, attributes):
    memory = getattr(push, series)
    arrays = [getattr(memory, name) for name in attributes]
    again = [getattr(memory, name) for name in attributes]
    assert [address_of(each) for each in arrays] == [address_of(each) for each in again]
    strides = {each.strides[0] for each in arrays}
    assert len(strides) == 1 and strides.pop() > arrays[1].shape[1] * 8  # rows of one structure
    offsets = [address_of(each) - address_of(arrays[0]) for each in arrays]
    assert all(0 <= offset < arrays[0].strides[0] for offset in offsets)
    assert not any(each.flags.owndata or each.flags.writeable for each in arrays)


def test_values_of_the_series(push):
    tool, wrench = push.tool, push.wrench
    assert len(tool) == len(tool.t) == len(tool.poses) and len(wrench) == len(wrench.forces)
    assert np.array_equal(tool.poses, np.hstack([tool.positions, tool.quaternions]))
    assert np.allclose(np.linalg.norm(tool.quaternions, axis=1), 1.0)
    assert np.array_equal(tool.t, tool.stamps * 1e-9)
    middle = tool.at((tool.t[0] + tool.t[1]) / 2)
    assert np.allclose(middle[:3], tool.positions[:2].mean(axis=0))
    assert tool.at(tool.t[0] - 1.0) is None
    with pytest.raises(ValueError):
        tool.positions[0, 0] = 1.0


def test_views_outlive_recording_and_folder(push_folder, tmp_path):
    folder = shutil.copytree(push_folder, tmp_path / "copy")
    recording = pcavr.read_recording(folder)
    positions, expected = recording.tool.positions, recording.tool.positions.copy()
    shutil.rmtree(folder)
    assert len(recording.wrench.forces) > 0
    del recording
    gc.collect()
    np.zeros(10**6)  # other memory
    assert np.array_equal(positions, expected)


def test_stated_objects(push):
    first = push.objects[0]
    assert first.name == "box_1" and first.mass > 0 and first.is_movable
    assert first.pose.shape == (7,)
    assert set(push.tracked) == {"box_1", "box_2"}
    assert push.camera is None and len(push.frame_t) == 0
    with pytest.raises(IndexError):
        push.frame(0)
    assert "tool poses" in repr(push)


def make_camera():
    return pcavr.Camera(64, 48, 60.0, 60.0, 31.5, 23.5)


def make_frames(count=3):
    rows, columns = np.mgrid[0:48, 0:64]
    color = np.stack([columns * 4, rows * 5, 0 * rows], axis=2).astype(np.uint8)
    return [(0.1 * i, color, np.full((48, 64), 0.8 + 0.1 * i, dtype=np.float32)) for i in range(count)]


def test_frames_are_views_of_the_decoded_images(tmp_path):
    pcavr.write_recording(tmp_path / "r", frames=iter(make_frames()), camera=make_camera())
    recording = pcavr.read_recording(tmp_path / "r")
    assert np.allclose(recording.frame_t, [0.0, 0.1, 0.2])
    assert recording.camera.width == 64 and recording.camera.lens == "plumb_bob"
    frame = recording.frame(-1)
    assert frame.color.shape == (48, 64, 3) and frame.color.dtype == np.uint8
    assert address_of(frame.color) == address_of(frame.color)
    assert address_of(frame.depth) == address_of(frame.depth)
    assert not frame.depth.flags.owndata and not frame.depth.flags.writeable
    assert np.allclose(frame.depth, 1.0, atol=1e-6) and frame.t == frame.depth_t == 0.2
    color = frame.color
    del frame, recording
    gc.collect()
    assert color[0, 60, 0] > 200
    (tmp_path / "r" / "depth").rename(tmp_path / "gone")
    with pytest.raises(pcavr.Error):
        pcavr.read_recording(tmp_path / "r").frame(0)


def test_frame_of_a_folder_that_is_gone(tmp_path):
    pcavr.write_recording(tmp_path / "r", frames=iter(make_frames()), camera=make_camera())
    recording = pcavr.read_recording(tmp_path / "r")
    shutil.rmtree(tmp_path / "r")
    with pytest.raises(pcavr.Error) as raised:
        recording.frame(0)
    assert raised.value.file.startswith(str(tmp_path / "r")) and recording.frame_t[2] == pytest.approx(0.2)


def write_push(push, folder, cube, **changed):
    arguments = {
        "tool": (push.tool.t, push.tool.poses),
        "wrench": (push.wrench.t, np.hstack([push.wrench.forces, push.wrench.torques])),
        "tracked": {"cube": (push.tracked["box_1"].t, push.tracked["box_1"].poses)},
        "objects": [pcavr.Object("cube", cube, mass=1.0, pose=push.objects[0].pose)],
        "tool_radius": 0.01, **changed}
    pcavr.write_recording(folder, **arguments)


def test_written_recording_is_accepted_and_read_back(push, cube, tmp_path, command):
    write_push(push, tmp_path / "r", cube)
    inspected = command("inspect", tmp_path / "r")
    assert inspected.returncode == 0, inspected.stdout + inspected.stderr
    read = pcavr.read_recording(tmp_path / "r")
    assert np.allclose(read.tool.t, push.tool.t, atol=1e-6)
    assert np.allclose(read.tool.positions, push.tool.positions, atol=1e-6)
    assert np.allclose(read.wrench.forces, push.wrench.forces, atol=1e-6)
    assert np.allclose(read.tracked["cube"].poses, push.tracked["box_1"].poses, atol=1e-6)
    assert read.objects[0].mass == 1.0 and read.tool_radius == 0.01
    assert read.notes == push.notes


def test_output_is_replaced_on_request_only(push, cube, tmp_path):
    write_push(push, tmp_path / "r", cube)
    with pytest.raises(pcavr.Error, match="exist"):
        write_push(push, tmp_path / "r", cube)
    write_push(push, tmp_path / "r", cube, replace=True)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "diary.txt").write_text("mine")
    with pytest.raises(pcavr.Error):
        write_push(push, tmp_path / "other", cube, replace=True)
    assert [file.name for file in (tmp_path / "other").iterdir()] == ["diary.txt"]


def raised_in_the_middle():
    yield make_frames(1)[0]
    raise RuntimeError("camera unplugged")


BAD_FRAMES = {
    "of another size": [(0.0, np.zeros((10, 10, 3), np.uint8), np.zeros((10, 10), np.float32))],
    "not ascending": [make_frames(1)[0], make_frames(1)[0]],
    "of floats": [(0.0, np.zeros((48, 64, 3)), np.zeros((48, 64), np.float32))],
    "with integer depth": [(0.0, np.zeros((48, 64, 3), np.uint8), np.zeros((48, 64), np.uint16))],
    "without depth": [(0.0, np.zeros((48, 64, 3), np.uint8))],
    "gray": [(0.0, np.zeros((48, 64), np.uint8), np.zeros((48, 64), np.float32))],
    "at nan": [(np.nan, np.zeros((48, 64, 3), np.uint8), np.zeros((48, 64), np.float32))],
    "numbers": [1, 2],
}


@pytest.mark.parametrize("case", BAD_FRAMES)
def test_bad_frames_leave_nothing(case, tmp_path):
    with pytest.raises((pcavr.Error, TypeError), match="frames"):
        pcavr.write_recording(tmp_path / "r", frames=BAD_FRAMES[case], camera=make_camera())
    assert not list(tmp_path.iterdir())


def test_exception_of_a_generator_passes(tmp_path):
    with pytest.raises(RuntimeError, match="unplugged"):
        pcavr.write_recording(tmp_path / "r", frames=raised_in_the_middle(), camera=make_camera())
    assert not list(tmp_path.iterdir())


def test_bad_recordings_are_not_written(push, cube, tmp_path):
    far = push.tool.poses
    far[3, 0] = 1e9
    heavy = np.array(push.wrench.forces)
    heavy[2, 1] = 1e12
    box = pcavr.Object("cube", cube)
    for changed in [{"tool": (push.tool.t, far)}, {"wrench": (push.wrench.t, heavy)},
                    {"tracked": {"sphere": (push.tool.t, push.tool.poses)}}, {"objects": [box, box]},
                    {"tool_radius": -1.0}, {"frames": make_frames()}]:
        with pytest.raises(pcavr.Error):
            write_push(push, tmp_path / "r", cube, **changed)
        assert not (tmp_path / "r").exists()


@pytest.mark.parametrize("name", ["", "a/b", "../up", ".hidden"])
def test_names_that_are_no_files(name, cube):
    with pytest.raises(pcavr.Error, match="name"):
        pcavr.Object(name, cube)


@pytest.mark.parametrize("changed", [{"width": 0}, {"fx": -1.0}, {"cx": float("nan")},
                                     {"distortion": [1.0, 2.0]}, {"lens": "round", "distortion": [1.0]},
                                     {"distortion": [-5.0, 0.0, 0.0, 0.0, 0.0]}])
def test_cameras_that_can_not_be(changed):
    arguments = {"width": 64, "height": 48, "fx": 60.0, "fy": 60.0, "cx": 31.5, "cy": 23.5, **changed}
    with pytest.raises(pcavr.Error):
        pcavr.Camera(**arguments)


def test_camera_projects():
    camera = make_camera()
    assert np.allclose(camera.project([[0.0, 0.0, 1.0], [0.1, 0.0, 1.0]]), [[31.5, 23.5], [37.5, 23.5]])
    with pytest.raises(pcavr.Error, match=r"points\[0\]"):
        camera.project([[0.0, 0.0, -1.0]])
