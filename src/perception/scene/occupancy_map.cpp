// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/occupancy_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

#include "pcavr/base/core/check.hpp"

#include "occupancy_state.hpp"

namespace pcavr {
namespace {

/// The cell that contains a point [cells]; for coordinates within twice kMaxCell.
Eigen::Vector3i cell_of(const Eigen::Vector3d& point) {
  // A cast of a positive number rounds down, and is faster than std::floor.
  constexpr int kShift = 1 << 16;
  const auto floor = [](double x) { return static_cast<int>(x + kShift) - kShift; };
  return {floor(point.x()), floor(point.y()), floor(point.z())};
}

double log_odds(double probability) { return std::log(probability / (1.0 - probability)); }

void validate(const OccupancyOptions& options) {
  PCAVR_REQUIRE(options.resolution > 0.0, options.resolution);
  PCAVR_REQUIRE(options.max_range >= options.resolution, options.max_range);
  PCAVR_REQUIRE(options.prob_hit > 0.5 && options.prob_hit < 1.0, options.prob_hit);
  PCAVR_REQUIRE(options.prob_miss > 0.0 && options.prob_miss < 0.5, options.prob_miss);
  PCAVR_REQUIRE(options.clamping_min > 0.0 && options.clamping_min < 0.5, options.clamping_min);
  PCAVR_REQUIRE(options.clamping_max > 0.5 && options.clamping_max < 1.0, options.clamping_max);
}

/// Calls `visit(i)` for each bit that is set.
template <typename Visit>
void for_each_bit(const BlockBits& bits, const Visit& visit) {
  for (std::size_t word = 0; word < bits.size(); ++word) {
    for (std::uint64_t rest = bits[word]; rest != 0; rest &= rest - 1) {
      visit(word * 64 + static_cast<std::size_t>(std::countr_zero(rest)));
    }
  }
}

}  // namespace

OccupancyMap::State::State(const OccupancyOptions& chosen) : options(chosen) {
  const double low = log_odds(options.clamping_min);
  const double high = log_odds(options.clamping_max);
  const double hit = log_odds(options.prob_hit);
  const double miss = log_odds(options.prob_miss);
  // The full range of 16 bits, except kUnknown.
  units_per_log_odds = 32000.0 / std::max({-low, high, hit, -miss});
  const auto units = [&](double value) {
    return static_cast<int>(std::lround(value * units_per_log_odds));
  };
  clamping_min = units(low);
  clamping_max = units(high);
  hit_update = units(hit);
  miss_update = units(miss);
}

const std::vector<Eigen::Vector2f>& OccupancyMap::State::rays_of(const CameraModel& camera) {
  if (camera == ray_camera && !rays.empty()) return rays;
  ray_camera = camera;
  rays.clear();
  rays.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      rays.push_back(camera.normalise({double(u), double(v)}).cast<float>());
    }
  }
  return rays;
}

void OccupancyMap::State::collect_ends(const DepthImage& depth, const MaskImage& is_dynamic,
                                       const CameraModel& camera, const Pose& T_base_camera,
                                       const Eigen::Vector3d& origin) {
  const std::vector<Eigen::Vector2f>& directions = rays_of(camera);
  const Eigen::Matrix3f R = (T_base_camera.rotation_matrix() / options.resolution).cast<float>();
  const float max_coordinate = static_cast<float>(kMaxCell);
  const std::span<const float> depths = depth.pixels();
  const std::span<const std::uint8_t> dynamic = is_dynamic.pixels();
  end_cells.clear();
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const float z = depths[i];
    if (!(z > 0.0F) || (!dynamic.empty() && dynamic[i] != 0)) continue;
    const Eigen::Vector3f ray =
        R * Eigen::Vector3f(directions[i].x() * z, directions[i].y() * z, z);
    if (!(ray.cwiseAbs().maxCoeff() < max_coordinate)) continue;
    const Eigen::Vector3i cell = cell_of(origin + ray.cast<double>());
    // Neighbouring pixels mostly share a cell.
    if (end_cells.empty() || end_cells.back() != cell) end_cells.push_back(cell);
  }
}

