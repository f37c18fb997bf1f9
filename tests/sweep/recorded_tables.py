# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""The tables of a recording as rows of numbers, read, changed and written: what wrong_recordings,
wrong_scenes and wrong_arms change. Poses are rows t x y z qx qy qz qw, wrenches t fx fy fz tx ty tz."""
import math
import re

from faults import replace_file


class Table:
    """A .csv with a header, or a TUM list. `save` replaces the file."""

    def __init__(self, path):
        self.path = path
        self.separator = "," if path.suffix == ".csv" else " "
        lines = path.read_text().splitlines()
        self.head = [line for line in lines if line[:1] in ("#", "t")]
        self.rows = [[float(cell) for cell in line.split(self.separator)] for line in lines
                     if line and line[0] not in "#t"]

    def save(self):
        body = [self.separator.join(f"{value:.9g}" if i else f"{value:.6f}" for i, value in enumerate(row))
                for row in self.rows]
        replace_file(self.path, "\n".join(self.head + body) + "\n")

    def change(self, function):
        """Each row becomes `function(row)`, or is left out where that is None."""
        self.rows = [row for row in map(function, self.rows) if row is not None]
        self.save()

    @property
    def span(self):
        return self.rows[0][0], self.rows[-1][0]

    @property
    def interval(self):
        first, last = self.span
        return (last - first) / max(1, len(self.rows) - 1)


def forget_counts(recording):
    """The lists are changed: their rows must not be checked against what `simulate` wrote."""
    (recording / "written.yaml").unlink(missing_ok=True)


def tool(recording):
    return Table(recording / "tool.csv")


def wrench(recording):
    return Table(recording / "wrench.csv")


def tracks(recording):
    return [Table(path) for path in sorted(recording.glob("tracked/objects/*/tracked.txt"))]


def streams(recording):
    """The tables of this recording by what they are."""
    found = {"force": wrench(recording), "tool": tool(recording)}
    found.update({f"tracking of {table.path.parent.name}": table for table in tracks(recording)})
    return found


def edit_manifest(recording, pattern, replace, count=0):
    """How many places of recording.yaml matched; `replace` takes the match."""
    path = recording / "recording.yaml"
    text, changed = re.subn(pattern, replace, path.read_text(), count=count)
    replace_file(path, text)
    return changed


def scale_meshes(recording, factor, shift=(0.0, 0.0, 0.0)):
    """How many .obj files there are: their coordinates times `factor`, then moved [m]."""
    paths = list(recording.glob("objects/*.obj"))
    for path in paths:
        lines = path.read_text().split("\n")
        for i, line in enumerate(lines):
            cells = line.split()
            if cells[:1] == ["v"]:
                lines[i] = "v " + " ".join(f"{float(x) * factor + s:.9g}" for x, s in zip(cells[1:4], shift))
        replace_file(path, "\n".join(lines))
    return len(paths)


# Rotations, as rows of matrices and as quaternions x y z w


def axis_turn(axis, angle):
    """Rotation matrix about a unit vector [rad]."""
    x, y, z = axis
    c, s, k = math.cos(angle), math.sin(angle), 1.0 - math.cos(angle)
    return [[c + x * x * k, x * y * k - z * s, x * z * k + y * s],
            [y * x * k + z * s, c + y * y * k, y * z * k - x * s],
            [z * x * k - y * s, z * y * k + x * s, c + z * z * k]]


def times(matrix, vector):
    return [sum(a * b for a, b in zip(row, vector)) for row in matrix]


def quaternion(axis, angle):
    s = math.sin(0.5 * angle)
    return [s * axis[0], s * axis[1], s * axis[2], math.cos(0.5 * angle)]


def product(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]


def conjugate(q):
    return [-q[0], -q[1], -q[2], q[3]]


def rotate(q, vector):
    return product(product(q, [*vector, 0.0]), conjugate(q))[:3]


def pose_product(a, b):
    """T_a T_b of two rows of seven numbers."""
    moved = rotate(a[3:], b[:3])
    return [x + y for x, y in zip(a[:3], moved)] + product(a[3:], b[3:])


def inverse(pose):
    q = conjugate(pose[3:])
    return [-x for x in rotate(q, pose[:3])] + q


def random_axis(rng):
    while True:
        axis = [rng.gauss(0.0, 1.0) for _ in range(3)]
        norm = math.sqrt(sum(x * x for x in axis))
        if norm > 1e-3:
            return [x / norm for x in axis]
