#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the command on inputs that were once read wrongly, and compares with their right values.

    tests/faults/shared_faults.py --pcavr build/dev/apps/pcavr/pcavr [--only stl-corners] [--data FOLDER]

The inputs are the folder `faults` of the shared recordings (PCAVR_DATA); where it is absent, the exit
code is 77 and ctest reports a skipped test. Each check prints "ok", or what was seen and what is right.
Needs only python3.
"""
import argparse
import json
import math
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
TIMEOUT = 120  # s for one command
REFUSAL_SECONDS = 20  # for a hostile file
REFUSAL_BYTES = 1 << 30  # resident, for a hostile file


class Wrong(Exception):
    """A result that is not the right one."""


def check(is_right, seen):
    if not is_right:
        raise Wrong(seen)


class Command:
    def __init__(self, pcavr, work):
        self.pcavr = pcavr
        self.work = work

    def __call__(self, *args, timeout=TIMEOUT):
        """Exit code, result (from --json; None without one) and standard error."""
        line = [self.pcavr, "--json", *(str(arg) for arg in args)]
        try:
            done = subprocess.run(line, capture_output=True, text=True, errors="replace", timeout=timeout,
                                  cwd=self.work, stdin=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            raise Wrong(f"no end after {timeout} s: {' '.join(line[2:])}") from None
        check(done.returncode in (0, 1, 2), f"exit code {done.returncode}: {' '.join(line[2:])}")
        check("internal error" not in done.stderr, done.stderr[-300:])
        try:
            result = json.loads(done.stdout) if done.stdout.strip() else None
        except ValueError:
            result = None
        return done.returncode, result, done.stderr

    def done(self, *args):
        """The result of a command that must succeed, and its standard error."""
        code, result, errors = self(*args)
        check(code == 0, f"exit {code}: {errors.strip().splitlines()[-1:]}")
        return result, errors

    def text(self, *args):
        """Exit code and all that is printed for a person."""
        done = subprocess.run([self.pcavr, *(str(arg) for arg in args)], capture_output=True, text=True,
                              errors="replace", timeout=TIMEOUT, cwd=self.work, stdin=subprocess.DEVNULL)
        check(done.returncode in (0, 1, 2), f"exit code {done.returncode}")
        return done.returncode, done.stdout + done.stderr


def near(value, right, relative):
    return value is not None and abs(value - right) <= relative * abs(right)


def says(text, *words):
    """Whether one of the alternatives occurs."""
    lower = text.lower()
    return any(word.lower() in lower for word in words)


def refused_or_said(code, text, *words):
    check(code != 0 or says(text, "warning", *words), f"exit 0 without a word: {text[-200:]}")
    check(says(text, *words), f"does not say {words}: {text[-300:]}")


def rows_of(file):
    if not file.exists():
        return 0
    with open(file) as lines:
        return sum(1 for _ in lines) - 1


# Bags


def db3_packed(pcavr, data, work):
    for name in ("plain", "bag_zstd_file_mode", "plain.db3.zst", "plain.db3.bz2"):
        code, text = pcavr.text("inspect", data / name)
        check(code == 0 and says(text, "200 messages", "200"), f"{name}: {text[-200:]}")


def bag_without_messages(pcavr, data, work):
    code, text = pcavr.text("inspect", data / "no-messages.bag")
    check(code == 0 and says(text, "0 messages") and not says(text, "is cut", "warning"), text[-200:])


def tf_static_twice(pcavr, data, work):
    for name in ("a4_static_corrected", "a4b_static_corrected_mid", "a5_two_parents_old_first"):
        out = work / name
        _, errors = pcavr.done("import", data / f"{name}.mcap", "--base-frame", "base_link", "--tool-frame", "tip",
                               "--object", "body=/vicon/body", "--manifest", data / "bodies.yaml", "-o", out)
        rows = rows_of(out / "tool.csv")
        check(rows == 3693, f"{name}: {rows} rows, 3693 are right")
        check(says(errors, "warning"), f"{name}: nothing is said of the replaced transform")


def camera_info_roi(pcavr, data, work):
    right = {"roi_crop": (320, 240, 525.0, 159.5, 119.5), "roi_crop_wh": (320, 240, 525.0, 159.5, 119.5),
             "binning2": (320, 240, 262.5, 159.75, 119.75), "binning2_wh": (320, 240, 262.5, 159.75, 119.75)}
    for name, (width, height, focal, cx, cy) in right.items():
        out = work / name
        code, text = pcavr.text("import", data / f"{name}.mcap", "-o", out)
        if code != 0:
            check(says(text, "roi", "region of interest", "binning"), f"{name}: {text[-200:]}")
            continue
        camera = yaml_numbers(out / "recording.yaml")
        wanted = {"width": width, "height": height, "fx": focal, "fy": focal, "cx": cx, "cy": cy}
        for key, value in wanted.items():
            check(abs(camera[key] - value) < 0.3, f"{name}: {key} {camera[key]}, {value} is right")


def yaml_numbers(file):
    """The numbers of the lines `key: number` of a manifest."""
    found = {}
    for line in file.read_text().splitlines():
        key, _, value = line.strip().partition(":")
        try:
            found.setdefault(key, float(value.split("#")[0]))
        except ValueError:
            continue
    return found


def image_encodings(pcavr, data, work):
    for name, encoding in (("c_bayer_rggb8.bag", "bayer_rggb8"), ("c_yuv422.mcap", "yuv422")):
        out = work / name
        code, text = pcavr.text("import", data / name, "-o", out)
        if says(text.replace(name, ""), encoding):
            continue
        check(code == 0 and not says(text, "grey"), f"{name}: grey frames, encoding not named: {text[-200:]}")


def depth_not_registered(pcavr, data, work):
    code, text = pcavr.text("import", data / "sdk_bag.bag", "-o", work / "rec")
    refused_or_said(code, text, "registered")


# Tables


def csv_dialects(pcavr, data, work):
    sound = {"semicolon": None, "quoted": None, "tabs": None, "epoch_ns": None}
    for name in sound:
        out = work / name
        code, text = pcavr.text("import", data / name / "r", "--tool-topic", "tip", "--wrench-topic", "ft",
                                "--object", "body=body", "-o", out)
        if code != 0:
            check(says(text, "separator", "delimiter", "nanoseconds", " ns", "quote"), f"{name}: {text[-200:]}")
            continue
        check(rows_of(out / "tool.csv") > 100, f"{name}: {rows_of(out / 'tool.csv')} rows")
    command = ("import", data / "nan_row/r", "--tool-topic", "tip", "--wrench-topic", "ft", "--object", "body=body")
    code, text = pcavr.text(*command, "-o", work / "nan")
    if code != 0:
        check(says(text, "--skip-bad"), f"nan_row: {text[-200:]}")
        code, text = pcavr.text(*command, "--skip-bad", "-o", work / "nan_skipped")
        check(code == 0, f"nan_row --skip-bad: {text[-200:]}")


def friction_of(pcavr, recording, out):
    """The identified values by name, of the only object; and all that is printed."""
    code, result, errors = pcavr("identify", "friction", recording, "-o", out)
    if code != 0:
        return None, errors
    return result["objects"][0], errors + json.dumps(result)


STAMP_UNIT_WORDS = ("milliseconds", "stamps in ms", "ticks", "unit of the stamps", "unit of its stamps")


def stamps_in_ms(pcavr, data, work):
    for name in ("p_ms", "p_10ms_ticks"):
        rec = work / name
        code, text = pcavr.text("import", data / name / "r", "--tool-topic", "tip", "--wrench-topic", "ft", "--object",
                                "body=body", "--manifest", data / "bodies.yaml", "-o", rec)
        if says(text, *STAMP_UNIT_WORDS):
            continue
        check(code == 0, f"{name}: {text[-200:]}")
        values, said = friction_of(pcavr, rec, work / f"{name}.yaml")
        if says(said, *STAMP_UNIT_WORDS):
            continue
        check(values is not None, f"{name}: {said[-200:]}")
        check(near(values.get("limiting_static_friction"), 3.379, 0.1), f"{name}: {values}")
    code, text = pcavr.text("identify", "robot", data / "ms.csv", "--robot", data / "ur10e.urdf", "-o", work / "robot")
    refused_or_said(code, text, *STAMP_UNIT_WORDS)


def held_samples(pcavr, data, work):
    right = {"limiting_static_friction": (3.39, 4), "sliding_friction_coefficient": (0.231, 4)}
    for name in ("probe-1_tool_hold_4", "probe-1_hold_10"):
        values, said = friction_of(pcavr, data / name, work / f"{name}.yaml")
        if values is None:
            check(says(said, "repeat", "held"), f"{name}: {said[-200:]}")
            continue
        expect_within(values, right, name)
        expect_within(values, {"contact.exponent": (1.5, 4)}, name)
    values, said = friction_of(pcavr, data / "push-3_hold_10", work / "push-3.yaml")
    if values is None:
        check(says(said, "repeat", "held"), f"push-3: {said[-200:]}")
    else:
        expect_within(values, {"limiting_static_friction": (16.2, 4), "sliding_friction_coefficient": (0.390, 4)}, "push-3")


def expect_within(values, right, what):
    """Each value within its number of stated standard deviations, and of a tenth of the right value."""
    for key, (value, max_z) in right.items():
        found, std = values.get(key), values.get(f"{key}_std")
        check(found is not None, f"{what}: no {key} in {values}")
        check(std is None or abs(found - value) <= max_z * std, f"{what}: {key} {found} +- {std}, {value} is right")
        check(near(found, value, 0.15), f"{what}: {key} {found}, {value} is right")


def tracker_outlier(pcavr, data, work):
    rec = data / "rec"
    scene = work / "scene"
    pcavr.done("build", rec, "-o", scene)
    code, text = pcavr.text("replay", rec, "--scene", scene, "-o", work / "run")
    check(code == 0 and says(text, "outlier", "jump"), f"replay: exit {code}: {text[-300:]}")
    code, text = pcavr.text("identify", "friction", rec, "--scene", scene, "-o", work / "p.yaml")
    check(code in (0, 1) and "nan" not in (work / "p.yaml").read_text().lower() if code == 0 else True, text[-200:])


# Clouds and depth


def constant_viewpoint(pcavr, data, work):
    _, errors = pcavr.done("import", data / "const", "-o", work / "rec")
    result, _ = pcavr.done("build", work / "rec", "-o", work / "scene")
    poses = (work / "scene/camera_trajectory.txt").read_text().splitlines()
    places = {tuple(line.split()[1:4]) for line in poses if not line.startswith("#")}
    check(len(places) > 1, f"one pose for all frames: {errors[-200:]}")


def depth_scale(pcavr, data, work):
    code, text = pcavr.text("import", data / "noscale_mm", "--camera", data / "cam.yaml", "-o", work / "rec")
    if code != 0:
        return check(says(text, "depth_scale", "factor"), text[-200:])
    if abs(yaml_numbers(work / "rec/recording.yaml")["depth_scale"] - 1000.0) < 1.0:
        result, _ = pcavr.done("build", work / "rec", "-o", work / "scene")
        return check(near(result["mesh_area_m2"], 3.38, 0.15), f"mesh {result['mesh_area_m2']} m^2")
    code, text = pcavr.text("build", work / "rec", "-o", work / "scene")
    return check(code == 1 and says(text, "depth_scale"), f"exit {code}: {text[-300:]}")


# Tags


def tag_id_twice(pcavr, data, work):
    true_box = (0.630, -0.185, 0.062)
    for name, tag in (("r_dup0_table_0.95", "tag36h11:0"), ("r_dup5_single_tag", "tag36h11:5")):
        code, result, errors = pcavr("build", data / name, "-o", work / name)
        check(says(errors, tag) and says(errors, "twice", "two tags"), f"{name}: exit {code}: {errors[-300:]}")
        if code != 0:
            continue
        box = next((o for o in result["objects"] if o["name"] == "fp_box"), None)
        if box is None or box["evidence"] == "not_seen":
            continue
        error = math.dist(box["t_m"], true_box)
        check(error < max(0.005, 4 * box["position_sigma_m"]), f"{name}: fp_box is {1000 * error:.0f} mm off")


# Meshes and robots

PRISM_VOLUME = 0.00028  # m^3


def build_with_mesh(pcavr, data, work, mesh, key="dae"):
    """Exit code and text of `build` with this mesh of the recording c's object."""
    recording = work / f"c_{mesh.name}"
    shutil.copytree(data.parent / "scene-validation/c", recording)
    name = f"part{mesh.suffix.lower()}"
    shutil.copy(mesh, recording / name)
    manifest = recording / "recording.yaml"
    manifest.write_text(manifest.read_text().replace("mesh: part.ply", f"mesh: {name}"))
    return pcavr("build", recording, "-o", work / f"s_{mesh.name}", timeout=REFUSAL_SECONDS + 20)


