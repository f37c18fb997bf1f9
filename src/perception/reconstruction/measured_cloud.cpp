// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/reconstruction/measured_cloud.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "pcavr/base/core/check.hpp"

#include "perception/reconstruction/block_map.hpp"

namespace pcavr {
namespace {

/// Coordinates beyond this are left out, so that cells fit into the table's keys [cells].
constexpr float kMaxCell = 1'000'000.0F;
/// Neighbouring depths on one surface differ by less than this, relative to depth: as for a slope
/// of 80 degrees at 2 mrad per pixel, plus noise.
constexpr float kMaxDepthStep = 0.02F;

/// Every second pixel of every second row is used, of four phases in turn: finer pixels share their
/// voxels.
constexpr int kPixelStep = 2;
/// A voxel with less than this share of the weight of a voxel one or two further along its normal
/// is of the same surface, by noise.
constexpr float kMinWeightShare = 0.5F;

BlockCoordinates cell_at(const Eigen::Vector3f& p, float inverse_size) {
  const auto floor = [&](float x) { return static_cast<int>(std::floor(x * inverse_size)); };
  return {floor(p.x()), floor(p.y()), floor(p.z())};
}

Eigen::Vector3i block_of(const BlockCoordinates& cell) {
  // An arithmetic shift rounds down, also for negative numbers.
  static_assert(kBlockSide == 8);
  return {cell.x >> 3, cell.y >> 3, cell.z >> 3};
}

/// Weighted sums over the points of a voxel, relative to its corner.
struct VoxelSum {
  Eigen::Vector3f corner = Eigen::Vector3f::Zero();
  Eigen::Vector3f offset = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  std::array<float, 3> color{};
  float weight = 0.0F;
  std::uint32_t last_frame = 0;
  std::uint32_t frames = 0;
};

/// Numbers of cells, with the last ones looked up beside the table: neighbouring pixels mostly
/// share a voxel.
class CellIndex {
 public:
  /// The cell's number; the next one where it is new.
  std::uint32_t find_or_add(const BlockCoordinates& cell, std::uint32_t next) {
    Recent& recent = recent_[static_cast<std::size_t>(cell.x * 73 + cell.y * 19 + cell.z * 7) &
                             (recent_.size() - 1)];
    if (recent.number != BlockHashTable::kNone && recent.cell == cell) return recent.number;
    std::uint32_t number = table_.find(cell);
    if (number == BlockHashTable::kNone) {
      number = next;
      table_.insert(cell, number);
    }
    recent = {cell, number};
    return number;
  }
  /// BlockHashTable::kNone where there is none.
  [[nodiscard]] std::uint32_t find(const BlockCoordinates& cell) const { return table_.find(cell); }
  [[nodiscard]] std::size_t memory_bytes() const { return table_.memory_bytes(); }

 private:
  struct Recent {
    BlockCoordinates cell;
    std::uint32_t number = BlockHashTable::kNone;
  };
  BlockHashTable table_;
  std::vector<Recent> recent_ = std::vector<Recent>(4096);
};

/// The rays of a camera's pixels on the plane z = 1.
struct RayTable {
  CameraModel camera;
  std::vector<Eigen::Vector2f> rays;

  void prepare(const CameraModel& used) {
    if (used == camera && !rays.empty()) return;
    camera = used;
    rays.clear();
    for (int v = 0; v < used.height; ++v) {
      for (int u = 0; u < used.width; ++u) {
        rays.push_back(used.normalise({double(u), double(v)}).cast<float>());
      }
    }
  }
  [[nodiscard]] Eigen::Vector3f point(int u, int v, float z) const {
    const Eigen::Vector2f& ray = rays[static_cast<std::size_t>(v * camera.width + u)];
    return {ray.x() * z, ray.y() * z, z};
  }
};

/// The difference of the points of two neighbours of a pixel along one axis: of both where they are
/// on the pixel's surface, else of one and the pixel. nullopt where neither is.
std::optional<Eigen::Vector3f> tangent(const RayTable& rays, const DepthImage& depth, int u, int v,
                                       int du, int dv) {
  const float z = depth(u, v);
  const auto is_near = [&](int i, int j) {
    return depth.contains(i, j) && std::abs(depth(i, j) - z) <= kMaxDepthStep * z;
  };
  const bool before = is_near(u - du, v - dv);
  const bool after = is_near(u + du, v + dv);
  if (!before && !after) return std::nullopt;
  const auto point = [&](int i, int j) { return rays.point(i, j, depth(i, j)); };
  return (after ? point(u + du, v + dv) : point(u, v)) -
         (before ? point(u - du, v - dv) : point(u, v));
}

/// The surface's normal at a pixel, toward the camera.
std::optional<Eigen::Vector3f> normal_at(const RayTable& rays, const DepthImage& depth, int u,
                                         int v) {
  const auto along_u = tangent(rays, depth, u, v, 1, 0);
  const auto along_v = tangent(rays, depth, u, v, 0, 1);
  if (!along_u || !along_v) return std::nullopt;
  // x right and y down: the product points away from the camera.
  const Eigen::Vector3f normal = along_v->cross(*along_u);
  const float length = normal.norm();
  if (!(length > 0.0F)) return std::nullopt;
  return Eigen::Vector3f(normal / length);
}

template <typename IsKept>
void append(const PointCloud& cloud, const IsKept& is_kept, PointCloud& kept) {
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!is_kept(cloud.points[i])) continue;
    kept.points.push_back(cloud.points[i]);
    if (!cloud.normals.empty()) kept.normals.push_back(cloud.normals[i]);
    if (!cloud.colors.empty()) kept.colors.push_back(cloud.colors[i]);
  }
}

