# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Calibrations from arrays."""
import functools
import json
import os
import signal
import struct
import zlib

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
        assert raised.value.place.startswith(place) or f"{place} " in str(raised.value), str(raised.value)
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


BOARD_TEXT = "chessboard:7x6:30mm"
COLUMNS, ROWS, SQUARE = 7, 6, 0.03  # inner corners; [m]
LENS = pcavr.Camera(480, 360, 430.0, 425.0, 244.0, 176.0, distortion=[-0.1, 0.05, 0.0, 0.0, 0.0])


def looking_at(distance, about_x, about_y, aside):
    """The board in a camera that looks at its middle, tilted [rad]."""
    tilt = product(np.array([np.sin(about_x / 2), 0, 0, np.cos(about_x / 2)]),
                   np.array([0, np.sin(about_y / 2), 0, np.cos(about_y / 2)]))
    facing = np.concatenate([[*aside, distance], product(tilt, np.array([1.0, 0, 0, 0]))])
    middle = np.array([(COLUMNS - 1) * SQUARE / 2, (ROWS - 1) * SQUARE / 2, 0.0])
    return compose(facing, np.concatenate([-middle, [0.0, 0, 0, 1.0]]))


@functools.cache
def rays_of_pixels():
    """(3, 3 * height, 3 * width) directions with z = 1, three by three a pixel: the lens is inverted by fixed point."""
    v, u = (np.mgrid[0:3 * LENS.height, 0:3 * LENS.width] + 0.5) / 3 - 0.5
    x = distorted_x = (u - LENS.cx) / LENS.fx
    y = distorted_y = (v - LENS.cy) / LENS.fy
    for _ in range(8):
        r2 = x * x + y * y
        scale = 1 / (1 + LENS.distortion[0] * r2 + LENS.distortion[1] * r2 * r2)
        x, y = distorted_x * scale, distorted_y * scale
    return np.array([x, y, np.ones_like(x)])


def draw_board(pose):
    """A picture of the board, each pixel the mean of its rays."""
    to_board = inverse(pose)
    rotation = np.array([turned(to_board[3:], axis) for axis in np.eye(3)]).T
    ray = np.tensordot(rotation, rays_of_pixels(), 1)
    scale = -to_board[2] / ray[2]
    column = np.floor((to_board[0] + scale * ray[0]) / SQUARE).astype(int)
    row = np.floor((to_board[1] + scale * ray[1]) / SQUARE).astype(int)
    dark = (column >= -1) & (row >= -1) & (column < COLUMNS) & (row < ROWS) & ((column + row) % 2 == 0)
    fine = np.where(dark, 30.0, 220.0)
    return fine.reshape(LENS.height, 3, LENS.width, 3).mean(axis=(1, 3)).astype(np.uint8)


@pytest.fixture(scope="module")
def board_pictures():
    tilts = [(0.0, 0.5), (0.5, 0.0), (-0.5, 0.2), (0.1, -0.5), (0.4, 0.4), (-0.4, -0.4), (0.4, -0.4), (0.0, 0.0)]
    aside = [(-0.1, 0.0), (0.1, 0.05), (0.0, 0.07), (0.1, -0.07), (-0.1, -0.06), (-0.08, 0.07), (0.0, -0.05),
             (0.0, 0.0)]
    poses = [looking_at(0.5, *tilt, place) for tilt, place in zip(tilts, aside)]
    return np.array([draw_board(pose) for pose in poses]), np.array(poses)


def test_camera_of_pictures(board_pictures):
    pictures, poses = board_pictures
    found = pcavr.calibrate_camera(pictures, BOARD_TEXT)
    assert found.camera.fx == pytest.approx(LENS.fx, abs=4 * found.stds[0] + 0.2)
    assert found.camera.cy == pytest.approx(LENS.cy, abs=4 * found.stds[3] + 0.2)
    assert found.pixel_rms < 0.2 and found.noise < 0.2 and found.pixel_std > 0
    assert found.pictures == list(range(len(pictures))) and found.outliers == []
    of_the_camera = 4 * found.stds[:4].max() / LENS.fx * np.linalg.norm(poses[:, :3], axis=1).max()  # [m]
    assert np.allclose(found.poses[:, :3], poses[:, :3], atol=of_the_camera) and found.view_rms.shape == (8,)
    assert found.coverage.shape == (6, 8) and found.coverage.sum() == 8 * COLUMNS * ROWS
    assert found.covered == pytest.approx((found.coverage > 0).mean())
    assert np.allclose(np.sqrt(np.diag(found.covariance))[:4], found.stds[:4])