def meshes_read(*names, allowed_error=None):
    def run(pcavr, data, work):
        for name in names:
            code, _, errors = build_with_mesh(pcavr, data, work, data / name)
            if code != 0 and allowed_error and says(errors, allowed_error):
                continue
            check(code == 0, f"{name}: {errors[-300:]}")

    return run


def zero_length_cylinder(pcavr, data, work):
    code, text = pcavr.text("predict", "reach", "--robot", data / "panda-gazebo.urdf", "--point", 0.4, 0.1, 0.4)
    check("scale is not positive" not in text, text[-200:])
    check(says(text, "panda_mount"), f"the shape that is left out is not named: {text[-300:]}")


def hostile(pcavr, data, work):
    for name in ("double_free.ply", "segfault.gltf", "abort.dae", "hang_10_GB.dae"):
        code, _, errors = build_with_mesh(pcavr, data, work, data / name)
        # A glTF with a skin is valid: it may be read.
        check(code == 1 or name == "segfault.gltf", f"{name}: exit {code}")
        check(code == 0 or len(errors.strip().splitlines()) >= 1, f"{name}: {errors[-200:]}")
        check(not list(work.glob("*.partial*")), f"{name}: a partial folder stays")
    for name in ("schema_5_GB.mcap", "view_without_end.db3", "view_without_end_topics.db3", "stamp_min.db3"):
        code, _, errors = pcavr("inspect", data / name, timeout=REFUSAL_SECONDS)
        check(name == "stamp_min.db3" or (code == 1 and name in errors), f"{name}: exit {code}: {errors[-200:]}")
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
    check(peak < REFUSAL_BYTES, f"a command took {peak >> 20} MB")


