// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/marker/tag_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/perception/marker/tag_detector.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

namespace pcavr {
namespace {

constexpr double kPixelsPerMillimetre = 4.0;

TagSheetOptions a_sheet(const std::string& family, std::vector<int> ids, double size) {
  TagSheetOptions options;
  options.family = family;
  options.ids = std::move(ids);
  options.size = size;
  return options;
}

/// Paints the black rectangles of our SVG, each `Mx yhWvHh-Wz`, on a white page.
GrayImage rasterise(const std::string& svg) {
  GrayImage image(static_cast<int>(210 * kPixelsPerMillimetre),
                  static_cast<int>(297 * kPixelsPerMillimetre), 255);
  const std::size_t begin = svg.find(" d=\"") + 4;
  const std::string path = svg.substr(begin, svg.find('"', begin) - begin);
  for (std::size_t at = path.find('M'); at != std::string::npos; at = path.find('M', at + 1)) {
    double x = 0, y = 0, w = 0, h = 0;
    EXPECT_EQ(std::sscanf(path.c_str() + at, "M%lf %lfh%lfv%lf", &x, &y, &w, &h), 4);
    const auto pixel = [](double mm) {
      return static_cast<int>(std::lround(mm * kPixelsPerMillimetre));
    };
    for (int v = pixel(y); v < pixel(y + h); ++v) {
      for (int u = pixel(x); u < pixel(x + w); ++u) image(u, v) = 0;
    }
  }
  return image;
}

TEST(TagSheet, IsDetectedAtTheCorrectSizeForEveryFamily) {
  for (const std::string& family : tag_families()) {
    const TagSheet sheet = *make_tag_sheet(a_sheet(family, {3, 0}, 0.04));
    auto detector = TagDetector::create({family});
    const auto found = detector->detect(rasterise(sheet.svg_pages.at(0)));
    ASSERT_EQ(found.size(), 2U) << family;
    EXPECT_EQ(found[0].id.id, 0) << family;
    EXPECT_EQ(found[1].id.id, 3) << family;
    for (const TagDetection& tag : found) {
      const Eigen::Vector2d right = (tag.corners[1] - tag.corners[0]) / kPixelsPerMillimetre;
      const Eigen::Vector2d up = (tag.corners[3] - tag.corners[0]) / kPixelsPerMillimetre;
      // Cells are rounded to whole pixels: a quarter of a millimetre.
      EXPECT_LT((right - Eigen::Vector2d(40, 0)).norm(), 0.3) << family;
      EXPECT_LT((up - Eigen::Vector2d(0, -40)).norm(), 0.3) << family;
    }
  }
}

TEST(TagSheet, HasValidManifestLines) {
  const TagSheet sheet = *make_tag_sheet(a_sheet("tag36h11", {4, 11}, 0.0625));
  const auto manifest =
      parse_manifest("format: pcavr-recording/1\n" + sheet.manifest_yaml, "recording.yaml");
  ASSERT_TRUE(manifest.has_value()) << manifest.error().to_string();
  ASSERT_EQ(manifest->markers.size(), 2U);
  EXPECT_EQ(manifest->markers[1].id.to_string(), "tag36h11:11");
  EXPECT_EQ(manifest->markers[1].size, 0.0625);
  EXPECT_EQ(manifest->markers[1].role, MarkerRole::base);
}

TEST(TagSheet, HasAsManyPagesAsTheTagsNeed) {
  std::vector<int> ids;
  for (int i = 0; i < 40; ++i) ids.push_back(i);
  const TagSheet few = *make_tag_sheet(a_sheet("tag36h11", {0}, 0.15));
  const TagSheet many = *make_tag_sheet(a_sheet("tag36h11", ids, 0.15));
  EXPECT_EQ(few.svg_pages.size(), 1U);
  EXPECT_EQ(many.svg_pages.size(), 40U);
  EXPECT_NE(many.pdf.find("/Count 40"), std::string::npos);
}

TEST(TagSheet, HasAPdfWithACorrectCrossReferenceTable) {
  const std::string pdf = make_tag_sheet(a_sheet("DICT_4X4_50", {1, 2, 3}, 0.08))->pdf;
  EXPECT_EQ(pdf.rfind("%PDF-1.4", 0), 0U);
  const std::size_t start = pdf.rfind("startxref\n");
  const std::size_t table = std::stoul(pdf.substr(start + 10));
  ASSERT_EQ(pdf.compare(table, 5, "xref\n"), 0);
  const std::size_t entries = pdf.find('\n', table + 5) + 1;
  const int count = std::stoi(pdf.substr(table + 7));
  ASSERT_GT(count, 4);
  for (int i = 1; i < count; ++i) {
    const std::size_t offset =
        std::stoul(pdf.substr(entries + 20 * static_cast<std::size_t>(i), 10));
    const std::string expected = std::to_string(i) + " 0 obj";
    EXPECT_EQ(pdf.compare(offset, expected.size(), expected), 0) << i;
  }
  // A4 in points.
  EXPECT_NE(pdf.find("/MediaBox [0 0 595.276 841.890]"), std::string::npos);
}

TEST(TagSheet, RejectsInvalidOptions) {
  const auto message = [](const TagSheetOptions& options) {
    const auto sheet = make_tag_sheet(options);
    return sheet ? std::string() : sheet.error().to_string();
  };
  EXPECT_NE(message(a_sheet("tag99", {0}, 0.08)).find("tag99"), std::string::npos);
  EXPECT_NE(message(a_sheet("tag36h11", {587}, 0.08)).find("586"), std::string::npos);
  EXPECT_NE(message(a_sheet("tag36h11", {-1}, 0.08)).find("-1"), std::string::npos);
  EXPECT_NE(message(a_sheet("tag36h11", {0}, 0.3)).find("does not fit"), std::string::npos);
  EXPECT_FALSE(message(a_sheet("tag36h11", {}, 0.08)).empty());
  EXPECT_FALSE(message(a_sheet("tag36h11", {0}, 0.0)).empty());
  EXPECT_FALSE(message(a_sheet("tag36h11", {0}, std::nan(""))).empty());
}

TEST(TagPicture, HasABlackBorderInTheClassicFamilies) {
  const TagPicture picture = *tag_picture("tag36h11", 0);
  EXPECT_EQ(picture.cells, 8);
  EXPECT_EQ(picture.border, 0);
  for (int i = 0; i < 8; ++i) {
    EXPECT_FALSE(picture.is_white[static_cast<std::size_t>(i)]);
    EXPECT_FALSE(picture.is_white[static_cast<std::size_t>(8 * i)]);
  }
}

TEST(TagPicture, IncludesTheCellsOutsideTheCornerSquareOfTheNewFamilies) {
  const TagPicture picture = *tag_picture("tagStandard41h12", 0);
  EXPECT_EQ(picture.cells, 9);
  EXPECT_EQ(picture.border, 2);
  // White inside the square's edge, black outside it.
  EXPECT_TRUE(picture.is_white[2 * 9 + 2]);
  EXPECT_FALSE(picture.is_white[1 * 9 + 1]);
}

}  // namespace
}  // namespace pcavr
