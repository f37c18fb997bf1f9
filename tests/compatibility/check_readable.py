#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Does this version read what earlier ones wrote? VERSION.tar.xz beside this file has a recording, its scene,
parameters and a run, as that version's commands wrote them; a release adds its own:

    pcavr simulate push --no-images --seed 5 --objects 1 --duration 2 -o recording
    pcavr build recording -o scene
    pcavr identify friction recording --scene scene -o parameters.yaml
    pcavr replay recording --scene scene --parameters parameters.yaml \\
        --forward-delay 0.1 --backward-delay 0.1 -o run

    check_readable.py COMMAND            # the built pcavr
"""
import json
import pathlib
import subprocess
import sys
import tarfile
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ERROR = "predicted.touched.translation.rmse_m"
MAX_ERROR = 0.005  # m, of a prediction by those parameters: another meaning of one of them exceeds it


def run(command, folder, *arguments):
    done = subprocess.run([command, *arguments], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"pcavr {' '.join(arguments)}: exit code {done.returncode}: {done.stderr}")


def error_of(folder, report):
    found = json.loads((folder / report / "report.json").read_text())
    return max(value for key, value in found.items() if key.endswith(ERROR))


def check(command, archive):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        with tarfile.open(archive) as packed:
            packed.extractall(folder)
        for what in ("recording", "scene", "run"):
            run(command, folder, "inspect", what)
        run(command, folder, "evaluate", "run", "--truth", "recording/truth", "-o", "of_then")
        run(command, folder, "replay", "recording", "--scene", "scene", "--parameters", "parameters.yaml",
            "--no-corrections", "-o", "again")
        run(command, folder, "evaluate", "again", "--truth", "recording/truth", "-o", "of_now")
        then, now = error_of(folder, "of_then"), error_of(folder, "of_now")
        print(f"{archive.name}: position error {1e3 * then:.2f} mm as written, {1e3 * now:.2f} mm replayed")
        return max(then, now) < MAX_ERROR


def main(command):
    archives = sorted(HERE.glob("*.tar.xz"))
    if not archives:
        sys.exit(f"{HERE}: no files of earlier versions")
    return 0 if all([check(command, archive) for archive in archives]) else 1


if __name__ == "__main__":
    sys.exit(main(str(pathlib.Path(sys.argv[1]).resolve())))