void OccupancyMap::State::trace(const Eigen::Vector3d& origin) {
  const double max_range = options.max_range / options.resolution;
  const auto ray_to = [&](const Eigen::Vector3i& cell) {
    return Eigen::Vector3d(cell.cast<double>() + Eigen::Vector3d::Constant(0.5) - origin);
  };
  // Cells beyond the range are last, without duplicates; their rays are truncated.
  const auto far =
      std::partition(end_cells.begin(), end_cells.end(), [&](const Eigen::Vector3i& cell) {
        return ray_to(cell).squaredNorm() <= max_range * max_range;
      });
  std::sort(far, end_cells.end(), [](const Eigen::Vector3i& a, const Eigen::Vector3i& b) {
    return std::tie(a.x(), a.y(), a.z()) < std::tie(b.x(), b.y(), b.z());
  });
  end_cells.erase(std::unique(far, end_cells.end()), end_cells.end());
  const auto truncated = [&](const Eigen::Vector3i& cell) {
    return Eigen::Vector3d(origin + ray_to(cell).normalized() * max_range);
  };

  Eigen::AlignedBox3i box(cell_of(origin));
  for (auto cell = end_cells.begin(); cell != far; ++cell) box.extend(*cell);
  for (auto cell = far; cell != end_cells.end(); ++cell) box.extend(cell_of(truncated(*cell)));
  // One cell of margin on each side, for rounding of rays along the box's faces.
  frame.reset(box.min() - Eigen::Vector3i::Ones(), box.max() + Eigen::Vector3i::Ones());
  for (auto cell = end_cells.begin(); cell != far; ++cell) {
    if (frame.mark_hit(*cell)) frame.mark_ray(origin, origin + ray_to(*cell));
  }
  for (auto cell = far; cell != end_cells.end(); ++cell) frame.mark_ray(origin, truncated(*cell));
}

OccupancyBlock& OccupancyMap::State::block_at(const Eigen::Vector3i& position) {
  const auto [found, is_new] = index_of_block.try_emplace(block_key(position), blocks.size());
  if (is_new) blocks.emplace_back(position);
  return blocks[found->second];
}

std::optional<OccupancyMap::State::CellIndex> OccupancyMap::State::index_of(
    const Eigen::Vector3i& cell) const {
  // An arithmetic shift rounds down, also for negative numbers.
  const auto found = index_of_block.find(block_key(cell.unaryExpr([](int c) { return c >> 3; })));
  if (found == index_of_block.end()) return std::nullopt;
  const auto inside = [&](int axis) { return static_cast<unsigned>(cell[axis]) & 7U; };
  return CellIndex{found->second, index_in_block(inside(0), inside(1), inside(2))};
}

void OccupancyMap::State::update_from_frame() {
  frame.for_each_block(
      [&](const Eigen::Vector3i& position, const BlockBits& traversed, const BlockBits& hit) {
        auto& values = block_at(position).values;
        const auto update = [&](std::size_t cell, int change) {
          const int before = values[cell] == kUnknown ? 0 : values[cell];
          values[cell] =
              static_cast<std::int16_t>(std::clamp(before + change, clamping_min, clamping_max));
        };
        for_each_bit(traversed, [&](std::size_t cell) { update(cell, miss_update); });
        for_each_bit(hit, [&](std::size_t cell) { update(cell, hit_update); });
      });
}

OccupancyMap::OccupancyMap(const OccupancyOptions& options) {
  validate(options);
  state_ = std::make_unique<State>(options);
}
OccupancyMap::~OccupancyMap() = default;
OccupancyMap::OccupancyMap(OccupancyMap&&) noexcept = default;
OccupancyMap& OccupancyMap::operator=(OccupancyMap&&) noexcept = default;

const OccupancyOptions& OccupancyMap::options() const { return state_->options; }

void OccupancyMap::integrate(const DepthImage& depth, const MaskImage& is_dynamic,
                             const CameraModel& camera, const Pose& T_base_camera) {
  PCAVR_REQUIRE(depth.width() == camera.width && depth.height() == camera.height, depth.width(),
                depth.height());
  PCAVR_REQUIRE(is_dynamic.empty() ||
                (is_dynamic.width() == depth.width() && is_dynamic.height() == depth.height()));
  const double resolution = state_->options.resolution;
  const Eigen::Vector3d origin = T_base_camera.translation() / resolution;
  const double max_range = state_->options.max_range / resolution;
  // Written so that NaN fails.
  if (!(origin.cwiseAbs().maxCoeff() + max_range <= kMaxCell)) return;
  state_->collect_ends(depth, is_dynamic, camera, T_base_camera, origin);
  if (state_->end_cells.empty()) return;
  state_->trace(origin);
  state_->update_from_frame();
}

OccupancyMap::Cell OccupancyMap::at(const Eigen::Vector3d& p_base) const {
  const Eigen::Vector3d point = p_base / state_->options.resolution;
  if (!(point.cwiseAbs().maxCoeff() < 2.0 * kMaxCell)) return Cell::unknown;
  const auto index = state_->index_of(cell_of(point));
  if (!index) return Cell::unknown;
  const std::int16_t value = state_->blocks[index->block].values[index->cell];
  if (value == kUnknown) return Cell::unknown;
  return value >= 0 ? Cell::occupied : Cell::free;
}

OccupancyMap::Counts OccupancyMap::counts() const {
  Counts counts;
  for (const OccupancyBlock& block : state_->blocks) {
    for (const std::int16_t value : block.values) {
      if (value == kUnknown) continue;
      ++(value >= 0 ? counts.occupied : counts.free);
    }
  }
  return counts;
}

std::size_t OccupancyMap::memory_bytes() const {
  // Estimate per hash node: key, index, next pointer and bucket.
  return state_->blocks.capacity() * sizeof(OccupancyBlock) +
         state_->index_of_block.size() * 4 * sizeof(void*);
}

}  // namespace pcavr
