// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/preview_parts.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <opencv2/imgproc.hpp>

#include "pcavr/base/geometry/pixel.hpp"

#include "preview.hpp"

namespace pcavr {
namespace {

cv::Mat as_mat(ColorImage& image) {
  return {image.height(), image.width(), CV_8UC3, image.pixels().data()};
}

cv::Scalar as_scalar(const Rgb8& color) {
  return {double(color.r), double(color.g), double(color.b)};
}

Rgb8 scaled(const Rgb8& color, float factor) {
  const auto channel = [&](std::uint8_t c) {
    return static_cast<std::uint8_t>(std::lround(static_cast<float>(c) * factor));
  };
  return {channel(color.r), channel(color.g), channel(color.b)};
}

constexpr Rgb8 kTextColor{38, 44, 54};
constexpr Rgb8 kOutlineColor{255, 255, 255};
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.55;  // readable in a picture of 1280 x 960

void draw_text(cv::Mat& mat, const std::string& text, const cv::Point& at) {
  // An outline keeps the text readable on any background.
  cv::putText(mat, text, at, kFont, kFontScale, as_scalar(kOutlineColor), 4, cv::LINE_AA);
  cv::putText(mat, text, at, kFont, kFontScale, as_scalar(kTextColor), 1, cv::LINE_AA);
}

}  // namespace

TriangleMesh tubes(const std::vector<Eigen::Vector3d>& line, double radius) {
  constexpr std::uint32_t kSides = 8;  // looks round at a width of some pixels
  TriangleMesh mesh;
  for (std::size_t segment = 0; segment + 1 < line.size(); ++segment) {
    const Eigen::Vector3d along = line[segment + 1] - line[segment];
    if (along.norm() < 1e-9) continue;
    const Eigen::Vector3d u = along.unitOrthogonal();
    const Eigen::Vector3d v = along.normalized().cross(u);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const double angle = 2.0 * M_PI * side / kSides;
      const Eigen::Vector3d normal = std::cos(angle) * u + std::sin(angle) * v;
      for (const Eigen::Vector3d& end : {line[segment], line[segment + 1]}) {
        mesh.vertices.emplace_back((end + radius * normal).cast<float>());
        mesh.normals.emplace_back(normal.cast<float>());
      }
      const std::uint32_t here = first + 2 * side;
      const std::uint32_t next = first + 2 * ((side + 1) % kSides);
      mesh.triangles.push_back({here, next, next + 1});
      mesh.triangles.push_back({here, next + 1, here + 1});
    }
  }
  return mesh;
}

void draw_background(Canvas& canvas) {
  const Eigen::Vector3f top_color(246.0F, 248.0F, 251.0F);
  const Eigen::Vector3f bottom_color(203.0F, 210.0F, 220.0F);
  for (int y = 0; y < canvas.color.height(); ++y) {
    const float down = static_cast<float>(y) / static_cast<float>(canvas.color.height());
    const Eigen::Vector3f c = top_color + down * (bottom_color - top_color);
    const auto byte = [&](int channel) {
      return static_cast<std::uint8_t>(std::lround(c[channel]));
    };
    std::ranges::fill(canvas.color.row(y), Rgb8{byte(0), byte(1), byte(2)});
  }
}

void draw_contours(Canvas& canvas, std::uint8_t first_outlined,
                   const std::vector<std::optional<Rgb8>>& colors) {
  constexpr int kRadius = 3;          // [px]
  constexpr float kStrength = 12.0F;  // of the darkening, by relative depth difference
  constexpr float kMinBrightness = 0.55F;
  ColorImage shaded = canvas.color;
  for (int y = kRadius; y < canvas.color.height() - kRadius; ++y) {
    for (int x = kRadius; x < canvas.color.width() - kRadius; ++x) {
      const float depth = canvas.depth(x, y);
      if (depth == 0.0F) continue;
      const std::uint8_t id = canvas.id(x, y);
      float behind = 0.0F;
      bool is_border = false;
      for (const auto& [dx, dy] :
           {std::pair{kRadius, 0}, {-kRadius, 0}, {0, kRadius}, {0, -kRadius}}) {
        const float other = canvas.depth(x + dx, y + dy);
        if (other > 0.0F) behind += std::max(0.0F, 1.0F - other / depth) / 4.0F;
        is_border = is_border || canvas.id(x + dx, y + dy) != id;
      }
      const bool is_outline = is_border && id >= first_outlined;
      const float brightness =
          is_outline ? 0.35F : std::max(kMinBrightness, 1.0F - kStrength * behind);
      const std::size_t outlined = is_outline ? std::size_t{id} - first_outlined : colors.size();
      shaded(x, y) = outlined < colors.size() && colors[outlined]
                         ? *colors[outlined]
                         : scaled(canvas.color(x, y), brightness);
    }
  }
  canvas.color = std::move(shaded);
}

void draw_label(ColorImage& picture, const Eigen::Vector2d& at, const std::string& text,
                const Rgb8& color) {
  cv::Mat mat = as_mat(picture);
  const cv::Size size = cv::getTextSize(text, kFont, kFontScale, 1, nullptr);
  constexpr int kFarOutside = 1'000'000;  // [px], outside any image
  const cv::Point corner(
      clamp_to_int(std::round(at.x()), -kFarOutside, kFarOutside) - size.width / 2,
      clamp_to_int(std::round(at.y()), -kFarOutside, kFarOutside) - 12);
  draw_text(mat, text, corner);
  cv::line(mat, corner + cv::Point(0, 6), corner + cv::Point(size.width, 6), as_scalar(color), 2,
           cv::LINE_AA);
}

void draw_scale_bar(ColorImage& picture, double metre) {
  // The maximum of 1, 2, 5, 10, ... that is at most a fifth of the width.
  const double max_length = 0.2 * picture.width() / metre;
  const double decade = std::pow(10.0, std::floor(std::log10(max_length)));
  const double length = decade * (max_length >= 5.0 * decade   ? 5.0
                                  : max_length >= 2.0 * decade ? 2.0
                                                               : 1.0);
  const std::string text =
      length >= 1.0 ? fmt::format("{:.0f} m", length) : fmt::format("{:.0f} cm", 100.0 * length);
  cv::Mat mat = as_mat(picture);
  const cv::Point left(40, picture.height() - 40);
  const cv::Point right = left + cv::Point(static_cast<int>(std::lround(length * metre)), 0);
  const cv::Point up(0, -7);
  for (const auto& [rgb, thickness] : {std::pair{kOutlineColor, 5}, {kTextColor, 2}}) {
    const cv::Scalar color = as_scalar(rgb);
    cv::line(mat, left, right, color, thickness, cv::LINE_AA);
    cv::line(mat, left, left + up, color, thickness, cv::LINE_AA);
    cv::line(mat, right, right + up, color, thickness, cv::LINE_AA);
  }
  draw_text(mat, text, left + cv::Point(0, -14));
}

}  // namespace pcavr
