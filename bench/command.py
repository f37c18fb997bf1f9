# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""What the scripts of this folder share: pcavr's command, and the arguments of judges of recordings."""
import argparse
import json
import pathlib
import subprocess


def run(*words):
    """What a command of pcavr reports with --json."""
    words = [str(word) for word in words]
    done = subprocess.run([*words, "--json"], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(words)}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def recordings_parser(description, work):
    """Of scripts that judge the recordings below a folder, and write below `work`."""
    parser = argparse.ArgumentParser(description=description,
                                     formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path, required=True)
    parser.add_argument("--pcavr", default="build/test/apps/pcavr/pcavr")
    parser.add_argument("--only", default="", help="regular expression of the names that are judged")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path(work))
    return parser
