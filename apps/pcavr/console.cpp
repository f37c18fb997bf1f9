// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "console.hpp"

#include <algorithm>
#include <cstdio>

#include <unistd.h>

#include "pcavr/base/core/utf8.hpp"

#include "terminal.hpp"

namespace pcavr::app {
namespace {

constexpr int kBarWidth = 30;                                    ///< [characters]
constexpr auto kRedrawInterval = std::chrono::milliseconds(50);  ///< faster is not visible

}  // namespace

Console::Console()
    : is_terminal_(::isatty(STDERR_FILENO) != 0), has_colors_(has_colors(STDERR_FILENO)) {}

Console::~Console() { clear_bar(); }

Observer Console::observer() {
  return {.progress = [this](std::string_view stage, std::size_t done,
                             std::size_t total) { progress(stage, done, total); },
          .warn = [this](std::string_view line) { print_line("warning: ", line); },
          .note = [this](std::string_view line) { print_line("", line); }};
}

void Console::progress(std::string_view stage, std::size_t done, std::size_t total) {
  const auto now = std::chrono::steady_clock::now();
  if (stage != stage_) {
    stage_ = stage;
    stage_start_ = now;
    last_drawn_ = {};
  }
  const double seconds = std::chrono::duration<double>(now - stage_start_).count();
  if (total > 0 && done >= total) {
    clear_bar();
    std::fprintf(stderr, "%s: %zu in %.1f s\n", stage_.c_str(), done, seconds);
    return;
  }
  if (!is_terminal_ || now - last_drawn_ < kRedrawInterval) return;
  last_drawn_ = now;
  bar_is_shown_ = true;
  if (total == 0) {
    std::fprintf(stderr, "\r\033[K%s: %zu", stage_.c_str(), done);
    return;
  }
  const auto filled = static_cast<std::size_t>(kBarWidth) * done / total;
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  const double left =
      done == 0 ? 0.0 : seconds * static_cast<double>(total - done) / static_cast<double>(done);
  std::fprintf(stderr, "\r\033[K%s [%s] %zu/%zu, %.0f s left", stage_.c_str(), bar.c_str(), done,
               total, left);
}

void Console::print_line(std::string_view prefix, std::string_view line) {
  clear_bar();
  const std::string kind = styled(prefix, TextStyle::kWarning, has_colors_ && !prefix.empty());
  std::fprintf(stderr, "%s%s\n", kind.c_str(), printable(line).c_str());
}

void Console::clear_bar() {
  if (bar_is_shown_) std::fputs("\r\033[K", stderr);
  bar_is_shown_ = false;
}

}  // namespace pcavr::app
