// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/bag_import/csv_series.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <fstream>
#include <map>
#include <utility>

#include "pcavr/core/input_ranges.hpp"
#include "pcavr/core/output.hpp"
#include "pcavr/recording/text_rows.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// The columns of a message's numbers, in the order in which ROS serialises them.
struct SeriesKind {
  const char* type;
  std::vector<std::string> columns;
};
const std::array<SeriesKind, 3>& series_kinds() {
  static const std::array<SeriesKind, 3> kKinds{
      {{"geometry_msgs/PoseStamped", {"x", "y", "z", "qx", "qy", "qz", "qw"}},
       {"geometry_msgs/WrenchStamped", {"fx", "fy", "fz", "tx", "ty", "tz"}},
       {"geometry_msgs/PointStamped", {"x", "y", "z"}}}};
  return kKinds;
}
constexpr std::array<std::string_view, 4> kSensorStamps{"t_header", "timestamp", "time", "t"};
constexpr std::array<std::string_view, 2> kRecorderStamps{"t_bag", "t_receive"};

/// Where a file's columns are.
struct SeriesLayout {
  std::string type = "csv";
  std::vector<std::size_t> numbers = {};
  std::size_t stamp = 0;
  std::size_t log_time = 0;
  std::size_t columns = 0;
};

template <typename Names>
std::optional<std::size_t> first_of(const std::vector<std::string>& header, const Names& names) {
  for (const auto& name : names) {
    const auto at = std::find(header.begin(), header.end(), name);
    if (at != header.end()) return static_cast<std::size_t>(at - header.begin());
  }
  return std::nullopt;
}

SeriesLayout layout_of(const std::vector<std::string>& header) {
  SeriesLayout layout{.columns = header.size()};
  const auto stamp = first_of(header, kSensorStamps);
  const auto log_time = first_of(header, kRecorderStamps);
  if (!stamp && !log_time) return layout;
  layout.stamp = stamp.value_or(log_time.value_or(0));
  layout.log_time = log_time.value_or(layout.stamp);
  for (const SeriesKind& kind : series_kinds()) {
    layout.numbers.clear();
    for (const std::string& column : kind.columns) {
      if (const auto at = first_of(header, std::array{column})) layout.numbers.push_back(*at);
    }
    if (layout.numbers.size() != kind.columns.size()) continue;
    layout.type = kind.type;
    return layout;
  }
  layout.numbers.clear();
  return layout;
}

/// Of a file, by its header alone.
Expected<SeriesLayout> read_layout(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string header;
  constexpr std::size_t kMaxHeader = 1U << 16;
  for (char c = 0; header.size() < kMaxHeader && stream.get(c) && c != '\n';) header += c;
  if (!stream && header.empty()) {
    return Error{.message = "can't be read or is empty", .file = file.string()};
  }
  LineReader lines(header);
  const auto columns = read_header(file.string(), lines);
  if (!columns) return columns.error();
  return layout_of(*columns);
}

/// By topic. Files of a folder; or those that begin as `path` does, up to the end of a number or
/// word.
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

Stamp stamp_of(double seconds) {
  return Stamp{static_cast<std::int64_t>(seconds * 1e9 + (seconds < 0.0 ? -0.5 : 0.5))};
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
  /// Without a frame.
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

class CsvSeriesReader final : public BagReader {
 public:
  void add(const std::string& topic, const fs::path& file, SeriesLayout layout) {
    topics_.push_back({.name = topic,
                       .type = layout.type,
                       .encoding = "ros1",
                       .schema_encoding = {},
                       .schema = {}});
    files_.push_back(file);
    layouts_.push_back(std::move(layout));
  }

  Expected<std::optional<BagMessage>> next() override {
    for (; file_ < files_.size(); ++file_, lines_.reset()) {
      if (layouts_[file_].numbers.empty()) continue;
      if (!lines_) {
        if (const auto opened = open(); !opened) return fail(opened.error());
      }
      std::optional<std::string_view> line = lines_->next();
      while (line && trimmed(*line).empty()) line = lines_->next();
      if (!line) continue;
      auto message = message_of(*line);
      return message ? std::move(message) : fail(message.error());
    }
    return std::optional<BagMessage>();
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  Error fail(Error error) {
    file_ = files_.size();
    return error;
  }

  Expected<void> open() {
    Expected<std::string> text = read_file(files_[file_]);
    if (!text) return text.error();
    text_ = *std::move(text);
    lines_.emplace(text_);
    (void)lines_->next();  // the header
    return {};
  }

  Error error_at(std::string message) const {
    return {.message = std::move(message),
            .file = files_[file_].string(),
            .line = lines_->line(),
            .hint = "write one number for each column of the header"};
  }

  Expected<std::optional<BagMessage>> message_of(std::string_view line) {
    const SeriesLayout& layout = layouts_[file_];
    std::vector<double> row;
    row.reserve(layout.columns);
    for (const std::string_view field : split_at(',', line)) {
      const std::optional<double> number = parse_number(field);
      if (!number) return error_at("'" + std::string(field) + "' is not a number");
      row.push_back(*number);
    }
    if (row.size() != layout.columns) {
      return error_at("has " + std::to_string(row.size()) + " columns, the header " +
                      std::to_string(layout.columns));
    }
    for (const std::size_t stamp : {layout.stamp, layout.log_time}) {
      if (!ranges::kStamp.contains(row[stamp]) || row[stamp] < 0.0) {
        return error_at("stamp out of range");
      }
    }
    payload_.start(stamp_of(row[layout.stamp]));
    for (const std::size_t column : layout.numbers) payload_.add(row[column]);
    const Stamp log_time = stamp_of(row[layout.log_time]);
    return std::optional<BagMessage>({.topic = file_,
                                      .log_time = log_time,
                                      .publish_time = log_time,
                                      .payload = payload_.bytes()});
  }

  std::vector<fs::path> files_;
  std::vector<BagTopic> topics_;       ///< one for each file
  std::vector<SeriesLayout> layouts_;  ///< one for each file
  std::vector<std::string> warnings_;
  std::size_t file_ = 0;
  std::string text_;
  std::optional<LineReader> lines_;
  Ros1Payload payload_;
};

}  // namespace

bool has_csv_series(const fs::path& path) {
  const auto files = series_files(path);
  return std::any_of(files.begin(), files.end(), [](const auto& entry) {
    const auto layout = read_layout(entry.second);
    return layout && !layout->numbers.empty();
  });
}

Expected<std::unique_ptr<BagReader>> open_csv_series(const fs::path& path) {
  auto reader = std::make_unique<CsvSeriesReader>();
  for (const auto& [topic, file] : series_files(path)) {
    Expected<SeriesLayout> layout = read_layout(file);
    if (!layout) return layout.error();
    reader->add(topic, file, *std::move(layout));
  }
  return std::unique_ptr<BagReader>(std::move(reader));
}

Expected<std::unique_ptr<BagReader>> open_bag_or_csv(const fs::path& path) {
  return has_csv_series(path) ? open_csv_series(path) : open_bag(path);
}

}  // namespace pcavr
