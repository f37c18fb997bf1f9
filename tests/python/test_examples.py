# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""The examples, and the one in docs/python.md, run as they stand."""
import re
import shutil

import numpy as np
import pytest

import pcavr
from conftest import EXAMPLES, SOURCE, run_script


@pytest.fixture(scope="module")
def work(box_1, tmp_path_factory):
    """A folder with the files that the examples read."""
    folder = tmp_path_factory.mktemp("work")
    np.savez(folder / "push.npz", t_tool=box_1.tool[0], tool=box_1.tool[1], t_force=box_1.wrench[0],
             force=box_1.wrench[1], t_box=box_1.tracked[0], box=box_1.tracked[1], mass=box_1.mass,
             tool_radius=box_1.tool_radius)
    shutil.copy(box_1.cad, folder / "box.obj")
    pcavr.write_parameters(folder / "parameters.yaml", {"box": box_1.identify().parameters})
    return folder


@pytest.mark.parametrize("arguments, printed", [
    ("identify_friction.py", r"mu = 0\.\d{3} \+- 0\.\d{3}"),
    ("predict_push.py", r"pushed \d+\.\d mm, error \d\.\d mm"),
])
def test_examples(work, arguments, printed):
    done = run_script(EXAMPLES / arguments, work)
    assert done.returncode == 0, done.stderr
    assert re.fullmatch(printed + "\n", done.stdout)


def test_example_that_writes(work, tmp_path, command):
    script = f"import sys; sys.argv[1:] = [{str(tmp_path / 'r')!r}]\n"
    (tmp_path / "script.py").write_text(script + (EXAMPLES / "write_recording.py").read_text())
    done = run_script(tmp_path / "script.py", work)
    assert done.returncode == 0 and "poses of the tool" in done.stdout, done.stderr
    assert command("inspect", tmp_path / "r").returncode == 0


def test_example_of_the_document(work, tmp_path):
    [block] = re.findall(r"```python\n(.*?)```", (SOURCE / "docs" / "python.md").read_text(), re.DOTALL)
    assert len(block.splitlines()) <= 15
    (tmp_path / "script.py").write_text(block)
    done = run_script(tmp_path / "script.py", work)
    assert done.returncode == 0 and re.match(r"mu = 0\.\d{3}", done.stdout), done.stderr