def test_camera_of_other_pictures_of_the_same(board_pictures, tmp_path, command):
    """Colour, strides, a list and files give what the command gives."""
    pictures, _ = board_pictures
    found = pcavr.calibrate_camera(pictures, BOARD_TEXT)
    color = np.repeat(pictures[:, :, :, None], 3, axis=3)
    listed = [np.asfortranarray(picture) for picture in pictures]
    folder = tmp_path / "pictures"
    folder.mkdir()
    for number, picture in enumerate(pictures):
        (folder / f"view_{number}.png").write_bytes(png_of(picture))
    done = command("calibrate", "camera", folder, "--board", BOARD_TEXT, "-o", tmp_path / "camera.yaml", "--json")
    assert done.returncode == 0, done.stderr
    stated = json.loads(done.stdout)["intrinsics"]
    of_folder = pcavr.calibrate_camera(folder, BOARD_TEXT)
    for same in [found, of_folder, *(pcavr.calibrate_camera(each, BOARD_TEXT) for each in (color, listed))]:
        assert (same.camera.fx, same.camera.cx) == pytest.approx((stated["fx"], stated["cx"]), rel=1e-9)
        assert same.camera.distortion == found.camera.distortion
    assert of_folder.text() == (tmp_path / "camera.yaml").read_text()
    assert "camera_matrix" in found.text("ros") and "cam0" in found.text("kalibr")
    with pytest.raises(pcavr.Error, match="format"):
        found.text("matlab")  # type: ignore[arg-type]


def png_of(gray):
    def chunk(name, content):
        return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))
    header = struct.pack(">IIBBBBB", gray.shape[1], gray.shape[0], 8, 0, 0, 0, 0)
    rows = b"".join(b"\0" + row.tobytes() for row in gray)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def test_picture_without_the_board_is_named(board_pictures):
    pictures, _ = board_pictures
    found = pcavr.calibrate_camera([*pictures[:4], np.full_like(pictures[0], 128), *pictures[4:]], BOARD_TEXT)
    assert found.pictures == [0, 1, 2, 3, 5, 6, 7, 8]
    assert any("picture 4" in note for note in found.notes)


def test_pictures_that_can_not_be(board_pictures, tmp_path):
    pictures, _ = board_pictures
    for wrong, place in [(pictures[:2], "pictures"), (np.full((3, 48, 64), 128, np.uint8), "pictures"),
                         (pictures[:, :, :, None], "pictures[0]"), (pictures[0], "pictures[0]"),
                         ([], "pictures"), ([pictures[0], pictures[1, :-1], pictures[2]], "picture 1")]:
        with pytest.raises(pcavr.Error) as raised:
            pcavr.calibrate_camera(wrong, BOARD_TEXT)
        assert raised.value.place == place, str(raised.value)
    for wrong in [pictures.astype(float), pictures.astype(np.uint16), None, 3, [None]]:
        with pytest.raises(TypeError, match="pictures"):
            pcavr.calibrate_camera(wrong, BOARD_TEXT)
    with pytest.raises(pcavr.Error) as raised:
        pcavr.calibrate_camera(tmp_path, BOARD_TEXT)
    assert raised.value.file == str(tmp_path)
    for changed, named in [({"board": "chessboard"}, "board"), ({"lens": "pinhole"}, "lens"),
                           ({"lens": "fisheye", "k3": True}, "k3"), ({"threads": -1}, "threads")]:
        with pytest.raises(pcavr.Error, match=named):
            pcavr.calibrate_camera(pictures, **{"board": BOARD_TEXT, **changed})  # type: ignore[arg-type]


