// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/board/board_views.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/board/picture_file.hpp"

#include "perception/board/board_search.hpp"

namespace pcavr {
namespace {

/// Points by which a picture has a board's pose with something to spare.
constexpr std::size_t kMinPoints = 6;

/// A picture in a file or in memory.
struct PictureSource {
  std::string name = {};  ///< in messages
  std::string file = {};  ///< empty: in memory
  int number = 0;
  /// Reads it; a file is read again by each call, so that not all are in memory at once.
  std::function<Expected<GrayImage>()> read = {};
};

/// What became of one picture.
struct SearchedPicture {
  int width = 0, height = 0;
  std::optional<Error> error = {};
  FoundTags tags = {};
  std::optional<FoundGrid> grid = {};
  FoundPoints points = {};
};

bool has_tags(const Board& board) {
  return board.kind == BoardKind::charuco || board.kind == BoardKind::tags;
}

void search(const PictureSource& source, const Board& board, SearchedPicture& searched) {
  const Expected<GrayImage> image = source.read();
  if (!image) {
    searched.error = image.error();
    return;
  }
  searched.width = image->width();
  searched.height = image->height();
  if (has_tags(board)) {
    searched.tags = find_tags(*image, board);
  } else {
    searched.grid = find_grid(*image, board);
    if (searched.grid) searched.points = searched.grid->points;
  }
}

/// The places on the board of all tags, by the layout that all pictures together show.
void place_tags(const std::vector<PictureSource>& sources, const Board& board,
                Parallelism parallelism, std::vector<SearchedPicture>& pictures) {
  std::vector<FoundTags> tags;
  for (const SearchedPicture& picture : pictures) tags.push_back(picture.tags);
  const BoardLayout layout = choose_layout(tags, board);
  parallel_for(parallelism, sources.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (tags[i].tags.empty()) continue;
      if (board.kind == BoardKind::tags) {
        pictures[i].points = points_of_tags({}, tags[i], board, layout);
        continue;
      }
      const Expected<GrayImage> image = sources[i].read();
      if (image) {
        pictures[i].points = points_of_tags(*image, tags[i], board, layout);
      } else {
        pictures[i].error = image.error();
      }
    }
  });
}

/// Why a picture is no view; nothing where it is one.
std::optional<std::string> fault_of(const SearchedPicture& picture, const Board& board) {
  if (picture.tags.is_mirrored) {
    return "is mirrored: its tags can be read from right to left only";
  }
  if (picture.tags.twice > 0) {
    return fmt::format("shows two boards: {} of its tags are there twice", picture.tags.twice);
  }
  if (picture.grid && picture.grid->is_another) return "shows two boards";
  if (picture.points.ids.size() >= kMinPoints) return std::nullopt;
  if (has_tags(board) && !picture.tags.tags.empty()) {
    return fmt::format("shows {} tags of {}, too few of them in the board's places",
                       picture.tags.tags.size(), board.family);
  }
  return "does not show the whole board, or too small or blurred";
}

std::string join(const std::vector<std::string>& names) {
  constexpr std::size_t kMaxNames = 8;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kMaxNames; ++i) {
    text += (i == 0 ? "" : ", ") + names[i];
  }
  if (names.size() > kMaxNames) text += fmt::format(" and {} more", names.size() - kMaxNames);
  return text;
}

