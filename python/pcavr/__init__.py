# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Scenes from depth recordings, identified contact and friction, and predicted pushes.

Units are SI. Poses are arrays x y z [m] qx qy qz qw (unit quaternion), in the robot's base frame with
z up unless another frame is stated. What is wrong with data is an Error.
"""
from ._errors import DataWarning, Error
from ._pcavr import (
    Body, BodyPose, Camera, Finding, Frame, Identification, Identified, IdentifiedObject, IkSolution,
    Object, ObjectEntry, Parameters, Recording, Robot, Scene, SceneObject, Tag, TagDetection,
    TagDetector, Trajectory, Value, World, WrenchSeries, body_pose, build, evaluate, export, export_lerobot,
    identify, identify_recording, parse_parameters, read_parameters, read_recording, read_scene, replay,
    simulate, tag_cells, tag_families, write_parameters, write_recording)

__all__ = [
    "Body", "BodyPose", "Camera", "DataWarning", "Error", "Finding", "Frame", "Identification",
    "Identified", "IdentifiedObject", "IkSolution", "Object", "ObjectEntry", "Parameters", "Recording",
    "Robot", "Scene", "SceneObject", "Tag", "TagDetection", "TagDetector", "Trajectory", "Value",
    "World", "WrenchSeries", "body_pose", "build", "evaluate", "export", "export_lerobot",
    "identify", "identify_recording", "parse_parameters", "read_parameters", "read_recording", "read_scene",
    "replay", "simulate", "tag_cells", "tag_families", "write_parameters", "write_recording",
]