def test_forked_process_calibrates_the_same_with_threads(board_pictures):
    """The parent's worker threads are not in the child, which must not wait for them."""
    pictures, _ = board_pictures
    expected = pcavr.calibrate_camera(pictures, BOARD_TEXT, threads=2).camera.fx
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        signal.alarm(60)
        try:
            os.write(writer, repr(pcavr.calibrate_camera(pictures, BOARD_TEXT, threads=2).camera.fx).encode())
        finally:
            os._exit(0)  # the tests are the parent's; without a value it fails
    os.close(writer)
    with os.fdopen(reader) as pipe:
        assert float(pipe.read()) == expected
    os.waitpid(child, 0)


def test_hand_eye_of_calibrated_pictures(board_pictures):
    """The poses of calibrate_camera are what calibrate_hand_eye takes."""
    pictures, poses = board_pictures
    flange = np.array([compose(BOARD, compose(inverse(pose), inverse(CAMERA))) for pose in poses])
    seen = pcavr.calibrate_camera(pictures, BOARD_TEXT)
    found = pcavr.calibrate_hand_eye(flange[seen.pictures], seen.poses)
    assert np.linalg.norm(found.camera.pose[:3] - CAMERA[:3]) < 3e-3


TAG_CAMERA = pcavr.Camera(640, 480, 520.0, 520.0, 319.5, 239.5)
TAG_SIZE = 0.08  # [m]
PLACES = [np.array([x, y, 0.0, 0.0, 0.0, 0.0, 1.0]) for x, y in [(0, 0), (0.2, 0), (0, 0.15), (0.2, 0.15)]]
CORNERS = TAG_SIZE / 2 * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])


@pytest.fixture(scope="module")
def walk():
    """Twelve images past four tags on a table: times, and detections with 0.1 px of noise."""
    rng = np.random.default_rng(7)
    detections = []
    for i in range(12):
        about_x, about_y = 0.4 * np.sin(i), 0.4 * np.cos(1.3 * i)
        tilt = product(np.array([np.sin(about_x / 2), 0, 0, np.cos(about_x / 2)]),
                       np.array([0, np.sin(about_y / 2), 0, np.cos(about_y / 2)]))
        base = compose(np.concatenate([[0.0, 0.0, 0.6], product(tilt, np.array([1.0, 0, 0, 0]))]),
                       np.array([-0.1, -0.075, 0.0, 0.0, 0.0, 0.0, 1.0]))
        detections.append([])
        for number, place in enumerate(PLACES):
            seen = compose(base, place)
            pixels = TAG_CAMERA.project(np.array([seen[:3] + turned(seen[3:], corner) for corner in CORNERS]))
            detections[-1].append(pcavr.TagDetection("tag36h11", number, pixels + rng.normal(0, 0.1, (4, 2))))
    return 0.1 * np.arange(12), detections


def stated(moved=()):
    return [pcavr.Tag("tag36h11", i, TAG_SIZE, place + (0.03 if i in moved else 0.0) * np.eye(7)[0])
            for i, place in enumerate(PLACES)]


def test_tags_of_a_walk(walk):
    found = pcavr.calibrate_tags(walk, TAG_CAMERA, stated(moved=[2]))
    tags = found.bodies[""]
    assert [(tag.family, tag.id, tag.size) for tag in tags] == [("tag36h11", i, TAG_SIZE) for i in range(4)]
    for tag, place in zip(tags, PLACES):
        assert np.linalg.norm(tag.pose[:3] - place[:3]) < 1e-3 and tag.images == 12 and tag.pixel_rms < 0.5
        assert tag.covariance.shape == (6, 6) and tag.moved_between is None
    assert [tag.has_moved for tag in tags] == [False, False, True, False]
    assert tags[2].offset == pytest.approx(0.03, abs=1e-3) and 0 < tags[2].position_std < 1e-3
    assert [tag.is_reference for tag in tags] == [True, True, False, True]
    assert "tag36h11:2" in found.verdict and any("tag36h11:2" in note for note in found.notes)


def test_tags_of_objects_and_of_a_size(walk):
    tags = stated()
    found = pcavr.calibrate_tags(walk, TAG_CAMERA, tags[:2], objects={"box": tags[2:]})
    assert {name: [tag.id for tag in body] for name, body in found.bodies.items()} == {"": [0, 1], "box": [2, 3]}
    found = pcavr.calibrate_tags(walk, TAG_CAMERA, tags[:1], size=TAG_SIZE, fixed=["tag36h11:0"])
    assert [tag.offset is None for tag in found.bodies[""]] == [False, True, True, True]
    assert np.linalg.norm(found.bodies[""][3].pose[:3] - PLACES[3][:3]) < 1e-3


