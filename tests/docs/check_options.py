#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that the options which README.md, docs/ and the modules' pages name are those of the command:
--OPTION of any of its commands (or of a script in bench/), `SECTION.KEY` of a configuration file.

    check_options.py COMMAND [ROOT]      # the built pcavr; default: this repository
"""
import pathlib
import re
import subprocess
import sys

COMMAND_NAME = re.compile(r"^  ([a-z][a-z-]+)  ", re.MULTILINE)
FLAG = re.compile(r"(?<![\w-])--[a-z][a-z0-9-]+")
DOTTED = re.compile(r"`([a-z]\w*(?:\.[a-z]\w*)+)`")
# Commands of other programs: in a block, and scripts of this repository in a text.
OTHER_COMMAND = re.compile(r"^ {4}(?:sudo )?(?:\S*/)?(?:cmake|docker|pip|python3) .*$|`scripts/[^`]*`", re.MULTILINE)
FILE_SUFFIXES = set("csv glb jsonl json mcap mp4 ply png scene sdf svg txt urdf usda xml yaml".split())


def output_of(command, *arguments):
    run = subprocess.run([command, *arguments], capture_output=True, text=True, check=False)
    if run.returncode != 0:
        sys.exit(f"{command} {' '.join(arguments)}: exit code {run.returncode}: {run.stderr.strip()}")
    return run.stdout


def help_of(command, *subcommands):
    """The help of a command and of its subcommands."""
    text = output_of(command, *subcommands, "--help")
    _, _, commands = text.partition("\nSubcommands:")
    return text + "".join(help_of(command, *subcommands, name) for name in COMMAND_NAME.findall(commands))


def sections_of(command):
    """The keys of a configuration file by section."""
    sections, keys = {}, set()
    for line in output_of(command, "--print-config").splitlines():
        if section := re.match(r"([a-z][\w.]*):", line):
            keys = sections.setdefault(section[1], set())
        elif key := re.match(r"  ([a-z]\w*):", line):
            keys.add(key[1])
    return sections


def is_option(name, sections):
    """Whether a dotted name is one of an option, or none that could be."""
    families = {section.split(".")[0] for section in sections}
    section, _, key = name.rpartition(".")
    return (name.split(".")[0] not in families or key in FILE_SUFFIXES or name in sections
            or key in sections.get(section, ()))


def main(command, root):
    flags = set(FLAG.findall(help_of(command)))
    for script in (root / "bench").rglob("*.py"):
        flags |= set(FLAG.findall(script.read_text()))
    sections = sections_of(command)
    if len(flags) < 50 or len(sections) < 50:
        sys.exit(f"only {len(flags)} options and {len(sections)} sections found: has their format changed?")
    faults = []
    for page in [root / "README.md", *sorted((root / "docs").glob("*.md")), *sorted((root / "src").rglob("README.md"))]:
        text = OTHER_COMMAND.sub("", page.read_text())
        faults += [f"{page}: no command has {flag}" for flag in sorted(set(FLAG.findall(text)) - flags)]
        faults += [f"{page}: no section has {name}" for name in sorted(set(DOTTED.findall(text)))
                   if not is_option(name, sections)]
    print("\n".join(faults) or f"{len(flags)} options, {len(sections)} sections: the pages name no others")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).parents[2])))
