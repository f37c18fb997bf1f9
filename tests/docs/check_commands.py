#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that the command accepts what the pages write: each `pcavr ...` of their blocks, and of a text where it has
options, is parsed by the command, with --print-config in place of its work. And that of each page with a block the table
below says what runs it.

    check_commands.py COMMAND [ROOT]     # the built pcavr; default: this repository
"""
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

# What runs the blocks of a page: follow_tutorial.py of tests/e2e/CMakeLists.txt, or
RUN_BY = {
    "docs/start.md": "demo",
    "docs/install.md": "scripts/check-packages",
    "docs/python.md": "tests/python/test_install.py, test_examples.py",
    "docs/bags.md": "parsed here; tests/e2e/import_bag_test.cpp runs the like on its own bags",
    "docs/calibrate.md": "parsed here; tests/e2e/calibrate_test.cpp runs the like on its own rigs",
    "docs/export.md": "parsed here; tests/e2e/export_command_test.cpp runs the like",
    "docs/page.md": "tests/browser: tiles",
    "docs/record.md": "parsed here; tests/e2e/record_test.cpp runs the like",
    "docs/configuration.md": "parsed here; tests/e2e/configuration_test.cpp runs the like",
    "docs/doctor.md": "parsed here; tests/e2e/consistency_command_test.cpp runs the like",
    "docs/device-plugin.md": "parsed here; your-force-device.md runs the like",
    "docs/robot-plugin.md": "parsed here; your-robot.md runs the like",
    "docs/ros2.md": "parsed here; tests/ros2 runs the like",
    "docs/vr.md": "parsed here; tests/browser runs the like",
    "docs/engines.md": ".ci/nightly",
    "docs/scale.md": "parsed here; tests/e2e/tiles_test.cpp runs the like",
    "docs/judged.md": "parsed here; .ci/nightly and tests/e2e/calibrate_test.cpp run the like on shared recordings",
    "CONTRIBUTING.md": ".ci/run, .ci/nightly",
}
END_OF_COMMAND = {"&&", "||", "|", "&", ";", ">", ">>", "2>&1", "<", ")"}
OTHER_PROGRAM = re.compile(r"import pcavr|find_package\(|docker build ")  # of which pcavr is an argument


def blocks_of(text):
    """The indented and the fenced blocks, without their indent and with continued lines as one."""
    indented = re.findall(r"(?:^|\n\n)((?:    .*\n|\n(?=    ))+)", text)
    fenced = re.findall(r"^```\w*\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    blocks = [re.sub(r"^    ", "", block, flags=re.MULTILINE) for block in indented] + fenced
    return [re.sub(r"\\\n\s*", "", block) for block in blocks]


def words_of(line):
    """The words of the pcavr in a line of a shell, or none."""
    if OTHER_PROGRAM.match(line):
        return None
    try:
        lexer = shlex.shlex(line, posix=True, punctuation_chars="();<>|&")
        lexer.whitespace_split = True
        words = list(lexer)
    except ValueError:  # a text with one apostrophe
        return None
    if "pcavr" not in words:
        return None
    words = words[words.index("pcavr") + 1:]
    end = next((i for i, word in enumerate(words) if word in END_OF_COMMAND or word.startswith((">", "2>"))), len(words))
    return words[:end]


def commands_of(text):
    for block in blocks_of(text):
        for line in block.splitlines():
            if (words := words_of(line.removeprefix("$ "))) is not None:
                yield line, words
    for line in re.findall(r"`(pcavr [^`]*--[^`]*)`", re.sub(r"\s*\n\s*", " ", text)):
        words = words_of(line)
        if words and not words[-1].startswith("-"):  # else an option is named, without its value
            yield line, words


def refusal(command, words, folder):
    """What the command says of its command line, or none."""
    (folder / "options.yaml").write_text("build:\n  min_island: 0.001\n")  # --config reads it
    words = [re.sub(r"\$\w+|^NUMBER$", "1", word) for word in words]
    run = subprocess.run([command, *words, "--print-config"], cwd=folder, capture_output=True, text=True, check=False)
    return run.stderr.strip() if run.returncode != 0 else ""


def page_faults(command, root, folder, counts):
    pages = [root / "README.md", root / "CONTRIBUTING.md", *sorted((root / "docs").rglob("*.md"))]
    followed = (root / "tests/e2e/CMakeLists.txt").read_text()
    for page in pages:
        name = str(page.relative_to(root))
        text = page.read_text()
        commands = list(commands_of(text))
        counts.append(len(commands))
        for line, words in commands:
            if fault := refusal(command, words, folder):
                yield f"{name}: {line.strip()}: {fault}"
        has_block = any(words_of(line.removeprefix("$ ")) for block in blocks_of(text) for line in block.splitlines())
        is_followed = name in followed or (page.parent.name == "tutorials" and page.stem in followed)
        if has_block and name not in RUN_BY and not is_followed:
            yield f"{name}: nothing runs its commands: see RUN_BY"


def demo_faults(root):
    """docs/start.md and ./demo do the same: the commands of the page with their options."""
    done = re.sub(r"\\\n\s*", "", (root / "demo").read_text())
    for line, words in commands_of((root / "docs/start.md").read_text()):
        options = {word for word in words if word.startswith("--")}
        like = [each for each in done.splitlines() if re.search(rf'\$pcavr"? {words[0]} ', each)]
        if not any(options <= set(re.findall(r"--[a-z-]+", each)) for each in like):
            yield f"docs/start.md: ./demo has no '{line.strip()}'"


def main(command, root):
    counts = []
    with tempfile.TemporaryDirectory() as folder:
        faults = [*page_faults(str(pathlib.Path(command).resolve()), root, pathlib.Path(folder), counts), *demo_faults(root)]
    if sum(counts) < 80:
        faults.append(f"only {sum(counts)} commands found: has the pages' form changed?")
    print("\n".join(faults) or f"{sum(counts)} commands of {len(counts)} pages are accepted")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).parents[2])))
