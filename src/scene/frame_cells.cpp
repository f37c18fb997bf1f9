// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "frame_cells.hpp"

namespace pcavr {
namespace {

int floored_to_block(int cell) { return cell & ~(kBlockEdge - 1); }

/// Positions across the ray's longest axis are fixed-point numbers: 2^32 to a cell.
constexpr double kOne = 4294967296.0;
constexpr int kFraction = 32;

/// One of the two axes across the longest one.
struct CrossAxis {
  const std::size_t* codes;  ///< by cell
  std::int64_t position;     ///< at the end of the slab
  std::int64_t step;         ///< from slab to slab
  std::int64_t cell;         ///< at the start of the slab

  /// How far into the slab the ray leaves `cell`, for a slab of unit length that ends at position.
  [[nodiscard]] double crossing() const {
    const std::int64_t border = (step > 0 ? cell + 1 : cell) << kFraction;
    return static_cast<double>(border - (position - step)) / static_cast<double>(step);
  }
};

/// All coordinates are positive here, so that a cast rounds down.
std::int64_t cell_of(double position) { return static_cast<std::int64_t>(position); }

/// A ray cut into slabs of one cell along its longest axis.
struct SlabWalk {
  const std::size_t* codes;  ///< along the longest axis, by cell
  std::int64_t first;        ///< slabs by their cell along the longest axis
  std::int64_t last;
  std::int64_t forward;  ///< 1 or -1
  CrossAxis a;
  CrossAxis b;
  std::int64_t end_a;  ///< where the ray ends
  std::int64_t end_b;
};

/// `codes`: by axis and cell. The ray must have a length.
SlabWalk slab_walk(const std::array<std::vector<std::size_t>, 3>& codes,
                   const Eigen::Vector3d& origin, const Eigen::Vector3d& end) {
  const Eigen::Vector3d ray = end - origin;
  int longest = 0;
  const double length = ray.cwiseAbs().maxCoeff(&longest);
  const bool is_forward = ray[longest] > 0.0;
  const std::int64_t first = cell_of(origin[longest]);
  const double to_border = is_forward ? static_cast<double>(first + 1) - origin[longest]
                                      : origin[longest] - static_cast<double>(first);
  const auto codes_of = [&](int axis) { return codes[static_cast<std::size_t>(axis)].data(); };
  const auto cross_axis = [&](int axis) {
    const double slope = ray[axis] / length;
    return CrossAxis{codes_of(axis),
                     static_cast<std::int64_t>((origin[axis] + slope * to_border) * kOne),
                     static_cast<std::int64_t>(slope * kOne), cell_of(origin[axis])};
  };
  const int axis_a = longest == 0 ? 1 : 0;
  const int axis_b = longest == 2 ? 1 : 2;
  return {codes_of(longest),     first,
          cell_of(end[longest]), is_forward ? 1 : -1,
          cross_axis(axis_a),    cross_axis(axis_b),
          cell_of(end[axis_a]),  cell_of(end[axis_b])};
}

}  // namespace

void FrameCells::reset(const Eigen::Vector3i& low, const Eigen::Vector3i& high) {
  low_ = low.unaryExpr(&floored_to_block);
  block_count_ = (high - low_) / kBlockEdge + Eigen::Vector3i::Ones();
  // Places of the coordinates in a cell's code: z changes fastest.
  std::size_t blocks = 1;
  for (int axis = 2; axis >= 0; --axis) {
    auto& codes = codes_[static_cast<std::size_t>(axis)];
    codes.resize(static_cast<std::size_t>(block_count_[axis] * kBlockEdge));
    for (std::size_t i = 0; i < codes.size(); ++i) {
      const auto inside = static_cast<unsigned>(i % kBlockEdge);
      codes[i] =
          i / kBlockEdge * blocks * kBlockCells +
          index_in_block(axis == 0 ? inside : 0, axis == 1 ? inside : 0, axis == 2 ? inside : 0);
    }
    blocks *= static_cast<std::size_t>(block_count_[axis]);
  }
  for (Bits* bits : {&passed_, &hit_}) bits->assign(blocks * kBlockCells / 64, 0);
}

void FrameCells::mark_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& end) {
  if (origin == end) return;
  const Eigen::Vector3d low = low_.cast<double>();
  SlabWalk walk = slab_walk(codes_, origin - low, end - low);
  CrossAxis& a = walk.a;
  CrossAxis& b = walk.b;
  std::uint64_t* const words = passed_.data();
  const auto mark = [words](std::size_t code) {
    words[code >> 6] |= std::uint64_t{1} << (code & 63);
  };
  // Where the ray changes a and b within one slab, it passes a third cell between.
  const auto mark_between = [&](std::size_t code, std::int64_t next_a, std::int64_t next_b) {
    mark(code + (a.crossing() < b.crossing() ? a.codes[next_a] + b.codes[b.cell]
                                             : a.codes[a.cell] + b.codes[next_b]));
  };

  for (std::int64_t slab = walk.first; slab != walk.last; slab += walk.forward) {
    const std::size_t code = walk.codes[slab];
    const std::int64_t next_a = a.position >> kFraction;
    const std::int64_t next_b = b.position >> kFraction;
    mark(code + a.codes[a.cell] + b.codes[b.cell]);
    if (next_a != a.cell && next_b != b.cell) mark_between(code, next_a, next_b);
    mark(code + a.codes[next_a] + b.codes[next_b]);
    a.cell = next_a;
    b.cell = next_b;
    a.position += a.step;
    b.position += b.step;
  }
  if (a.cell == walk.end_a && b.cell == walk.end_b) return;
  const std::size_t code = walk.codes[walk.last];
  mark(code + a.codes[a.cell] + b.codes[b.cell]);
  if (a.cell != walk.end_a && b.cell != walk.end_b) mark_between(code, walk.end_a, walk.end_b);
}

}  // namespace pcavr
