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
// measured depth; one gain by channel is fitted to it first, for both colourings.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/model/cad_model.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recording/frame_reader.hpp"
#include "pcavr/recording/image_codec.hpp"
#include "pcavr/recording/recording.hpp"

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
};

/// Pictures of a level of detail from a camera.
Rendered render(const pcavr::Scene& scene, const pcavr::SurfaceQuery& query, std::size_t level,
                const ColorImage& atlas, const pcavr::CameraModel& camera,
                const pcavr::Pose& T_base_camera, const pcavr::RgbdFrame& frame) {
  const pcavr::TriangleMesh& mesh = scene.levels_of_detail_base[level];
  Rendered rendered{Picture(camera.width, camera.height), Picture(camera.width, camera.height)};
  const Eigen::Vector3f origin = T_base_camera.translation().cast<float>();
  const Eigen::Array2f size(float(atlas.width()), float(atlas.height()));
  for (int y = 8; y < camera.height - 8; ++y) {
    for (int x = 8; x < camera.width - 8; ++x) {
      const float measured = frame.depth(x * frame.depth.width() / camera.width,
                                         y * frame.depth.height() / camera.height);
      if (!(measured > 0.0F)) continue;
      const Eigen::Vector3d ray = camera.unproject({x, y}, 1.0);
      const auto hit = query.cast(origin, (T_base_camera.rotation() * ray).cast<float>());
      if (!hit) continue;
      const double z = static_cast<double>(hit->distance) / ray.norm();
      if (std::abs(z - static_cast<double>(measured)) > 0.03) continue;
      const auto& [a, b, c] = mesh.triangles[hit->triangle];
      const float w = 1.0F - hit->u - hit->v;
      rendered.by_vertices(x, y) = static_cast<double>(w) * vector_of(mesh.colors[a]) +
                                   static_cast<double>(hit->u) * vector_of(mesh.colors[b]) +
                                   static_cast<double>(hit->v) * vector_of(mesh.colors[c]);
      if (!scene.texture) continue;
      const auto& uv = scene.texture->coordinates[level];
      rendered.textured(x, y) = bilinear(
          atlas, ((w * uv[a] + hit->u * uv[b] + hit->v * uv[c]).array() * size - 0.5F).matrix());
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
  [[nodiscard]] double psnr() const {
    return 10.0 * std::log10(255.0 * 255.0 / std::max(1e-9, squares / channels));
  }
};

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

void compare(Picture picture, const ColorImage& recorded, Comparison& sum) {
  even_out(picture, recorded);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      if (!picture(x, y)) continue;
      sum.squares += (*picture(x, y) - vector_of(recorded(x, y))).squaredNorm();
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

void save(const std::string& file, const Picture& picture, const ColorImage& recorded) {
  ColorImage both(picture.width() * 2, picture.height());
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const Eigen::Vector3d c = picture(x, y).value_or(Eigen::Vector3d::Zero());
      const auto byte = [](double v) {
        return static_cast<std::uint8_t>(std::clamp(v, 0.0, 255.0));
      };
      both(x, y) = {byte(c.x()), byte(c.y()), byte(c.z())};
      both(x + picture.width(), y) = recorded(x, y);
    }
  }
  const std::string bytes = value_or_exit(pcavr::encode_color(both));
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

/// The scene's colours, and the camera that they were registered to.
struct Colours {
  ColorImage atlas;
  pcavr::CameraModel camera;
  pcavr::Pose T_color_depth;
};

Colours colours_of(const pcavr::Scene& scene, const pcavr::CameraModel& camera) {
  if (!scene.texture) return {{}, camera, {}};
  const pcavr::SceneTexture& texture = *scene.texture;
  pcavr::ImageDecoder decoder;
  Colours colours{
      value_or_exit(decoder.color(texture.jpeg, {"texture", texture.width, texture.height})),
      texture.color_camera, texture.T_color_depth};
  std::printf("texture %d x %d, %.1f kB, texel %.2f mm, %zu views, %.1f %% seen\n", texture.width,
              texture.height, 1e-3 * double(texture.jpeg.size()), 1e3 * texture.texel,
              texture.views, 100.0 * texture.seen_fraction);
  const Eigen::Vector3d t = 1e3 * texture.T_color_depth.translation();
  std::printf("colour camera: f %.1f %.1f, c %.1f %.1f, offset %.1f %.1f %.1f mm\n",
              colours.camera.fx, colours.camera.fy, colours.camera.cx, colours.camera.cy, t.x(),
              t.y(), t.z());
  return colours;
}

/// Compares a level of detail with each held-out image, and saves the pictures of the middle one.
void compare_level(const pcavr::Scene& scene, std::size_t level, const Colours& colours,
                   const HeldOutFrames& frames, const pcavr::Trajectory& poses) {
  const pcavr::SurfaceQuery query(scene.levels_of_detail_base[level]);
  Comparison textured, by_vertices, by_vertices_registered;
  for (const std::size_t i : frames.held_out) {
    const pcavr::RgbdFrame frame = value_or_exit(pcavr::decode_frame(frames.whole, i));
    const auto pose = poses.at(frame.depth_stamp);
    if (!pose) continue;
    const Rendered given =
        render(scene, query, level, colours.atlas, *frames.whole.manifest.camera, *pose, frame);
    compare(given.by_vertices, frame.color, by_vertices);
    const Rendered registered = render(scene, query, level, colours.atlas, colours.camera,
                                       *pose * colours.T_color_depth.inverse(), frame);
    compare(registered.by_vertices, frame.color, by_vertices_registered);
    compare(registered.textured, frame.color, textured);
    if (i != frames.held_out[frames.held_out.size() / 2]) continue;
    const std::string name = "level" + std::to_string(level);
    save(name + "_texture.jpg", registered.textured, frame.color);
    save(name + "_vertices.jpg", given.by_vertices, frame.color);
  }
  const auto print = [&](const char* what, const Comparison& sum) {
    std::printf("%zu triangles, %-30s PSNR %.2f dB, SSIM %.4f\n",
                scene.levels_of_detail_base[level].triangles.size(), what, sum.psnr(),
                sum.ssim / sum.windows);
  };
  print("vertex colours:", by_vertices);
  print("vertex colours, registered:", by_vertices_registered);
  print("texture:", textured);
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
