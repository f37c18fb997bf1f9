// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gtest/gtest.h>

#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

TEST(StateFindings, ReportThatAnObjectSlidWhereNoSampleOfItsSlidesIsUsable) {
  const auto remark = [](double slid) {
    ObjectIdentification found;
    IdentifiableObject object;
    object.is_movable = true;
    state_findings(IdentificationGoal::friction, object, slid, found);
    for (const ParameterFinding& row : found.findings)
      if (row.name == "sliding_friction_coefficient") return row.remark;
    return std::string();
  };
  EXPECT_EQ(remark(0.2), "slide the object for a second or more at 40 mm/s");
  EXPECT_NE(remark(12.3).find("it slid for 12.3 s"), std::string::npos) << remark(12.3);
}

}  // namespace
}  // namespace pcavr
