// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tile_files.hpp"

#include <memory>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "pcavr/recordings/recording/option_file.hpp"

#include "tile_fields.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kSurveyFormat = "pcavr-tile-survey/1\n";
constexpr std::string_view kAnyFormat = "pcavr-tile-";  // of any version
constexpr std::string_view kPartFormat = "pcavr-tile-part/2\n";

Error refused(const fs::path& file, const std::string& why, const std::string& hint) {
  return {.message = why, .file = file.string(), .place = {}, .hint = hint};
}

Error too_short(const fs::path& file, const std::out_of_range& error) {
  return refused(file, error.what(), "run the step before it again");
}

/// Version and options: tiles of others do not fit together.
std::string build_of(const BuildOptions& options) {
  BuildOptions copy = options;
  std::vector<OptionSection> sections = sections_of(copy.perception);
  for (OptionSection& section : sections_of(copy)) sections.push_back(std::move(section));
  return fmt::format("pcavr {}\ntrust-poses {}, skip-bad {}\n{}", PCAVR_VERSION,
                     options.trust_poses, options.skip_bad, print_options(sections));
}

/// What a file of a part begins with.
struct PartHeader {
  TilePart part;
  std::string survey;  ///< its digest
};

PartHeader take_header(StepFileReader& file) {
  PartHeader header;
  file(header.part);
  file(header.survey);
  return header;
}

}  // namespace

bool is_tile_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string begin(kAnyFormat.size(), '\0');
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin == kAnyFormat;
}

Expected<void> write_tile_survey(const TileFrames& frames, const Survey& survey,
                                 const BuildOptions& options, const WriteContent& write) {
  StepFileWriter file(kSurveyFormat, write);
  file(build_of(options));
  file(frames);
  file(survey);
  const Expected<std::string> written = file.finish();
  return written ? Expected<void>() : written.error();
}

Expected<TileSurvey> read_tile_survey(const fs::path& path, const Recording& recording,
                                      const BuildOptions& options) try {
  Expected<StepFileReader> file = StepFileReader::open(path, kSurveyFormat);
  if (!file) return file.error();
  std::string build;
  (*file)(build);
  if (build != build_of(options))
    return refused(path, "is of other options, or of another version of pcavr",
                   "give all steps the same --config and options");
  TileSurvey read;
  read.digest = file->digest();
  (*file)(read.frames);
  (*file)(read.survey);
  if (!recording.manifest.camera || read.frames.recording != recording_digest(recording))
    return refused(path, "is of another recording", "run survey of " + recording.folder.string());
  return read;
} catch (const std::out_of_range& error) {
  return too_short(path, error);
}

FusedPartWriter::FusedPartWriter(const TilePart& part, const std::string& survey,
                                 const WriteContent& write)
    : file_(kPartFormat, write) {
  file_(part);
  file_(survey);
}

Expected<void> FusedPartWriter::add(const FusedTile& tile) {
  file_(true);
  file_(tile);
  return file_.written();
}

Expected<void> FusedPartWriter::finish(bool has_agreed_surface) {
  file_(false);
  file_(has_agreed_surface);
  const Expected<std::string> written = file_.finish();
  return written ? Expected<void>() : written.error();
}

Expected<FusedParts> FusedParts::open(const std::vector<fs::path>& paths,
                                      const std::string& survey) {
  FusedParts parts;
  std::vector<bool> is_read(paths.size(), false);
  for (const fs::path& path : paths) {
    Expected<StepFileReader> file = StepFileReader::open(path, kPartFormat);
    if (!file) return file.error();
    PartHeader header;
    try {
      header = take_header(*file);
    } catch (const std::out_of_range& error) {
      return too_short(path, error);
    }
    if (header.survey != survey)
      return refused(path, "was fused from another survey than this build is given",
                     "run fuse again with the same file of survey");
    if (header.part.count != paths.size())
      return refused(path, fmt::format("is one of {} parts", header.part.count),
                     fmt::format("give all of them; {} are given", paths.size()));
    if (header.part.number >= paths.size() || is_read[header.part.number])
      return refused(path, fmt::format("is part {} again", header.part.number + 1),
                     "give each part once");
    is_read[header.part.number] = true;
    parts.files_.push_back(*std::move(file));
  }
  return parts;
}

Expected<FusedTiles> FusedParts::read() {
  FusedTiles fused;
  for (StepFileReader& file : files_) {
    try {
      for (bool has_tile = true; file(has_tile), has_tile;) {
        // On the heap: GCC 12 warns that the optional part of a local one may be uninitialised.
        const auto tile = std::make_unique<FusedTile>();
        file(*tile);
        fused.add(std::move(*tile));
      }
      bool has_agreed_surface = false;
      file(has_agreed_surface);
      fused.has_agreed_surface = fused.has_agreed_surface || has_agreed_surface;
    } catch (const std::out_of_range& error) {
      return too_short(file.path(), error);
    }
  }
  return fused;
}

}  // namespace pcavr
