// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "paper_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "html_text.hpp"
#include "pooled_errors.hpp"

namespace pcavr {
namespace {

/// What the papers print. B: haptic augmented reality, contact of a robot's tool with plastic.
/// C: movable objects in a point-cloud augmented virtual environment.
struct Printed {
  const char* source;
  const char* what;
  const char* figure;
};
constexpr Printed kLimitingFoam = {"C, position tracking",
                                   "limiting friction of the foam-faced box, and its STD",
                                   "9.57 N, 0.861 N"};
constexpr Printed kLimitingRubber = {"C, position tracking",
                                     "limiting friction of the rubber-faced box, and its STD",
                                     "40.62 N, 2.346 N"};
constexpr Printed kMass = {"C, table 2", "error of the mass", "about 5 %"};
constexpr Printed kSlidingError = {
    "C, Fig. 10", "position error while sliding; theirs without delay", "about 3 mm"};
constexpr Printed kSystemError = {"C, Fig. 11",
                                  "position error while touched or moving, with 200 + 200 ms",
                                  "no figure; mainly in the transitions"};
constexpr Printed kForceError = {"C, Fig. 9", "relative force error once parameters were sent",
                                 "below 10 %"};
constexpr Printed kPeakError = {"B, table 3", "relative error of the largest force of a contact",
                                "1.85 ± 0.85 %"};
constexpr Printed kSlotting = {"B, hole slotting", "largest force: real, virtual, difference",
                               "91.23 N, 93.27 N, 2.24 %"};

/// B's table 3: the largest force of a contact along z by approach speed.
struct PrintedContact {
  double speed;     ///< [mm/s]
  double measured;  ///< [N]
  double felt;      ///< [N]
};
constexpr std::array<PrintedContact, 7> kContactsOfB = {{{5, 22.41, 22.85},
                                                         {10, 21.57, 21.73},
                                                         {20, 18.97, 18.35},
                                                         {30, 16.87, 16.60},
                                                         {40, 19.21, 18.68},
                                                         {50, 18.88, 19.06},
                                                         {60, 17.49, 17.20}}};

std::string with_unit(double value, const char* unit) { return readable(value) + ' ' + unit; }

std::string of_errors(const std::vector<double>& errors, double scale, const char* unit) {
  if (errors.empty()) return "-";
  const ErrorStatistics figures = statistics(errors);
  return "median " + with_unit(scale * figures.median, unit) + ", rmse " +
         with_unit(scale * figures.rmse, unit) + ", 95 % below " +
         with_unit(scale * figures.p95, unit) + ", worst " + with_unit(scale * figures.max, unit);
}

/// A parameter of every object that has it, each as `text` puts it.
template <typename Text>
std::string of_parameter(const Findings& findings, const std::string& name, Text text) {
  std::string all;
  for (const ParameterError& error : findings.parameters) {
    const std::string one = error.name == name ? text(error) : std::string();
    if (!one.empty()) all += (all.empty() ? "" : "; ") + error.object + " " + one;
  }
  return all.empty() ? "-" : all;
}

/// Only boxes that bear what the paper's do can stand beside them.
std::string limiting_friction_near(const Findings& findings, double paper) {
  constexpr double kSameBox = 0.02;  // share: the paper gives three digits of a spread of 6 to 9 %
  return of_parameter(findings, "limiting_static_friction", [&](const ParameterError& error) {
    const double known = error.truth ? *error.truth : paper;
    if (!error.estimate || std::abs(known - paper) > kSameBox * paper) return std::string();
    const std::optional<double>& deviation = error.estimate->deviation;
    return with_unit(error.estimate->value, "N") +
           (deviation ? ", " + with_unit(*deviation, "N") : "") +
           (error.truth ? " (true: " + with_unit(*error.truth, "N") + ")" : "");
  });
}

std::string mass_errors(const Findings& findings) {
  return of_parameter(findings, "mass", [](const ParameterError& error) {
    return error.relative ? with_unit(kPercent * *error.relative, "%") : std::string();
  });
}

std::string max_forces(const RunFindings& run) {
  ContactPeak largest;
  for (const auto& [object, peaks] : run.peaks) {
    for (const ContactPeak& peak : peaks) {
      if (peak.measured > largest.measured) largest = peak;
    }
  }
  if (largest.measured <= 0.0) return "-";
  return with_unit(largest.measured, "N") + ", " + with_unit(largest.felt, "N") + ", " +
         with_unit(kPercent * std::abs(largest.felt - largest.measured) / largest.measured, "%");
}

std::string peak_error_text(const RunFindings& run) {
  const std::vector<double> errors = peak_errors(run);
  if (errors.empty()) return "-";
  const ErrorStatistics figures = statistics(errors);
  return readable(kPercent * figures.mean) + " ± " + with_unit(kPercent * figures.std, "%") +
         " of " + std::to_string(errors.size()) + " contacts";
}

/// Nothing ever slides: only then is a contact one as paper B's.
bool is_of_presses(const RunFindings& run) {
  for (const auto& [object, timeline] : run.phases()) {
    for (const PhaseChange& change : timeline) {
      if (change.phase == Phase::sliding) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<double> peak_errors(const RunFindings& run) {
  std::vector<double> errors;
  for (const auto& [object, peaks] : run.peaks) {
    for (const ContactPeak& peak : peaks) {
      errors.push_back(std::abs(peak.felt - peak.measured) / peak.measured);
    }
  }
  return errors;
}

ReportTable paper_table(const Findings& findings) {
  const RunFindings& run = *findings.run;
  ReportTable table{.title = "The papers' figures and this run's",
                    .columns = {"figure", "paper", "printed there", "this run"}};
  const auto add = [&](const Printed& printed, const std::string& ours) {
    table.rows.push_back({printed.what, printed.source, printed.figure, ours});
  };
  const auto millimetres = [](const std::vector<PoseError>& errors) {
    return of_errors(translations(errors), kMillimetres, "mm");
  };
  add(kLimitingFoam, limiting_friction_near(findings, 9.57));
  add(kLimitingRubber, limiting_friction_near(findings, 40.62));
  add(kMass, mass_errors(findings));
  add(kSlidingError, millimetres(predicted_errors_in(
                         findings, [](Phase phase) { return phase == Phase::sliding; })));
  add(kSystemError, millimetres(predicted_errors_in(findings, is_touched_or_moving)));
  add(kForceError, of_errors(relative_force_errors(run), kPercent, "%"));
  add(kPeakError, peak_error_text(run));
  add(kSlotting, max_forces(run));
  table.note =
      "B: haptic augmented reality with seven damping laws; C: movable objects in a point-cloud "
      "augmented virtual environment. Their boxes and robots are real; where a run is of a "
      "simulated recording, methods are compared under stated noise, not hardware. The text of C "
      "at hand lacks the numbers of its tables 1 and 2; this run's stand under Parameters. C's "
      "figures 8 and 9, the comparison of estimators, are in the report of pcavr identify.";
  return table;
}

ReportTable contact_table(const Findings& findings) {
  const RunFindings& run = *findings.run;
  ReportTable table{.title = "Largest force of each contact",
                    .columns = {"contact", "speed (mm/s)", "measured (N)", "felt (N)", "error (%)"},
                    .is_folded = true};
  const auto add = [&](const std::string& name, const std::string& speed, double measured,
                       double felt) {
    table.rows.push_back({name, speed, readable(measured), readable(felt),
                          readable(kPercent * std::abs(felt - measured) / measured)});
  };
  for (const auto& [object, peaks] : run.peaks) {
    for (const ContactPeak& peak : peaks) {
      const std::string t = fixed(to_seconds(peak.begin - findings.origin), 3);
      const std::optional<double>& speed = peak.approach_speed;
      add(object + ", from " + t + " s", speed ? readable(kMillimetres * *speed) : "-",
          peak.measured, peak.felt);
    }
  }
  if (table.rows.empty() || !is_of_presses(run)) return table;
  table.is_folded = false;
  for (const PrintedContact& contact : kContactsOfB) {
    add("paper B, table 3", fixed(contact.speed, 0), contact.measured, contact.felt);
  }
  return table;
}

}  // namespace pcavr
