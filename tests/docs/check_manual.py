#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that each subcommand has its manual page, and that completion offers its options.

    check_manual.py COMMAND MANUAL       # the built pcavr; the folder that make-command-pages wrote
"""
import gzip
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

BASH = """
source "$1"
shift
COMP_WORDS=(pcavr "$@")
COMP_CWORD=$#
_pcavr
printf '%s\\n' "${COMPREPLY[@]}"
"""


def with_commands(command, above=()):
    """[(full name as a tuple, command)] of a command and all below it."""
    name = (*above, command["name"])
    return [(name, command)] + [one for each in command["commands"] for one in with_commands(each, name)]


def flags_of(command):
    return {flag for option in command["options"] for flag in option["names"]}


def page_faults(name, command, folder):
    page = folder / "man1" / f"{'-'.join(name)}.1.gz"
    if not page.exists():
        yield f"{page.name} is missing"
        return
    text = gzip.decompress(page.read_bytes()).decode().replace("\\-", "-")
    yield from (f"{page.name} has no {flag}" for flag in sorted(flags_of(command)) if flag not in text)
    with tempfile.NamedTemporaryFile(suffix=".1") as plain:
        plain.write(gzip.decompress(page.read_bytes()))
        plain.flush()
        for checker in (["lexgrog"], ["mandoc", "-T", "lint", "-W", "error"]):
            if shutil.which(checker[0]):
                run = subprocess.run([*checker, plain.name], capture_output=True, text=True, check=False)
                if run.returncode != 0:
                    yield f"{page.name}: {checker[0]}: {run.stdout}{run.stderr}"


def bash_offers(folder, words):
    run = subprocess.run(["bash", "-c", BASH, "bash", folder / "completions" / "pcavr", *words],
                         capture_output=True, text=True, check=True)
    return set(run.stdout.split())


def bash_faults(name, command, folder):
    missing = flags_of(command) - bash_offers(folder, [*name[1:], "-"])
    missing |= {each["name"] for each in command["commands"]} - bash_offers(folder, [*name[1:], ""])
    yield from (f"bash: '{' '.join(name)}' does not offer {word}" for word in sorted(missing))


def shell_faults(folder):
    """What zsh and fish state of their files, where these shells are installed."""
    completions = folder / "completions"
    for shell in (["zsh", "-n", completions / "_pcavr"], ["fish", "--no-execute", completions / "pcavr.fish"]):
        if shutil.which(shell[0]):
            run = subprocess.run(shell, capture_output=True, text=True, check=False)
            if run.returncode != 0 or run.stderr:
                yield f"{shell[0]}: {run.stderr}"
    if shutil.which("fish"):
        line = f"source {completions / 'pcavr.fish'}; complete -C 'pcavr identify friction --sce'"
        run = subprocess.run(["fish", "--no-config", "-c", line], capture_output=True, text=True, check=False)
        if "--scene" not in run.stdout:
            yield f"fish: --scene is not offered: {run.stdout}{run.stderr}"


def main(command, folder):
    described = subprocess.run([command, "--describe-commands"], capture_output=True, text=True, check=True)
    commands = with_commands(json.loads(described.stdout))
    if len(commands) < 20:
        sys.exit(f"only {len(commands)} commands found: has their description changed?")
    faults = list(shell_faults(folder))
    for name, each in commands:
        faults += [*page_faults(name, each, folder), *bash_faults(name, each, folder)]
    values = bash_offers(folder, ["import", "--format", ""])
    if "7scenes" not in values:
        faults.append(f"bash: import --format offers {values}")
    print("\n".join(faults) or f"{len(commands)} commands have their pages, and bash offers their options")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], pathlib.Path(sys.argv[2])))
