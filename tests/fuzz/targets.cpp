// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "fuzz/targets.hpp"

#include <algorithm>
#include <string>

#include "pcavr/core/check.hpp"
#include "pcavr/recording/manifest.hpp"
#include "pcavr/recording/parameters_file.hpp"

#include "recording/camera_keys.hpp"
#include "recording/image_codec.hpp"
#include "recording/png_codec.hpp"
#include "recording/recording_text.hpp"
#include "recording/time_series.hpp"

namespace pcavr::fuzz {
namespace {

constexpr char kFile[] = "the-file";
constexpr int kWidth = 16;
constexpr int kHeight = 12;

void expect_whole(const Error& error) {
  PCAVR_REQUIRE(error.file == kFile, error.to_string());
  PCAVR_REQUIRE(!error.message.empty() && !error.hint.empty(), error.to_string());
}

void expect_line(const Error& error) {
  expect_whole(error);
  PCAVR_REQUIRE(error.line > 0 || error.message == "is empty", error.to_string());
}

/// Strictly, an error has its line; leniently, only a wrong header is one.
template <typename Content>
void parse_both_ways(Expected<Series<Content>> (*parse)(const SeriesText&), std::string_view text) {
  const auto strict = parse({kFile, text, false});
  const auto lenient = parse({kFile, text, true});
  if (!strict) expect_line(strict.error());
  if (strict) {
    PCAVR_REQUIRE(lenient && lenient->report.skipped() == 0);
    PCAVR_REQUIRE(lenient->content.size() == strict->content.size());
  }
}

void trajectory_round_trip(std::string_view text) {
  parse_both_ways(parse_trajectory, text);
  const auto series = parse_trajectory({kFile, text, true});
  PCAVR_REQUIRE(series.has_value());
  const std::string written = format_trajectory(series->content);
  const auto again = parse_trajectory({kFile, written});
  PCAVR_REQUIRE(again && again->content.size() == series->content.size());
}

PngImage png_with_rows(std::string_view bytes) {
  PngImage png{.width = kWidth, .height = kHeight};
  const auto kind = bytes.empty() ? 0u : static_cast<unsigned char>(bytes[0]);
  png.bit_depth = kind % 2 == 0 ? 8 : 16;
  png.channels = static_cast<int>(kind / 2 % 4) + 1;
  png.rows.assign(bytes.begin(), bytes.end());
  png.rows.resize((png.row_size() + 1) * kHeight);
  return png;
}

/// A camera that was taken sees along every pixel, and finds each again.
void expect_sound(const CameraModel& camera) {
  const double right = camera.width - 0.5;
  const double bottom = camera.height - 0.5;
  for (const Eigen::Vector2d& pixel :
       {Eigen::Vector2d(-0.5, -0.5), Eigen::Vector2d(right, -0.5), Eigen::Vector2d(-0.5, bottom),
        Eigen::Vector2d(right, bottom), Eigen::Vector2d(0.5 * right, 0.5 * bottom)}) {
    const Eigen::Vector2d again = camera.project(camera.unproject(pixel, 2.0));
    // Rounding, at focal lengths up to 6.5 million pixels.
    PCAVR_REQUIRE((again - pixel).norm() < 1e-5, again.x(), again.y(), pixel.x(), pixel.y());
  }
}

}  // namespace

void manifest(std::string_view bytes) {
  const Expected<Manifest> manifest = parse_manifest(std::string(bytes), kFile);
  if (!manifest) return expect_line(manifest.error());
  const std::string written = format_manifest(*manifest);
  const Expected<Manifest> again = parse_manifest(written, kFile);
  PCAVR_REQUIRE(again.has_value(), again.error().to_string(), written);
  PCAVR_REQUIRE(again->markers.size() == manifest->markers.size());
  PCAVR_REQUIRE(again->objects.size() == manifest->objects.size());
  PCAVR_REQUIRE(again->camera == manifest->camera);
  if (manifest->camera) expect_sound(*manifest->camera);
}

void camera_file(std::string_view bytes) {
  const Expected<CameraFile> camera = parse_camera_file(std::string(bytes), kFile);
  if (!camera) return expect_line(camera.error());
  PCAVR_REQUIRE(camera->camera.width > 0 && camera->camera.fx > 0.0);
  expect_sound(camera->camera);
}

void image_list(std::string_view bytes) {
  parse_both_ways(parse_image_list, bytes);
  const auto list = parse_image_list({kFile, bytes, true});
  PCAVR_REQUIRE(list.has_value());
  for (const ListedImage& image : list->content) {
    PCAVR_REQUIRE(image.path.is_relative() && *image.path.begin() != "..", image.path);
  }
}

void series(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::string_view text = bytes.substr(1);
  switch (bytes[0]) {
    case 'g':
      return trajectory_round_trip(text);
    case 't':
      return parse_both_ways(parse_tool, text);
    case 'w':
      return parse_both_ways(parse_wrench, text);
    case 'j':
      return parse_both_ways(parse_joints, text);
    default:
      return;
  }
}

void image(std::string_view bytes) {
  const ExpectedImage expected{kFile, kWidth, kHeight};
  ImageDecoder decoder;
  if (const auto color = decoder.color(bytes, expected); !color) expect_whole(color.error());
  if (const auto depth = decoder.raw_depth(bytes, expected); depth) {
    const auto again = decoder.raw_depth(encode_depth(*depth), expected);
    PCAVR_REQUIRE(again.has_value());
    PCAVR_REQUIRE(std::ranges::equal(again->pixels(), depth->pixels()));
  } else {
    expect_whole(depth.error());
  }
  PngImage plain;
  if (!decode_png(encode_png(png_with_rows(bytes)), plain)) return;
  PngImage again;
  PCAVR_REQUIRE(decode_png(encode_png(plain), again).has_value());
  PCAVR_REQUIRE(again.rows == plain.rows);
}

void parameters(std::string_view bytes) {
  const Expected<ParameterTable> table = parse_parameters(std::string(bytes), kFile);
  if (!table) return expect_line(table.error());
  const std::string written = format_parameters(*table);
  const Expected<ParameterTable> again = parse_parameters(written, kFile);
  PCAVR_REQUIRE(again.has_value(), again.error().to_string(), written);
  PCAVR_REQUIRE(format_parameters(*again) == written);
}

}  // namespace pcavr::fuzz
