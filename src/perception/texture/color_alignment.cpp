// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "color_alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "pcavr/base/core/solvers.hpp"

#include "exposure.hpp"

namespace pcavr {
namespace {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;
using Row7d = Eigen::Matrix<double, 1, 7>;
using Row6d = Eigen::Matrix<double, 1, 6>;

constexpr std::size_t kMaxPoints = 12'000;
constexpr std::size_t kPointsPerChunk = 500;
constexpr double kNoise = 8.0;  ///< std of a colour's difference between views, of 255
/// Prior std of the registration between colour and depth camera of one sensor: focal scale, offset
/// [px of 640], roll [rad], translation [m].
constexpr std::array<double, 7> kRegistrationStd{0.10, 12.0, 12.0, 0.02, 0.03, 0.03, 0.01};
/// Prior std of a view's pose after tracking: translation [m] and rotation [rad].
constexpr double kTranslationStd = 0.003;
constexpr double kRotationStd = 0.002;
/// Observations with about one common error: what geometry, poses and light leave is not noise.
constexpr double kCorrelated = 300.0;
/// Steps of the registration in images of one size: robust weights make them short where many
/// points are far off. Ended where no parameter moves by more than a share of its prior std.
constexpr int kMaxSteps = 20;
constexpr double kMinStep = 0.01;
/// Another registration is taken if it lowers the mean difference at least by this factor.
constexpr double kMinImprovement = 0.97;
/// It must also move the points at least by this in the mean, as a share of the image's width: less
/// than 2.6 of 640 pixels may come from the poses' errors.
constexpr double kMinDisplacement = 0.004;
/// Mean distance between a point's pixels in its first and last view from which the registration
/// is identified, as a share of the image's width: a camera that stands still says nothing about
/// it.
constexpr double kMinMotion = 0.02;

float gray_of(const Rgb8& c) { return static_cast<float>(c.r + c.g + c.b) / 3.0F; }

/// Means of the gray values of squares of 2 x 2 pixels.
Image<float> halved(const ColorImage& color) {
  Image<float> half(color.width() / 2, color.height() / 2);
  for (int y = 0; y < half.height(); ++y) {
    for (int x = 0; x < half.width(); ++x) {
      half(x, y) =
          0.25F * (gray_of(color(2 * x, 2 * y)) + gray_of(color(2 * x + 1, 2 * y)) +
                   gray_of(color(2 * x, 2 * y + 1)) + gray_of(color(2 * x + 1, 2 * y + 1)));
    }
  }
  return half;
}

/// Means of squares of `factor` pixels a side.
Image<float> binned(const Image<float>& fine, int factor) {
  Image<float> coarse(fine.width() / factor, fine.height() / factor, 0.0F);
  const float scale = 1.0F / static_cast<float>(factor * factor);
  for (int y = 0; y < coarse.height() * factor; ++y) {
    for (int x = 0; x < coarse.width() * factor; ++x)
      coarse(x / factor, y / factor) += scale * fine(x, y);
  }
  return coarse;
}

/// A gray image, binned by `factor`, in which points are looked up.
class GrayLevel {
 public:
  explicit GrayLevel(const ColorImage& color) : factor_(1), color_(&color) {}
  GrayLevel(Image<float> image, int factor) : factor_(factor), image_(std::move(image)) {}

  struct Value {
    double gray = 0.0;
    Eigen::RowVector2d gradient;  ///< by pixels of the full image
  };
  /// nullopt at the border.
  [[nodiscard]] std::optional<Value> at(const Eigen::Vector2d& pixel) const {
    const double u = (pixel.x() + 0.5) / factor_ - 0.5;
    const double v = (pixel.y() + 0.5) / factor_ - 0.5;
    const int width = color_ != nullptr ? color_->width() : image_.width();
    const int height = color_ != nullptr ? color_->height() : image_.height();
    if (!(u > 1.0 && v > 1.0 && u < width - 3 && v < height - 3)) return std::nullopt;
    const auto value = [&](double du, double dv) {
      const double at_u = u + du;
      const double at_v = v + dv;
      const int x = static_cast<int>(at_u);
      const int y = static_cast<int>(at_v);
      const double a = at_u - x;
      const double b = at_v - y;
      const double above = (1.0 - a) * gray(x, y) + a * gray(x + 1, y);
      const double below = (1.0 - a) * gray(x, y + 1) + a * gray(x + 1, y + 1);
      return (1.0 - b) * above + b * below;
    };
    Value result;
    result.gray = value(0.0, 0.0);
    result.gradient =
        Eigen::RowVector2d(value(0.5, 0.0) - value(-0.5, 0.0), value(0.0, 0.5) - value(0.0, -0.5)) /
        factor_;
    return result;
  }

