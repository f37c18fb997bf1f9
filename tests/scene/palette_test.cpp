// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/palette.hpp"

#include <cmath>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "perception/scene/glb_writer.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

nlohmann::json page_palette() {
  std::ifstream file(source_folder() / "apps/viewer/src/palette.json");
  return nlohmann::json::parse(file);
}

std::string hex(const Rgb8& color) {
  return fmt::format("#{:02x}{:02x}{:02x}", color.r, color.g, color.b);
}

TEST(Palette, IsThatOfThePage) {
  const nlohmann::json page = page_palette();
  ASSERT_EQ(page["objects"].size(), kObjectColors.size());
  for (std::size_t i = 0; i < kObjectColors.size(); ++i) {
    EXPECT_EQ(page["objects"][i], hex(kObjectColors[i]));
  }
  EXPECT_EQ(page["fixed"], hex(kFixedObjectColor));
  EXPECT_EQ(page["sources"]["predicted"], hex(kPredictedColor));
  EXPECT_EQ(page["sources"]["tracked"], hex(kTrackedColor));
  EXPECT_EQ(page["sources"]["measured"], hex(kMeasuredColor));
}

TEST(Palette, ColoursTheBodiesOfAGlbFile) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  GlbWriter writer;
  std::vector<int> nodes;
  for (const std::size_t i : {0U, 1U}) {
    const int number = writer.add_mesh("part", mesh, GlbMaterial::body, object_color(i));
    nodes.push_back(writer.add_node("part", Pose(), number));
  }
  const std::string bytes = writer.finish(writer.add_node("base", Pose(), -1), nodes);
  const std::string text = bytes.substr(20, bytes.find('\0', 20) - 20);
  const nlohmann::json document = nlohmann::json::parse(text.substr(0, text.rfind('}') + 1));
  ASSERT_EQ(document["materials"].size(), 2U);
  for (const std::size_t i : {0U, 1U}) {
    const nlohmann::json& factor =
        document["materials"][i]["pbrMetallicRoughness"]["baseColorFactor"];
    const std::array<std::uint8_t, 3> srgb{object_color(i).r, object_color(i).g, object_color(i).b};
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const double s = srgb[channel] / 255.0;  // IEC 61966-2-1
      const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
      EXPECT_NEAR(factor[channel].get<double>(), linear, 1e-4);
    }
  }
}

}  // namespace
}  // namespace pcavr
