// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/bag_import/csv_series.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <utility>
#include <vector>

#include "pcavr/recordings/recording/text_rows.hpp"

#include "recordings/bag_import/csv_layout.hpp"
#include "recordings/bag_import/csv_rows.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxHeader = 1U << 16;  ///< [bytes] and its first row

/// The layout of a file, found from its header and first row alone.
Expected<CsvLayout> read_layout(const fs::path& file, const CsvOptions& options) {
  std::ifstream stream(file, std::ios::binary);
  std::string start(kMaxHeader, '\0');
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(stream.gcount()));
  if (start.empty()) return Error{.message = "can't be read or is empty", .file = file.string()};
  Expected<CsvLayout> layout = layout_of(start, options);
  if (layout) return layout;
  Error error = layout.error();
  error.file = file.string();
  return error;
}

/// Files by topic: those of a folder, or those whose names begin with the name of `path`, up to the
/// end of a number or word.
std::map<std::string, fs::path> series_files(const fs::path& path) {
  std::error_code code;
  const bool is_folder = fs::is_directory(path, code);
  if (is_folder && fs::exists(path / "recording.yaml", code)) return {};
  const std::string start = is_folder ? "" : path.filename().string();
  fs::path folder = is_folder ? path : path.parent_path();
  if (folder.empty()) folder = ".";
  std::map<std::string, fs::path> files;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end;
       entry.increment(code)) {
    const std::string name = entry->path().filename().string();
    if (!name.ends_with(".csv") || !name.starts_with(start)) continue;
    std::string topic = name.substr(start.size(), name.size() - start.size() - 4);
    const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
    if (!start.empty() && is_word(start.back()) && !topic.empty() && is_word(topic[0])) continue;
    topic.erase(0, topic.find_first_not_of("_-. "));
    if (topic.empty()) topic = entry->path().stem().string();
    files.emplace(topic, entry->path());
  }
  return files;
}

/// ROS 1's serialization: packed, little-endian.
class Ros1Payload {
 public:
  template <typename Number>
  void add(Number value) {
    const auto raw = std::bit_cast<std::array<std::uint8_t, sizeof(Number)>>(value);
    static_assert(std::endian::native == std::endian::little);
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
  }
  /// Begins a message with a header that has no frame.
  void start(Stamp stamp) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    bytes_.clear();
    add(std::uint32_t{0});  // seq
    add(static_cast<std::uint32_t>(stamp.nanoseconds / kSecond));
    add(static_cast<std::uint32_t>(stamp.nanoseconds % kSecond));
    add(std::uint32_t{0});
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// A file and its topics.
struct CsvFile {
  fs::path path;
  CsvLayout layout;
  std::size_t first_topic = 0;  ///< of its series, in their order; one, too, where it has none
};

std::string topic_name(const std::string& file_topic, const CsvLayout& layout,
                       const CsvLayout::Series& series) {
  if (series.name.empty()) return file_topic;
  return layout.is_take ? series.name : file_topic + "/" + series.name;
}

class CsvSeriesReader final : public BagReader {
 public:
  explicit CsvSeriesReader(bool skip_bad) : skip_bad_(skip_bad) {}

  void add(const std::string& topic, CsvFile file) {
    file.first_topic = topics_.size();
    for (const CsvLayout::Series& series : file.layout.series) {
      const std::string name = topic_name(topic, file.layout, series);
      // Two takes may have the same body.
      const bool is_taken = std::any_of(topics_.begin(), topics_.end(),
                                        [&](const BagTopic& other) { return other.name == name; });
      add_topic(is_taken ? topic + "/" + name : name, series.type);
    }
    if (file.layout.series.empty()) add_topic(topic, "csv");
    files_.push_back(std::move(file));
  }
  [[nodiscard]] std::vector<CsvFile>& files() { return files_; }
  void warn(std::string text) { warnings_.push_back(std::move(text)); }