/// Cells of the edge `max_distance` that have a vertex of a mesh.
class CellsOfMesh {
 public:
  CellsOfMesh(const TriangleMesh& mesh, double max_distance)
      : inverse_size_(static_cast<float>(1.0 / max_distance)) {
    PCAVR_REQUIRE(max_distance > 0.0, max_distance);
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      const BlockCoordinates cell = cell_at(vertex, inverse_size_);
      if (occupied_.find(cell) == BlockHashTable::kNone) occupied_.insert(cell, 0);
    }
  }

  /// Whether the cell of a point, or one next to it, has a vertex.
  [[nodiscard]] bool operator()(const Eigen::Vector3f& point) const {
    const BlockCoordinates cell = cell_at(point, inverse_size_);
    for (int i = 0; i < 27; ++i) {
      const BlockCoordinates neighbour{cell.x + i % 3 - 1, cell.y + i / 3 % 3 - 1,
                                       cell.z + i / 9 - 1};
      if (occupied_.find(neighbour) != BlockHashTable::kNone) return true;
    }
    return false;
  }

 private:
  float inverse_size_;  ///< [1/m]
  BlockHashTable occupied_;
};

std::uint8_t rounded(float value) { return static_cast<std::uint8_t>(value + 0.5F); }

}  // namespace

struct MeasuredCloud::State {
  double voxel_size;
  DepthNoise noise;
  std::optional<BlockBox> kept;  ///< empty: all blocks
  CellIndex index;
  std::vector<VoxelSum> voxels;
  RayTable rays;
  std::uint32_t frames = 0;
  bool has_colors = false;

  void add_point(const Eigen::Vector3f& p_base, const Eigen::Vector3f& normal_base, float weight,
                 const Rgb8* color) {
    const auto size = static_cast<float>(voxel_size);
    if (!(p_base.cwiseAbs().maxCoeff() < kMaxCell * size)) return;
    const BlockCoordinates cell = cell_at(p_base, 1.0F / size);
    if (kept && !kept->contains(block_of(cell))) return;
    const std::uint32_t number = index.find_or_add(cell, static_cast<std::uint32_t>(voxels.size()));
    if (number == voxels.size()) {
      voxels.emplace_back().corner = Eigen::Vector3i(cell.x, cell.y, cell.z).cast<float>() * size;
    }
    VoxelSum& voxel = voxels[number];
    voxel.offset += weight * (p_base - voxel.corner);
    voxel.normal += weight * normal_base;
    voxel.weight += weight;
    if (color != nullptr) {
      voxel.color[0] += weight * static_cast<float>(color->r);
      voxel.color[1] += weight * static_cast<float>(color->g);
      voxel.color[2] += weight * static_cast<float>(color->b);
    }
    if (voxel.last_frame != frames) ++voxel.frames;
    voxel.last_frame = frames;
  }

  /// Whether no voxel along the normal holds much more of the surface (non-maximum suppression).
  [[nodiscard]] bool is_maximum(const VoxelSum& voxel, const Eigen::Vector3f& normal) const {
    const auto size = static_cast<float>(voxel_size);
    const Eigen::Vector3f mean = voxel.corner + voxel.offset / voxel.weight;
    for (const float step : {-2.0F, -1.0F, 1.0F, 2.0F}) {
      const std::uint32_t other = index.find(cell_at(mean + step * size * normal, 1.0F / size));
      if (other == BlockHashTable::kNone) continue;
      if (voxel.weight < kMinWeightShare * voxels[other].weight) return false;
    }
    return true;
  }
};

