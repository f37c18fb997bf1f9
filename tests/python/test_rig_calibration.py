# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Calibrations of depth cameras and tracked objects, from arrays and recordings."""
import json

import numpy as np
import pytest

import pcavr
from conftest import BOX

SCALE, OFFSET, DEPTH_NOISE = 1.02, 0.008, 5e-4  # true depth = SCALE * measured + OFFSET [m]


@pytest.fixture
def distances():
    """Twelve distances by depth and as they are [m]."""
    expected = np.linspace(0.4, 1.5, 12)
    noise = np.random.default_rng(3).normal(0.0, DEPTH_NOISE, 12)
    return (expected - OFFSET) / SCALE + noise, expected


def test_scale_and_offset_of_distances(distances):
    found = pcavr.calibrate_depth(distances)
    assert abs(found.scale - SCALE) < 4 * found.scale_std < 0.01
    assert found.offset is not None and found.offset_std is not None
    assert abs(found.offset - OFFSET) < 4 * found.offset_std < 0.01
    assert found.covariance[0, 0] == pytest.approx(found.scale_std**2)
    assert (found.views, found.places, found.plane_rms, found.plane_tilt) == (12, 12, None, None)
    assert found.fitted_rms < 2 * DEPTH_NOISE < found.before_rms
    assert found.depth_scale == pytest.approx(1 / found.scale) and "too small" in found.verdict
    assert "kind: depth" in found.text() and "depth_scale" in found.text()


def test_offset_that_one_distance_does_not_show(distances):
    found = pcavr.calibrate_depth((distances[0][:5] * 0.05 + 0.6, distances[1][:5] * 0.05 + 0.6))
    assert found.offset is None and found.offset_std is None
    assert any("not observable" in note for note in found.notes)


def test_distances_of_another_dtype_order_and_strides(distances):
    measured, expected = distances
    found = pcavr.calibrate_depth(distances)
    readonly = np.repeat(measured, 2)[::2]
    readonly.setflags(write=False)
    for same in [(list(measured), list(expected)), [readonly, expected], (measured.astype(">f8"), expected)]:
        assert pcavr.calibrate_depth(same).scale == found.scale


def test_distances_that_can_not_be(distances):
    measured, expected = distances
    hole = np.array(measured)
    hole[3] = np.nan
    for wrong, place in [((measured[:-1], expected), "expected"), ((measured[:, None], expected), "measured"),
                         ((hole, expected), "measured[3]"), ((measured, -expected), "expected[0]"),
                         ((measured[:4], expected[:4]), "measured"), (([], []), "measured")]:
        with pytest.raises(pcavr.Error) as raised:
            pcavr.calibrate_depth(wrong)
        assert raised.value.place == place, str(raised.value)
    for wrong in [(measured,), None, 3, (measured, None), (measured.astype(str), expected), measured]:
        with pytest.raises(TypeError):
            pcavr.calibrate_depth(wrong)
    with pytest.raises(pcavr.Error) as raised:
        pcavr.calibrate_depth(distances, frames=0)
    assert raised.value.place == "frames"


def test_depth_of_a_recording_as_the_command_finds_it(tmp_path, command):
    folder = tmp_path / "recording"
    done = command("simulate", "tabletop", "-o", folder, "--duration", "2", "--frames-per-second", "6")
    assert done.returncode == 0, done.stderr
    done = command("calibrate", "depth", folder, "-o", tmp_path / "depth.yaml", "--frames", "60", "--json")
    assert done.returncode == 0, done.stderr
    stages = set()
    found = pcavr.calibrate_depth(folder, frames=60, progress=lambda stage, done, total: stages.add(stage))
    stated = json.loads(done.stdout)
    assert (found.scale, found.views, found.plane_rms) == (stated["scale"], stated["views"], stated["plane_rms"])
    assert found.text() == (tmp_path / "depth.yaml").read_text() and stages


def test_recordings_without_what_a_calibration_needs(push_folder, tmp_path):
    with pytest.raises(pcavr.Error, match="images") as raised:
        pcavr.calibrate_depth(push_folder)
    assert raised.value.file == str(push_folder)
    for calibrate in (pcavr.calibrate_depth, pcavr.calibrate_objects):
        with pytest.raises(pcavr.Error) as raised:
            calibrate(tmp_path / "absent")
        assert str(tmp_path) in raised.value.file


TIP = 0.01  # [m]
SHIFT = np.array([0.012, -0.007, 0.0])  # [m] of the mesh in the tracker's frame
TURN = 0.1  # [rad] about z


