// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <sstream>

// Disables OctoMap's debug output.
#define OCTOMAP_NODEBUGOUT
#include <octomap/OcTree.h>

#include "pcavr/base/core/output.hpp"

#include "occupancy_state.hpp"

namespace pcavr {
namespace {

/// OctoMap's key of the cell whose lower corner is base's origin.
constexpr int kCentralKey = 32768;

octomap::key_type key_of(int block, unsigned inside) {
  return static_cast<octomap::key_type>(block * kBlockEdge + static_cast<int>(inside) +
                                        kCentralKey);
}

void copy_block(const OccupancyBlock& block, double units_per_log_odds, octomap::OcTree& tree) {
  for (unsigned x = 0; x < kBlockEdge; ++x) {
    for (unsigned y = 0; y < kBlockEdge; ++y) {
      for (unsigned z = 0; z < kBlockEdge; ++z) {
        const std::int16_t value = block.values[index_in_block(x, y, z)];
        if (value == kUnknown) continue;
        const octomap::OcTreeKey key(key_of(block.position.x(), x), key_of(block.position.y(), y),
                                     key_of(block.position.z(), z));
        tree.setNodeValue(key, static_cast<float>(value / units_per_log_odds), true);
      }
    }
  }
}

}  // namespace

Expected<void> OccupancyMap::write(const std::filesystem::path& file) const {
  octomap::OcTree tree(state_->options.resolution);
  tree.setClampingThresMin(state_->options.clamping_min);
  tree.setClampingThresMax(state_->options.clamping_max);
  for (const OccupancyBlock& block : state_->blocks) {
    copy_block(block, state_->units_per_log_odds, tree);
  }
  tree.updateInnerOccupancy();
  tree.toMaxLikelihood();
  tree.prune();
  // The header is written here: OctoMap's compiled writeBinary() prints debug output.
  std::ostringstream content;
  content << "# Octomap OcTree binary file\n# written by pcavr " PCAVR_VERSION "\nid "
          << tree.getTreeType() << "\nsize " << tree.size() << "\nres " << tree.getResolution()
          << "\ndata\n";
  if (tree.size() > 0) tree.writeBinaryData(content);
  return write_file(file, std::move(content).str());
}

}  // namespace pcavr
