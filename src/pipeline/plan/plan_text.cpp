// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "pcavr/pipeline/plan_motion.hpp"

namespace pcavr {

std::string format_path(const MotionPlan& plan) {
  std::string text = "t,x,y,z\n";
  for (const PlannedPoint& point : plan.path) {
    text += fmt::format("{:.3f},{:.6f},{:.6f},{:.6f}\n", point.t, point.p_base.x(),
                        point.p_base.y(), point.p_base.z());
  }
  return text;
}

namespace {

std::string std_text(const std::optional<double>& std) {
  return std ? fmt::format("{:.2g}", *std) : "not known yet";
}

std::string contacts_text(const ObjectPlan& one) {
  std::vector<std::string> parts;
  if (one.press_series > 0) {
    parts.push_back(fmt::format("{} x presses at 5, 15 and 40 mm/s, {:.2g} mm deep",
                                one.press_series, 1e3 * one.press_depth));
  }
  if (one.breakaways > 0) {
    parts.push_back(fmt::format("{} pushes at {:.2g} mm/s until it slides", one.breakaways,
                                1e3 * one.loading_speed));
  }
  if (one.slides > 0) {
    parts.push_back(
        fmt::format("{} slides of {:.0f} mm at {:.0f} mm/s, modulated by {:.2g} Hz, {:.2g} mm",
                    one.slides, 1e3 * one.slide.distance, 1e3 * one.slide.speed,
                    one.slide.frequency, 1e3 * one.slide.amplitude));
  }
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : "; ") + part;
  return text.empty() ? "nothing: the wished stds are reached" : text;
}

}  // namespace

std::vector<std::string> describe_plan(const MotionPlan& plan) {
  std::vector<std::string> lines;
  for (const ObjectPlan& one : plan.objects) {
    lines.push_back(one.name + ": " + contacts_text(one));
    for (const PlannedStd& row : one.stds) {
      lines.push_back(fmt::format("  {:<30} std now: {}, expected: {}, wished: {} {}", row.name,
                                  row.now ? std_text(row.now) : "-", std_text(row.expected),
                                  std_text(row.wished), row.unit));
    }
    for (const std::string& note : one.notes) lines.push_back("  note: " + note);
  }
  return lines;
}

}  // namespace pcavr
