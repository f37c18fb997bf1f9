#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of a tutorial, its indented blocks, one after the other in a folder that has of the
sources' folders bench, include and samples alone.

    follow_tutorial.py COMMAND TUTORIAL.md [FILE:OBJECT:KEY=VALUE ...]   # the built pcavr

Afterwards each KEY of OBJECT in the parameter FILE has to be within three of its stds of VALUE. Exit code 77,
skipped: a package of npm can't be installed.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
MAX_STDS = 3.0


def blocks_of(text):
    """The indented blocks, without their indent."""
    blocks, lines = [], []
    for line in [*text.splitlines(), "end"]:
        if line.startswith("    "):
            lines.append(line[4:])
        elif lines and line:
            blocks.append("\n".join(lines))
            lines = []
    return blocks


def run(block, folder, command):
    path = f"{pathlib.Path(command).resolve().parent}:{os.environ['PATH']}"
    return subprocess.run(["bash", "-euo", "pipefail", "-c", block], cwd=folder, env={**os.environ, "PATH": path},
                          capture_output=True, text=True, check=False)


def faults_of(folder, expectation):
    """The first difference from FILE:OBJECT:KEY=VALUE, or none."""
    file, name, key, value = re.fullmatch(r"(.+):(.+):(.+)=(.+)", expectation).groups()
    text = (folder / file).read_text()
    own = re.search(rf"^{name}:\n((?:  .*\n)+)", text, re.MULTILINE)[1]
    found = float(re.search(rf"^  {key}: (\S+)", own, re.MULTILINE)[1])
    std = float(re.search(rf"^  {key}_std: (\S+)", own, re.MULTILINE)[1])
    print(f"{expectation}: {found:.4g} +- {std:.2g}")
    return abs(found - float(value)) > MAX_STDS * std


def main(command, tutorial, expectations):
    blocks = blocks_of(pathlib.Path(tutorial).read_text())
    if len(blocks) < 3:
        sys.exit(f"only {len(blocks)} blocks of commands in {tutorial}: has its form changed?")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for name in ("bench", "include", "samples"):
            (folder / name).symlink_to(ROOT / name)
        for block in blocks:
            done = run(block, folder, command)
            print(f"{block}\n{done.stdout[-600:]}{done.stderr[-600:]}")
            if done.returncode != 0 and "npm install" in block.splitlines()[0]:
                return SKIPPED
            if done.returncode != 0:
                return 1
        return int(any([faults_of(folder, expectation) for expectation in expectations]))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], sys.argv[3:]))
