#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that the documents state the versions of the protocols and the checks that the scripts run.

    check_versions.py [ROOT]             # default: this repository
"""
import pathlib
import re
import sys

# What a document states, and where the code has it: (file, expression) with one group each.
VERSIONS = [
    ("the link's version", ("docs/link.md", r"\| u8 \| version: (\d+) \|"),
     ("include/pcavr/teleoperation/link/link_message.hpp", r"kLinkVersion = (\d+);")),
    ("the link's version in the changelog", ("CHANGELOG.md", r"`pcavr-link/(\d+)`"),
     ("include/pcavr/teleoperation/link/link_message.hpp", r"kLinkVersion = (\d+);")),
    ("the page's protocol", ("docs/live-protocol.md", r'"protocol": (\d+)'),
     ("apps/viewer/src/protocol.ts", r"protocolVersion = (\d+);")),
    ("the time limit of clang-tidy", ("CONTRIBUTING.md", r"for at most (\d+) seconds"),
     (".ci/run", r"check-tidy --seconds (\d+)")),
    ("the version of the packages", ("packaging/changelog", r"pcavr \(([\d.]+)-"),
     ("CMakeLists.txt", r"project\(pcavr VERSION ([\d.]+)")),
]


def found(root, file, expression):
    match = re.search(expression, (root / file).read_text())
    return match[1] if match else None


def version_faults(root):
    for what, document, code in VERSIONS:
        stated, actual = found(root, *document), found(root, *code)
        if stated is None or stated != actual:
            yield f"{document[0]}: {what}: states {stated}, {code[0]} has {actual}"


def nightly_faults(root):
    """Scripts that the table of CONTRIBUTING.md has in its nightly column and .ci/nightly does not run, and others."""
    rows = [line.split("|") for line in (root / "CONTRIBUTING.md").read_text().splitlines() if line.startswith("|")]
    stated = {script for row in rows if len(row) > 3 for script in re.findall(r"bench/[\w/]+\.py", row[3])}
    run = set(re.findall(r"bench/[\w/]+\.py", (root / ".ci/nightly").read_text()))
    for script in sorted(stated ^ run):
        where = "CONTRIBUTING.md" if script in run else ".ci/nightly"
        yield f"{where}: {script} is missing"


def main(root):
    faults = [*version_faults(root), *nightly_faults(root)]
    print("\n".join(faults) or f"{len(VERSIONS)} versions and the nightly scripts are as stated")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2]))
