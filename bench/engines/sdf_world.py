# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""An exported SDF world of one movable body, as the engines' programs take it, with each setting."""
import json
import math
import xml.etree.ElementTree as ElementTree

DEFAULTS, MU_ALONE, EXPORT, BEST = "engine's defaults", "mu alone", "export", "best known"
# Of a body of export.json: its friction by slip speed, and the coefficient that was exported.
LAW = ("mass", "friction", "static_friction", "coulomb_friction", "viscous", "stribeck_speed", "friction_radius")
PARTNER = 10.0  # coefficient that drops out where an engine takes the smaller one


def numbers(text):
    return [float(word) for word in text.split()]


def quaternion(roll, pitch, yaw):
    """x, y, z, w of R = Rz(yaw) Ry(pitch) Rx(roll)."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a / 2), math.sin(a / 2)) for a in (roll, pitch, yaw))
    return [sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy]


def pose(element):
    values = numbers(element.findtext("pose", "0 0 0 0 0 0"))
    return {"position": values[:3], "quaternion": quaternion(*values[3:])}


def principal(inertia):
    """Principal moments and axes (a quaternion x, y, z, w) of a symmetric 3 x 3 matrix [Jacobi]."""
    a = [row[:] for row in inertia]
    axes = [[float(i == j) for j in range(3)] for i in range(3)]
    for _ in range(20):
        for p, q in ((0, 1), (0, 2), (1, 2)):
            if abs(a[p][q]) < 1e-18:
                continue
            theta = 0.5 * math.atan2(2.0 * a[p][q], a[q][q] - a[p][p])
            c, s = math.cos(theta), math.sin(theta)
            for rows in (a, axes):
                for row in rows:
                    row[p], row[q] = c * row[p] - s * row[q], s * row[p] + c * row[q]
            a[p], a[q] = ([c * x - s * y for x, y in zip(a[p], a[q])],
                          [s * x + c * y for x, y in zip(a[p], a[q])])
    m = axes
    determinant = sum(m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3]
                                 - m[1][(i + 2) % 3] * m[2][(i + 1) % 3]) for i in range(3))
    if determinant < 0.0:
        m = [[-row[0], row[1], row[2]] for row in m]
    return [a[i][i] for i in range(3)], rotation_quaternion(m)


def rotation_quaternion(m):
    """x, y, z, w of a rotation matrix, by its largest component."""
    squares = [1 + m[0][0] - m[1][1] - m[2][2], 1 - m[0][0] + m[1][1] - m[2][2],
               1 - m[0][0] - m[1][1] + m[2][2], 1 + m[0][0] + m[1][1] + m[2][2]]
    k = max(range(4), key=squares.__getitem__)
    size = 2.0 * math.sqrt(squares[k])
    if k == 3:
        q = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], 0.0]
    else:
        i, j = (k + 1) % 3, (k + 2) % 3
        q = [0.0, 0.0, 0.0, m[j][i] - m[i][j]]
        q[i], q[j] = m[k][i] + m[i][k], m[k][j] + m[j][k]
    q = [value / size for value in q]
    q[k] = size / 4.0
    return q


def read_obj(file):
    points, triangles = [], []
    for line in file.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            triangles.append([int(word.split("/")[0]) - 1 for word in words[1:4]])
    return points, triangles


def read_surface(collision):
    return {"friction": float(collision.findtext("surface/friction/ode/mu")),
            "stiffness": float(collision.findtext("surface/contact/ode/kp")),
            "damping": float(collision.findtext("surface/contact/ode/kd"))}


def read_body(model, folder):
    link = model.find("link")
    inertial = link.find("inertial")
    i = {key: float(inertial.findtext(f"inertia/{key}")) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")}
    matrix = [[i["ixx"], i["ixy"], i["ixz"]], [i["ixy"], i["iyy"], i["iyz"]], [i["ixz"], i["iyz"], i["izz"]]]
    moments, axes = principal(matrix)
    shapes = link.findall("collision")
    offset = numbers(shapes[0].findtext("pose"))[:3]
    points, triangles = read_obj(folder / shapes[0].findtext("geometry/mesh/uri"))
    body = {**pose(model), "mass": float(inertial.findtext("mass")),
            "centre_of_mass": numbers(inertial.findtext("pose"))[:3], "inertia": moments,
            "inertia_quaternion": axes, "inertia_z": i["izz"], "triangles": triangles,
            "points": [[p + o for p, o in zip(point, offset)] for point in points],
            **read_surface(shapes[0]), "feet": []}
    for foot in shapes[1:]:
        body["feet"].append({"centre": numbers(foot.findtext("pose"))[:3],
                             "radius": float(foot.findtext("geometry/sphere/radius")), **read_surface(foot)})
    return body


def read_world(folder):
    """The world of a folder with scene.sdf and export.json, as exported."""
    root = ElementTree.parse(folder / "scene.sdf").getroot().find("world")
    manifest = json.loads((folder / "export.json").read_text())
    known = manifest["bodies"][0]
    world = {"gravity": numbers(root.findtext("gravity")), "supports": [], "partner_friction": PARTNER,
             "tip_friction": PARTNER}
    for model in root.findall("model"):
        box = model.find("link/collision/geometry/box")
        if box is not None:
            world["supports"].append({**pose(model), "size": numbers(box.findtext("size"))})
        elif model.get("name") == known["name"]:
            world["body"] = read_body(model, folder)
        elif model.get("name") == manifest["tool"]:
            world["tool_radius"] = float(model.findtext("link/collision/geometry/sphere/radius"))
    body = world["body"]
    body["static_ratio"] = known["static_friction"] / known["friction"]
    # URDF's rule for Bullet: the product of two coefficients, and one for a body.
    world["bullet_support_friction"] = 1.0
    body["bullet_friction"] = known["friction"]
    world["bullet_tip_friction"] = body["friction"] / known["friction"]
    return world, manifest


def with_setting(world, manifest, setting):
    """A copy with the coefficients of a setting; the others' bodies stand on their own surfaces."""
    changed = json.loads(json.dumps(world))
    if setting == BEST:
        changed["body"]["law"] = {key: manifest["bodies"][0][key] for key in LAW}
    if setting in (EXPORT, BEST):
        return changed
    is_default = setting == DEFAULTS
    mu = None if is_default else manifest["bodies"][0]["coulomb_friction"]
    changed["body"].update(feet=[], static_ratio=1.0, friction=mu, bullet_friction=mu)
    if is_default:
        for key in ("partner_friction", "tip_friction", "bullet_support_friction", "bullet_tip_friction"):
            changed[key] = None
    else:
        changed["bullet_support_friction"] = changed["bullet_tip_friction"] = 1.0
    return changed
