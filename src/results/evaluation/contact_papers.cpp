// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/report/number_text.hpp"
#include "pcavr/physics/contact/impact.hpp"

#include "paper_comparison.hpp"
#include "pooled_errors.hpp"

namespace pcavr {
namespace {

constexpr char kNone[] = "–";

/// Paper B's table 3: the peak force of a contact along z by approach speed.
struct PublishedPress {
  double speed;     ///< [mm/s]
  double measured;  ///< [N]
  double rendered;  ///< [N]
};
constexpr std::array<PublishedPress, 7> kPressesOfB = {{{5, 22.41, 22.85},
                                                        {10, 21.57, 21.73},
                                                        {20, 18.97, 18.35},
                                                        {30, 16.87, 16.60},
                                                        {40, 19.21, 18.68},
                                                        {50, 18.88, 19.06},
                                                        {60, 17.49, 17.20}}};

/// Paper B's table 4 [%].
constexpr std::pair<const char*, double> kSoftOfB[] = {
    {"paper B's method", 2.24}, {"GADM, as in B", 2.75}, {"HSMM, as in B", 3.12}};

/// Slower and faster than table 3's by this factor, a press is compared with its nearest speed:
/// impacts are faster.
constexpr double kSpeedMargin = 1.5;

/// Restitution at which B chooses Herbert-McWhannell.
constexpr double kRestitutionOfB = 0.8;

double relative_error(double measured, double rendered) {
  return std::abs(rendered - measured) / measured;
}

/// Index of B's speed that is nearest by ratio.
std::size_t nearest_speed(double speed) {
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < kPressesOfB.size(); ++i) {
    const auto distance = [&](std::size_t k) {
      return std::abs(std::log(kMillimetres * speed / kPressesOfB[k].speed));
    };
    if (distance(i) < distance(nearest)) nearest = i;
  }
  return nearest;
}

std::string mean_and_std(const std::vector<double>& errors) {
  return errors.empty() ? kNone : mean_percent_text(errors);
}

ReportTable table_3(const std::vector<ContactPeak>& presses) {
  ReportTable table{.title = "Presses by speed [paper B, table 3]",
                    .columns = {"speed (mm/s)", "B: real, virtual (N)", "B: error (%)",
                                "this run: real, rendered (N)", "error (%)", "presses"}};
  std::array<std::vector<ContactPeak>, kPressesOfB.size()> by_speed;
  for (const ContactPeak& press : presses) {
    by_speed[nearest_speed(*press.approach_speed)].push_back(press);
  }
  std::vector<double> errors_of_b, errors;
  for (std::size_t i = 0; i < kPressesOfB.size(); ++i) {
    const PublishedPress& b = kPressesOfB[i];
    errors_of_b.push_back(relative_error(b.measured, b.rendered));
    double measured = 0.0, rendered = 0.0;
    std::vector<double> own;
    for (const ContactPeak& press : by_speed[i]) {
      measured += press.measured;
      rendered += press.rendered;
      own.push_back(relative_error(press.measured, press.rendered));
    }
    const auto count = static_cast<double>(own.size());
    const std::string forces =
        own.empty() ? kNone : readable(measured / count) + ", " + readable(rendered / count);
    const std::string error = own.empty() ? kNone : readable(kPercent * statistics(own).mean);
    table.rows.push_back({fixed(b.speed, 0), fixed(b.measured, 2) + ", " + fixed(b.rendered, 2),
                          readable(kPercent * errors_of_b.back()), forces, error,
                          std::to_string(own.size())});
    errors.insert(errors.end(), own.begin(), own.end());
  }
  table.rows.push_back({"all", "", mean_and_std(errors_of_b), "", mean_and_std(errors),
                        std::to_string(errors.size())});
  table.note = "Forces: means of the presses nearest to a speed, of all objects.";
  return table;
}

ReportTable table_4(const std::vector<ContactPeak>& presses) {
  ReportTable table{.title = "Soft object: error of the peak force [paper B, table 4]",
                    .columns = {"method", "error (%)", "presses"}};
  for (const auto& [method, error] : kSoftOfB) table.rows.push_back({method, readable(error), ""});
  std::vector<double> errors;
  for (const ContactPeak& press : presses) {
    errors.push_back(relative_error(press.measured, press.rendered));
  }
  table.rows.push_back({"this run", mean_and_std(errors), std::to_string(errors.size())});
  return table;
}

/// Empty where no object of the run has a restitution.
ReportTable figure_6(const Findings& findings) {
  ReportTable table{.title = "Error of the damping laws' restitution [paper B, figure 6]",
                    .columns = {"law", "B's choice: at " + fixed(kRestitutionOfB, 1) + " (%)"}};
  if (!findings.run->files.parameters) return {};
  std::vector<double> restitutions{kRestitutionOfB};
  for (const auto& [object, known] : *findings.run->files.parameters) {
    const auto& c = known.contact_restitution;
    if (!c || !(c->value > 0.0 && c->value < 1.0)) continue;
    restitutions.push_back(c->value);
    table.columns.push_back(object + ": at " + readable(c->value) + " (%)");
  }
  if (restitutions.size() == 1) return {};
  std::vector<DampingLaw> laws(kPublishedDampingLaws.begin(), kPublishedDampingLaws.end());
  laws.push_back(DampingLaw::exact);
  for (const DampingLaw law : laws) {
    std::vector<std::string> row{std::string(name_of(law))};
    for (const double c : restitutions) {
      const bool is_best = best_published_damping_law(c).law == law;
      row.push_back(fixed(kPercent * score_damping_law(law, c).relative_error, 1) +
                    (is_best ? " (smallest)" : ""));
    }
    table.rows.push_back(std::move(row));
  }
  table.note = "B takes Herbert-McWhannell at 0.8. The exact relation is not one of B's.";
  return table;
}

bool has_speed_of_b(const ContactPeak& press) {
  if (!press.approach_speed) return false;
  const double speed = kMillimetres * *press.approach_speed;
  return speed > kPressesOfB.front().speed / kSpeedMargin &&
         speed < kPressesOfB.back().speed * kSpeedMargin;
}

}  // namespace

std::vector<ContactPeak> experiment_presses(const RunFindings& run, bool soft) {
  std::vector<ContactPeak> presses;
  std::size_t at_speed = 0, contacts = 0;
  for (const auto& [object, peaks] : run.peaks) {
    for (const ContactPeak& peak : peaks) {
      ++contacts;
      if (peak.task != ContactTask::press || !has_speed_of_b(peak)) continue;
      ++at_speed;
      if (is_soft_press(peak) == soft) presses.push_back(peak);
    }
  }
  if (2 * at_speed < contacts) presses.clear();
  return presses;
}

std::vector<ReportTable> contact_paper_tables(const Findings& findings) {
  std::vector<ReportTable> tables;
  const std::vector<ContactPeak> hard = experiment_presses(*findings.run, false);
  const std::vector<ContactPeak> soft = experiment_presses(*findings.run, true);
  if (!hard.empty()) tables.push_back(table_3(hard));
  if (!soft.empty()) tables.push_back(table_4(soft));
  ReportTable laws = figure_6(findings);
  if (!laws.rows.empty()) tables.push_back(std::move(laws));
  return tables;
}

}  // namespace pcavr
