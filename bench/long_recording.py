#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Writes a long recording without images: repeats another one's tool motion and force.

    bench/long_recording.py push_two_boxes long --minutes 60 --upsample 2
    pcavr build push_two_boxes -o scene
    /usr/bin/time -v pcavr replay long --scene scene --tracked long/tracked -o run

The tracking is the truth of the source, 30 poses a second. Between two repetitions is a second
without samples, in which the objects are reset.
"""
import argparse
import pathlib
import shutil

PAUSE = 1.0  # [s] between two repetitions


def read_rows(file, separator, header):
    lines = file.read_text(encoding="utf-8").splitlines()[header:]
    return [line.split(separator) for line in lines if line and not line.startswith("#")]


def upsampled(rows, factor):
    """Linear interpolation between the rows; the text of the original rows is kept."""
    numbers = [[float(cell) for cell in row] for row in rows]
    result = []
    for i, row in enumerate(rows):
        result.append((numbers[i][0], row[1:]))
        for k in range(1, factor if i + 1 < len(rows) else 1):
            share = k / factor
            between = [a + share * (b - a) for a, b in zip(numbers[i], numbers[i + 1])]
            result.append((between[0], [f"{value:.7f}" for value in between[1:]]))
    return result


def write_repeated(file, header, rows, separator, period, repetitions):
    file.parent.mkdir(parents=True, exist_ok=True)
    tails = [(t, separator + separator.join(cells) + "\n") for t, cells in rows]
    with open(file, "w", encoding="utf-8") as out:
        out.write(header)
        for i in range(repetitions):
            out.write("".join(f"{t + i * period:.6f}{tail}" for t, tail in tails))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("target", type=pathlib.Path)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--upsample", type=int, default=1, help="output rows for each input row")
    arguments = parser.parse_args()
    source, target = arguments.source, arguments.target
    target.mkdir(parents=True)
    shutil.copy(source / "recording.yaml", target)
    shutil.copytree(source / "objects", target / "objects")
    tool = upsampled(read_rows(source / "tool.csv", ",", 1), arguments.upsample)
    wrench = upsampled(read_rows(source / "wrench.csv", ",", 1), arguments.upsample)
    period = tool[-1][0] + PAUSE
    repetitions = max(1, round(60.0 * arguments.minutes / period))
    write_repeated(target / "tool.csv", "t,x,y,z,qx,qy,qz,qw\n", tool, ",", period, repetitions)
    write_repeated(target / "wrench.csv", "t,fx,fy,fz,tx,ty,tz\n", wrench, ",", period, repetitions)
    for truth in sorted((source / "truth" / "objects").glob("*.txt")):
        rows = [(float(row[0]), row[1:]) for row in read_rows(truth, None, 0)]
        rows = [row for i, row in enumerate(rows) if i == 0 or i % 3 == 0]  # of 100 a second
        write_repeated(target / "tracked" / "objects" / truth.stem / "tracked.txt",
                       "# timestamp tx ty tz qx qy qz qw\n", rows, " ", period, repetitions)
    print(f"{target}: {repetitions} repetitions, {repetitions * period / 60.0:.1f} min")


if __name__ == "__main__":
    main()
