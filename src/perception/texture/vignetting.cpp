// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "vignetting.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

/// Prior std of the vignetting: cos^4 of the angle alone gives 2.
constexpr double kVignettingStd = 0.3;
constexpr double kMaxVignetting = 1.0;
/// Std of a colour's difference between views, as a share: larger ones are shadows and highlights.
constexpr double kRelativeNoise = 0.05;
/// Observations with about one common error: what light and geometry leave is not noise.
constexpr double kCorrelatedSamples = 300.0;
constexpr float kDark = 8.0F;  ///< of 255: whatever the vignetting

/// A point's colour in a view.
struct VignettedSample {
  Eigen::Index view = 0;
  double log_gray = 0.0;
  double by_vignetting = 0.0;  ///< derivative of log_gray
  double weight = 1.0;
};

void collect_in_logarithms(const std::vector<SeenColor>& point,
                           const std::vector<PaintedView>& views,
                           std::vector<VignettedSample>& samples) {
  samples.clear();
  for (const SeenColor& seen : point) {
    const PaintedView& view = views[seen.view];
    const float gray = view.evened_out(seen.raw).mean();
    if (gray < kDark) continue;
    const float slope = seen.raw.squared_slope;
    samples.push_back({static_cast<Eigen::Index>(seen.view), std::log(static_cast<double>(gray)),
                       static_cast<double>(view.brightening(slope) * slope)});
  }
}

/// Huber's weights around the median [Huber 1964].
void weigh_around_median(std::vector<VignettedSample>& samples) {
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(
      samples.begin(), middle, samples.end(),
      [](const VignettedSample& a, const VignettedSample& b) { return a.log_gray < b.log_gray; });
  const double median = middle->log_gray;
  for (VignettedSample& sample : samples)
    sample.weight = kRelativeNoise / std::max(kRelativeNoise, std::abs(sample.log_gray - median));
}

/// Equations of the views' logarithmic gains, with the vignetting as the last unknown.
class VignettingEquations {
 public:
  explicit VignettingEquations(Eigen::Index views)
      : H_(Eigen::MatrixXd::Zero(views + 1, views + 1)), g_(Eigen::VectorXd::Zero(views + 1)) {}

  /// The point's colour is eliminated: the sums are those of differences from the weighted mean.
  void add(const std::vector<VignettedSample>& samples) {
    const Eigen::Index last = g_.size() - 1;
    double sum = 0.0;
    double mean_gray = 0.0;
    double mean_slope = 0.0;
    for (const VignettedSample& s : samples) {
      sum += s.weight;
      mean_gray += s.weight * s.log_gray;
      mean_slope += s.weight * s.by_vignetting;
    }
    mean_gray /= sum;
    mean_slope /= sum;
    for (const VignettedSample& s : samples) {
      const double residual = s.weight * (s.log_gray - mean_gray);
      const double slope = s.by_vignetting - mean_slope;
      for (const VignettedSample& other : samples)
        H_(s.view, other.view) -= s.weight * other.weight / sum;
      H_(s.view, s.view) += s.weight;
      H_(s.view, last) += s.weight * slope;
      H_(last, s.view) += s.weight * slope;
      H_(last, last) += s.weight * slope * slope;
      g_[s.view] += residual;
      g_[last] += residual * slope;
      count_ += 1.0;
    }
  }

  /// The change of the vignetting.
  [[nodiscard]] double step(double vignetting) const {
    const Eigen::Index last = g_.size() - 1;
    Eigen::MatrixXd H = H_;
    H.diagonal().array() += 1.0;  // the mean of the gains is free
    const double prior =
        (1.0 + count_ / kCorrelatedSamples) * std::pow(kRelativeNoise / kVignettingStd, 2);
    H(last, last) += prior;
    Eigen::VectorXd g = g_;
    g[last] += prior * vignetting;
    return -H.ldlt().solve(g)[last];
  }

 private:
  Eigen::MatrixXd H_;
  Eigen::VectorXd g_;
  double count_ = 0.0;
};

}  // namespace

void estimate_vignetting(std::vector<PaintedView>& views, const SeenColors& points) {
  if (views.empty()) return;
  VignettingEquations normal(static_cast<Eigen::Index>(views.size()));
  std::vector<VignettedSample> samples;
  for (const std::vector<SeenColor>& point : points) {
    collect_in_logarithms(point, views, samples);
    if (samples.size() < 2) continue;
    weigh_around_median(samples);
    normal.add(samples);
  }
  const auto before = static_cast<double>(views.front().vignetting);
  const double after = std::clamp(before + normal.step(before), 0.0, kMaxVignetting);
  for (PaintedView& view : views) view.vignetting = static_cast<float>(after);
}

}  // namespace pcavr
