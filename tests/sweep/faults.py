# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Random bad inputs: each function corrupts a private copy of sound inputs and returns the Trial
that uses it. All randomness comes from the given generator."""
import os
import pathlib
import re
import shutil

from trial import Trial

ODD_NUMBERS = ["nan", "inf", "-inf", "-1", "0", "-0.0", "1e-300", "1e300", "1e12", "-0.002", "3.7",
               "99999999999999999999", "0x10", "1,5", "", "two", "[1, 2]", "{}", "~"]
ODD_BYTES = [b"", b"\0" * 64, b"\xff\xfe\0\0", b"\x89PNG\r\n\x1a\n", b"ply\nformat ascii 1.0\n",
             b"solid x\n", b"\n\n\n", b"%YAML 9.9\n---\n", b"{", b"\xef\xbb\xbf"]


class Sound:
    """Sound inputs, created once by the command; copies are hard links, replaced on a change."""

    def __init__(self, folder):
        self.folder = folder
        self.images = folder / "images"  # a recording with images, its scene
        self.images_scene = folder / "images-scene"
        self.push = folder / "push"  # a recording without images, its scene, parameters and run
        self.push_scene = folder / "push-scene"
        self.parameters = folder / "parameters.yaml"
        self.run = folder / "run"

    def copy(self, source, work):
        target = work / source.name
        if source.is_dir():
            shutil.copytree(source, target, copy_function=os.link)
        else:
            os.link(source, target)
        return target


def replace_file(path, content):
    """Unlinks first: must not write through a hard link into the sound input."""
    path.unlink()
    path.write_bytes(content if isinstance(content, bytes) else content.encode())


def files_of(folder, *endings):
    return sorted(p for p in folder.rglob("*") if p.is_file() and p.name.endswith(endings))


# Commands by input -------------------------------------------------------------------------------


def use_recording(rng, sound, recording, work, is_image):
    """A command that reads `recording`."""
    output = work / "output"
    kind = rng.choice(["build", "inspect", "identify", "replay"])
    if kind == "inspect":
        return ["inspect", recording], None
    if kind == "build" or is_image and kind == "identify":
        return ["build", recording, "-o", output], output
    scene = sound.images_scene if is_image else sound.push_scene
    if kind == "identify":
        goal = rng.choice(["contact", "friction"])
        return ["identify", goal, recording, "--scene", scene, "--tracked",
                recording / "tracked", "-o", work / "output.yaml"], work / "output.yaml"
    args = ["replay", recording, "--scene", scene, "-o", output]
    return args + ([] if is_image else ["--tracked", recording / "tracked"]), output


def with_flags(rng, args):
    return args + rng.choice([[], [], ["--json"], ["--threads", "1"]])


def corrupted_recording(rng, sound, work, corrupt, name):
    is_image = rng.random() < 0.4
    recording = sound.copy(sound.images if is_image else sound.push, work)
    what = corrupt(rng, recording)
    args, output = use_recording(rng, sound, recording, work, is_image)
    if rng.random() < 0.2 and args[0] != "inspect":
        args = args + ["--skip-bad"]
    return Trial(f"{name}: {what}", with_flags(rng, args), [recording], output)


# Text -------------------------------------------------------------------------------------------


def corrupt_manifest_value(rng, recording):
    path = recording / "recording.yaml"
    lines = path.read_text().split("\n")
    index = rng.choice([i for i, line in enumerate(lines) if re.search(r":\s*\S|\d", line)])
    odd = rng.choice(ODD_NUMBERS)
    numbers = list(re.finditer(r"-?\d+(\.\d+)?", lines[index].split("#")[0]))
    if numbers and rng.random() < 0.8:
        at = rng.choice(numbers)
        lines[index] = lines[index][: at.start()] + odd + lines[index][at.end():]
    else:
        lines[index] = lines[index].split(":")[0] + ": " + odd
    replace_file(path, "\n".join(lines))
    return f"recording.yaml:{index + 1} '{lines[index].strip()}'"


def corrupt_table_cell(rng, recording):
    path = rng.choice(files_of(recording, ".csv", ".txt"))
    lines = path.read_text().split("\n")
    index = rng.randrange(max(1, len(lines) - 1))
    separator = "," if path.suffix == ".csv" else " "
    cells = lines[index].split(separator)
    column = rng.randrange(len(cells))
    cells[column] = rng.choice(ODD_NUMBERS)
    lines[index] = separator.join(cells)
    replace_file(path, "\n".join(lines))
    return f"{path.name}:{index + 1} '{lines[index][:60]}'"


def corrupt_table_rows(rng, recording):
    path = rng.choice(files_of(recording, ".csv", ".txt"))
    lines = path.read_text().split("\n")
    kind = rng.choice(["cut", "swap", "double", "no header", "one row", "shift", "carriage returns"])
    middle = len(lines) // 2
    if kind == "cut":
        text = "\n".join(lines)
        replace_file(path, text[: rng.randrange(len(text) // 2, len(text))])
        return f"{path.name} cut"
    if kind == "swap":
        lines[middle], lines[middle - 1] = lines[middle - 1], lines[middle]
    elif kind == "double":
        lines.insert(middle, lines[middle])
    elif kind == "no header":
        lines = lines[1:]
    elif kind == "one row":
        lines = lines[:2] + lines[-2:]
    elif kind == "shift":
        separator = "," if path.suffix == ".csv" else " "
        shift = rng.choice([-0.002, -5.0, 1000.0, 1.7e9])
        shifted = []
        for line in lines:
            first, _, rest = line.partition(separator)
            try:
                shifted.append(f"{float(first) + shift:.6f}{separator}{rest}")
            except ValueError:
                shifted.append(line)
        lines = shifted
        kind = f"stamps shifted by {shift:g} s"
    replace_file(path, ("\r\n" if kind == "carriage returns" else "\n").join(lines))
    return f"{path.name}, {kind}"


def corrupt_bytes(rng, recording):
    path = rng.choice(files_of(recording, ".png", ".jpg", ".obj", ".ply", ".csv", ".txt", ".yaml"))
    content = bytearray(path.read_bytes())
    kind = rng.choice(["cut", "flip", "other", "longer", "repeated"])
    if kind == "cut":
        content = content[: rng.randrange(len(content) + 1)]
    elif kind == "flip":
        for _ in range(rng.randrange(1, 30)):
            if content:
                content[rng.randrange(len(content))] = rng.randrange(256)
    elif kind == "other":
        content = bytearray(rng.choice(ODD_BYTES))
    elif kind == "longer":
        content += rng.randbytes(rng.randrange(1, 2000))
    else:
        content = content + content
    replace_file(path, bytes(content))
    return f"{path.relative_to(recording)}, {kind}"


def corrupt_kind_of_file(rng, recording):
    path = rng.choice(files_of(recording, ".png", ".jpg", ".obj", ".ply", ".csv", ".txt", ".yaml"))
    path.unlink()
    kind = rng.choice(["gone", "a folder", "a link to itself", "a FIFO", "/dev/zero", "/dev/null",
                       "unreadable"])
    if kind == "a folder":
        path.mkdir()
    elif kind == "a link to itself":
        path.symlink_to(path)
    elif kind == "a FIFO":
        os.mkfifo(path)
    elif kind.startswith("/dev"):
        path.symlink_to(kind)
    elif kind == "unreadable":
        path.symlink_to("/proc/1/mem")
    return f"{path.relative_to(recording)} is {kind}"


def corrupt_mesh(rng, recording):
    path = rng.choice(files_of(recording / "objects", ".obj", ".ply"))
    lines = path.read_text(errors="replace").split("\n")
    kind = rng.choice(["NaN", "huge", "an index that is none", "many", "flat", "no faces"])
    vertices = [i for i, line in enumerate(lines) if line.startswith("v ")]
    faces = [i for i, line in enumerate(lines) if line.startswith("f ")]
    if not vertices or not faces:
        return corrupt_bytes(rng, recording)
    if kind == "NaN":
        lines[rng.choice(vertices)] = "v nan 0 0"
    elif kind == "huge":
        lines[rng.choice(vertices)] = "v 1e38 1e38 -1e38"
    elif kind == "an index that is none":
        lines[rng.choice(faces)] = rng.choice(["f 1 2 999999999", "f 0 0 0", "f -9 1 2", "f 1 1 1"])
    elif kind == "many":
        path_ply = b"ply\nformat binary_little_endian 1.0\nelement vertex 100000000000000\n" \
                   b"property float x\nproperty float y\nproperty float z\n" \
                   b"element face 12\nproperty list uchar int vertex_indices\nend_header\n"
        replace_file(path, path_ply)
        return f"{path.name} declares 1e14 vertices"
    elif kind == "flat":
        lines = [re.sub(r"\S+$", "0", line) if line.startswith("v ") else line for line in lines]
    else:
        lines = [line for line in lines if not line.startswith("f ")]
    replace_file(path, "\n".join(lines))
    return f"{path.name}, {kind}"


def recording_fault(corrupt, name):
    return lambda rng, sound, work: corrupted_recording(rng, sound, work, corrupt, name)


# Scenes, runs and parameters --------------------------------------------------------------------


def corrupt_any(rng, folder):
    files = [p for p in files_of(folder, "") if p.stat().st_size > 0]
    path = rng.choice(files)
    content = bytearray(path.read_bytes())
    kind = rng.choice(["cut", "cut inside a number", "flip", "gone", "empty"])
    if kind == "gone":
        path.unlink()
        return f"{path.relative_to(folder)} gone"
    if kind == "cut":
        content = content[: rng.randrange(len(content))]
    elif kind == "cut inside a number":
        digits = [i for i, byte in enumerate(content[-400:]) if chr(byte).isdigit()]
        content = content[: max(0, len(content) - 400) + rng.choice(digits or [0])]
    elif kind == "flip":
        for _ in range(rng.randrange(1, 20)):
            content[rng.randrange(len(content))] = rng.randrange(256)
    else:
        content = bytearray()
    replace_file(path, bytes(content))
    return f"{path.relative_to(folder)}, {kind}"


def corrupted_scene(rng, sound, work):
    is_image = rng.random() < 0.3
    scene = sound.copy(sound.images_scene if is_image else sound.push_scene, work)
    recording = sound.images if is_image else sound.push
    what = corrupt_any(rng, scene)
    output = work / "output"
    args, output = rng.choice([
        (["inspect", scene], None),
        (["replay", recording, "--scene", scene, "-o", output]
         + ([] if is_image else ["--tracked", recording / "tracked"]), output),
        (["evaluate", scene, "--truth", recording / "truth", "-o", output], output)])
    return Trial(f"scene: {what}", with_flags(rng, args), [scene], output)


def corrupted_run(rng, sound, work):
    run = sound.copy(sound.run, work)
    what = corrupt_any(rng, run)
    output = work / "output"
    args, output = rng.choice([
        (["inspect", run], None),
        (["evaluate", run, "--truth", sound.push / "truth", "-o", output], output),
        (["replay", sound.push, "--scene", sound.push_scene, "--tracked", run, "-o", output],
         output)])
    return Trial(f"run: {what}", with_flags(rng, args), [run], output)


def corrupted_parameters(rng, sound, work):
    path = sound.copy(sound.parameters, work)
    lines = path.read_text().split("\n")
    index = rng.randrange(len(lines))
    numbers = list(re.finditer(r"-?\d+(\.\d+)?(e[-+]?\d+)?", lines[index]))
    odd = rng.choice(ODD_NUMBERS)
    if numbers:
        at = rng.choice(numbers)
        lines[index] = lines[index][: at.start()] + odd + lines[index][at.end():]
    else:
        lines[index] = odd
    replace_file(path, "\n".join(lines))
    output = work / "output"
    args = ["replay", sound.push, "--scene", sound.push_scene, "--tracked", sound.push / "tracked",
            "--parameters", path, "-o", output]
    return Trial(f"parameters.yaml:{index + 1} '{lines[index].strip()}'", with_flags(rng, args),
                 [path], output)


# Options and outputs ----------------------------------------------------------------------------

NUMERIC_OPTIONS = {
    "build": ["--voxel", "--occupancy-resolution", "--threads"],
    "replay": ["--forward-delay", "--backward-delay", "--jitter", "--loss", "--seed", "--threads"],
    "simulate": ["--seed", "--clock-offset", "--saturate", "--threads", "--duration", "--objects",
                 "--frames-per-second"],
    "tags": ["--size", "--page-width", "--page-height", "--ids"],
    "import": ["--depth-scale", "--rate", "--stride", "--first"],
    "serve": ["--port", "--tool-radius", "--max-force"],
}


def odd_option(rng, sound, work):
    command = rng.choice(sorted(NUMERIC_OPTIONS))
    option = rng.choice(NUMERIC_OPTIONS[command])
    value = rng.choice([odd for odd in ODD_NUMBERS if odd not in ("[1, 2]", "{}", "~", "1e12")])
    output = work / "output"
    args = {
        "build": ["build", sound.push, "-o", output],
        "replay": ["replay", sound.push, "--scene", sound.push_scene, "--tracked",
                   sound.push / "tracked", "-o", output],
        "simulate": ["simulate", "press", "--no-images", "-o", output],
        "tags": ["tags", "-o", work / "sheet.svg"] + (["--ids", "0"] if option != "--ids" else []),
        "import": ["import", sound.images, "--format", "tum", "-o", output],
        "serve": ["serve", sound.folder / "no-such-scene"],
    }[command]
    return Trial(f"{command} {option}={value}", args + [f"{option}={value}"], [], output)


def odd_output(rng, sound, work):
    """Outputs that are, contain or lie in an input, or are invalid."""
    recording = sound.copy(sound.push, work)
    link = work / "link"
    link.symlink_to(recording)
    loop = work / "loop"
    loop.symlink_to(loop)
    (work / "mine").mkdir()
    (work / "mine" / "precious.txt").write_text("keep me")
    target = rng.choice([recording, work, ".", "..", "", link, link / "deeper", loop,
                         loop / "x", recording / "truth", recording / "new", work / ("x" * 300),
                         "/dev/null/x", "/proc/x", work / "mine",
                         recording / "tool.csv", b"\xff\xfe".decode("latin-1")])
    force = rng.choice([[], ["--force"], ["--force"]])
    args = rng.choice([
        ["build", recording, "-o", target],
        ["replay", recording, "--scene", sound.push_scene, "--tracked", recording / "tracked", "-o",
         target],
        ["identify", "friction", recording, "--scene", sound.push_scene, "-o", target],
        ["identify", "friction", recording, "--scene", sound.push_scene, "-o", work / "p.yaml",
         "--report", target],
        ["import", recording, "--format", "tum", "-o", target],
        ["evaluate", recording, "-o", target]])
    # Relative paths are relative to the command's working folder, the private copy.
    return Trial(f"-o {target!s:.60} {' '.join(force)} ({args[0]})", args + force,
                 [recording, work / "mine"], None, prefix=f"cd '{recording}';", must_fail=True)


def limited_resources(rng, sound, work):
    output = work / "output"
    prefix = rng.choice(["ulimit -v 520000;", "ulimit -v 600000;", "ulimit -n 12;", "ulimit -f 8;",
                         "ulimit -u 1; ulimit -v 900000;", "export LC_ALL=de_DE.UTF-8;",
                         "export LC_ALL=tr_TR.UTF-8 LANG=C;", "export HOME=/nowhere;",
                         "exec 2>/dev/full;", "exec 1>/dev/full;", "exec 1>&-;"])
    args = rng.choice([["build", sound.images, "-o", output],
                       ["replay", sound.push, "--scene", sound.push_scene, "--tracked",
                        sound.push / "tracked", "-o", output],
                       ["simulate", "press", "--no-images", "-o", output]])
    # A summary that can't be printed is an error after the output was committed.
    checked = None if "1>" in prefix else output
    return Trial(f"{prefix} {args[0]}", args, [], checked, prefix=f"trap '' XFSZ; {prefix}")


def ended_early(rng, sound, work):
    output = work / "output"
    args = rng.choice([["build", sound.images, "-o", output],
                       ["replay", sound.push, "--scene", sound.push_scene, "--tracked",
                        sound.push / "tracked", "-o", output],
                       ["simulate", "probe", "--no-images", "-o", output]])
    return Trial(f"SIGTERM to {args[0]}", args, [], output, kill_after=rng.uniform(0.05, 1.5))


# Data that contradict each other ----------------------------------------------------------------


def scale_numbers(path, pattern, factor):
    """Multiplies the number in the first group of each match."""
    text = path.read_text()
    changed = re.sub(pattern, lambda m: m.group(0).replace(
        m.group(1), f"{float(m.group(1)) * factor:.9g}"), text)
    assert changed != text, pattern
    replace_file(path, changed)


def scale_mesh(recording, factor):
    for path in files_of(recording / "objects", ".obj"):
        lines = [f"v {' '.join(f'{float(x) * factor:.9g}' for x in line.split()[1:4])}"
                 if line.startswith("v ") else line for line in path.read_text().split("\n")]
        replace_file(path, "\n".join(lines))


def scale_columns(path, first, last, factor, separator):
    lines = []
    for line in path.read_text().split("\n"):
        cells = line.split(separator)
        try:
            cells[first:last] = [f"{float(x) * factor:.9g}" for x in cells[first:last]]
        except ValueError:
            pass
        lines.append(separator.join(cells))
    replace_file(path, "\n".join(lines))


def contradiction(rng, sound, work):
    factor = rng.choice([0.001, 0.2, 0.5, 1 / 1.6, 1.6, 2.0, 5.0, 1000.0])
    kind = rng.choice(["tag size", "depth scale", "focal length", "CAD", "poses", "tool"])
    if kind == "tool":
        # Units only: other factors can't be distinguished from another tool motion.
        factor = rng.choice([1000.0, 0.001])
        recording = sound.copy(sound.push, work)
        scale_columns(recording / "tool.csv", 1, 4, factor, ",")
        output = work / "output.yaml"
        args = ["identify", "friction", recording, "--scene", sound.push_scene, "--tracked",
                recording / "tracked", "-o", output]
        return Trial(f"tool.csv times {factor:g}", args, [recording], output,
                     is_contradiction=True)
    recording = sound.copy(sound.images, work)
    manifest = recording / "recording.yaml"
    if kind == "tag size":
        scale_numbers(manifest, r"size: ([0-9.]+)", factor)
    elif kind == "depth scale":
        scale_numbers(manifest, r"depth_scale: ([0-9.]+)", factor)
    elif kind == "focal length":
        scale_numbers(manifest, rng.choice([r"fx: ([0-9.]+)", r"f[xy]: ([0-9.]+)"]), factor)
    elif kind == "CAD":
        scale_mesh(recording, factor)
    else:
        trajectory = recording / "truth" / "camera.txt"
        target = recording / "groundtruth.txt"
        os.link(trajectory, target)
        scale_columns(target, 1, 4, factor, " ")
    output = work / "output"
    return Trial(f"{kind} times {factor:.3g}", ["build", recording, "-o", output], [recording],
                 output, is_contradiction=True)


# name: (weight, function)
FAULTS = {
    "manifest value": (0.16, recording_fault(corrupt_manifest_value, "manifest")),
    "table cell": (0.14, recording_fault(corrupt_table_cell, "table")),
    "table rows": (0.10, recording_fault(corrupt_table_rows, "table")),
    "bytes": (0.10, recording_fault(corrupt_bytes, "bytes")),
    "kind of file": (0.06, recording_fault(corrupt_kind_of_file, "file")),
    "CAD": (0.06, recording_fault(corrupt_mesh, "CAD")),
    "scene": (0.08, corrupted_scene),
    "run": (0.05, corrupted_run),
    "parameters": (0.04, corrupted_parameters),
    "option": (0.06, odd_option),
    "output": (0.05, odd_output),
    "limits": (0.03, limited_resources),
    "ended early": (0.02, ended_early),
    "contradiction": (0.05, contradiction),
}
