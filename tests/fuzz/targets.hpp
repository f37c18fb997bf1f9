// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace pcavr::fuzz {

/// One target for each kind of untrusted input: files, and messages between the sites. Each also
/// checks that accepted input survives a write-read round trip and that an error has its place and
/// reason. Throws ContractError otherwise.
void manifest(std::string_view bytes);
void camera_file(std::string_view bytes);
void image_list(std::string_view bytes);
/// Trajectory, tool, wrench and joints, by the first byte's letter: g, t, w, j.
void series(std::string_view bytes);
/// JPEG and PNG of 16 x 12 pixels; also the bytes as the filtered rows of a PNG.
void image(std::string_view bytes);
void parameters(std::string_view bytes);
/// A point cloud, PCD or PLY.
void cloud(std::string_view bytes);
/// An occupancy map of OctoMap, binary or full.
void octomap(std::string_view bytes);
/// A triangle mesh: the first byte chooses STL (s), PLY (p), OBJ (o) or glTF.
void mesh(std::string_view bytes);
/// A file of a scene: the first byte chooses scene.yaml (y), a .glb (g) or mesh.ply.
void scene(std::string_view bytes);
/// A recorded trace of an operator's hand.
void trace(std::string_view bytes);
/// A robot description.
void urdf(std::string_view bytes);
/// The report of an arm's identification.
void identified_arm(std::string_view bytes);
/// A correction from the robot's site.
void message(std::string_view bytes);
/// A table of poses or forces, as a program logs it: the first byte chooses the options.
void csv(std::string_view bytes);
/// A message between two sites.
void link(std::string_view bytes);
/// An MCAP file, a ROS 1 bag, a rosbag2 database.
void mcap(std::string_view bytes);
void ros1_bag(std::string_view bytes);
void sqlite_bag(std::string_view bytes);
/// A ROS message: the first byte chooses type and serialization.
void ros_message(std::string_view bytes);
/// Messages of the topics of a robot on ROS 2: the first byte chooses poses or joint states of the
/// tool, then each message follows its topic and its length, a byte each.
void ros2_intake(std::string_view bytes);
/// A WebSocket message of page or server.
void live(std::string_view bytes);

}  // namespace pcavr::fuzz