MeasuredCloud::MeasuredCloud(double voxel_size, const DepthNoise& noise,
                             const std::optional<BlockBox>& part)
    : state_(std::make_unique<State>()) {
  PCAVR_REQUIRE(voxel_size > 0.0, voxel_size);
  state_->voxel_size = voxel_size;
  state_->noise = noise;
  if (part) state_->kept = part->expanded(1);
}

MeasuredCloud::~MeasuredCloud() = default;
MeasuredCloud::MeasuredCloud(MeasuredCloud&&) noexcept = default;

void MeasuredCloud::add(const DepthImage& depth, const ColorImage& color,
                        const MaskImage& is_dynamic, const CameraModel& camera,
                        const Pose& T_base_camera) {
  PCAVR_REQUIRE(depth.width() == camera.width && depth.height() == camera.height, depth.width(),
                depth.height(), camera.width, camera.height);
  PCAVR_REQUIRE(color.empty() || color.pixels().size() == depth.pixels().size(), color.width());
  PCAVR_REQUIRE(is_dynamic.empty() || is_dynamic.pixels().size() == depth.pixels().size(),
                is_dynamic.width());
  State& state = *state_;
  ++state.frames;
  state.has_colors = state.has_colors || !color.empty();
  state.rays.prepare(camera);
  const Eigen::Matrix3f R = T_base_camera.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_base_camera.translation().cast<float>();
  const auto phase = static_cast<int>(state.frames % (kPixelStep * kPixelStep));
  for (int v = phase / kPixelStep; v < depth.height(); v += kPixelStep) {
    for (int u = phase % kPixelStep; u < depth.width(); u += kPixelStep) {
      const float z = depth(u, v);
      if (!(z > 0.0F) || (!is_dynamic.empty() && is_dynamic(u, v) != 0)) continue;
      const std::optional<Eigen::Vector3f> normal = normal_at(state.rays, depth, u, v);
      if (!normal) continue;
      const double std = state.noise.depth_std(static_cast<double>(z));
      const auto weight =
          static_cast<float>(state.noise.constant * state.noise.constant / (std * std));
      state.add_point(R * state.rays.point(u, v, z) + t, R * *normal, weight,
                      color.empty() ? nullptr : &color(u, v));
    }
  }
}

void MeasuredCloud::add_unseen() { ++state_->frames; }

PointCloud MeasuredCloud::points(int min_frames) const {
  PCAVR_REQUIRE(min_frames >= 1, min_frames);
  PointCloud cloud;
  for (const VoxelSum& voxel : state_->voxels) {
    if (voxel.frames < static_cast<std::uint32_t>(min_frames)) continue;
    const float length = voxel.normal.norm();
    // Both sides of a thin thing in one voxel: no normal.
    if (!(length > 0.1F * voxel.weight)) continue;
    const Eigen::Vector3f normal = voxel.normal / length;
    if (!state_->is_maximum(voxel, normal)) continue;
    const float scale = 1.0F / voxel.weight;
    cloud.points.push_back(voxel.corner + voxel.offset * scale);
    cloud.normals.push_back(normal);
    if (!state_->has_colors) continue;
    cloud.colors.push_back({rounded(voxel.color[0] * scale), rounded(voxel.color[1] * scale),
                            rounded(voxel.color[2] * scale)});
  }
  return cloud;
}

std::size_t MeasuredCloud::voxel_count() const { return state_->voxels.size(); }

std::size_t MeasuredCloud::memory_bytes() const {
  return state_->voxels.capacity() * sizeof(VoxelSum) + state_->index.memory_bytes();
}

PointCloud points_near(const PointCloud& cloud, const TriangleMesh& mesh, double max_distance) {
  PointCloud near;
  append(cloud, CellsOfMesh(mesh, max_distance), near);
  return near;
}

PointCloud points_near(std::vector<PointCloud>&& parts, const TriangleMesh& mesh,
                       double max_distance) {
  const CellsOfMesh is_near(mesh, max_distance);
  std::size_t count = 0;
  for (const PointCloud& part : parts) count += part.points.size();
  PointCloud near;
  near.points.reserve(count);
  near.normals.reserve(count);
  near.colors.reserve(count);
  for (PointCloud& part : parts) append(std::exchange(part, {}), is_near, near);
  return near;
}

PointCloud points_in(const PointCloud& cloud, const BlockBox& box, double voxel_size) {
  const auto inverse_size = static_cast<float>(1.0 / voxel_size);
  const auto is_inside = [&](const Eigen::Vector3f& point) {
    return box.contains(block_of(cell_at(point, inverse_size)));
  };
  PointCloud inside;
  append(cloud, is_inside, inside);
  return inside;
}

}  // namespace pcavr
