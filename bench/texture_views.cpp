// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Renders views of a scene that were held out and compares them with the recorded images: PSNR and
// SSIM [Wang et al. 2004] with the texture and with the vertices' colours alone.
//
//   pcavr_bench_texture RECORDING POSES [EVERY [SECTION.KEY=VALUE ...]]
//
// POSES: camera_trajectory.txt of a scene that was built from all frames. Every EVERY-th (default
// 8) frame is held out of the build. Each held-out image is compared where the mesh is seen at the
// measured depth; one gain by channel is fitted to it first, for both colourings. "View aligned":
// from a pose that was refined by the picture's colours, as a held-out pose has errors, too.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "arguments.hpp"

namespace {

using pcavr::ColorImage;
using pcavr::Rgb8;
using pcavr::bench::fail;
using pcavr::bench::set_option;
using pcavr::bench::value_or_exit;

Eigen::Vector3d vector_of(const Rgb8& c) { return Eigen::Vector3d(c.r, c.g, c.b); }

Eigen::Vector3d bilinear(const ColorImage& image, const Eigen::Vector2f& at) {
  const double u = std::clamp<double>(at.x(), 0.0, image.width() - 1.001);
  const double v = std::clamp<double>(at.y(), 0.0, image.height() - 1.001);
  const int x = static_cast<int>(u);
  const int y = static_cast<int>(v);
  return (1.0 - v + y) *
             ((1.0 - u + x) * vector_of(image(x, y)) + (u - x) * vector_of(image(x + 1, y))) +
         (v - y) * ((1.0 - u + x) * vector_of(image(x, y + 1)) +
                    (u - x) * vector_of(image(x + 1, y + 1)));
}

/// A picture of the mesh; empty where nothing is compared.
using Picture = pcavr::Image<std::optional<Eigen::Vector3d>>;

struct Rendered {
  Picture textured;
  Picture by_vertices;
  pcavr::Image<Eigen::Vector3d> p_base;  ///< where something is compared
};

/// The scene's colours, and the camera that they were registered to.
struct Colours {
  ColorImage atlas;
  pcavr::CameraModel camera;
  pcavr::Pose T_color_depth;
  double vignetting = 0.0;
  /// Share of a colour that the camera leaves there.
  [[nodiscard]] double share_at(int x, int y) const {
    return 1.0 -
           vignetting * (Eigen::Vector2d((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy))
                            .squaredNorm();
  }
};

/// Whether the depth image has a point of the surface, which the depth camera sees elsewhere than
/// the colour camera.
bool is_measured(const pcavr::CameraModel& depth_camera, const pcavr::DepthImage& depth,
                 const Eigen::Vector3d& p_depth) {
  if (!(p_depth.z() > 0.0)) return false;
  const Eigen::Vector2d at = depth_camera.project(p_depth);
  if (!depth_camera.contains(at)) return false;
  const float measured =
      depth(static_cast<int>(at.x() + 0.5) * depth.width() / depth_camera.width,
            static_cast<int>(at.y() + 0.5) * depth.height() / depth_camera.height);
  return measured > 0.0F && std::abs(p_depth.z() - static_cast<double>(measured)) < 0.03;
}

/// Pictures of a level of detail from a camera.
Rendered render(const pcavr::Scene& scene, const pcavr::SurfaceQuery& query, std::size_t level,
                const Colours& colours, const pcavr::CameraModel& depth_camera,
                const pcavr::Pose& T_base_depth, const pcavr::RgbdFrame& frame) {
  const pcavr::CameraModel& camera = colours.camera;
  const ColorImage& atlas = colours.atlas;
  const pcavr::Pose T_base_camera = T_base_depth * colours.T_color_depth.inverse();
  const pcavr::TriangleMesh& mesh = scene.levels_of_detail_base[level];
  Rendered rendered{Picture(camera.width, camera.height), Picture(camera.width, camera.height),
                    pcavr::Image<Eigen::Vector3d>(camera.width, camera.height)};
  const Eigen::Vector3f origin = T_base_camera.translation().cast<float>();
  const Eigen::Array2f size(float(atlas.width()), float(atlas.height()));
  for (int y = 8; y < camera.height - 8; ++y) {
    for (int x = 8; x < camera.width - 8; ++x) {
      const Eigen::Vector3d ray = camera.unproject({x, y}, 1.0);
      const auto hit = query.cast(origin, (T_base_camera.rotation() * ray).cast<float>());
      if (!hit) continue;
      const Eigen::Vector3d p_color = static_cast<double>(hit->distance) * ray.normalized();
      if (!is_measured(depth_camera, frame.depth, colours.T_color_depth.inverse() * p_color))
        continue;
      rendered.p_base(x, y) = T_base_camera * p_color;
      const auto& [a, b, c] = mesh.triangles[hit->triangle];
      const float w = 1.0F - hit->u - hit->v;
      const double share = colours.share_at(x, y);
      rendered.by_vertices(x, y) =
          share * (static_cast<double>(w) * vector_of(mesh.colors[a]) +
                   static_cast<double>(hit->u) * vector_of(mesh.colors[b]) +
                   static_cast<double>(hit->v) * vector_of(mesh.colors[c]));
      if (!scene.texture) continue;
      const auto& uv = scene.texture->coordinates[level];
      rendered.textured(x, y) =
          share *
          bilinear(atlas,
                   ((w * uv[a] + hit->u * uv[b] + hit->v * uv[c]).array() * size - 0.5F).matrix());
    }
  }
  return rendered;
}

/// Sums of a comparison over all images.
struct Comparison {
  double squares = 0.0;
  double channels = 0.0;
  double ssim = 0.0;
  double windows = 0.0;
  std::vector<float> errors = {};  ///< squared, by pixel
  [[nodiscard]] double psnr() const {
    return 10.0 * std::log10(255.0 * 255.0 / std::max(1e-9, squares / channels));
  }
};

/// Share of the squared errors that the worst pixels have.
double share_of_worst(std::vector<float> errors, double fraction) {
  std::sort(errors.begin(), errors.end(), std::greater<>());
  const auto worst =
      errors.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(errors.size()));
  const double all = std::accumulate(errors.begin(), errors.end(), 1e-9);
  return std::accumulate(errors.begin(), worst, 0.0) / all;
}

double luma(const Eigen::Vector3d& c) { return 0.299 * c.x() + 0.587 * c.y() + 0.114 * c.z(); }

/// SSIM of the luma in one window; empty where a pixel is.
std::optional<double> ssim(const Picture& picture, const ColorImage& recorded, int left, int top,
                           int window) {
  Eigen::Array2d mean = Eigen::Array2d::Zero();
  Eigen::Array3d square = Eigen::Array3d::Zero();
  for (int y = top; y < top + window; ++y) {
    for (int x = left; x < left + window; ++x) {
      if (!picture(x, y)) return std::nullopt;
      const double a = luma(*picture(x, y));
      const double b = luma(vector_of(recorded(x, y)));
      mean += Eigen::Array2d(a, b);
      square += Eigen::Array3d(a * a, b * b, a * b);
    }
  }
  mean /= window * window;
  square /= window * window;
  const double var_a = square[0] - mean[0] * mean[0];
  const double var_b = square[1] - mean[1] * mean[1];
  const double cov = square[2] - mean[0] * mean[1];
  constexpr double kC1 = 0.01 * 255 * 0.01 * 255;
  constexpr double kC2 = 0.03 * 255 * 0.03 * 255;
  return (2.0 * mean[0] * mean[1] + kC1) * (2.0 * cov + kC2) /
         ((mean.square().sum() + kC1) * (var_a + var_b + kC2));
}

/// Sum and number of the absolute second differences that a plane of colour does not have.
struct NoiseSum {
  double sum = 0.0;
  double count = 0.0;
  /// Standard deviation of the noise [Immerkaer 1996]: an upper bound, as texture counts too.
  [[nodiscard]] double std() const {
    return std::sqrt(std::numbers::pi / 2.0) * sum / (6.0 * std::max(1.0, count));
  }
};

void add_noise(const Picture& compared, const ColorImage& recorded, NoiseSum& noise) {
  for (int y = 1; y + 1 < recorded.height(); ++y) {
    for (int x = 1; x + 1 < recorded.width(); ++x) {
      if (!compared(x, y)) continue;
      const auto row = [&](int at_y) -> Eigen::Vector3d {
        return vector_of(recorded(x - 1, at_y)) - 2.0 * vector_of(recorded(x, at_y)) +
               vector_of(recorded(x + 1, at_y));
      };
      noise.sum += (row(y - 1) - 2.0 * row(y) + row(y + 1)).lpNorm<1>();
      noise.count += 3.0;
    }
  }
}

/// Fits one gain to each channel, so that the camera's exposure does not count.
void even_out(Picture& picture, const ColorImage& recorded) {
  Eigen::Array3d products = Eigen::Array3d::Constant(1e-9);
  Eigen::Array3d squares = Eigen::Array3d::Constant(1e-9);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      if (!picture(x, y)) continue;
      products += picture(x, y)->array() * vector_of(recorded(x, y)).array();
      squares += picture(x, y)->array().square();
    }
  }
  const Eigen::Array3d gain = products / squares;
  for (auto& pixel : picture.pixels()) {
    if (pixel) *pixel = (pixel->array() * gain).matrix();
  }
}

