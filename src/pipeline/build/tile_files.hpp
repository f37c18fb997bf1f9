// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/pipeline/tile_steps.hpp"

#include "step_file.hpp"
#include "survey.hpp"
#include "tile_fusion.hpp"

namespace pcavr {

/// What the first step of a build by tiles finds, for the fusion and for the rest of the scene.
struct TileSurvey {
  TileFrames frames;
  Survey survey;
  std::string digest = {};  ///< of the file that it was read from
};

/// With version and options, of which the tiles are to be fused.
[[nodiscard]] Expected<void> write_tile_survey(const TileFrames& frames, const Survey& survey,
                                               const BuildOptions& options,
                                               const WriteContent& write);
/// An Error where the file is none, is damaged, or is of another recording, options or version.
[[nodiscard]] Expected<TileSurvey> read_tile_survey(const std::filesystem::path& file,
                                                    const Recording& recording,
                                                    const BuildOptions& options);

/// Writes the tiles of a part one after the other, as they are fused.
class FusedPartWriter {
 public:
  /// `survey` is the digest of the file of survey_tiles(). `write` must outlive this.
  FusedPartWriter(const TilePart& part, const std::string& survey, const WriteContent& write);

  [[nodiscard]] Expected<void> add(const FusedTile& tile);
  /// Call once, at the end.
  [[nodiscard]] Expected<void> finish(bool has_agreed_surface);

 private:
  StepFileWriter file_;
};

/// The files of all parts of a scene, whose tiles are not read yet.
class FusedParts {
 public:
  /// In any order. An Error where one is missing, is there twice, is damaged, or was fused from
  /// another survey.
  [[nodiscard]] static Expected<FusedParts> open(const std::vector<std::filesystem::path>& files,
                                                 const std::string& survey);

  /// Call once.
  [[nodiscard]] Expected<FusedTiles> read();

 private:
  std::vector<StepFileReader> files_;
};

}  // namespace pcavr