def test_tags_as_the_command_finds_them(walk, tmp_path, command):
    t, detections = walk
    found = pcavr.calibrate_tags(walk, TAG_CAMERA, stated(moved=[2]), fixed=[0])
    rows = [",".join(["t,id", *(f"{axis}{i}" for i in range(4) for axis in "uv")])]
    for stamp, tags in zip(t, detections):
        rows += [",".join([repr(float(stamp)), str(tag.id), *(repr(float(u)) for u in tag.corners.ravel())])
                 for tag in tags]
    (tmp_path / "corners.csv").write_text("\n".join(rows) + "\n")
    (tmp_path / "camera.yaml").write_text(
        "camera: {width: 640, height: 480, fx: 520, fy: 520, cx: 319.5, cy: 239.5}\n")
    (tmp_path / "layout.yaml").write_text("markers:\n" + "".join(
        f"  - {{family: tag36h11, id: {tag.id}, size: {tag.size}, role: base, "
        f"pose: {{t: {list(tag.pose[:3])}, q: {list(tag.pose[3:])}}}}}\n" for tag in stated(moved=[2])))
    done = command("calibrate", "tags", "corners.csv", "--camera", "camera.yaml", "--layout", "layout.yaml",
                   "--fixed", "0", "-o", "tags.yaml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = (tmp_path / "tags.yaml").read_text().splitlines()
    assert [line for line in found.text().splitlines() if not line.startswith("source")] == [
        line for line in lines if not line.startswith("source")]
    assert "tag_bundles" in found.text("apriltag_ros") and "bodies" in found.text("tagslam")
    with pytest.raises(pcavr.Error, match="format"):
        found.text("ros")  # type: ignore[arg-type]


def test_walks_that_can_not_be(walk):
    t, detections = walk
    tags = stated()
    for changed, place in [({"walk": (t[:-1], detections)}, "walk"), ({"walk": (t[::-1], detections)}, "walk t[1]"),
                           ({"walk": (t, [[]] * 12)}, "base"), ({"tags": tags[:1]}, "tags"), ({"fixed": [9]}, "fixed"),
                           ({"size": 80.0}, "size"), ({"objects": {"": tags[2:]}, "tags": tags[:2]}, "objects")]:
        with pytest.raises(pcavr.Error) as raised:
            pcavr.calibrate_tags(**{"walk": walk, "camera": TAG_CAMERA, "tags": tags, **changed})
        assert raised.value.place.startswith(place) or f"{place} " in str(raised.value), str(raised.value)
    for wrong in [None, t, (t, None), (t, [None] * 12), (t, detections, 3)]:
        with pytest.raises(TypeError, match="walk"):
            pcavr.calibrate_tags(wrong, TAG_CAMERA, tags)
    for corners in [np.zeros((4, 3)), np.full((4, 2), np.nan)]:
        with pytest.raises(pcavr.Error, match="corners"):
            pcavr.TagDetection("tag36h11", 1, corners)
    with pytest.raises(pcavr.Error, match="family"):
        pcavr.TagDetection("tag99h1", 1, np.zeros((4, 2)))
    with pytest.raises(pcavr.Error, match="corner_std"):
        pcavr.TagDetection("tag36h11", 1, np.zeros((4, 2)), corner_std=-1.0)


def test_messages_name_arguments_and_no_options(walk):
    """Of the command's options the arguments are named."""
    for changed, named in [({"tags": stated()[:1]}, "size"), ({"fixed": [9]}, "fixed 9")]:
        with pytest.raises(pcavr.Error, match=named) as raised:
            pcavr.calibrate_tags(**{"walk": walk, "camera": TAG_CAMERA, "tags": stated(), **changed})
        assert "--" not in str(raised.value) + raised.value.hint
    found = pcavr.calibrate_tags(walk, TAG_CAMERA, stated()[:2])
    (note,) = [note for note in found.notes if "not known" in note]
    assert "--" not in note and "size takes them" in note