 private:
  [[nodiscard]] double gray(int x, int y) const {
    return static_cast<double>(color_ != nullptr ? gray_of((*color_)(x, y)) : image_(x, y));
  }

  double factor_;
  const ColorImage* color_ = nullptr;  ///< in place of an image of its own
  Image<float> image_;
};

std::vector<SeenPoint> sample_points(const std::vector<PaintedView>& views,
                                     const TriangleMesh& mesh, Parallelism parallelism) {
  const std::size_t stride = mesh.vertices.size() / kMaxPoints + 1;
  std::vector<SeenPoint> points(mesh.vertices.size() / stride);
  parallel_for(parallelism, points.size(), kPointsPerChunk,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t i = begin; i < end; ++i) {
                   const std::size_t vertex = i * stride;
                   points[i].p_base = mesh.vertices[vertex];
                   const float norm = mesh.normals[vertex].norm();
                   if (!(norm > 0.0F)) continue;
                   const Eigen::Vector3f normal = mesh.normals[vertex] / norm;
                   for (std::uint32_t view = 0; view < views.size(); ++view) {
                     if (views[view].look_up(points[i].p_base, normal))
                       points[i].views.push_back(view);
                   }
                 }
               });
  std::erase_if(points, [](const SeenPoint& point) { return point.views.size() < 2; });
  return points;
}

/// Huber's weight [Huber 1964].
double robust_weight(double residual) {
  const double size = std::abs(residual);
  return size <= kNoise ? 1.0 : kNoise / size;
}

/// The registration as parameters relative to the one that the recording states.
ColorRegistration registration_of(const ColorRegistration& given, const Vector7d& x) {
  ColorRegistration result = given;
  const double pixels = given.camera.width / 640.0;
  result.camera.fx *= 1.0 + x[0];
  result.camera.fy *= 1.0 + x[0];
  result.camera.cx += pixels * x[1];
  result.camera.cy += pixels * x[2];
  result.T_color_depth = Pose(Eigen::Quaterniond(Eigen::AngleAxisd(x[3], Eigen::Vector3d::UnitZ())),
                              Eigen::Vector3d(x[4], x[5], x[6])) *
                         given.T_color_depth;
  result.is_estimated = true;
  return result;
}

/// A point in one view.
struct Look {
  std::uint32_t view = 0;
  double gray = 0.0;
  double weight = 1.0;
  Row7d by_registration = Row7d::Zero();
  Row6d by_pose = Row6d::Zero();
};

class Alignment {
 public:
  Alignment(std::vector<PaintedView>& views, std::vector<SeenPoint> points,
            const ColorRegistration& given, Parallelism parallelism)
      : views_(views), points_(std::move(points)), given_(given), parallelism_(parallelism) {
    halves_.resize(views_.size());
    for_each_view([&](std::size_t i) { halves_[i] = halved(views_[i].view().color); });
  }

  /// Prepares the images binned by `factor`, 1 or even.
  void set_level(int factor) {
    levels_.assign(views_.size(), std::nullopt);
    for_each_view([&](std::size_t i) {
      if (factor == 1) {
        levels_[i].emplace(views_[i].view().color);
      } else {
        levels_[i].emplace(binned(halves_[i], factor / 2), factor);
      }
    });
  }

  /// Mean distance of the points' pixels by another registration from those by the given one [px].
  [[nodiscard]] double mean_displacement(const ColorRegistration& registration) const {
    double sum = 0.0;
    double count = 0.0;
    for (const SeenPoint& point : points_) {
      const PaintedView& view = views_[point.views.front()];
      const Eigen::Vector3d p = view.view().T_base_camera.inverse() * point.p_base.cast<double>();
      const Eigen::Vector3d a = registration.T_color_depth * p;
      const Eigen::Vector3d b = given_.T_color_depth * p;
      if (!(a.z() > 0.05 && b.z() > 0.05)) continue;
      sum += (registration.camera.project(a) - given_.camera.project(b)).norm();
      count += 1.0;
    }
    return count > 0.0 ? sum / count : 0.0;
  }

  /// Mean distance between a point's pixels in its first and last view [px].
  [[nodiscard]] double mean_motion() const {
    double sum = 0.0;
    for (const SeenPoint& point : points_) {
      const auto pixel_in = [&](std::uint32_t i) {
        return views_[i].color_camera().project(views_[i].in_color_camera(point.p_base));
      };
      sum += (pixel_in(point.views.back()) - pixel_in(point.views.front())).norm();
    }
    return sum / static_cast<double>(points_.size());
  }

  void set_registration(const ColorRegistration& registration) {
    for (PaintedView& view : views_) view.set_registration(registration);
  }

