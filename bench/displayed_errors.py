# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator sees and feels against what happens at the same time, from a run's files.

A plainly delayed display shows what happened a round trip ago. Errors are averaged over the times
at which an object is touched or has moved within the last round trip, of all objects together."""
import bisect
import csv
import math
import statistics

SETTLING = 0.3  # [s] of a contact, over which paper C excludes its force
BIN = 0.05  # [s] over which forces are averaged: below a person's reaction, above the noise
MAX_GAP = 0.1  # [s] without forces within one contact: lost messages
MIN_FORCE = 1.0  # [N] a smaller one is mostly noise
MIN_MOTION = 1e-4  # [m] within a round trip, that of an object which moves


def read_path(file):
    """Times and positions of a trajectory file."""
    rows = [[float(cell) for cell in line.split()[:4]] for line in file.read_text().splitlines()
            if line and not line.startswith("#")]
    return [row[0] for row in rows], [row[1:] for row in rows]


def at(path, t):
    times, points = path
    i = min(max(bisect.bisect_left(times, t), 1), len(times) - 1)
    share = min(max((t - times[i - 1]) / (times[i] - times[i - 1]), 0.0), 1.0)
    return [a + share * (b - a) for a, b in zip(points[i - 1], points[i])]


def force_bins(run, column):
    """By object: {index of the bin: mean force} of a column of force.csv."""
    sums = {}
    with open(run / "force.csv", newline="") as file:
        for row in csv.DictReader(file):
            bin_of = sums.setdefault(row["object"], {}).setdefault(int(float(row["t"]) / BIN), [])
            bin_of.append(float(row[column]))
    return {name: {index: statistics.fmean(values) for index, values in bins.items()}
            for name, bins in sums.items()}


def share_of_delayed(run, truth, round_trip):
    """Mean errors of the display over those of a delayed one: of positions, of forces."""
    shown = delayed = 0.0
    for folder in sorted((run / "objects").iterdir()):
        predicted, true = (read_path(file) for file in (folder / "predicted.txt",
                                                        truth / "objects" / f"{folder.name}.txt"))
        for t, point in zip(*predicted):
            now, before = at(true, t), at(true, t - round_trip)
            if true[0][0] + round_trip < t <= true[0][-1] and math.dist(now, before) > MIN_MOTION:
                shown += math.dist(point, now)
                delayed += math.dist(before, now)
    measured, rendered = force_bins(run, "measured"), force_bins(run, "virtual")
    lag = round(round_trip / BIN)
    felt = late = 0.0
    for name, bins in measured.items():
        for index, force in bins.items():
            felt += abs(rendered[name][index] - force)
            late += abs(bins.get(index - lag, 0.0) - force)
    return [a / b if b > 0.0 else None for a, b in ((shown, delayed), (felt, late))]


def settled_force_errors(run):
    """Relative errors of the rendered force outside the first 0.3 s of each contact."""
    errors = []
    measured, rendered = force_bins(run, "measured"), force_bins(run, "virtual")
    for name, bins in measured.items():
        begin = last = None
        for index in sorted(bins):
            if bins[index] < MIN_FORCE:
                begin = None
                continue
            # A run has no forces while nothing is touched.
            begin = index if begin is None or (index - last) * BIN > MAX_GAP else begin
            last = index
            if (index - begin) * BIN >= SETTLING:
                errors.append(abs(rendered[name][index] - bins[index]) / bins[index])
    return sorted(errors)
