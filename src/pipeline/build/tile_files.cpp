// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tile_files.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <type_traits>

#include <fmt/core.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/option_file.hpp"

#include "pipeline/jobs/sha256.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kFramesFormat = "pcavr-tile-frames/1\n";
constexpr std::string_view kPartFormat = "pcavr-tile-part/1\n";
constexpr std::size_t kDigestSize = 64;

class Writer {
 public:
  explicit Writer(std::string_view format) : bytes_(format) {}

  template <typename T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(&value, sizeof(T));
  }
  template <typename T>
  void add_all(const std::vector<T>& values) {
    add(std::uint64_t{values.size()});
    for (const T& value : values) add(value);
  }
  void add_all(const std::vector<Eigen::Vector3f>& values) {
    add(std::uint64_t{values.size()});
    for (const Eigen::Vector3f& value : values) append(value.data(), 3 * sizeof(float));
  }
  void add_text(std::string_view text) {
    add(std::uint64_t{text.size()});
    append(text.data(), text.size());
  }
  /// Call once, at the end.
  [[nodiscard]] std::string take() {
    Sha256 hash;
    hash.add(bytes_);
    bytes_ += hash.digest();
    return std::move(bytes_);
  }

 private:
  void append(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }

  std::string bytes_;
};

/// Throws std::out_of_range where the bytes end before a value, or values can not be.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  template <typename T>
  [[nodiscard]] T take() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value{};
    std::memcpy(&value, next(sizeof(T)).data(), sizeof(T));
    return value;
  }
  [[nodiscard]] bool take_bool() { return take<std::uint8_t>() != 0; }
  template <typename T>
  void take_all(std::vector<T>& values) {
    values.resize(count(sizeof(T)));
    for (T& value : values) value = take<T>();
  }
  void take_all(std::vector<Eigen::Vector3f>& values) {
    values.resize(count(3 * sizeof(float)));
    for (Eigen::Vector3f& value : values) {
      std::memcpy(value.data(), next(3 * sizeof(float)).data(), 3 * sizeof(float));
    }
  }
  [[nodiscard]] std::string_view take_text() { return next(count(1)); }

 private:
  /// A count of values of a size, no more than there are.
  std::size_t count(std::size_t size) {
    const auto values = take<std::uint64_t>();
    if (values > bytes_.size() / size) throw std::out_of_range("ends too early");
    return values;
  }
  std::string_view next(std::size_t size) {
    if (size > bytes_.size()) throw std::out_of_range("ends too early");
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }

  std::string_view bytes_;
};

Error refused(const fs::path& file, const std::string& why, const std::string& hint) {
  return {.message = why, .file = file.string(), .place = {}, .hint = hint};
}

/// The bytes between a file's format and its digest.
Expected<std::string_view> checked(const fs::path& file, std::string_view format,
                                   std::string_view content) {
  if (!content.starts_with(format) || content.size() < format.size() + kDigestSize)
    return refused(file, "is no file of this step, or of another version", "run the step again");
  Sha256 hash;
  hash.add(content.substr(0, content.size() - kDigestSize));
  if (hash.digest() != digest_of(content))
    return refused(file, "is damaged: its SHA-256 is another one", "run the step again");
  content.remove_prefix(format.size());
  content.remove_suffix(kDigestSize);
  return content;
}

/// Version and options: tiles of others do not fit together.
std::string build_of(const BuildOptions& options) {
  BuildOptions copy = options;
  std::vector<OptionSection> sections = sections_of(copy.perception);
  for (OptionSection& section : sections_of(copy)) sections.push_back(std::move(section));
  return fmt::format("pcavr {}\n{}", PCAVR_VERSION, print_options(sections));
}

void add(const Pose& pose, Writer& writer) {
  for (int i = 0; i < 4; ++i) writer.add(pose.rotation().coeffs()[i]);
  for (int i = 0; i < 3; ++i) writer.add(pose.translation()[i]);
}

Pose take_pose(Reader& reader) {
  Eigen::Quaterniond rotation;
  Eigen::Vector3d translation;
  for (int i = 0; i < 4; ++i) rotation.coeffs()[i] = reader.take<double>();
  for (int i = 0; i < 3; ++i) translation[i] = reader.take<double>();
  Pose pose(rotation, translation);
  // The constructor normalises what has been normalised, which may change the last bit.
  const_cast<Eigen::Quaterniond&>(pose.rotation()) = rotation;
  return pose;
}

void add(const PlacedFrame& frame, Writer& writer) {
  writer.add(std::uint64_t{frame.index});
  add(frame.T_base_camera, writer);
  writer.add_all(frame.is_dynamic.runs());
  writer.add_all(frame.reach.patch_depths);
}

PlacedFrame take_frame(const TileFrames& frames, Reader& reader) {
  PlacedFrame frame{.index = reader.take<std::uint64_t>(),
                    .T_base_camera = take_pose(reader),
                    .is_dynamic = {},
                    .reach = {}};
  std::vector<std::uint32_t> runs;
  reader.take_all(runs);
  const auto pixels =
      static_cast<std::uint64_t>(frames.width) * static_cast<std::uint64_t>(frames.height);
  if (std::accumulate(runs.begin(), runs.end(), std::uint64_t{0}) != pixels)
    throw std::out_of_range("a mask of another size");
  frame.is_dynamic = PackedMask(frames.width, frames.height, std::move(runs));
  frame.reach.T_camera_base = frame.T_base_camera.inverse();
  reader.take_all(frame.reach.patch_depths);
  return frame;
}

