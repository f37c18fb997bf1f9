#!/usr/bin/env python3
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Writes a CAD body with a very high number of triangles: a box with slightly convex faces.

    bench/fine_cad.py box.stl --triangles 5000000 --size 0.175 0.175 0.125 --bulge 0.0005

The file type is that of the extension: .stl and .ply binary, .obj text. The box is centred at the
origin; its edges are straight, so that it can replace a box of the same size in a recording.
"""
import argparse
import array
import math
import struct


def faces(cells, size, bulge):
    """For each face a grid of points by row, counter-clockwise seen from outside."""
    steps = [2.0 * i / cells - 1.0 for i in range(cells + 1)]
    steps[0], steps[-1] = -1.0, 1.0
    half = [0.5 * s for s in size]
    for axis in range(3):
        u_axis, v_axis = (axis + 1) % 3, (axis + 2) % 3
        for side in (-1.0, 1.0):
            rows = []
            for v in steps if side > 0 else reversed(steps):
                row = []
                for u in steps:
                    point = [0.0, 0.0, 0.0]
                    point[axis] = side * (half[axis] + bulge * (1.0 - u * u) * (1.0 - v * v))
                    point[u_axis] = u * half[u_axis]
                    point[v_axis] = v * half[v_axis]
                    row.append(tuple(point))
                rows.append(row)
            yield rows


def write_stl(file, cells, size, bulge):
    with open(file, "wb") as out:
        out.write(b"fine CAD body".ljust(80) + struct.pack("<I", 12 * cells * cells))
        triangle = struct.Struct("<12fH")
        for rows in faces(cells, size, bulge):
            for low, high in zip(rows, rows[1:]):
                data = bytearray()
                for a, b, c, d in zip(low, low[1:], high[1:], high):
                    data += triangle.pack(0, 0, 0, *a, *b, *c, 0)
                    data += triangle.pack(0, 0, 0, *a, *c, *d, 0)
                out.write(data)


def indexed_mesh(cells, size, bulge):
    """Unique vertices, and triangles as indices into them."""
    indices, vertices, triangles = {}, array.array("f"), array.array("I")
    for rows in faces(cells, size, bulge):
        previous = None
        for row in rows:
            current = []
            for point in row:
                index = indices.setdefault(point, len(indices))
                if 3 * index == len(vertices):
                    vertices.extend(point)
                current.append(index)
            for i in range(cells if previous else 0):
                a, b, c, d = previous[i], previous[i + 1], current[i + 1], current[i]
                triangles.extend((a, b, c, a, c, d))
            previous = current
    return vertices, triangles


def write_ply(file, vertices, triangles):
    count = len(triangles) // 3
    header = ("ply\nformat binary_little_endian 1.0\n"
              f"element vertex {len(vertices) // 3}\n"
              "property float x\nproperty float y\nproperty float z\n"
              f"element face {count}\nproperty list uchar int vertex_indices\nend_header\n")
    with open(file, "wb") as out:
        out.write(header.encode() + vertices.tobytes())
        row = struct.Struct("<B3I")
        for i in range(0, len(triangles), 3):
            out.write(row.pack(3, *triangles[i:i + 3]))


def write_obj(file, vertices, triangles):
    with open(file, "w", encoding="ascii") as out:
        for i in range(0, len(vertices), 3):
            out.write("v %.9g %.9g %.9g\n" % tuple(vertices[i:i + 3]))
        for i in range(0, len(triangles), 3):
            out.write("f %d %d %d\n" % tuple(v + 1 for v in triangles[i:i + 3]))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", help="output file: .stl, .ply or .obj")
    parser.add_argument("--triangles", type=int, default=5_000_000)
    parser.add_argument("--size", type=float, nargs=3, default=[0.175, 0.175, 0.125],
                        help="of the box [m]")
    parser.add_argument("--bulge", type=float, default=0.0005, help="of a face's centre [m]")
    arguments = parser.parse_args()
    cells = max(1, math.ceil(math.sqrt(arguments.triangles / 12)))
    if arguments.file.endswith(".stl"):
        write_stl(arguments.file, cells, arguments.size, arguments.bulge)
    elif arguments.file.endswith(".ply"):
        write_ply(arguments.file, *indexed_mesh(cells, arguments.size, arguments.bulge))
    elif arguments.file.endswith(".obj"):
        write_obj(arguments.file, *indexed_mesh(cells, arguments.size, arguments.bulge))
    else:
        parser.error("the file must end in .stl, .ply or .obj")
    print(f"{arguments.file}: {12 * cells * cells} triangles")


if __name__ == "__main__":
    main()
