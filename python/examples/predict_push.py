# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Predicts a box that the recorded tool pushes, step by step of 1 ms, and compares it with tracking."""
import numpy as np

import pcavr

push = np.load("push.npz")
known = pcavr.read_parameters("parameters.yaml")["box"]
body = pcavr.Body("box", "box.obj", push["box"][0], known)
t_tool, tips = push["t_tool"], push["tool"][:, :3]
world = pcavr.World([body], tips[0], tool_radius=float(push["tool_radius"]), start=float(t_tool[0]))
steps = np.arange(t_tool[0], t_tool[-1], 0.001) + 0.001
for tip in np.stack([np.interp(steps, t_tool, tips[:, axis]) for axis in range(3)], axis=1):
    world.step(tip)
error = np.linalg.norm(world.pose("box")[:2] - push["box"][-1, :2])
pushed = np.linalg.norm(push["box"][-1, :2] - push["box"][0, :2])
print(f"pushed {1e3 * pushed:.1f} mm, error {1e3 * error:.1f} mm")