void add(const SurfaceTile& tile, Writer& writer) {
  writer.add_all(tile.mesh.vertices);
  writer.add_all(tile.mesh.normals);
  writer.add_all(tile.mesh.colors);
  writer.add_all(tile.mesh.triangles);
  writer.add_all(tile.borrowed);
  writer.add(std::uint64_t{tile.lent.size()});
  for (const auto& [edge, vertex] : tile.lent) {
    writer.add(edge);
    writer.add(vertex);
  }
}

SurfaceTile take_tile(Reader& reader) {
  SurfaceTile tile;
  reader.take_all(tile.mesh.vertices);
  reader.take_all(tile.mesh.normals);
  reader.take_all(tile.mesh.colors);
  reader.take_all(tile.mesh.triangles);
  reader.take_all(tile.borrowed);
  const auto lent = reader.take<std::uint64_t>();
  for (std::uint64_t i = 0; i < lent; ++i) {
    const auto edge = reader.take<GridEdge>();
    tile.lent.emplace_back(edge, reader.take<std::uint32_t>());
  }
  return tile;
}

void add(const FusedTile& tile, Writer& writer) {
  writer.add(std::uint64_t{tile.number});
  add(tile.surface, writer);
  writer.add(tile.strict.has_value());
  if (tile.strict) add(*tile.strict, writer);
  writer.add_all(tile.points.points);
  writer.add_all(tile.points.normals);
  writer.add_all(tile.points.colors);
}

FusedTile take_fused(Reader& reader) {
  FusedTile tile{.number = reader.take<std::uint64_t>(), .surface = take_tile(reader)};
  if (reader.take_bool()) tile.strict = take_tile(reader);
  reader.take_all(tile.points.points);
  reader.take_all(tile.points.normals);
  reader.take_all(tile.points.colors);
  return tile;
}

/// A file's part of the scene, with which part it is.
struct ReadPart {
  TilePart part;
  std::string frames;
};

/// Appends its tiles.
ReadPart take_part(Reader& reader, FusedTiles& fused) {
  ReadPart read{{reader.take<std::uint64_t>(), reader.take<std::uint64_t>()},
                std::string(reader.take_text())};
  fused.has_agreed_surface = reader.take_bool() || fused.has_agreed_surface;
  const auto tiles = reader.take<std::uint64_t>();
  for (std::uint64_t i = 0; i < tiles; ++i) fused.tiles.push_back(take_fused(reader));
  return read;
}

}  // namespace

bool is_tile_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string line;
  std::getline(stream, line);
  line += '\n';
  return line == kFramesFormat || line == kPartFormat;
}

std::string digest_of(std::string_view content) {
  return std::string(content.substr(content.size() - std::min(kDigestSize, content.size())));
}

std::string format_tile_frames(const TileFrames& frames, const BuildOptions& options) {
  Writer writer(kFramesFormat);
  writer.add_text(build_of(options));
  writer.add_text(frames.recording);
  writer.add(frames.tile_size);
  writer.add(frames.width);
  writer.add(frames.height);
  writer.add(std::uint64_t{frames.frames.size()});
  for (const PlacedFrame& frame : frames.frames) add(frame, writer);
  return writer.take();
}

Expected<TileFrames> read_tile_frames(const fs::path& file, const BuildOptions& options) try {
  const Expected<std::string> content = read_file(file);
  if (!content) return content.error();
  const Expected<std::string_view> bytes = checked(file, kFramesFormat, *content);
  if (!bytes) return bytes.error();
  Reader reader(*bytes);
  if (reader.take_text() != build_of(options))
    return refused(file, "is of other options, or of another version of pcavr",
                   "give both steps the same --config and options");
  TileFrames frames{.recording = std::string(reader.take_text()),
                    .tile_size = reader.take<double>(),
                    .width = reader.take<int>(),
                    .height = reader.take<int>()};
  const auto count = reader.take<std::uint64_t>();
  for (std::uint64_t i = 0; i < count; ++i) frames.frames.push_back(take_frame(frames, reader));
  return frames;
} catch (const std::out_of_range& error) {
  return refused(file, error.what(), "run the step again");
}

std::string format_fused_part(const FusedTiles& fused, const TilePart& part,
                              const std::string& frames) {
  Writer writer(kPartFormat);
  writer.add(std::uint64_t{part.number});
  writer.add(std::uint64_t{part.count});
  writer.add_text(frames);
  writer.add(fused.has_agreed_surface);
  writer.add(std::uint64_t{fused.tiles.size()});
  for (const FusedTile& tile : fused.tiles) add(tile, writer);
  return writer.take();
}

Expected<FusedTiles> read_fused_parts(const std::vector<fs::path>& files,
                                      const std::string& frames) {
  FusedTiles fused;
  std::vector<bool> is_read(files.size(), false);
  for (const fs::path& file : files) {
    const Expected<std::string> content = read_file(file);
    if (!content) return content.error();
    const Expected<std::string_view> bytes = checked(file, kPartFormat, *content);
    if (!bytes) return bytes.error();
    Reader reader(*bytes);
    ReadPart read;
    try {
      read = take_part(reader, fused);
    } catch (const std::out_of_range& error) {
      return refused(file, error.what(), "run the step again");
    }
    if (read.frames != frames)
      return refused(file, "was fused from other frames or options than this build has",
                     "run survey and fuse again, with the same --config and options");
    if (read.part.count != files.size())
      return refused(file, fmt::format("is one of {} parts", read.part.count),
                     fmt::format("give all of them; {} are given", files.size()));
    if (read.part.number >= files.size() || is_read[read.part.number])
      return refused(file, fmt::format("is part {} again", read.part.number + 1),
                     "give each part once");
    is_read[read.part.number] = true;
  }
  return fused;
}

}  // namespace pcavr
