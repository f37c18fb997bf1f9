# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""pip installs the package into an environment without the network."""
import os
import subprocess
import sys

import pytest

from conftest import SOURCE

pytestmark = pytest.mark.slow


def run(*arguments, **environment):
    kept = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run([str(each) for each in arguments], env={**kept, **environment},
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_installed_package_runs_and_sources_stay_clean(tmp_path):
    before = {path for path in (SOURCE / "python").rglob("*") if "__pycache__" not in path.parts}
    environment = tmp_path / "environment"
    run(sys.executable, "-m", "venv", "--system-site-packages", environment)
    run(environment / "bin" / "pip", "install", "--no-build-isolation", "--no-index", "--no-deps",
        SOURCE / "python", PCAVR_BUILD_DIR=os.environ["PCAVR_BUILD_DIR"])
    printed = run(environment / "bin" / "python", "-c",
                  "import pcavr; print(pcavr.__file__, pcavr.tag_families()[0])")
    assert printed.startswith(str(environment))
    listed = run(environment / "bin" / "pip", "show", "--files", "pcavr")
    assert "pcavr/py.typed" in listed and "pcavr/_pcavr.pyi" in listed
    assert {path for path in (SOURCE / "python").rglob("*") if "__pycache__" not in path.parts} == before
