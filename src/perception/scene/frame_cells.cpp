// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "frame_cells.hpp"

namespace pcavr {
namespace {

int round_down_to_block(int cell) { return cell & ~(kBlockEdge - 1); }

/// Positions along the two other axes are fixed-point numbers: 2^32 per cell.
constexpr double kOne = 4294967296.0;
constexpr int kFraction = 32;

/// One of the two axes other than the ray's longest one.
struct CrossAxis {
  const std::size_t* bit_indices;  ///< by cell
  std::int64_t position;           ///< at the end of the slab
  std::int64_t step;               ///< from slab to slab
  std::int64_t cell;               ///< at the start of the slab

  /// The fraction of the slab after which the ray leaves `cell`; the slab ends at `position`.
  [[nodiscard]] double crossing() const {
    const std::int64_t border = (step > 0 ? cell + 1 : cell) << kFraction;
    return static_cast<double>(border - (position - step)) / static_cast<double>(step);
  }
};

/// All coordinates are positive here, so that a cast rounds down.
std::int64_t cell_of(double position) { return static_cast<std::int64_t>(position); }

/// Voxel traversal (3D DDA) of a ray, in slabs of one cell along its longest axis.
struct SlabWalk {
  const std::size_t* bit_indices;  ///< along the longest axis, by cell
  std::int64_t first;              ///< slabs by their cell along the longest axis
  std::int64_t last;
  std::int64_t forward;  ///< 1 or -1
  CrossAxis a;
  CrossAxis b;
  std::int64_t end_a;  ///< where the ray ends
  std::int64_t end_b;
};

/// `bit_indices`: by axis and cell. The ray must have a non-zero length.
SlabWalk slab_walk(const std::array<std::vector<std::size_t>, 3>& bit_indices,
                   const Eigen::Vector3d& origin, const Eigen::Vector3d& end) {
  const Eigen::Vector3d ray = end - origin;
  int longest = 0;
  const double length = ray.cwiseAbs().maxCoeff(&longest);
  const bool is_forward = ray[longest] > 0.0;
  const std::int64_t first = cell_of(origin[longest]);
  const double to_border = is_forward ? static_cast<double>(first + 1) - origin[longest]
                                      : origin[longest] - static_cast<double>(first);
  const auto bit_indices_of = [&](int axis) {
    return bit_indices[static_cast<std::size_t>(axis)].data();
  };
  const auto cross_axis = [&](int axis) {
    const double slope = ray[axis] / length;
    return CrossAxis{bit_indices_of(axis),
                     static_cast<std::int64_t>((origin[axis] + slope * to_border) * kOne),
                     static_cast<std::int64_t>(slope * kOne), cell_of(origin[axis])};
  };
  const int axis_a = longest == 0 ? 1 : 0;
  const int axis_b = longest == 2 ? 1 : 2;
  return {bit_indices_of(longest), first,
          cell_of(end[longest]),   is_forward ? 1 : -1,
          cross_axis(axis_a),      cross_axis(axis_b),
          cell_of(end[axis_a]),    cell_of(end[axis_b])};
}

}  // namespace

void FrameCells::reset(const Eigen::Vector3i& low, const Eigen::Vector3i& high) {
  min_ = low.unaryExpr(&round_down_to_block);
  block_count_ = (high - min_) / kBlockEdge + Eigen::Vector3i::Ones();
  // The contribution of each coordinate to a cell's bit index: z changes fastest.
  std::size_t blocks = 1;
  for (int axis = 2; axis >= 0; --axis) {
    auto& bit_indices = bit_indices_[static_cast<std::size_t>(axis)];
    bit_indices.resize(static_cast<std::size_t>(block_count_[axis] * kBlockEdge));
    for (std::size_t i = 0; i < bit_indices.size(); ++i) {
      const auto inside = static_cast<unsigned>(i % kBlockEdge);
      bit_indices[i] =
          i / kBlockEdge * blocks * kBlockCells +
          index_in_block(axis == 0 ? inside : 0, axis == 1 ? inside : 0, axis == 2 ? inside : 0);
    }
    blocks *= static_cast<std::size_t>(block_count_[axis]);
  }
  for (Bits* bits : {&traversed_, &hit_}) bits->assign(blocks * kBlockCells / 64, 0);
}

void FrameCells::mark_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& end) {
  if (origin == end) return;
  const Eigen::Vector3d low = min_.cast<double>();
  SlabWalk walk = slab_walk(bit_indices_, origin - low, end - low);
  CrossAxis& a = walk.a;
  CrossAxis& b = walk.b;
  std::uint64_t* const words = traversed_.data();
  const auto mark = [words](std::size_t bit_index) {
    words[bit_index >> 6] |= std::uint64_t{1} << (bit_index & 63);
  };
  // A ray that changes both a and b within one slab traverses a third cell in between.
  const auto mark_between = [&](std::size_t bit_index, std::int64_t next_a, std::int64_t next_b) {
    mark(bit_index + (a.crossing() < b.crossing() ? a.bit_indices[next_a] + b.bit_indices[b.cell]
                                                  : a.bit_indices[a.cell] + b.bit_indices[next_b]));
  };

  for (std::int64_t slab = walk.first; slab != walk.last; slab += walk.forward) {
    const std::size_t bit_index = walk.bit_indices[slab];
    const std::int64_t next_a = a.position >> kFraction;
    const std::int64_t next_b = b.position >> kFraction;
    mark(bit_index + a.bit_indices[a.cell] + b.bit_indices[b.cell]);
    if (next_a != a.cell && next_b != b.cell) mark_between(bit_index, next_a, next_b);
    mark(bit_index + a.bit_indices[next_a] + b.bit_indices[next_b]);
    a.cell = next_a;
    b.cell = next_b;
    a.position += a.step;
    b.position += b.step;
  }
  if (a.cell == walk.end_a && b.cell == walk.end_b) return;
  const std::size_t bit_index = walk.bit_indices[walk.last];
  mark(bit_index + a.bit_indices[a.cell] + b.bit_indices[b.cell]);
  if (a.cell != walk.end_a && b.cell != walk.end_b) mark_between(bit_index, walk.end_a, walk.end_b);
}

}  // namespace pcavr
