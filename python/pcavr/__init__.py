# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Scenes from depth recordings, identified contact and friction, and predicted pushes.

Units are SI. Poses are arrays x y z [m] qx qy qz qw (unit quaternion), in the robot's base frame with
z up unless another frame is stated. What is wrong with data is an Error.
"""
from . import _interpreter  # first: it refuses others than the main one
from ._errors import DataWarning, Error
from ._pcavr import (
    BaseParameter, Body, BodyPose, CalibratedCamera, CalibratedDepth, CalibratedObject, CalibratedObjects,
    CalibratedPose, CalibratedTag, CalibratedTags, Camera, ClockOffset, Finding, ForceSensor, Frame, HandEye,
    Identification, Identified, IdentifiedJoint, IdentifiedObject, IdentifiedRobot, IkSolution, Object,
    ObjectEntry, Parameters, Payload, Recording, Robot, Scene, SceneObject, Tag, TagDetection, TagDetector,
    Touch, TouchedObject, Trajectory, Value, World, WrenchSeries, body_pose, build, calibrate_camera,
    calibrate_clocks, calibrate_depth, calibrate_force, calibrate_hand_eye, calibrate_objects, calibrate_tags,
    calibrate_touch, evaluate, export, export_lerobot, identify, identify_recording, identify_robot,
    parse_parameters, read_parameters, read_recording, read_scene, replay, simulate, tag_cells, tag_families,
    write_parameters, write_recording)

__all__ = [
    "BaseParameter", "Body", "BodyPose", "CalibratedCamera", "CalibratedDepth", "CalibratedObject",
    "CalibratedObjects", "CalibratedPose", "CalibratedTag", "CalibratedTags", "Camera", "ClockOffset",
    "DataWarning", "Error", "Finding", "ForceSensor", "Frame", "HandEye", "Identification", "Identified",
    "IdentifiedJoint", "IdentifiedObject", "IdentifiedRobot", "IkSolution", "Object", "ObjectEntry",
    "Parameters", "Payload", "Recording", "Robot", "Scene", "SceneObject", "Tag", "TagDetection",
    "TagDetector", "Touch", "TouchedObject", "Trajectory", "Value", "World", "WrenchSeries", "body_pose",
    "build", "calibrate_camera", "calibrate_clocks", "calibrate_depth", "calibrate_force",
    "calibrate_hand_eye", "calibrate_objects", "calibrate_tags", "calibrate_touch", "evaluate", "export",
    "export_lerobot", "identify", "identify_recording", "identify_robot", "parse_parameters",
    "read_parameters", "read_recording", "read_scene", "replay", "simulate", "tag_cells", "tag_families",
    "write_parameters", "write_recording",
]
