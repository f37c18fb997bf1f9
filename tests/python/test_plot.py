# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""pcavr.plot draws what the arrays have; skipped without matplotlib."""
import math
import pathlib

import numpy as np
import pytest

import pcavr
import pcavr.plot

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")


def test_push_draws_every_sample(push):
    force, distance = pcavr.plot.push(push)
    assert [line.get_xdata().size for line in force.lines] == [len(push.wrench)] * 3
    assert [line.get_label() for line in distance.lines] == ["tip", *push.tracked]
    box = distance.lines[1].get_ydata()
    expected = 1e3 * math.dist(push.tracked["box_1"].positions[0], push.tracked["box_1"].positions[-1])
    assert box[0] == 0 and math.isclose(box[-1], expected)


def test_values_names_what_is_not_excited(tmp_path):
    axes = pcavr.plot.values({"one": pcavr.Value(0.3, 0.01), "two": pcavr.Value(0.4, 0.01),
                              "three": None}, "mu")
    assert [label.get_text() for label in axes.get_yticklabels()] == ["one", "two", "three (not excited)"]
    assert np.isclose(axes.lines[0].get_xdata()[0], 0.35)
    axes.figure.savefig(tmp_path / "values.png")
    assert pathlib.Path(tmp_path / "values.png").stat().st_size > 1000
