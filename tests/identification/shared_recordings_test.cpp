// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/physics/identification/contact_fit.hpp"
#include "pcavr/physics/identification/estimator.hpp"
#include "pcavr/physics/identification/local_direction.hpp"
#include "pcavr/physics/identification/segmentation.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/identification/sliding.hpp"

#include "support/shared_data.hpp"

namespace pcavr {
namespace {

std::vector<std::vector<double>> read_numbers(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(file, line);  // the header
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::vector<double>& row = rows.emplace_back();
    for (double value = 0.0; words >> value;) row.push_back(value);
  }
  return rows;
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

struct Window {
  std::vector<double> t, tool, force;
};

/// Windows of 3 s (2 s remain after the drift's smoothing has removed the ends), each along its own
/// mean force. Force on the tip and position in mm, as logged.
std::vector<Window> palpation_windows(const std::vector<std::vector<double>>& rows) {
  std::vector<Window> windows;
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    while (end < rows.size() && rows[end][0] == rows[i][0] && rows[end][1] < rows[i][1] + 3.0 &&
           (end == i || rows[end][1] > rows[end - 1][1])) {
      sum += Eigen::Vector3d(rows[end][5], rows[end][6], rows[end][7]);
      ++end;
    }
    Window window;
    const Eigen::Vector3d out = sum.normalized();
    for (std::size_t k = i; k < end; ++k) {
      window.t.push_back(rows[k][1]);
      window.tool.push_back(-1e-3 * out.dot(Eigen::Vector3d(rows[k][2], rows[k][3], rows[k][4])));
      window.force.push_back(out.dot(Eigen::Vector3d(rows[k][5], rows[k][6], rows[k][7])));
    }
    if (window.t.size() > 120) windows.push_back(std::move(window));
    i = std::max(i + 1, end);
  }
  return windows;
}

TEST(Palpation, HasTheKnownStiffnessAndADampingWithItsStd) {
  PCAVR_NEEDS_SHARED_DATA("real/palpation/ContPalpRAL18T1.csv");
  ContactFitOptions options;
  options.drift_half_width = 0.5;  // one period of the 2 Hz it was pressed with
  std::vector<double> stiffness, damping, damping_std;
  for (const Window& window :
       palpation_windows(read_numbers(shared_data("real/palpation/ContPalpRAL18T1.csv")))) {
    const ForceMotion press{window.t, window.tool, window.force};
    const ContactFit fit = identify_contact(std::span(&press, 1), options).best();
    if (!fit.is_valid) continue;
    stiffness.push_back(fit.stiffness.value);
    damping.push_back(fit.damping.value);
    damping_std.push_back(fit.damping.std);
  }
  ASSERT_GT(stiffness.size(), 50U);
  RecordProperty("windows", std::to_string(stiffness.size()));
  RecordProperty("stiffness", std::to_string(quantile(stiffness, 0.5)));
  RecordProperty("damping", std::to_string(quantile(damping, 0.5)));
  RecordProperty("damping_std", std::to_string(quantile(damping_std, 0.5)));
  EXPECT_NEAR(quantile(stiffness, 0.5), 483.0, 0.05 * 483.0);
  EXPECT_NEAR(quantile(damping, 0.5), 2.0, 1.0);
  EXPECT_LT(quantile(damping_std, 0.5), 1.0);
}

/// A palpation run as logged: one long travel in contact, cut only where the tip leaves the tissue.
struct Travel {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> force_base, p_base_tip;
};

Travel palpation_travel(const std::vector<std::vector<double>>& rows) {
  Travel travel;
  for (const auto& row : rows) {
    if (!travel.t.empty() && row[1] <= travel.t.back()) continue;
    travel.t.push_back(row[1]);
    travel.p_base_tip.push_back(1e-3 * Eigen::Vector3d(row[2], row[3], row[4]));
    travel.force_base.push_back(-Eigen::Vector3d(row[5], row[6], row[7]));
  }
  return travel;
}

TEST(Palpation, HasTheKnownStiffnessWithoutBeingCutIntoWindows) {
  PCAVR_NEEDS_SHARED_DATA("real/palpation/ContPalpRAL18T1.csv");
  const Travel travel =
      palpation_travel(read_numbers(shared_data("real/palpation/ContPalpRAL18T1.csv")));
  const Segmentation cut =
      segment_contacts(travel.t, travel.force_base, travel.t, travel.p_base_tip);
  const PathView tip(travel.t, travel.p_base_tip);
  const ContactFitOptions options;
  std::vector<LocalContact> contacts;
  std::vector<ForceMotion> presses, local;
  contacts.reserve(cut.contacts.size());
  for (const Contact& contact : cut.contacts) {
    if (contact.kind != ContactKind::press || contact.impact) continue;
    const auto first = std::lower_bound(travel.t.begin(), travel.t.end(), contact.t.front());
    const auto begin = static_cast<std::size_t>(first - travel.t.begin());
    contacts.push_back(along_local_force(contact.t,
                                         std::span(cut.force_base).subspan(begin, contact.t.size()),
                                         tip, options.moving_half_width));
    presses.push_back(contact.series());
    local.push_back(contacts.back().series(contact.tool_noise));
  }
  const ContactIdentification found = identify_contact(presses, options, local);
  const IdentifiedParameter& stiffness = found.best().stiffness;
  RecordProperty("stiffness", std::to_string(stiffness.value));
  RecordProperty("stiffness_std", std::to_string(stiffness.std));
  EXPECT_NE(found.proposal.find("the surface moves"), std::string::npos);
  EXPECT_NEAR(stiffness.value, 483.0, 0.05 * 483.0);
  EXPECT_LT(stiffness.std, 0.1 * 483.0);
}

/// One segment of a palpation run, along its mean force.
Window whole_segment(const std::vector<std::vector<double>>& rows, double segment) {
  Window window;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& row : rows) {
    if (row[0] == segment) sum += Eigen::Vector3d(row[5], row[6], row[7]);
  }
  const Eigen::Vector3d out = sum.normalized();
  for (const auto& row : rows) {
    if (row[0] != segment || (!window.t.empty() && row[1] <= window.t.back())) continue;
    window.t.push_back(row[1]);
    window.tool.push_back(-1e-3 * out.dot(Eigen::Vector3d(row[2], row[3], row[4])));
    window.force.push_back(out.dot(Eigen::Vector3d(row[5], row[6], row[7])));
  }
  return window;
}

