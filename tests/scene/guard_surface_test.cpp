// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/guard_surface.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/scene/occupancy_map.hpp"
#include "pcavr/perception/scene/occupancy_tree.hpp"
#include "pcavr/perception/scene/scene_text.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

/// A square plate of 0.4 m at height 0.1 m, as an occupancy map of 2 cm.
class GuardedScan : public testing::Test {
 protected:
  void SetUp() override {
    OccupancyOptions options;
    options.resolution = 0.02;
    OccupancyMap map(options);
    TriangleMesh plate;
    plate.vertices = {
        {-0.2F, -0.2F, 0.11F}, {0.2F, -0.2F, 0.11F}, {0.2F, 0.2F, 0.11F}, {-0.2F, 0.2F, 0.11F}};
    plate.triangles = {{0, 1, 2}, {0, 2, 3}};
    map.mark_occupied(plate);
    ASSERT_TRUE(map.write(folder_.path() / kOccupancyFile));
  }
  /// The same as a full tree; octomap's own writer prints, so the header is made here.
  std::string full_tree() const {
    octomap::OcTree tree(0.02);
    for (int x = -5; x < 5; ++x)
      tree.updateNode(octomap::point3d(0.02F * float(x), 0.0F, 0.1F), true);
    std::ostringstream text;
    text << "# Octomap OcTree file\nid OcTree\nsize " << tree.size() << "\nres 0.02\ndata\n";
    tree.writeData(text);
    return text.str();
  }
  Expected<OccupancyTree> read(const std::string& bytes) const {
    const auto file = folder_.path() / "map.ot";
    EXPECT_TRUE(write_file(file, bytes));
    return OccupancyTree::read(file);
  }
  const TemporaryFolder folder_;
};

TEST_F(GuardedScan, IsAsFarFromTheMapAsItsMargin) {
  const GuardSurface guard{"plate", GuardScan{0.05}};
  const auto mesh = guard_mesh(guard, folder_.path());
  ASSERT_TRUE(mesh) << mesh.error().to_string();
  ASSERT_GT(mesh->triangles.size(), 500U);
  const auto map = OccupancyTree::read(folder_.path() / kOccupancyFile);
  ASSERT_TRUE(map);
  double worst = 0.0;
  for (const Eigen::Vector3f& vertex : mesh->vertices) {
    const auto clearance = map->clearance(vertex.cast<double>(), 0.2);
    ASSERT_TRUE(clearance.has_value());
    worst = std::max(worst, std::abs(*clearance - 0.05));
  }
  RecordProperty("worst_mm", std::to_string(1e3 * worst));
  EXPECT_LT(worst, 0.01);  // half a cell
}

TEST_F(GuardedScan, ProtectsWhatIsNearTheMap) {
  const GuardSurface guard{"plate", GuardScan{0.05}};
  const auto guarded = [&](double z) {
    return *is_guarded(guard, folder_.path(), {0, 0, z}, 0.01);
  };
  EXPECT_TRUE(guarded(0.15));
  EXPECT_FALSE(guarded(0.20));
}

TEST_F(GuardedScan, NeedsAReadableMap) {
  ASSERT_TRUE(write_file(folder_.path() / kOccupancyFile, "# Octomap OcTree binary file\nsiz"));
  const auto mesh = guard_mesh({"plate", GuardScan{0.05}}, folder_.path());
  ASSERT_FALSE(mesh);
  EXPECT_NE(mesh.error().to_string().find("OctoMap"), std::string::npos);
}

TEST_F(GuardedScan, AFullTreeIsRead) {
  const auto tree = read(full_tree());
  ASSERT_TRUE(tree) << tree.error().to_string();
  EXPECT_EQ(tree->resolution(), 0.02);
  EXPECT_TRUE(tree->is_occupied({0.01, 0.0, 0.1}));
  EXPECT_FALSE(tree->is_occupied({0.01, 0.0, 0.2}));
  EXPECT_NEAR(*tree->clearance({0.01, 0.01, 0.22}, 0.5), 0.10, 1e-6);
  EXPECT_FALSE(tree->clearance({0.01, 0.01, 1.0}, 0.2).has_value());
}

TEST_F(GuardedScan, EveryCutOfAFullTreeIsAnError) {
  const std::string whole = full_tree();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(read(whole.substr(0, length))) << length;
  }
  EXPECT_FALSE(read(whole + "x"));
  std::string deep = "# Octomap OcTree file\nid OcTree\nsize 40\nres 0.02\ndata\n";
  for (int i = 0; i < 40; ++i) deep += std::string("\0\0\0\0\1", 5);
  EXPECT_NE(read(deep).error().message.find("deeper"), std::string::npos);
}

TEST(GuardSurface, ABoxAndAPlaneProtectTheirSides) {
  const GuardSurface box{"press",
                         GuardBox{Pose::from_translation({1.0, 0.0, 0.0}), {0.2, 0.2, 0.2}}};
  EXPECT_TRUE(*is_guarded(box, {}, {1.1, 0.0, 0.0}, 0.01));
  EXPECT_FALSE(*is_guarded(box, {}, {1.12, 0.0, 0.0}, 0.01));
  EXPECT_EQ(guard_mesh(box, {})->triangles.size(), 12U);
  const GuardSurface plane{"floor", GuardPlane{{0, 0, 0.1}, Eigen::Vector3d::UnitZ(), 1.0}};
  EXPECT_TRUE(*is_guarded(plane, {}, {0.0, 0.0, 0.0}, 0.01));
  EXPECT_FALSE(*is_guarded(plane, {}, {0.0, 0.0, 0.12}, 0.01));
  EXPECT_FALSE(*is_guarded(plane, {}, {0.6, 0.0, 0.0}, 0.01));
}

}  // namespace
}  // namespace pcavr
