// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/board/board_views.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/board/picture_file.hpp"

#include "perception/board/board_search.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Points by which a picture has a board's pose with something to spare.
constexpr std::size_t kMinPoints = 6;

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

void search(const NumberedPicture& file, const Board& board, SearchedPicture& searched) {
  const Expected<ColorImage> image = read_picture(file.file);
  if (!image) {
    searched.error = image.error();
    return;
  }
  searched.width = image->width();
  searched.height = image->height();
  const GrayImage gray = to_gray(*image);
  if (has_tags(board)) {
    searched.tags = find_tags(gray, board);
  } else {
    searched.grid = find_grid(gray, board);
    if (searched.grid) searched.points = searched.grid->points;
  }
}

/// The places on the board of all tags, by the layout that all pictures together show.
void place_tags(const std::vector<NumberedPicture>& files, const Board& board,
                Parallelism parallelism, std::vector<SearchedPicture>& pictures) {
  std::vector<FoundTags> tags;
  for (const SearchedPicture& picture : pictures) tags.push_back(picture.tags);
  const BoardLayout layout = choose_layout(tags, board);
  parallel_for(parallelism, files.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (tags[i].tags.empty()) continue;
      if (board.kind == BoardKind::tags) {
        pictures[i].points = points_of_tags({}, tags[i], board, layout);
        continue;
      }
      const Expected<ColorImage> image = read_picture(files[i].file);
      if (image) {
        pictures[i].points = points_of_tags(to_gray(*image), tags[i], board, layout);
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

Expected<BoardViews> collect(const std::string& pictures, const std::vector<NumberedPicture>& files,
                             const Board& board, std::vector<SearchedPicture> searched) {
  BoardViews found{.width = searched.front().width, .height = searched.front().height};
  std::map<std::string, std::vector<std::string>> faults;
  for (std::size_t i = 0; i < files.size(); ++i) {
    SearchedPicture& picture = searched[i];
    const std::string name = files[i].file.filename().string();
    if (picture.width != found.width || picture.height != found.height) {
      return Error{.message = fmt::format("has {} x {} pixels, {} has {} x {}", picture.width,
                                          picture.height, files.front().file.filename().string(),
                                          found.width, found.height),
                   .file = files[i].file.string(),
                   .hint = "give pictures of one camera and one size"};
    }
    if (const auto fault = fault_of(picture, board)) {
      faults[*fault].push_back(name);
      continue;
    }
    BoardView view{.name = fmt::format("view {}", files[i].number),
                   .file = files[i].file.string(),
                   .number = files[i].number,
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

}  // namespace

Expected<BoardViews> read_board_views(const std::string& pictures, const Board& board,
                                      Parallelism parallelism) {
  const Expected<std::vector<NumberedPicture>> files = list_pictures(pictures);
  if (!files) return files.error();
  std::vector<SearchedPicture> searched(files->size());
  parallel_for(parallelism, files->size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) search((*files)[i], board, searched[i]);
  });
  const auto first_error = [&] {
    const auto found = std::ranges::find_if(
        searched, [](const SearchedPicture& picture) { return picture.error.has_value(); });
    return found == searched.end() ? std::nullopt : found->error;
  };
  if (const auto error = first_error()) return *error;
  if (has_tags(board)) {
    place_tags(*files, board, parallelism, searched);
    if (const auto error = first_error()) return *error;
  }
  return collect(pictures, *files, board, std::move(searched));
}

}  // namespace pcavr
