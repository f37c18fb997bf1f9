# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings with images whose camera, tags, bodies or lists are wrong: as wrong_recordings, for `pcavr build`."""
import math
import re

from recorded_tables import (Table, edit_manifest, inverse, pose_product, quaternion, random_axis, replace_file,
                             scale_meshes)
from wrong_recordings import Wrong, either_way, log_uniform, signed

TAG = ("tag", "marker", "reprojection")
LENS = ("camera", "cx", "cy", "distortion", "fx", "focal", "lens", "depth", "tag")
MARKER = re.compile(r"  - family:.*?pose: \{t: \[([^\]]*)\], q: \[([^\]]*)\]\}", re.DOTALL)


def edit_marker(rng, recording, role, change):
    """`change(text, t, q)` gives the text of a random marker of this role anew; nothing where there is none."""
    path = recording / "recording.yaml"
    text = path.read_text()
    found = [match for match in MARKER.finditer(text) if f"role: {role}" in match[0]]
    if not found:
        return None
    match = rng.choice(found)
    t, q = ([float(x) for x in match[group].split(",")] for group in (1, 2))
    replace_file(path, text[:match.start()] + change(match[0], t, q) + text[match.end():])
    return match


def with_pose(text, t, q):
    numbers = (", ".join(f"{x:.9g}" for x in values) for values in (t, q))
    return re.sub(r"pose: \{.*\}", "pose: {{t: [{}], q: [{}]}}".format(*numbers), text)


def number_times(key, factor):
    return rf"(\b{key}: *)(-?[\d.]+)", lambda m: f"{m[1]}{float(m[2]) * factor:.7g}"


def tag_size(rng, recording, base):
    factor = either_way(rng, 1.02, 2.2)
    role = rng.choice(("base", "object"))
    if not edit_marker(rng, recording, role, lambda text, t, q: re.sub(*number_times("size", factor), text)):
        return None
    return Wrong(f"size of a {role} tag times {factor:.3g}", TAG + ("size", "depth"), max(factor, 1.0 / factor))


def tag_pose(rng, recording, base):
    size, angle = log_uniform(rng, 1.0, 60.0), rng.choice((0.0, rng.uniform(-20.0, 20.0)))
    offset = [size * 1e-3 * x for x in random_axis(rng)] + quaternion(random_axis(rng), math.radians(angle))

    def moved(text, t, q):
        pose = pose_product(t + q, offset)
        return with_pose(text, pose[:3], pose[3:])

    role = "base" if base.base_tags > 1 and rng.random() < 0.5 else "object"
    if not edit_marker(rng, recording, role, moved):
        return None
    return Wrong(f"pose of a {role} tag off by {size:.1f} mm, {angle:.0f} degrees", TAG + ("pose", "surface", "depth"))


def tag_w_first(rng, recording, base):
    role = rng.choice(("base", "object"))
    if not edit_marker(rng, recording, role, lambda text, t, q: with_pose(text, t, [q[3], *q[:3]])):
        return None
    return Wrong(f"quaternion of a {role} tag w first", TAG + ("upright", "vertical", "level", "quaternion", "depth"))


def tag_ids(rng, recording, base):
    if not edit_manifest(recording, r"\bid: 5\b", lambda m: "id: 905"):
        return None
    edit_manifest(recording, r"\bid: 6\b", lambda m: "id: 5")
    edit_manifest(recording, r"\bid: 905\b", lambda m: "id: 6")
    return Wrong("ids of two tags exchanged", TAG + ("size", "depth"))


def principal_point(rng, recording, base):
    shift, key = signed(rng, 1.0, 80.0), rng.choice(("cx", "cy"))
    edit_manifest(recording, rf"(\b{key}: *)([\d.]+)", lambda m: f"{m[1]}{float(m[2]) + shift:.7g}")
    return Wrong(f"{key} off by {shift:.1f} px", LENS)


