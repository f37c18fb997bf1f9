# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings that many tests read, made once."""
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import pcavr

SOURCE = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = SOURCE / "python" / "examples"


@pytest.fixture(scope="session")
def command():
    """Runs the command pcavr in a folder."""
    def run(*arguments, cwd=None):
        return subprocess.run([os.environ["PCAVR_COMMAND"], *map(str, arguments)], cwd=cwd,
                              capture_output=True, text=True, check=False)
    return run


@pytest.fixture(scope="session")
def push_folder(tmp_path_factory):
    """A tool pushes two boxes; without images, with the boxes' tracked poses."""
    folder = tmp_path_factory.mktemp("push") / "recording"
    pcavr.simulate("push", folder, seed=1, images=False)
    return folder


@pytest.fixture(scope="session")
def push(push_folder):
    return pcavr.read_recording(push_folder)


class PushArrays:
    """The arrays of a recording, and of one of its boxes."""

    def __init__(self, recording, box):
        self.tool = (recording.tool.t, recording.tool.poses)
        self.wrench = (recording.wrench.t, np.array(recording.wrench.forces))
        self.tracked = (recording.tracked[box].t, recording.tracked[box].poses)
        entry = next(each for each in recording.objects if each.name == box)
        self.cad = pathlib.Path(recording.folder) / entry.mesh
        self.pose, self.mass, self.tool_radius = entry.pose, entry.mass, recording.tool_radius

    def identify(self, **changed):
        arguments = {"tool": self.tool, "wrench": self.wrench, "tracked": self.tracked, "cad": self.cad,
                     "mass": self.mass, "pose": self.pose, "tool_radius": self.tool_radius, **changed}
        return pcavr.identify(arguments.pop("tool"), arguments.pop("wrench"), arguments.pop("tracked"),
                              arguments.pop("cad"), **arguments)


@pytest.fixture(scope="session")
def box_1(push):
    return PushArrays(push, "box_1")


BOX = (np.array([[x, y, z] for x in (-.05, .05) for y in (-.05, .05) for z in (-.05, .05)]),
       np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6],
                 [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]))


@pytest.fixture(scope="session")
def cube():
    """Vertices and triangles of a cube with edges of 0.1 m."""
    return BOX


def run_script(script, cwd):
    return subprocess.run([sys.executable, str(script)], cwd=cwd, capture_output=True, text=True,
                          check=False)
