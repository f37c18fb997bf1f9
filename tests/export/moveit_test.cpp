// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <octomap/OcTree.h>

#include "pcavr/perception/scene/occupancy_tree.hpp"
#include "pcavr/results/export/write_export.hpp"

#include "export/exported_box.hpp"

namespace pcavr {
namespace {

/// A map of 2 cm cells of which those in a cube about the box's place are occupied.
std::string map_with_debris(const Eigen::Vector3d& middle, double edge) {
  octomap::OcTree tree(0.02);
  for (double x = -edge; x <= edge; x += 0.02) {
    for (double y = -edge; y <= edge; y += 0.02) {
      for (double z = -edge; z <= edge; z += 0.02) {
        tree.updateNode(middle.x() + x, middle.y() + y, middle.z() + z, true);
      }
    }
  }
  std::ostringstream stream;
  tree.writeBinary(stream);
  return stream.str();
}

TEST(PlanningScene, HasNoCellOfTheScanInABody) {
  const ExportedBox box;
  auto world = box.world({{"box", identified_box()}});
  ASSERT_TRUE(world);
  const Pose& T_base_box = world->bodies.front().T_base_object;
  world->occupancy_file = box.target() / "map.bt";
  ASSERT_TRUE(write_file(world->occupancy_file, map_with_debris(T_base_box.translation(), 0.3)));
  ASSERT_TRUE(write_moveit(*world, box.target()));

  const auto json = nlohmann::json::parse(*read_file(box.target() / kPlanningSceneFile));
  const nlohmann::json& map = json["world"]["octomap"]["octomap"];
  EXPECT_EQ(map["id"], "OcTree");
  EXPECT_EQ(map["binary"], true);
  octomap::OcTree tree(map["resolution"].get<double>());
  std::string bytes;
  for (const int byte : map["data"]) bytes += static_cast<char>(byte);
  std::istringstream stream(bytes);
  tree.readBinaryData(stream);
  tree.expand();
  std::size_t occupied = 0;
  Eigen::AlignedBox3d box_object;
  for (const Eigen::Vector3f& v : world->bodies.front().mesh_object.vertices) {
    box_object.extend(v.cast<double>());
  }
  for (auto leaf = tree.begin_leafs(), end = tree.end_leafs(); leaf != end; ++leaf) {
    if (!tree.isNodeOccupied(*leaf)) continue;
    ++occupied;
    const Eigen::Vector3d centre(leaf.getX(), leaf.getY(), leaf.getZ());
    EXPECT_GT(box_object.exteriorDistance(T_base_box.inverse() * centre), 0.009) << centre;
  }
  EXPECT_GT(occupied, 10000U);  // of some 29 800: the cells around it are left
  EXPECT_LT(occupied, 29000U);
}

TEST(PlanningScene, HasTheBodiesAsCollisionObjects) {
  const ExportedBox box("a box");
  auto world = box.world({{"a box", identified_box()}});
  ASSERT_TRUE(world);
  ASSERT_TRUE(write_moveit(*world, box.target()));
  const auto json = nlohmann::json::parse(*read_file(box.target() / kPlanningSceneFile));
  EXPECT_EQ(json["is_diff"], true);
  const nlohmann::json& objects = json["world"]["collision_objects"];
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_EQ(objects[0]["id"], "a box");
  EXPECT_EQ(objects[0]["header"]["frame_id"], "base");
  EXPECT_NEAR(objects[0]["pose"]["position"]["x"].get<double>(),
              world->bodies.front().T_base_object.translation().x(), 1e-12);
  const nlohmann::json& mesh = objects[0]["meshes"][0];
  EXPECT_EQ(mesh["triangles"].size(), world->bodies.front().mesh_object.triangles.size());
  EXPECT_EQ(mesh["vertices"].size(), world->bodies.front().mesh_object.vertices.size());
  EXPECT_EQ(objects[1]["primitives"][0]["dimensions"].size(), 3U);
}

/// Reads the text as MoveIt's PlanningScene::loadGeometryFromStream does: names and shapes.
TEST(PlanningScene, HasTheTextThatRvizImports) {
  const ExportedBox box("a box");
  auto world = box.world({{"a box", identified_box()}});
  ASSERT_TRUE(world);
  ASSERT_TRUE(write_moveit(*world, box.target()));
  std::istringstream text(*read_file(box.target() / kPlanningTextFile));
  std::string line, shape;
  std::getline(text, line);
  std::vector<std::string> names;
  const auto skip_numbers = [&](int count) {
    double number = 0.0;
    for (int i = 0; i < count; ++i) ASSERT_TRUE(text >> number);
  };
  while (std::getline(text >> std::ws, line) && line != ".") {
    ASSERT_EQ(line.substr(0, 2), "* ");
    names.push_back(line.substr(2));
    skip_numbers(7);
    int shapes = 0, subframes = -1;
    ASSERT_TRUE(text >> shapes >> shape);
    ASSERT_EQ(shapes, 1);
    int vertices = 0, triangles = 0;
    if (shape == "mesh") {
      ASSERT_TRUE(text >> vertices >> triangles);
    }
    skip_numbers(shape == "mesh" ? 3 * (vertices + triangles) : 3);
    skip_numbers(7 + 4);  // the shape's pose, and its colour
    ASSERT_TRUE(text >> subframes);
    EXPECT_EQ(subframes, 0);
  }
  EXPECT_EQ(line, ".");
  EXPECT_EQ(names, (std::vector<std::string>{"a box", "support_0"}));
}

}  // namespace
}  // namespace pcavr
