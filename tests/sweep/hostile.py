# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Hostile inputs of commands that faults.py does not run: bags, arms and their logs, meshes of other
types, and what the live programs start with. Each function corrupts a private copy of sound inputs
and returns the Trial that uses it. All randomness comes from the given generator."""
import pathlib
import re

import sources
from faults import ODD_NUMBERS, files_of, replace_file, with_flags
from trial import Trial

CORPUS = pathlib.Path(__file__).resolve().parent.parent / "fuzz" / "corpus"
LIVE_TIME = 2.0  # [s] of a live program whose inputs are accepted
FIRST_PORT = 21000
ODD_WORDS = [b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\0\0\0\x80", b"\0\0\0\0", b"\x1b[31m",
             "\u202e".encode(), b"\0"]


def mutated(rng, content):
    """The bytes with one to three changes."""
    content = bytearray(content)
    for _ in range(rng.randint(1, 3)):
        at = rng.randrange(len(content) + 1)
        kind = rng.choice(["flip", "flip", "word", "word", "number", "cut", "remove", "repeat"])
        numbers = list(re.finditer(rb"-?\d+(\.\d+)?", bytes(content))) if kind == "number" else []
        if kind == "flip":
            for _ in range(rng.randint(1, 20)):
                if content:
                    content[rng.randrange(len(content))] = rng.randrange(256)
        elif kind == "word":
            word = rng.choice(ODD_WORDS)
            content[at: at + len(word)] = word
        elif numbers:
            chosen = rng.choice(numbers)
            content[chosen.start(): chosen.end()] = rng.choice(ODD_NUMBERS).encode()
        elif kind == "cut":
            del content[at:]
        elif kind == "remove":
            del content[at: at + rng.randint(1, 200)]
        elif kind == "repeat":
            content[at:at] = content[max(0, at - rng.randint(1, 2000)): at]
    return bytes(content)


def mutate_file(rng, path):
    replace_file(path, mutated(rng, path.read_bytes()))


def mutated_bag(rng, sound, work):
    kind = rng.choice(["folder", "folder", "mcap", "ros1_bag", "sqlite_bag"])
    if kind == "folder":
        bag = sound.copy(sound.bag, work)
        path = bag / rng.choice(["bag.db3", "bag.db3", "metadata.yaml"])
    else:
        seed = rng.choice(sorted((CORPUS / kind).iterdir()))
        ending = {"mcap": "mcap", "ros1_bag": "bag", "sqlite_bag": "db3"}[kind]
        bag = path = work / f"hostile.{ending}"
        path.write_bytes(seed.read_bytes())
    mutate_file(rng, path)
    output = work / "output"
    args, output = rng.choice([
        (["inspect", bag], None),
        (["import", bag, "-o", output], output),
        (["import", bag, "-o", output, "--tool-topic", "/tip", "--wrench-topic", "/ft"], output)])
    return Trial(f"bag: {kind}, {path.name}, {args[0]}", with_flags(rng, args), [bag], output)


def mutated_arm(rng, sound, work):
    arm = sound.copy(sound.arm, work)
    path = arm / rng.choice(["arm.urdf", "joints.csv"])
    mutate_file(rng, path)
    output = work / "output"
    kind = rng.choice(["identify", "identify", "import", "predict"])
    args = {
        "identify": ["identify", "robot", arm / "joints.csv", "--robot", arm / "arm.urdf", "-o", output]
        + rng.choice([[], ["--skip-bad"], ["--known-body"]]),
        "import": ["import", arm / "joints.csv", "-o", output],
        "predict": ["predict", "reach", "--robot", arm / "arm.urdf", "--identified",
                    sound.arm_report, "--point", "0.5", "0.3", "0.3", "--time", "1"],
    }[kind]
    output = None if kind == "predict" else output
    return Trial(f"arm: {path.name}, {kind}", with_flags(rng, args), [arm], output)


def mutated_mesh(rng, sound, work):
    recording = sound.copy(sound.push, work)
    first = files_of(recording / "objects", ".obj")[0]
    ending = rng.choice(["stl", "ply", "dae", "glb", "glb"])
    if ending == "glb":
        content = files_of(sound.push_scene / "objects", ".glb")[0].read_bytes()
    else:
        write = {"stl": sources.stl_of, "ply": sources.ply_of, "dae": sources.dae_of}[ending]
        content = write(*sources.triangles_of(first.read_text()))
    first.with_suffix("." + ending).write_bytes(mutated(rng, content))
    manifest = recording / "recording.yaml"
    replace_file(manifest, manifest.read_text().replace(first.name, f"{first.stem}.{ending}"))
    output = work / "output"
    return Trial(f"mesh: .{ending}", with_flags(rng, ["build", recording, "-o", output]),
                 [recording], output)


def mutated_live(rng, sound, work):
    """A live program that starts with a corrupted scene, parameter file or recording."""
    scene, parameters, recording = (sound.copy(source, work) for source in (
        sound.push_scene, sound.parameters, sound.push))
    victim = rng.choice(["scene", "scene", "parameters", "recording"])
    path = {"scene": rng.choice(files_of(scene, "")), "parameters": parameters,
            "recording": rng.choice(files_of(recording, ".csv", ".txt", ".yaml"))}[victim]
    mutate_file(rng, path)
    with_recording = victim == "recording"
    kind = rng.choice(["serve", "robot-site", "operator-site"])
    port = FIRST_PORT + rng.randrange(20000)
    args = {
        "serve": ["serve", scene, "--parameters", parameters, "--port", "0"]
        + (["--replay", recording, "--tracked", recording / "tracked"] if with_recording else []),
        "robot-site": ["robot-site", scene, "--parameters", parameters, "--port", port]
        + (["--recording", recording, "--tracked", recording / "tracked"] if with_recording
           else ["--plant", "push", "--seed", "12"]),
        "operator-site": ["operator-site", scene, "--parameters", parameters, "--port", port,
                          "--page-port", "0"]
        + (["--trace", recording] if with_recording else []),
    }[kind]
    return Trial(f"live: {victim} {path.name}, {kind}", args, [scene, parameters, recording],
                 kill_after=LIVE_TIME)


# name: (share of the trials, function)
HOSTILE = {
    "bag": (0.10, mutated_bag),
    "arm": (0.06, mutated_arm),
    "mesh type": (0.06, mutated_mesh),
    "live": (0.08, mutated_live),
}
