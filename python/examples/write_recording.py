# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Writes arrays as a recording folder, which the command and all functions read."""
import sys

import numpy as np

import pcavr

push = np.load("push.npz")
box = pcavr.Object("box", "box.obj", mass=float(push["mass"]), pose=push["box"][0])
pcavr.write_recording(
    sys.argv[1], objects=[box], tool_radius=float(push["tool_radius"]),
    tool=(push["t_tool"], push["tool"]), wrench=(push["t_force"], push["force"]),
    tracked={"box": (push["t_box"], push["box"])})
recording = pcavr.read_recording(sys.argv[1])
print(f"{len(recording.tool)} poses of the tool, {len(recording.wrench)} forces")
