# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Identifies mu of a pushed box from arrays: push.npz has the series, box.obj the box."""
import numpy as np

import pcavr

push = np.load("push.npz")
found = pcavr.identify(
    tool=(push["t_tool"], push["tool"]),           # (N,) s, (N, 7) x y z m, qx qy qz qw
    wrench=(push["t_force"], push["force"]),       # (M,) s, (M, 3) N that the tool exerts
    tracked=(push["t_box"], push["box"]),          # (K,) s, (K, 7)
    cad="box.obj", mass=float(push["mass"]), tool_radius=float(push["tool_radius"]))
mu = found["sliding_friction_coefficient"]
print(f"mu = {mu.value:.3f} +- {mu.std:.3f}" if mu.is_excited else mu.remark)