/// Relative rms error of the force predicted from damping, stiffness and offset that are a filter
/// width old, after 2 s: the tip drifts over the surface, so that the offset changes.
template <typename Estimator>
double palpation_error(Estimator estimator, const Window& window, double correlated) {
  const double interval = mean_interval(window.t);
  CausalFilter filter(3.0 * interval, 1.0 / interval, estimate_noise_std(window.force));
  std::vector<std::array<double, 3>> earlier(
      static_cast<std::size_t>(std::max(1L, std::lround(1.4 * correlated))));
  double squares = 0.0, force_squares = 0.0;
  for (std::size_t i = 0; i < window.t.size(); ++i) {
    const auto out =
        filter.step(window.t[i], window.tool[i] - window.tool.front(), window.force[i]);
    if (!out) continue;
    const std::array<double, 3> phi{out->speed, out->position, 1.0};
    std::array<double, 3>& then = earlier[i % earlier.size()];
    const double error = then[0] * phi[0] + then[1] * phi[1] + then[2] * phi[2] - out->force;
    estimator.step(phi, out->force);
    then = estimator.parameters();
    if (out->t < window.t.front() + 2.0) continue;
    squares += error * error, force_squares += out->force * out->force;
  }
  return std::sqrt(squares / force_squares);
}

TEST(Palpation, IsPredictedBetterByTheAdaptiveForgettingFactorThanByAConstantOne) {
  for (const char* name : {"ContPalpRAL18T1", "ContPalpTrial1", "ContPalpTrial3"}) {
    const std::string path = std::string("real/palpation/") + name + ".csv";
    PCAVR_NEEDS_SHARED_DATA(path);
    const auto rows = read_numbers(shared_data(path));
    const Window window = whole_segment(rows, rows.front()[0]);
    EstimatorOptions<3> options;
    options.scale = {0.01, 0.003, 1.0};
    const double interval = mean_interval(window.t);
    options.correlated_samples = correlated_samples(3.0 * interval, interval);
    const double correlated = options.correlated_samples;
    options.method = EstimationMethod::averaged;
    const double averaged = palpation_error(ParameterEstimator<3>(options), window, correlated);
    options.method = EstimationMethod::adaptive;
    const double unity = palpation_error(ParameterEstimator<3>(options), window, correlated);
    options.method = EstimationMethod::exponential;
    const double constant = palpation_error(ParameterEstimator<3>(options), window, correlated);
    options.method = EstimationMethod::block;
    const double block = palpation_error(ParameterEstimator<3>(options), window, correlated);
    RecordProperty(std::string(name) + "_affrls", std::to_string(averaged));
    RecordProperty(std::string(name) + "_unity_zone", std::to_string(unity));
    RecordProperty(std::string(name) + "_ewrls", std::to_string(constant));
    RecordProperty(std::string(name) + "_bsls", std::to_string(block));
    EXPECT_LE(averaged, constant) << name;
    EXPECT_LT(averaged, block) << name;
    EXPECT_LT(averaged, unity) << name;
  }
}