/// A point of the surface, as the picture shows it.
struct Shown {
  Eigen::Vector3d p_base;
  double gray = 0.0;
};

double gray_of(const ColorImage& image, const Eigen::Vector2d& at) {
  return bilinear(image, at.cast<float>()).mean();
}

/// Refines the pose of a held-out image by its differences from what the mesh shows there
/// [Zhou & Koltun 2014, eq. 2]: what is left is an error of the colours, not of the pose.
pcavr::Pose aligned(const std::vector<Shown>& points, const ColorImage& recorded,
                    const Colours& colours, const pcavr::Pose& T_base_depth) {
  const pcavr::CameraModel& camera = colours.camera;
  pcavr::Pose T_base_camera = T_base_depth * colours.T_color_depth.inverse();
  for (int iteration = 0; iteration < 10; ++iteration) {
    pcavr::Matrix6d H = pcavr::Matrix6d::Identity();
    pcavr::Vector6d g = pcavr::Vector6d::Zero();
    for (const Shown& point : points) {
      const Eigen::Vector3d p = T_base_camera.inverse() * point.p_base;
      const Eigen::Vector2d at = camera.project(p);
      if (!(at.minCoeff() > 4.0 && at.x() < camera.width - 5 && at.y() < camera.height - 5))
        continue;
      const auto slope = [&](const Eigen::Vector2d& step) {
        return 0.5 * (gray_of(recorded, at + step) - gray_of(recorded, at - step));
      };
      const double by_x = slope(Eigen::Vector2d::UnitX()) * camera.fx / p.z();
      const double by_y = slope(Eigen::Vector2d::UnitY()) * camera.fy / p.z();
      const Eigen::Vector3d by_p(by_x, by_y, -(by_x * p.x() + by_y * p.y()) / p.z());
      pcavr::Vector6d row;
      row << by_p, p.cross(by_p);
      const double residual = gray_of(recorded, at) - point.gray;
      const double weight = 1.0 / std::max(1.0, std::abs(residual) / 8.0);
      H += weight * row * row.transpose();
      g += weight * residual * row;
    }
    const pcavr::Vector6d step = -H.ldlt().solve(g);
    T_base_camera = T_base_camera * pcavr::Pose::exp(step).inverse();
  }
  return T_base_camera * colours.T_color_depth;
}