  Expected<std::optional<BagMessage>> next() override {
    for (; file_ < files_.size(); ++file_, rows_.reset()) {
      if (files_[file_].layout.series.empty()) continue;
      if (!rows_) {
        if (const auto opened = open(); !opened) return fail(opened.error());
      }
      while (series_ < layout().series.size() || next_row()) {
        const CsvLayout::Series& series = layout().series[series_++];
        auto message = message_of(series);
        if (message && !*message) continue;  // no sample in this row
        if (message) return message;
        if (!skip_bad_) return fail(message.error());
        series_ = layout().series.size();
        if (skipped_++ == 0) first_skipped_ = message.error();
      }
      report_file();
    }
    return std::optional<BagMessage>();
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  [[nodiscard]] const CsvLayout& layout() const { return files_[file_].layout; }

  void add_topic(const std::string& name, const std::string& type) {
    topics_.push_back(
        {.name = name, .type = type, .encoding = "ros1", .schema_encoding = {}, .schema = {}});
  }

  Error fail(Error error) {
    file_ = files_.size();
    return error;
  }

  Expected<void> open() {
    Expected<CsvRows> rows = CsvRows::open(files_[file_].path, layout());
    if (!rows) return rows.error();
    rows_.emplace(*std::move(rows));
    series_ = layout().series.size();
    skipped_ = row_count_ = 0;
    gaps_.assign(series_, 0);
    return {};
  }

  bool next_row() {
    series_ = 0;
    if (!rows_->next()) return false;
    ++row_count_;
    return true;
  }

  /// Reports what was assumed of the file that ends here, its rows that were skipped, and its
  /// bodies that were not seen.
  void report_file() {
    const CsvLayout::StampColumn& stamp = layout().stamp;
    const std::string name = files_[file_].path.string();
    for (const std::string& remark : layout().remarks) warn(name + ": " + remark);
    if (!stamp.is_date && !stamp.is_unit_stated && stamp.unit && *stamp.unit != TimeUnit::seconds) {
      warn(name + ": the stamps are read as " + name_of(*stamp.unit) + " since 1970");
    }
    for (std::size_t i = 0; layout().is_take && i < gaps_.size(); ++i) {
      if (gaps_[i] == 0) continue;
      warn(name + ": " + layout().series[i].name + " was not seen in " + std::to_string(gaps_[i]) +
           " of " + std::to_string(row_count_) + " frames");
    }
    if (skipped_ == 0) return;
    first_skipped_.hint.clear();
    warn(name + ": " + std::to_string(skipped_) + (skipped_ == 1 ? " row is" : " rows are") +
         " skipped, the first: line " + std::to_string(first_skipped_.line) + " " +
         first_skipped_.message);
  }

  /// nullopt where the row has no sample of the series.
  Expected<std::optional<BagMessage>> message_of(const CsvLayout::Series& series) {
    if (const auto width = rows_->check_width(); !width) return width.error();
    if (rows_->is_gap(series)) {
      ++gaps_[series_ - 1];
      return std::optional<BagMessage>();
    }
    const Expected<Stamp> stamp = rows_->stamp(layout().stamp);
    if (!stamp) return stamp.error();
    const Expected<Stamp> log_time = rows_->stamp(layout().log_time);
    if (!log_time) return log_time.error();
    const Expected<std::vector<double>> numbers = rows_->numbers(series);
    if (!numbers) return numbers.error();
    payload_.start(*stamp);
    if (series.type == kTrackedBodyType) payload_.add(std::uint32_t{0});  // the child frame
    for (const double number : *numbers) payload_.add(number);
    return std::optional<BagMessage>({.topic = files_[file_].first_topic + series_ - 1,
                                      .log_time = *log_time,
                                      .publish_time = *log_time,
                                      .payload = payload_.bytes()});
  }

  bool skip_bad_;
  std::vector<CsvFile> files_;
  std::vector<BagTopic> topics_;
  std::vector<std::string> warnings_;
  std::size_t file_ = 0;
  std::optional<CsvRows> rows_;  ///< of the file
  std::size_t series_ = 0;       ///< the next one of the row
  std::size_t row_count_ = 0, skipped_ = 0;
  std::vector<std::size_t> gaps_;  ///< rows without a sample, of each series
  Error first_skipped_;
  Ros1Payload payload_;
};

/// The stamp of a file's first row; nullopt where it can't be read.
std::optional<Stamp> first_stamp(const CsvFile& file) {
  Expected<CsvRows> rows = CsvRows::open(file.path, file.layout);
  if (!rows || !rows->next() || !rows->check_width()) return std::nullopt;
  const Expected<Stamp> stamp = rows->stamp(file.layout.stamp);
  if (!stamp) return std::nullopt;
  return *stamp;
}

std::string zone_text(Duration zone) {
  const auto minutes = std::chrono::duration_cast<std::chrono::minutes>(zone).count();
  char text[32];
  const int size = std::snprintf(text, sizeof(text), "UTC%c%02d:%02d", minutes < 0 ? '-' : '+',
                                 static_cast<int>(std::abs(minutes) / 60),
                                 static_cast<int>(std::abs(minutes) % 60));
  return {text, static_cast<std::size_t>(size)};
}

/// Takes stamps in local time as that zone's, of those that exist, in which they are nearest to the
/// other files'; as UTC where no other file has a date.
void place_local_times(CsvSeriesReader& reader) {
  constexpr Duration kStep = std::chrono::minutes(15);  // all zones are multiples of it
  constexpr Duration kMost = std::chrono::hours(14);
  constexpr Stamp kFirstDate{946'684'800'000'000'000};  // 2000-01-01: earlier ones count no dates
  const bool has_local =
      std::any_of(reader.files().begin(), reader.files().end(),
                  [](const CsvFile& file) { return file.layout.zone.has_value(); });
  if (!has_local) return;  // the files need not be read for their first stamps
  std::optional<Stamp> others;
  std::string other;
  for (const CsvFile& file : reader.files()) {
    if (file.layout.series.empty() || file.layout.zone) continue;
    const std::optional<Stamp> first = first_stamp(file);
    if (!first || *first < kFirstDate || (others && *others <= *first)) continue;
    others = first;
    other = file.path.filename().string();
  }
  for (CsvFile& file : reader.files()) {
    if (!file.layout.zone) continue;
    const std::optional<Stamp> first = first_stamp(file);
    if (first && others) {
      const Duration apart = *first - *others;
      const std::int64_t half = kStep.count() / 2;
      const std::int64_t steps =
          (apart.count() + (apart.count() < 0 ? -half : half)) / kStep.count();
      file.layout.zone = std::clamp(steps * kStep, -kMost, kMost);
    }
    reader.warn(file.path.string() + ": its stamps are in local time, taken as " +
                zone_text(*file.layout.zone) +
                (others ? ", nearest to " + other : "; no other file has a date"));
  }
}

}  // namespace

bool has_csv_series(const fs::path& path, const CsvOptions& options) {
  const auto files = series_files(path);
  return std::any_of(files.begin(), files.end(), [&](const auto& entry) {
    const auto layout = read_layout(entry.second, options);
    // A known column in an unknown unit is an error of the import, not another kind of file.
    return layout ? !layout->series.empty() : !layout.error().hint.empty();
  });
}

std::vector<std::string> other_files(const fs::path& path) {
  std::vector<std::string> names;
  std::error_code code;
  for (fs::directory_iterator entry(path, code), end; !code && entry != end;
       entry.increment(code)) {
    std::error_code type;
    const std::string name = entry->path().filename().string();
    if (entry->is_directory(type)) {
      names.push_back(name + '/');
    } else if (!name.ends_with(".csv")) {
      names.push_back(name);
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::optional<Error> unknown_csv_columns(const fs::path& path) {
  const auto files = series_files(path);
  if (files.empty() || has_csv_series(path)) return std::nullopt;
  const fs::path& file = files.begin()->second;
  const auto layout = read_layout(file, {});
  if (!layout) return layout.error();
  std::string names;
  for (const std::string& name : layout->names) names += (names.empty() ? "" : ", ") + name;
  return Error{.message = "has no columns of a pose or a force: " + names,
               .file = file.string(),
               .line = 1,
               .hint =
                   "say which they are, as --map t=COLUMN,fx=COLUMN,...; or name them t, x, y, "
                   "z, qx, qy, qz, qw or t, fx, fy, fz, tx, ty, tz"};
}

Expected<std::unique_ptr<BagReader>> open_csv_series(const fs::path& path,
                                                     const CsvOptions& options) {
  auto reader = std::make_unique<CsvSeriesReader>(options.skip_bad);
  std::vector<std::string> names;  // of all columns
  for (const auto& [topic, file] : series_files(path)) {
    Expected<CsvLayout> layout = read_layout(file, options);
    if (!layout) return layout.error();
    names.insert(names.end(), layout->names.begin(), layout->names.end());
    reader->add(topic, {.path = file, .layout = *std::move(layout)});
  }
  for (const auto& mapped : options.columns) {
    const std::string& column = mapped.second;
    const bool is_found = std::any_of(names.begin(), names.end(), [&](const std::string& other) {
      return other == column || parse_column(other).name == parse_column(column).name;
    });
    if (is_found) continue;
    return Error{.message = "no file has the column '" + column + "' that is to be " + mapped.first,
                 .file = path.string(),
                 .place = "--map",
                 .hint = "give columns as the files' headers have them"};
  }
  place_local_times(*reader);
  return std::unique_ptr<BagReader>(std::move(reader));
}

Expected<std::unique_ptr<BagReader>> open_bag_or_csv(const fs::path& path,
                                                     const CsvOptions& options) {
  return has_csv_series(path, options) ? open_csv_series(path, options) : open_bag(path);
}

}  // namespace pcavr
