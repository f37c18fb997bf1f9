# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Plots of a recording and of identified values, by matplotlib: Debian's python3-matplotlib, which nothing
else of pcavr needs. ImportError without it. Each function draws into the axes it is given, or into
a new figure, and returns the axes; nothing is shown or saved."""
import importlib
from collections.abc import Mapping, Sequence
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ._pcavr import Identified, IdentifiedObject, Recording, Value

_Array = npt.NDArray[np.float64]


def _new_axes(rows: int, height: float) -> Sequence[Any]:
    plt: Any = importlib.import_module("matplotlib.pyplot")  # here, since pcavr works without it
    _, axes = plt.subplots(rows, 1, sharex=True, squeeze=False, figsize=(8, height), layout="constrained")
    return list(axes[:, 0])


def _distances(positions: _Array) -> _Array:
    """Distances [mm] of the rows from the first one."""
    return 1e3 * np.linalg.norm(positions - positions[0], axis=1)


def push(recording: Recording, axes: Sequence[Any] | None = None) -> Sequence[Any]:
    """Force and motion of a recording over time, in two axes: the force's components [N]; the distance of the
    tip and of each tracked object from where it was first [mm]. t is in s from the first sample."""
    axes = _new_axes(2, 5.0) if axes is None else axes
    series = [recording.tool.t, recording.wrench.t, *(each.t for each in recording.tracked.values())]
    start = min((t[0] for t in series if len(t)), default=0.0)
    for i, name in enumerate("xyz"):
        if len(recording.wrench):
            axes[0].plot(recording.wrench.t - start, recording.wrench.forces[:, i], label=f"force {name}", lw=0.8)
    for name, path in {"tip": recording.tool, **recording.tracked}.items():
        if len(path):
            axes[1].plot(path.t - start, _distances(path.positions), label=name, lw=1.2)
    axes[0].set_ylabel("force on the object [N]")
    axes[1].set_ylabel("distance from the start [mm]")
    axes[1].set_xlabel("t [s]")
    for each in axes[:2]:
        each.legend(loc="upper right", fontsize="small")
        each.grid(alpha=0.3)
    return axes


_Result = Union[Value, Identified, IdentifiedObject, None]


def _value_of(result: _Result, key: str) -> tuple[float, float]:
    """Value and std; NaN where the motion did not excite it, or the std is not known."""
    if result is None:
        return np.nan, np.nan
    found: Any = result if isinstance(result, Value) else result[key]
    return found.value, np.nan if found.std is None else found.std


def values(results: Mapping[str, _Result], key: str, axes: Any | None = None) -> Any:
    """One parameter of many results, by name, as points with one standard deviation (a forest plot);
    the mean weighted by 1/std^2 is a line. None, and what the motion did not excite, is listed as such.
    KeyError for a key that a result does not have."""
    axes = _new_axes(1, 1.2 + 0.35 * len(results))[0] if axes is None else axes
    rows = {name: _value_of(result, key) for name, result in results.items()}
    known = np.array([row for row in rows.values() if np.all(np.isfinite(row)) and row[1] > 0])
    if len(known):
        weights = 1.0 / known[:, 1] ** 2
        mean, std = np.sum(weights * known[:, 0]) / np.sum(weights), np.sum(weights) ** -0.5
        axes.axvline(mean, color="0.4", lw=1)
        axes.axvspan(mean - std, mean + std, color="0.85")
    for i, (value, std) in enumerate(rows.values()):
        if np.isfinite(value):
            axes.errorbar([value], [i], xerr=[np.nan_to_num(std)], fmt="o", color="C0", capsize=3)
    names = [name if np.isfinite(value) else f"{name} (not excited)" for name, (value, _) in rows.items()]
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.set_xlabel(key)
    axes.grid(axis="x", alpha=0.3)
    return axes
