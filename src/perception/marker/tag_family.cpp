// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/tag_family.hpp"

#include <array>
#include <cstddef>
#include <vector>

#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>

#include "pcavr/perception/marker/tag_detector.hpp"

namespace pcavr {
namespace {

struct AprilTagEntry {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

constexpr std::array<AprilTagEntry, 6> kAprilTagFamilies{{
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag16h5", tag16h5_create, tag16h5_destroy},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
    {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
    {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
}};

/// Names in the order of OpenCV's enumeration cv::aruco::PREDEFINED_DICTIONARY_NAME.
constexpr std::array<const char*, 17> kArucoDictionaries{
    "DICT_4X4_50",   "DICT_4X4_100",       "DICT_4X4_250",  "DICT_4X4_1000", "DICT_5X5_50",
    "DICT_5X5_100",  "DICT_5X5_250",       "DICT_5X5_1000", "DICT_6X6_50",   "DICT_6X6_100",
    "DICT_6X6_250",  "DICT_6X6_1000",      "DICT_7X7_50",   "DICT_7X7_100",  "DICT_7X7_250",
    "DICT_7X7_1000", "DICT_ARUCO_ORIGINAL"};

}  // namespace

std::optional<AprilTagFamily> make_apriltag_family(const std::string& name) {
  for (const AprilTagEntry& entry : kAprilTagFamilies) {
    if (name == entry.name) return AprilTagFamily(entry.create(), entry.destroy);
  }
  return std::nullopt;
}

std::optional<int> aruco_dictionary_number(const std::string& name) {
  for (std::size_t i = 0; i < kArucoDictionaries.size(); ++i) {
    if (name == kArucoDictionaries[i]) return static_cast<int>(i);
  }
  return std::nullopt;
}

const std::vector<std::string>& tag_families() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const AprilTagEntry& entry : kAprilTagFamilies) all.emplace_back(entry.name);
    for (const char* name : kArucoDictionaries) all.emplace_back(name);
    return all;
  }();
  return names;
}

Error unknown_family(const std::string& name) {
  std::string known;
  for (const std::string& family : tag_families()) known += (known.empty() ? "" : ", ") + family;
  return {.message = "unknown tag family '" + name + "'", .hint = "use one of " + known};
}

}  // namespace pcavr