std::vector<Shown> shown_by(Picture picture, const Rendered& rendered, const ColorImage& recorded) {
  constexpr int kStride = 5;
  even_out(picture, recorded);
  std::vector<Shown> points;
  for (int y = 0; y < picture.height(); y += kStride) {
    for (int x = 0; x < picture.width(); x += kStride) {
      if (picture(x, y)) points.push_back({rendered.p_base(x, y), picture(x, y)->mean()});
    }
  }
  return points;
}

void compare(Picture picture, const ColorImage& recorded, Comparison& sum) {
  even_out(picture, recorded);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      if (!picture(x, y)) continue;
      const double error = (*picture(x, y) - vector_of(recorded(x, y))).squaredNorm();
      sum.squares += error;
      sum.errors.push_back(static_cast<float>(error));
      sum.channels += 3.0;
    }
  }
  constexpr int kWindow = 8;
  for (int top = 0; top + kWindow <= picture.height(); top += kWindow / 2) {
    for (int left = 0; left + kWindow <= picture.width(); left += kWindow / 2) {
      const auto value = ssim(picture, recorded, left, top, kWindow);
      if (!value) continue;
      sum.ssim += *value;
      sum.windows += 1.0;
    }
  }
}

/// The picture, the recorded one, and four times the absolute difference between them.
void save(const std::string& file, Picture picture, const ColorImage& recorded) {
  even_out(picture, recorded);
  ColorImage three(picture.width() * 3, picture.height());
  const auto rgb = [](const Eigen::Vector3d& c) {
    const auto byte = [](double v) { return static_cast<std::uint8_t>(std::clamp(v, 0.0, 255.0)); };
    return Rgb8{byte(c.x()), byte(c.y()), byte(c.z())};
  };
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      three(x + picture.width(), y) = recorded(x, y);
      if (!picture(x, y)) continue;
      three(x, y) = rgb(*picture(x, y));
      three(x + 2 * picture.width(), y) =
          rgb(4.0 * (*picture(x, y) - vector_of(recorded(x, y))).cwiseAbs());
    }
  }
  const std::string bytes = pcavr::encode_color_png(three);
  if (std::FILE* out = std::fopen(file.c_str(), "wb")) {
    std::fwrite(bytes.data(), 1, bytes.size(), out);
    std::fclose(out);
  }
}