TEST(PushTwoBoxes, IsIdentifiedFromOnePushEach) {
  PCAVR_NEEDS_SHARED_DATA("push_two_boxes/wrench.csv");
  std::vector<double> t_force, t_tool;
  std::vector<Eigen::Vector3d> force_base, p_base_tip;
  for (const auto& row : read_numbers(shared_data("push_two_boxes/wrench.csv"))) {
    t_force.push_back(row[0]);
    force_base.push_back({row[1], row[2], row[3]});
  }
  for (const auto& row : read_numbers(shared_data("push_two_boxes/tool.csv"))) {
    t_tool.push_back(row[0]);
    p_base_tip.push_back({row[1], row[2], row[3]});
  }
  const Segmentation found = segment_contacts(t_force, force_base, t_tool, p_base_tip);
  ASSERT_EQ(found.contacts.size(), 2U);
  // truth/parameters.yaml and truth/phase.csv.
  struct Truth {
    const char* name;
    double mass, limit, coulomb, viscous, contact, slide, stop, leave;
    HuntCrossley contact_law;
  };
  const Truth truths[] = {
      {"fp_box", 3.0, 9.57, 8.323, 10.0, 0.619, 1.206, 1.876, 2.172, {20600.0, 82400.0, 1.5}},
      {"r_box", 3.5, 40.62, 34.514, 25.0, 4.188, 4.582, 5.182, 5.480, {247000.0, 617500.0, 1.5}}};
  for (std::size_t i = 0; i < 2; ++i) {
    const Contact& contact = found.contacts[i];
    const Truth& truth = truths[i];
    EXPECT_EQ(contact.kind, ContactKind::slide);
    EXPECT_NEAR(contact.begin, truth.contact, 0.06);
    EXPECT_NEAR(contact.end, truth.leave, 0.06);
    ASSERT_EQ(contact.slides.size(), 1U);
    EXPECT_NEAR(contact.slides[0].begin, truth.slide, 0.06);
    EXPECT_NEAR(contact.slides[0].end, truth.stop, 0.06);
    SlidingOptions options;
    options.mass = truth.mass;
    const ForceMotion series = contact.series();
    const SlidingIdentification sliding =
        identify_sliding(std::span(&series, 1), truth.contact_law, options);
    ASSERT_TRUE(sliding.is_valid);
    const double friction = truth.coulomb + truth.viscous * sliding.speed;
    EXPECT_NEAR(sliding.coulomb.value + sliding.viscous.value * sliding.speed, friction,
                0.03 * friction);
    const IdentifiedParameter limit =
        friction_at_breakaway(series, contact.breakaway, truth.contact_law, truth.mass);
    // The first box is pushed fast, from rest just below its limit: its peak is 29 % above it.
    EXPECT_NEAR(limit.value, truth.limit, 0.15 * truth.limit);
    EXPECT_NEAR(limit.value, truth.limit, 2.0 * limit.std);
    const std::string name = truth.name;
    RecordProperty(name + "_limit", std::to_string(limit.value));
    RecordProperty(name + "_limit_std", std::to_string(limit.std));
    RecordProperty(name + "_peak", std::to_string(contact.breakaway.force));
    RecordProperty(name + "_friction", std::to_string(sliding.coulomb.value));
    RecordProperty(name + "_friction_truth", std::to_string(friction));
    RecordProperty(name + "_slide_begin", std::to_string(contact.slides[0].begin));
    RecordProperty(name + "_slide_end", std::to_string(contact.slides[0].end));
  }
}

}  // namespace
}  // namespace pcavr
