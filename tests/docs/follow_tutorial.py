#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of a page, its indented blocks, one after the other in a folder that has of the sources'
folders bench, include and samples alone. `pcavr serve` without a port is ended as by Ctrl-C.

    follow_tutorial.py COMMAND PAGE.md [--before FILE] [--leave-out REGEX] [FILE:OBJECT:KEY=VALUE ...]

COMMAND: the built pcavr. --before: a script that first makes what the page takes as given,
from the sources in PCAVR_SOURCE. --leave-out: lines that are
run elsewhere, or are no commands. Afterwards each KEY of OBJECT in the parameter FILE has to be within three of its stds
of VALUE. Exit code 77, skipped: a package of npm can't be installed.
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

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


# As a user's pcavr, but that `serve` takes a free port, and ends when it has said where it is.
ENDING_COMMAND = """#!/bin/sh
command='{}'
case "$1 $* " in serve*" --port "*) exec "$command" "$@" ;; serve*) ;; *) exec "$command" "$@" ;; esac
printed=$(mktemp)
"$command" "$@" --port 0 > "$printed" 2>&1 & server=$!
while kill -0 "$server" 2> /dev/null && ! grep -q '^open ' "$printed"; do sleep 0.1; done
kill -INT "$server" 2> /dev/null
wait "$server"
status=$?
cat "$printed"
rm "$printed"
exit "$status"
"""


def write_command(command, folder):
    folder.mkdir()
    script = folder / "pcavr"
    script.write_text(ENDING_COMMAND.format(pathlib.Path(command).resolve()))
    script.chmod(0o755)


def without(block, left_out):
    """A block without the commands that match; a command may go on over lines that end in a backslash."""
    commands = re.findall(r"(?:.*\\\n)*.*\n?", block)
    return "".join(each for each in commands if not (left_out and re.search(left_out, each)))


def run(block, folder):
    path = f"{folder / '.command'}:{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "PCAVR_SOURCE": str(ROOT)}
    return subprocess.run(["bash", "-euo", "pipefail", "-c", block], cwd=folder, env=environment,
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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command")
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("--before", type=pathlib.Path)
    parser.add_argument("--leave-out")
    parser.add_argument("expectations", nargs="*")
    given = parser.parse_intermixed_args()
    blocks = blocks_of(given.page.read_text())
    if len(blocks) < 3:
        sys.exit(f"only {len(blocks)} blocks of commands in {given.page}: has its form changed?")
    blocks = [block for block in (without(each, given.leave_out) for each in blocks) if block.strip()]
    if given.before:
        blocks.insert(0, given.before.read_text())
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        write_command(given.command, folder / ".command")
        for name in ("bench", "include", "samples"):
            (folder / name).symlink_to(ROOT / name)
        for block in blocks:
            begin = time.monotonic()
            done = run(block, folder)
            print(f"{block}\n{done.stdout[-600:]}{done.stderr[-600:]}({time.monotonic() - begin:.1f} s)\n")
            if done.returncode != 0 and "npm install" in block.splitlines()[0]:
                return SKIPPED
            if done.returncode != 0:
                print(f"exit code {done.returncode}")
                return 1
        return int(any([faults_of(folder, expectation) for expectation in given.expectations]))


if __name__ == "__main__":
    sys.exit(main())