struct HeldOutFrames {
  pcavr::Recording whole;
  pcavr::Recording built;  ///< without those held out
  std::vector<std::size_t> held_out;
};

HeldOutFrames hold_out(const char* folder, std::size_t every) {
  HeldOutFrames frames{value_or_exit(pcavr::read_recording(folder)), {}, {}};
  frames.built = frames.whole;
  frames.built.frames.clear();
  for (std::size_t i = 0; i < frames.whole.frames.size(); ++i) {
    if (i % every == every / 2) {
      frames.held_out.push_back(i);
    } else {
      frames.built.frames.push_back(frames.whole.frames[i]);
    }
  }
  return frames;
}

Colours colours_of(const pcavr::Scene& scene, const pcavr::CameraModel& camera) {
  if (!scene.texture) return {{}, camera, {}, 0.0};
  const pcavr::SceneTexture& texture = *scene.texture;
  pcavr::ImageDecoder decoder;
  Colours colours{
      value_or_exit(decoder.color(texture.jpeg, {"texture", texture.width, texture.height})),
      texture.color_camera, texture.T_color_depth, texture.vignetting};
  std::printf("texture %d x %d, %.1f kB, texel %.2f mm, %zu views, %.1f %% seen\n", texture.width,
              texture.height, 1e-3 * double(texture.jpeg.size()), 1e3 * texture.texel,
              texture.views, 100.0 * texture.seen_fraction);
  const Eigen::Vector3d t = 1e3 * texture.T_color_depth.translation();
  std::printf(
      "colour camera: f %.1f %.1f, c %.1f %.1f, offset %.1f %.1f %.1f mm, vignetting %.3f\n",
      colours.camera.fx, colours.camera.fy, colours.camera.cx, colours.camera.cy, t.x(), t.y(),
      t.z(), colours.vignetting);
  return colours;
}

