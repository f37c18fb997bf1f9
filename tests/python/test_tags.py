# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Tags and poses from images as arrays."""
import concurrent.futures

import numpy as np
import pytest

import pcavr

SIZE = 0.08  # [m]


@pytest.fixture(scope="module")
def camera():
    return pcavr.Camera(320, 240, 300.0, 300.0, 159.5, 119.5)


def draw_tag(family, tag_id, distance, camera):
    """A tag in the middle of the image, seen upright from the front: 180 degrees about x from the camera."""
    cells, border = pcavr.tag_cells(family, tag_id)
    cell = SIZE / (len(cells) - 2 * border)  # [m]
    rows, columns = np.mgrid[0:camera.height * 4, 0:camera.width * 4]  # four samples a side of a pixel
    x = ((columns + 0.5) / 4 - 0.5 - camera.cx) / camera.fx * distance
    y = ((rows + 0.5) / 4 - 0.5 - camera.cy) / camera.fy * distance
    column = np.floor(x / cell + len(cells) / 2).astype(int)
    row = np.floor(y / cell + len(cells) / 2).astype(int)
    inside = (row >= 0) & (row < len(cells)) & (column >= 0) & (column < len(cells))
    white = np.where(inside, cells[row.clip(0, len(cells) - 1), column.clip(0, len(cells) - 1)], True)
    fine = np.where(white, 220.0, 30.0)
    return fine.reshape(camera.height, 4, camera.width, 4).mean(axis=(1, 3)).astype(np.uint8)


def test_tag_is_found_and_its_pose_is_right(camera):
    image = draw_tag("tag36h11", 7, 0.3, camera)
    detector = pcavr.TagDetector(["tag36h11"], camera=camera)
    [found] = detector.detect(image)
    assert (found.family, found.id, found.hamming) == ("tag36h11", 7, 0)
    assert found.corners.shape == (4, 2) and np.ptp(found.corners[:, 0]) == pytest.approx(80, abs=0.5)
    seen = pcavr.body_pose([pcavr.Tag("tag36h11", 7, SIZE)], [found], camera,
                           depth=np.full((240, 320), 0.3, np.float32))
    assert seen.status in ("solved", "ambiguous") and seen.tags_used == 1
    assert np.allclose(seen.pose[:3], [0.0, 0.0, 0.3], atol=2e-3)
    assert seen.covariance.shape == (6, 6) and seen.reprojection_rms < 0.5


def test_layout_and_colour_of_the_image_do_not_matter(camera):
    image = draw_tag("tag36h11", 7, 0.3, camera)
    images = [image, np.asfortranarray(image), np.repeat(image, 2, axis=1)[:, ::2],
              np.repeat(image[:, :, None], 3, axis=2)]
    image.setflags(write=False)
    corners = [pcavr.TagDetector(["tag36h11"]).detect(each)[0].corners for each in images]
    assert all(np.array_equal(each, corners[0]) for each in corners)


def test_tag_that_is_not_seen(camera):
    seen = pcavr.body_pose([pcavr.Tag("tag36h11", 7, SIZE)], [], camera)
    assert seen.status == "not_seen" and seen.pose is None


def test_bad_tags(camera):
    with pytest.raises(pcavr.Error):
        pcavr.tag_cells("tag36h11", 100000)
    with pytest.raises(pcavr.Error, match="size"):
        pcavr.Tag("tag36h11", 7, 80.0)
    with pytest.raises(pcavr.Error, match="family"):
        pcavr.Tag("tag99h1", 7, SIZE)
    with pytest.raises(pcavr.Error, match="depth"):
        pcavr.body_pose([], [], camera, depth=np.zeros((7, 9), np.float32))


def test_families():
    assert "tag36h11" in pcavr.tag_families()


def test_bad_detectors_and_images():
    with pytest.raises(pcavr.Error):
        pcavr.TagDetector(["tag99h1"])
    detector = pcavr.TagDetector(["tag36h11"])
    for image in [np.zeros((4, 4, 4), np.uint8), np.zeros(4, np.uint8), np.zeros((0, 4), np.uint8)]:
        with pytest.raises(pcavr.Error, match="image"):
            detector.detect(image)
    for image in [np.zeros((48, 64)), np.zeros((48, 64), np.uint16), None, "image", [[1, 2], [3]]]:
        with pytest.raises((TypeError, ValueError)):
            detector.detect(image)


def test_threads_may_share_a_detector(camera):
    image = draw_tag("tag36h11", 7, 0.3, camera)
    detector = pcavr.TagDetector(["tag36h11"])
    with concurrent.futures.ThreadPoolExecutor(4) as threads:
        found = list(threads.map(detector.detect, [image] * 40))
    assert all([each.id for each in detections] == [7] for detections in found)