def touched_points():
    """Of a cube with edges of 0.1 m: five contacts on each of its four sides, three points in each, 0.1 mm of noise."""
    rng = np.random.default_rng(4)
    points = []
    for side in range(4):
        angle = side * np.pi / 2 + TURN
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        for along in np.linspace(-0.04, 0.04, 5):
            place = np.append(turn @ [0.05 + TIP, along], 0.01) + SHIFT
            points += [place + rng.normal(0.0, 1e-4, 3) for _ in range(3)]
    return np.array(points)


POINTS, CONTACTS = touched_points(), np.repeat(np.arange(20), 3)


def touched_cube(cad=BOX, points=POINTS, contacts=CONTACTS, **others):
    return pcavr.TouchedObject("cube", cad, points, contacts, **{"tool_radius": TIP, **others})


def test_object_of_touched_points():
    touched = touched_cube()
    assert (touched.name, touched.contacts) == ("cube", 20)
    found = pcavr.calibrate_objects([touched])
    (cube,) = found.objects
    assert np.linalg.norm(cube.pose[:2] - SHIFT[:2]) < 5e-4
    assert 2 * np.arcsin(abs(cube.pose[5])) == pytest.approx(TURN, abs=0.01)
    assert np.isfinite(cube.stds[[0, 1, 5]]).all() and np.isnan(cube.stds[[2, 3, 4]]).all()
    assert cube.fitted_rms < 3e-4 < cube.before_rms and cube.contacts == 20
    assert "cube" in cube.verdict and "kind: objects" in found.text() and found.notes == cube.notes


def test_touched_points_of_another_dtype_order_and_strides():
    pose = pcavr.calibrate_objects([touched_cube()]).objects[0].pose
    readonly = np.repeat(POINTS, 2, axis=0)[::2]
    readonly.setflags(write=False)
    for same in [touched_cube(points=np.asfortranarray(POINTS)), touched_cube(points=readonly),
                 touched_cube(contacts=CONTACTS.astype(np.uint8)), touched_cube(contacts=list(CONTACTS))]:
        assert np.array_equal(pcavr.calibrate_objects((same,)).objects[0].pose, pose)


def test_touched_objects_that_can_not_be():
    hole = np.array(POINTS)
    hole[7, 1] = np.nan
    for changed, place in [({"points": POINTS[:, :2]}, "points"), ({"points": hole}, "points[7, 1]"),
                           ({"contacts": CONTACTS[:-1]}, "contacts"), ({"tool_radius": 0.0}, "tool_radius"),
                           ({"tool_radius": np.nan}, "tool_radius"), ({"up": (0, 0, 0)}, "up"),
                           ({"pose": np.zeros(7)}, "pose"), ({"cad": (BOX[0], BOX[1] + 1)}, "cad")]:
        with pytest.raises(pcavr.Error) as raised:
            touched_cube(**changed)
        assert raised.value.place.startswith(place), str(raised.value)
    for changed in [{"contacts": CONTACTS.astype(float)}, {"contacts": None}, {"points": None}, {"cad": 3}]:
        with pytest.raises(TypeError, match=next(iter(changed))):
            touched_cube(**changed)


def test_contacts_that_do_not_show_an_object():
    few = CONTACTS < 3
    for touched in [touched_cube(points=POINTS[few], contacts=CONTACTS[few]),
                    touched_cube(points=np.zeros((0, 3)), contacts=np.zeros(0, int))]:
        with pytest.raises(pcavr.Error, match="are needed") as raised:
            pcavr.calibrate_objects([touched])
        assert raised.value.place == "cube"
    for wrong in [None, 3, [None], [touched_cube(), 3]]:
        with pytest.raises(TypeError):
            pcavr.calibrate_objects(wrong)
    with pytest.raises(pcavr.Error):
        pcavr.calibrate_objects([])
    for force in (-1.0, np.nan, 1e9):
        with pytest.raises(pcavr.Error) as raised:
            pcavr.calibrate_objects([touched_cube()], min_force=force)
        assert raised.value.place == "min_force"


def test_objects_of_a_recording_are_those_of_the_command(push_folder, tmp_path, command):
    """Its boxes are pushed from one side alone: both say so."""
    done = command("calibrate", "objects", push_folder, "-o", tmp_path / "objects.yaml")
    with pytest.raises(pcavr.Error, match="box_1 is touched in 3 contacts") as raised:
        pcavr.calibrate_objects(push_folder)
    assert done.returncode == 1 and raised.value.message in done.stderr
    assert raised.value.file == str(push_folder)