/// Compares a level of detail with each held-out image, and saves the pictures of the middle one.
void compare_level(const pcavr::Scene& scene, std::size_t level, const Colours& colours,
                   const HeldOutFrames& frames, const pcavr::Trajectory& poses) {
  const pcavr::SurfaceQuery query(scene.levels_of_detail_base[level]);
  const pcavr::CameraModel& given_camera = *frames.whole.manifest.camera;
  const Colours given{colours.atlas, given_camera, {}, 0.0};
  std::array<Comparison, 5> sums;
  NoiseSum noise;
  for (const std::size_t i : frames.held_out) {
    const pcavr::RgbdFrame frame = value_or_exit(pcavr::decode_frame(frames.whole, i));
    const auto pose = poses.at(frame.depth_stamp);
    if (!pose) continue;
    const auto seen_from = [&](const Colours& by, const pcavr::Pose& T_base_depth) {
      return render(scene, query, level, by, given_camera, T_base_depth, frame);
    };
    const Rendered plain = seen_from(given, *pose);
    const Rendered registered = seen_from(colours, *pose);
    add_noise(plain.by_vertices, frame.color, noise);
    compare(plain.by_vertices, frame.color, sums[0]);
    compare(registered.by_vertices, frame.color, sums[1]);
    compare(registered.textured, frame.color, sums[2]);
    const auto refined = [&](const Picture& picture) {
      const std::vector<Shown> points = shown_by(picture, registered, frame.color);
      return seen_from(colours, aligned(points, frame.color, colours, *pose));
    };
    compare(refined(registered.by_vertices).by_vertices, frame.color, sums[3]);
    compare(refined(registered.textured).textured, frame.color, sums[4]);
    if (i != frames.held_out[frames.held_out.size() / 2]) continue;
    const std::string name = "level" + std::to_string(level);
    save(name + "_texture.png", registered.textured, frame.color);
    save(name + "_vertices.png", plain.by_vertices, frame.color);
  }
  std::printf("%zu triangles; recorded pictures' noise: at most %.2f of 255 (PSNR %.1f dB)\n",
              scene.levels_of_detail_base[level].triangles.size(), noise.std(),
              20.0 * std::log10(255.0 / noise.std()));
  const std::array<const char*, 5> names{"vertex colours", "vertex colours, registered", "texture",
                                         "vertex colours, view aligned", "texture, view aligned"};
  for (std::size_t i = 0; i < sums.size(); ++i) {
    std::printf(
        "  %-30s PSNR %.2f dB, SSIM %.4f; of the squares, the worst 1 %% of pixels have "
        "%.0f %%, the worst 10 %% %.0f %%\n",
        names[i], sums[i].psnr(), sums[i].ssim / sums[i].windows,
        100.0 * share_of_worst(sums[i].errors, 0.01), 100.0 * share_of_worst(sums[i].errors, 0.1));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) fail("usage: pcavr_bench_texture RECORDING POSES [EVERY [SECTION.KEY=VALUE ...]]");
  const HeldOutFrames frames = hold_out(argv[1], argc > 3 ? std::stoul(argv[3]) : 8);
  const pcavr::Trajectory poses = value_or_exit(pcavr::read_trajectory(argv[2]));
  pcavr::BuildOptions options;
  for (int i = 4; i < argc; ++i) set_option(sections_of(options), argv[i]);
  const pcavr::Scene scene = value_or_exit(pcavr::build_scene(frames.built, options));
  for (const auto& stage : scene.quality.times) {
    std::printf("%-28s %.2f s, %.2f s of CPU\n", stage.stage.c_str(), stage.wall_seconds,
                stage.cpu_seconds);
  }
  const Colours colours = colours_of(scene, *frames.whole.manifest.camera);
  for (const std::size_t level : {std::size_t{0}, scene.levels_of_detail_base.size() - 1}) {
    compare_level(scene, level, colours, frames, poses);
  }
}