CHECKS = {
    "db3-packed-as-file": db3_packed,
    "bag-without-messages": bag_without_messages,
    "tf-static-twice": tf_static_twice,
    "camera-info-roi": camera_info_roi,
    "image-encodings": image_encodings,
    "depth-not-registered": depth_not_registered,
    "csv-dialects": csv_dialects,
    "stamps-in-ms": stamps_in_ms,
    "held-samples": held_samples,
    "tracker-outlier": tracker_outlier,
    "constant-viewpoint": constant_viewpoint,
    "depth-scale-too-small": depth_scale,
    "tag-id-twice": tag_id_twice,
    "stl-corners": meshes_read("stl_1e-17.stl", "stl_last_bit.stl", "octagonal_pocket.ply"),
    "ply-header-comments": meshes_read("ply_ascii.ply", "ply_meshio.ply", "ply_bin_comment_before_colours.ply",
                                       "ply_comment_after_element_face.ply", "ply_comment_between_properties.ply",
                                       "ply_normals_first_comment.ply"),
    "quantised-glb": meshes_read("plain.glb", "quant16.glb", "glb_short_mm.glb", "glb_short_norm.glb", "meshopt.glb",
                                 allowed_error="EXT_meshopt_compression"),
    "scene-validation": meshes_read("cubevt.obj", "dae_light_node_id_twice.dae", "dae_node_id_twice.dae",
                                    "glb_cam_same_name.glb"),
    "zero-length-cylinder": zero_length_cylinder,
    "hostile": hostile,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pcavr", required=True, type=pathlib.Path)
    parser.add_argument("--data", type=pathlib.Path,
                        default=pathlib.Path(os.environ.get("PCAVR_DATA", ROOT / "../shared/data")) / "faults")
    parser.add_argument("--only", choices=sorted(CHECKS), action="append")
    arguments = parser.parse_args()
    if not arguments.data.is_dir():
        print(f"skipped: {arguments.data} is absent; set PCAVR_DATA to the shared recordings")
        return SKIPPED
    failed = []
    for name in arguments.only or CHECKS:
        with tempfile.TemporaryDirectory(prefix="pcavr-fault-") as folder:
            work = pathlib.Path(folder)
            try:
                CHECKS[name](Command(arguments.pcavr.resolve(), work), (arguments.data / name).resolve(), work)
                print(f"ok      {name}", flush=True)
            except Wrong as wrong:
                failed.append(name)
                print(f"FAILED  {name}: {wrong}", flush=True)
    print(f"{len(failed)} failed" if failed else "all right")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