Error no_board(const std::string& pictures, const Board& board,
               const std::map<std::string, std::vector<std::string>>& faults) {
  const auto main_fault = std::max_element(
      faults.begin(), faults.end(),
      [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  std::string hint = "check --board " + board.source;
  if (main_fault->first.find("mirrored") != std::string::npos) {
    hint = "turn off the camera's mirroring, or flip the pictures back";
  } else if (main_fault->first.find("two boards") != std::string::npos) {
    hint = "cover one of them, or give a board whose tags the other does not have";
  } else if (board.kind == BoardKind::chessboard) {
    hint += ": its numbers are of inner corners, one less than of squares";
  }
  return {.message = fmt::format("no picture shows one {}: {} {}", describe(board),
                                 main_fault->second.front(), main_fault->first),
          .file = pictures,
          .hint = hint};
}

/// An Error where a picture has another size than the first one.
Expected<void> check_sizes(const std::vector<PictureSource>& sources,
                           const std::vector<SearchedPicture>& searched) {
  const SearchedPicture& first = searched.front();
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (searched[i].width == first.width && searched[i].height == first.height) continue;
    return Error{
        .message = fmt::format("has {} x {} pixels, {} has {} x {}", searched[i].width,
                               searched[i].height, sources.front().name, first.width, first.height),
        .file = sources[i].file,
        .place = sources[i].file.empty() ? sources[i].name : "",
        .hint = "give pictures of one camera and one size"};
  }
  return {};
}

Expected<BoardViews> collect(const std::string& pictures, const std::vector<PictureSource>& sources,
                             const Board& board, std::vector<SearchedPicture> searched) {
  BoardViews found{.width = searched.front().width, .height = searched.front().height};
  std::map<std::string, std::vector<std::string>> faults;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    SearchedPicture& picture = searched[i];
    if (const auto fault = fault_of(picture, board)) {
      faults[*fault].push_back(sources[i].name);
      continue;
    }
    BoardView view{.name = fmt::format("view {}", sources[i].number),
                   .file = sources[i].file,
                   .number = sources[i].number,
                   .ids = std::move(picture.points.ids),
                   .pixels = std::move(picture.points.pixels)};
    if (picture.grid) view.turns = picture.grid->turns;
    found.views.push_back(std::move(view));
  }
  if (found.views.empty()) return no_board(pictures, board, faults);
  for (const auto& [fault, names] : faults) {
    found.notes.push_back(
        fmt::format("left out: {}: {}{}", join(names), names.size() > 1 ? "each " : "", fault));
  }
  return found;
}

/// `pictures` is the file in errors.
Expected<BoardViews> views_of(const std::string& pictures,
                              const std::vector<PictureSource>& sources, const Board& board,
                              Parallelism parallelism) {
  std::vector<SearchedPicture> searched(sources.size());
  parallel_for(parallelism, sources.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) search(sources[i], board, searched[i]);
  });
  const auto first_error = [&] {
    const auto found = std::ranges::find_if(
        searched, [](const SearchedPicture& picture) { return picture.error.has_value(); });
    return found == searched.end() ? std::nullopt : found->error;
  };
  if (const auto error = first_error()) return *error;
  if (const auto sized = check_sizes(sources, searched); !sized) return sized.error();
  if (has_tags(board)) {
    place_tags(sources, board, parallelism, searched);
    if (const auto error = first_error()) return *error;
  }
  return collect(pictures, sources, board, std::move(searched));
}

}  // namespace

Expected<BoardViews> read_board_views(const std::string& pictures, const Board& board,
                                      Parallelism parallelism) {
  const Expected<std::vector<NumberedPicture>> files = list_pictures(pictures);
  if (!files) return files.error();
  std::vector<PictureSource> sources;
  for (const NumberedPicture& picture : *files) {
    sources.push_back({.name = picture.file.filename().string(),
                       .file = picture.file.string(),
                       .number = picture.number,
                       .read = [&picture]() -> Expected<GrayImage> {
                         const Expected<ColorImage> image = read_picture(picture.file);
                         if (!image) return image.error();
                         return to_gray(*image);
                       }});
  }
  return views_of(pictures, sources, board, parallelism);
}

Expected<BoardViews> find_board_views(std::span<const GrayImage> pictures, const Board& board,
                                      Parallelism parallelism) {
  if (pictures.empty()) return Error{.message = "there are no pictures"};
  std::vector<PictureSource> sources;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    sources.push_back({.name = fmt::format("picture {}", i),
                       .number = static_cast<int>(i),
                       .read = [&image = pictures[i]]() -> Expected<GrayImage> { return image; }});
  }
  return views_of("", sources, board, parallelism);
}

}  // namespace pcavr
