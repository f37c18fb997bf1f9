// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/checks/tracked_start.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

const Pose kFirstPlace = Pose::from_translation({0.5, 0.3, 0.05});
const Pose kSecondPlace = Pose::from_translation({0.6, -0.3, 0.05});

TrackedStart start(const std::string& name, const Pose& stated, const Pose& tracked) {
  return {name, "objects/" + name + "/tracked.txt", stated, tracked};
}

void expect_one(const std::vector<ConsistencyFinding>& findings, FindingSeverity severity,
                const std::string& text) {
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, severity);
  EXPECT_NE((findings[0].message + findings[0].hint).find(text), std::string::npos)
      << findings[0].to_string();
}

TEST(TrackedStart, AgreesWithinSomeCentimetres) {
  const Pose nudged = kFirstPlace * Pose::from_translation({0.03, 0.0, 0.0});
  EXPECT_TRUE(check_tracked_starts(
                  {start("a", kFirstPlace, nudged), start("b", kSecondPlace, kSecondPlace)})
                  .empty());
  EXPECT_TRUE(check_tracked_starts({}).empty());
}

TEST(TrackedStart, NamesTwoTracksThatAreExchanged) {
  const auto findings = check_tracked_starts(
      {start("a", kFirstPlace, kSecondPlace), start("b", kSecondPlace, kFirstPlace)});
  expect_one(findings, FindingSeverity::contradiction, "they are exchanged");
  EXPECT_NE(findings[0].message.find("of b"), std::string::npos);
}

TEST(TrackedStart, NamesAMirroredAxisAMillimetreAndAnInvertedPose) {
  const auto mirrored = [](const Pose& T) {
    return Pose(T.rotation(), {T.translation().x(), -T.translation().y(), T.translation().z()});
  };
  const auto millimetres = [](const Pose& T) {
    return Pose(T.rotation(), 1000.0 * T.translation());
  };
  const auto inverse = [](const Pose& T) { return T.inverse(); };
  // The places are not symmetric, so that mirroring does not exchange them.
  const Pose second = kSecondPlace * Pose::from_translation({0.0, 0.12, 0.0});
  const auto both = [&](const auto& change) {
    return check_tracked_starts(
        {start("a", kFirstPlace, change(kFirstPlace)), start("b", second, change(second))});
  };
  expect_one(both(mirrored), FindingSeverity::contradiction, "with y mirrored");
  expect_one(both(millimetres), FindingSeverity::contradiction, "millimetres");
  expect_one(both(inverse), FindingSeverity::contradiction, "inverted");
}

TEST(TrackedStart, WarnsOfAnObjectThatWasMovedBefore) {
  const Pose moved = kFirstPlace * Pose::from_translation({0.2, 0.1, 0.0});
  expect_one(check_tracked_starts(
                 {start("a", kFirstPlace, moved), start("b", kSecondPlace, kSecondPlace)}),
             FindingSeverity::warning, "the track of a begins 0.224 m from its pose");
}

}  // namespace
}  // namespace pcavr