  /// Mean difference of a view from the mean over the views, of 255.
  [[nodiscard]] double mean_difference() const {
    const std::vector<Eigen::Vector2d> sums = by_chunks<Eigen::Vector2d>(
        Eigen::Vector2d::Zero(), [&](const std::vector<Look>& looks, Eigen::Vector2d& sum) {
          const double mean = mean_of(looks);
          for (const Look& look : looks) {
            sum += Eigen::Vector2d(std::min(std::abs(look.gray - mean), 4.0 * kNoise), 1.0);
          }
        });
    Eigen::Vector2d total = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& sum : sums) total += sum;
    return total.y() > 0.0 ? total.x() / total.y() : 0.0;
  }

  /// One Gauss-Newton step of the registration; the points' colours are eliminated (variable
  /// projection): the residuals are differences from the mean, and so are their derivatives.
  /// Returns the largest change of a parameter, as a share of its prior std.
  double step_registration(Vector7d& x) {
    struct Normal {
      Matrix7d H = Matrix7d::Zero();
      Vector7d g = Vector7d::Zero();
      double count = 0.0;
    };
    const auto normals = by_chunks<Normal>({}, [&](std::vector<Look>& looks, Normal& normal) {
      const double mean = weigh(looks);
      double sum = 0.0;
      Row7d mean_row = Row7d::Zero();
      for (const Look& look : looks) {
        sum += look.weight;
        mean_row += look.weight * look.by_registration;
      }
      mean_row /= sum;
      for (const Look& look : looks) {
        const Row7d row = look.by_registration - mean_row;
        normal.H += look.weight * row.transpose() * row;
        normal.g += look.weight * row.transpose() * (look.gray - mean);
        normal.count += 1.0;
      }
    });
    Normal total;
    for (const Normal& normal : normals) {
      total.H += normal.H;
      total.g += normal.g;
      total.count += normal.count;
    }
    for (int i = 0; i < 7; ++i) {
      const double prior = total.count / kCorrelated *
                           std::pow(kNoise / kRegistrationStd[static_cast<std::size_t>(i)], 2);
      total.H(i, i) += prior;
      total.g[i] += prior * x[i];
    }
    const Vector7d step = total.H.ldlt().solve(total.g);
    x -= step;
    set_registration(registration_of(given_, x));
    return step.cwiseQuotient(Eigen::Map<const Vector7d>(kRegistrationStd.data()))
        .lpNorm<Eigen::Infinity>();
  }

  /// One step of each view's pose, towards the mean colours over the views.
  void step_poses() {
    struct Normal {
      std::vector<Matrix6d> H;
      std::vector<Vector6d> g;
      std::vector<double> count;
    };
    const Normal empty{std::vector<Matrix6d>(views_.size(), Matrix6d::Zero()),
                       std::vector<Vector6d>(views_.size(), Vector6d::Zero()),
                       std::vector<double>(views_.size(), 0.0)};
    const auto normals = by_chunks<Normal>(empty, [&](std::vector<Look>& looks, Normal& normal) {
      const double mean = weigh(looks);
      for (const Look& look : looks) {
        normal.H[look.view] += look.weight * look.by_pose.transpose() * look.by_pose;
        normal.g[look.view] += look.weight * look.by_pose.transpose() * (look.gray - mean);
        normal.count[look.view] += 1.0;
      }
    });
    Vector6d prior;
    prior << Eigen::Vector3d::Constant(std::pow(kNoise / kTranslationStd, 2)),
        Eigen::Vector3d::Constant(std::pow(kNoise / kRotationStd, 2));
    for (std::size_t i = 0; i < views_.size(); ++i) {
      double count = 0.0;
      for (const Normal& normal : normals) count += normal.count[i];
      const Vector6d scaled = std::max(1.0, count / kCorrelated) * prior;
      Matrix6d H = scaled.asDiagonal();
      Vector6d g = scaled.cwiseProduct(views_[i].correction().log());
      for (const Normal& normal : normals) {
        H += normal.H[i];
        g += normal.g[i];
      }
      views_[i].set_correction(Pose::exp(-H.ldlt().solve(g)) * views_[i].correction());
    }
  }

 private:
  /// A point in its views, with derivatives; empty where fewer than two see it.
  void look(const SeenPoint& point, std::vector<Look>& looks) const {
    looks.clear();
    for (const std::uint32_t i : point.views) {
      const PaintedView& view = views_[i];
      const Eigen::Vector3d p = view.in_color_camera(point.p_base);
      if (!(p.z() > 0.05)) continue;
      const CameraModel& camera = view.color_camera();
      const Eigen::Vector2d pixel = camera.project(p);
      const auto value = levels_[i]->at(pixel);
      if (!value) continue;
      const float slope = view.squared_slope(pixel.cast<float>());
      const auto gain = static_cast<double>(view.gain.mean() * view.brightening(slope));
      const Eigen::RowVector3d by_point = gain * value->gradient * camera.projection_jacobian(p);
      const double pixels = given_.camera.width / 640.0;
      Look look;
      look.view = i;
      look.gray = gain * value->gray + static_cast<double>(view.offset.mean());
      const Eigen::RowVector2d gradient = gain * value->gradient;
      look.by_registration << gradient.dot(
          Eigen::RowVector2d(given_.camera.fx * p.x() / p.z(), given_.camera.fy * p.y() / p.z())),
          pixels * gradient, by_point.dot(Eigen::RowVector3d(-p.y(), p.x(), 0.0)), by_point;
      look.by_pose << by_point, -by_point * skew(p);
      looks.push_back(look);
    }
    if (looks.size() < 2) looks.clear();
  }

  [[nodiscard]] static double mean_of(const std::vector<Look>& looks) {
    double sum = 0.0;
    double weights = 0.0;
    for (const Look& look : looks) {
      sum += look.weight * look.gray;
      weights += look.weight;
    }
    return sum / weights;
  }
  /// Sets robust weights; returns the mean with them.
  [[nodiscard]] static double weigh(std::vector<Look>& looks) {
    const double mean = mean_of(looks);
    for (Look& look : looks) look.weight = robust_weight(look.gray - mean);
    return mean_of(looks);
  }

  /// Calls `add` for each point that is seen; one sum for each chunk of points.
  template <typename Sum, typename Add>
  [[nodiscard]] std::vector<Sum> by_chunks(const Sum& zero, Add add) const {
    std::vector<Sum> sums((points_.size() + kPointsPerChunk - 1) / kPointsPerChunk, zero);
    parallel_for(parallelism_, points_.size(), kPointsPerChunk,
                 [&](std::size_t begin, std::size_t end) {
                   std::vector<Look> looks;
                   for (std::size_t i = begin; i < end; ++i) {
                     look(points_[i], looks);
                     if (!looks.empty()) add(looks, sums[begin / kPointsPerChunk]);
                   }
                 });
    return sums;
  }

  template <typename Do>
  void for_each_view(Do act) const {
    parallel_for(parallelism_, views_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) act(i);
    });
  }

  std::vector<PaintedView>& views_;
  std::vector<Image<float>> halves_;  ///< of the views: gray, binned by 2
  std::vector<SeenPoint> points_;
  const ColorRegistration& given_;
  Parallelism parallelism_;
  std::vector<std::optional<GrayLevel>> levels_;
};