def focal_length(rng, recording, base):
    factor, key = either_way(rng, 1.005, 1.5), rng.choice(("f[xy]", "fx", "fy"))
    edit_manifest(recording, *number_times(key, factor))
    return Wrong(f"{key} times {factor:.3g}", LENS)


def distortion(rng, recording, base):
    k1 = signed(rng, 0.01, 0.35)
    edit_manifest(recording, r"( *)depth_scale:", lambda m: f"{m[1]}distortion: [{k1:.4f}, 0, 0, 0, 0]\n{m[0]}")
    return Wrong(f"distortion k1 {k1:.3f} where there is none", LENS)


def depth_scale(rng, recording, base):
    factor = rng.choice((5.0, 0.2, either_way(rng, 1.01, 2.2)))
    edit_manifest(recording, *number_times("depth_scale", factor))
    return Wrong(f"depth_scale times {factor:.3g}", ("depth",), max(factor, 1.0 / factor))


def mesh_size(rng, recording, base):
    factor = rng.choice((1e-3, 1e3, either_way(rng, 1.02, 1.6)))
    if not scale_meshes(recording, factor):
        return None
    return Wrong(f"mesh times {factor:.3g}", ("mesh", "metres", "size"), max(factor, 1.0 / factor))


def mesh_origin(rng, recording, base):
    shift = [log_uniform(rng, 2.0, 60.0) * 1e-3 * x for x in random_axis(rng)]
    if not scale_meshes(recording, 1.0, shift):
        return None
    return Wrong("origin of the mesh off by " + " ".join(f"{1e3 * x:.0f}" for x in shift) + " mm",
                 TAG + ("mesh", "pose", "surface", "depth"))


def late_depth(rng, recording, base):
    """Depth of one image before under the stamps of this one."""
    path = recording / "depth.txt"
    rows = [line.split() for line in path.read_text().splitlines() if line[:1] != "#"]
    shifted = [f"{row[0]} {before[1]}" for before, row in zip(rows, rows[1:])]
    replace_file(path, "\n".join(shifted) + "\n")
    return Wrong("depth late by one image", ("depth", "pair", "late"))


def given_poses(rng, recording, base):
    """groundtruth.txt, of the true poses with an error that all of them have."""
    table = Table(recording / "truth" / "camera.txt")
    kind = rng.choice(("none", "inverse", "w first", "mm", "offset", "axes"))
    offset = [log_uniform(rng, 2.0, 200.0) * 1e-3 * x for x in random_axis(rng)]
    offset += quaternion(random_axis(rng), math.radians(signed(rng, 0.2, 20.0)))
    change = {"none": lambda pose: pose, "inverse": inverse, "w first": lambda pose: [*pose[:3], pose[6], *pose[3:6]],
              "mm": lambda pose: [1e3 * x for x in pose[:3]] + pose[3:],
              "offset": lambda pose: pose_product(pose, offset),
              "axes": lambda pose: pose_product(pose, [0.0] * 3 + [0.5, -0.5, 0.5, -0.5])}[kind]
    lines = [" ".join(f"{x:.9f}" for x in [row[0], *change(row[1:])]) for row in table.rows]
    (recording / "groundtruth.txt").write_text("\n".join(lines) + "\n")
    return Wrong(f"given poses, error: {kind}", ("pose", "groundtruth", "tag"), 1.0 if kind in ("none", "offset") else 2.0)


RIG_SCENES = {"tag size": (3, tag_size), "tag pose": (4, tag_pose), "principal point": (2, principal_point),
              "focal length": (2, focal_length), "distortion": (2, distortion)}
FILE_SCENES = {"tag w first": (2, tag_w_first), "tag ids": (1, tag_ids), "depth scale": (2, depth_scale),
               "mesh size": (2, mesh_size), "mesh origin": (2, mesh_origin), "late depth": (1, late_depth),
               "given poses": (3, given_poses)}
