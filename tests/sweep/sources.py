# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Sound inputs that the command reads but does not write: a bag, an arm with its log, and meshes of
other types. Written with the standard library only."""
import math
import sqlite3
import struct

MINIMAL_METADATA = """rosbag2_bagfile_information:
  version: 5
  storage_identifier: sqlite3
  relative_file_paths: [bag.db3]
  compression_format: ""
  compression_mode: ""
"""


class Cdr:
    """A little-endian CDR message: values aligned to their size, after its header of 4 bytes."""

    def __init__(self):
        self.body = b""

    def add(self, code, *values):
        size = struct.calcsize(code)
        for value in values:
            self.body += b"\0" * (-len(self.body) % size) + struct.pack("<" + code, value)
        return self

    def header(self, t, frame):
        self.add("i", int(t)).add("I", int(t % 1.0 * 1e9)).add("I", len(frame) + 1)
        self.body += frame.encode() + b"\0"
        return self

    def message(self):
        return b"\0\1\0\0" + self.body


def write_bag(folder, samples=200, rate=100.0):
    """A ROS 2 bag of a tool's poses and its forces."""
    folder.mkdir()
    (folder / "metadata.yaml").write_text(MINIMAL_METADATA)
    database = sqlite3.connect(folder / "bag.db3")
    database.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, "
                     "serialization_format TEXT, offered_qos_profiles TEXT)")
    database.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, "
                     "timestamp INTEGER, data BLOB)")
    database.execute("INSERT INTO topics VALUES(1, '/tip', 'geometry_msgs/msg/PoseStamped', 'cdr', '')")
    database.execute(
        "INSERT INTO topics VALUES(2, '/ft', 'geometry_msgs/msg/WrenchStamped', 'cdr', '')")
    for i in range(samples):
        t = 100.0 + i / rate
        pose = Cdr().header(t, "base").add("d", 0.4 + 0.05 * i / rate, 0.1, 0.05, 0.0, 0.0, 0.0, 1.0)
        wrench = Cdr().header(t, "base").add("d", -min(0.05 * i, 5.0), 0.0, 0.0, 0.0, 0.0, 0.0)
        for topic, data in ((1, pose), (2, wrench)):
            database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)",
                             (topic, int(t * 1e9), data.message()))
    database.commit()
    database.close()


# Two joints about vertical axes: no gravity, so that the torques are a short formula.
LINK = """<link name="{0}"><inertial><origin xyz="{1} 0 0"/><mass value="{2}"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.05"/></inertial>
<collision><origin xyz="{1} 0 0"/><geometry><box size="0.3 0.05 0.05"/></geometry></collision></link>
"""
JOINT = """<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/>
<origin xyz="{3} 0 0.3"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" velocity="4" effort="80"/></joint>
"""
LENGTH, CENTRE, INERTIA = 0.4, 0.2, 0.05
MASSES = (3.0, 2.0)


def arm_urdf():
    return ('<robot name="arm">\n<link name="base"/>\n' + LINK.format("upper", CENTRE, MASSES[0])
            + LINK.format("lower", CENTRE, MASSES[1]) + JOINT.format("j1", "base", "upper", 0)
            + JOINT.format("j2", "upper", "lower", LENGTH) + "</robot>\n")


def arm_torques(q2, v, a):
    """Of the two joints, with Coulomb and viscous friction [N m]."""
    coupling = MASSES[1] * LENGTH * CENTRE
    own = [INERTIA + mass * CENTRE**2 for mass in MASSES]
    elbow = own[1] + coupling * math.cos(q2)
    shoulder = own[0] + MASSES[1] * LENGTH**2 + elbow + coupling * math.cos(q2)
    turning = coupling * math.sin(q2)
    inertial = (shoulder * a[0] + elbow * a[1] - turning * (2.0 * v[0] * v[1] + v[1]**2),
                elbow * a[0] + own[1] * a[1] + turning * v[0]**2)
    return [torque + 1.5 * math.tanh(speed / 0.01) + 0.8 * speed
            for torque, speed in zip(inertial, v)]


def arm_log(rng, duration=12.0, rate=100.0):
    """joints.csv of a motion of three sines a joint, with noise."""
    waves = [[(rng.uniform(0.1, 0.5), 2.0 * math.pi * rng.uniform(0.1, 0.6), rng.uniform(0.0, 6.0))
              for _ in range(3)] for _ in range(2)]
    rows = ["t,q_j1,q_j2,tau_j1,tau_j2"]
    for i in range(int(duration * rate)):
        t = i / rate
        q = [sum(r * math.sin(w * t + p) for r, w, p in joint) for joint in waves]
        v = [sum(r * w * math.cos(w * t + p) for r, w, p in joint) for joint in waves]
        a = [-sum(r * w * w * math.sin(w * t + p) for r, w, p in joint) for joint in waves]
        torques = [torque + rng.gauss(0.0, 0.02) for torque in arm_torques(q[1], v, a)]
        rows.append(",".join(f"{value:.6f}" for value in (t, *q, *torques)))
    return "\n".join(rows) + "\n"


def triangles_of(obj):
    """Vertices and triangles (0-based) of a .obj file with triangles."""
    rows = [line.split() for line in obj.splitlines()]
    vertices = [[float(x) for x in row[1:4]] for row in rows if row[:1] == ["v"]]
    faces = [[int(word.split("/")[0]) - 1 for word in row[1:4]] for row in rows if row[:1] == ["f"]]
    return vertices, faces


def stl_of(vertices, faces):
    content = b"\0" * 80 + struct.pack("<I", len(faces))
    for face in faces:
        corners = [x for v in face for x in vertices[v]]
        content += struct.pack("<12fH", 0.0, 0.0, 0.0, *corners, 0)
    return content


def ply_of(vertices, faces):
    lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", "property float x",
             "property float y", "property float z", f"element face {len(faces)}",
             "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(f"{x:.6f}" for x in vertex) for vertex in vertices]
    lines += ["3 " + " ".join(map(str, face)) for face in faces]
    return ("\n".join(lines) + "\n").encode()


def dae_of(vertices, faces):
    numbers = " ".join(f"{x:.6f}" for vertex in vertices for x in vertex)
    indices = " ".join(str(v) for face in faces for v in face)
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="{3 * len(vertices)}">{numbers}</float_array>
<technique_common><accessor source="#a" count="{len(vertices)}" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="{len(faces)}"><input semantic="VERTEX" source="#v" offset="0"/><p>{indices}</p>
</triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">
<node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
""".encode()