/// The registration by the colours; the given one where it is not clearly better.
ColorRegistration find_registration(Alignment& alignment, const ColorRegistration& given) {
  Vector7d x = Vector7d::Zero();
  constexpr std::array<int, 4> kFactors{8, 4, 2, 1};
  alignment.set_level(2);
  const double before = alignment.mean_difference();
  for (const int factor : kFactors) {
    alignment.set_level(factor);
    int steps = 0;
    while (steps < kMaxSteps && alignment.step_registration(x) > kMinStep) ++steps;
  }
  const ColorRegistration registration = registration_of(given, x);
  alignment.set_level(2);
  const bool is_better = alignment.mean_difference() < kMinImprovement * before;
  if (is_better &&
      alignment.mean_displacement(registration) >= kMinDisplacement * given.camera.width) {
    return registration;
  }
  alignment.set_registration(given);
  return given;
}

}  // namespace

ColorRegistration align_colors(std::vector<PaintedView>& views, const TriangleMesh& mesh_base,
                               const ColorRegistration& given, bool with_poses,
                               Parallelism parallelism) {
  const std::vector<SeenPoint> points = sample_points(views, mesh_base, parallelism);
  even_out_exposures(views, points, parallelism);
  const auto with_vignetting = [&](ColorRegistration registration) {
    if (!views.empty()) registration.vignetting = static_cast<double>(views.front().vignetting);
    return registration;
  };
  if (!with_poses || views.size() < 3 || points.size() < 100) return with_vignetting(given);
  Alignment alignment(views, points, given, parallelism);
  const ColorRegistration registration = alignment.mean_motion() < kMinMotion * given.camera.width
                                             ? given
                                             : find_registration(alignment, given);
  for (const int factor : {2, 1}) {
    alignment.set_level(factor);
    for (int i = 0; i < 3; ++i) alignment.step_poses();
  }
  even_out_exposures(views, points, parallelism);
  return with_vignetting(registration);
}

}  // namespace pcavr
