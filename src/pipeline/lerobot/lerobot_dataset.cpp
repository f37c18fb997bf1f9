// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The files of a data set as LeRobot's code of version 3.0 reads them.
#include "pcavr/pipeline/lerobot_dataset.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/parquet.hpp"

#include "column_stats.hpp"
#include "lerobot_video.hpp"

namespace pcavr {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
namespace {

constexpr char kImageKey[] = "observation.images.color";
constexpr char kDataFile[] = "data/chunk-000/file-000.parquet";
constexpr char kEpisodesFile[] = "meta/episodes/chunk-000/file-000.parquet";
// Of LeRobot, which starts another file or folder there when it adds to the data set.
constexpr int kFilesPerChunk = 1000;
constexpr int kDataFileSize = 100;   // [MB]
constexpr int kVideoFileSize = 200;  // [MB]

enum class Kind { float32, int64, boolean };

/// A row of the data: a frame, and where it is.
struct Row {
  const LerobotFrame* frame = nullptr;
  int rate = 0;
  std::size_t frame_index = 0, episode = 0, index = 0, task = 0;
};

/// A column of the data, and its entry in info.json.
struct Feature {
  std::string name;
  Kind kind = Kind::float32;
  std::vector<std::string> components;  ///< of one: a number, not a list
  std::function<std::vector<double>(const Row&)> values;
};

const std::vector<Feature>& features() {
  const auto all = [](const auto& array) {
    return std::vector<double>(array.begin(), array.end());
  };
  const auto number = [](std::size_t value) {
    return std::vector<double>{static_cast<double>(value)};
  };
  const std::vector<std::string> pose{"x", "y", "z", "qx", "qy", "qz", "qw"};
  static const std::vector<Feature> kFeatures{
      {"observation.state", Kind::float32, pose,
       [all](const Row& row) { return all(row.frame->state); }},
      {"action", Kind::float32, pose, [all](const Row& row) { return all(row.frame->action); }},
      {"wrench",
       Kind::float32,
       {"fx", "fy", "fz", "tx", "ty", "tz"},
       [all](const Row& row) { return all(row.frame->wrench); }},
      {"phase",
       Kind::int64,
       {"phase"},
       [](const Row& row) { return std::vector{static_cast<double>(row.frame->phase)}; }},
      {"contact",
       Kind::boolean,
       {"contact"},
       [](const Row& row) { return std::vector{row.frame->contact ? 1.0 : 0.0}; }},
      {"mu",
       Kind::float32,
       {"mu"},
       [](const Row& row) { return std::vector<double>{row.frame->mu}; }},
      {"mu_std",
       Kind::float32,
       {"mu_std"},
       [](const Row& row) { return std::vector<double>{row.frame->mu_std}; }},
      {"timestamp",
       Kind::float32,
       {},
       [](const Row& row) { return std::vector{static_cast<double>(row.frame_index) / row.rate}; }},
      {"frame_index",
       Kind::int64,
       {},
       [number](const Row& row) { return number(row.frame_index); }},
      {"episode_index", Kind::int64, {}, [number](const Row& row) { return number(row.episode); }},
      {"index", Kind::int64, {}, [number](const Row& row) { return number(row.index); }},
      {"task_index", Kind::int64, {}, [number](const Row& row) { return number(row.task); }}};
  return kFeatures;
}

std::size_t width_of(const Feature& feature) {
  return std::max<std::size_t>(1, feature.components.size());
}

/// What is written, gathered before the files are.
struct Content {
  std::vector<std::string> tasks;      ///< by their index
  std::vector<std::vector<Row>> rows;  ///< by episode
  std::optional<LerobotVideo> video = {};
  int rate = 0;
};

Content content_of(const std::vector<LerobotEpisode>& episodes) {
  Content content;
  content.rate = episodes.front().rate;
  std::size_t index = 0;
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    auto task = std::ranges::find(content.tasks, episodes[e].task);
    if (task == content.tasks.end()) task = content.tasks.insert(task, episodes[e].task);
    std::vector<Row>& rows = content.rows.emplace_back();
    for (std::size_t i = 0; i < episodes[e].frames.size(); ++i) {
      rows.push_back({&episodes[e].frames[i], content.rate, i, e, index++,
                      static_cast<std::size_t>(task - content.tasks.begin())});
    }
  }
  return content;
}

std::vector<std::vector<double>> values_of(const Feature& feature, const std::vector<Row>& rows) {
  std::vector<std::vector<double>> values;
  values.reserve(rows.size());
  for (const Row& row : rows) values.push_back(feature.values(row));
  return values;
}

template <typename T>
std::vector<T> numbers_of(const std::vector<std::vector<double>>& values) {
  std::vector<T> numbers;
  numbers.reserve(values.size());
  for (const std::vector<double>& value : values) numbers.push_back(static_cast<T>(value[0]));
  return numbers;
}

ParquetColumn column_of(const Feature& feature, const std::vector<Row>& rows) {
  const std::vector<std::vector<double>> values = values_of(feature, rows);
  if (feature.kind == Kind::int64) return {feature.name, numbers_of<std::int64_t>(values)};
  if (feature.kind == Kind::boolean) return {feature.name, numbers_of<bool>(values)};
  if (width_of(feature) == 1) return {feature.name, numbers_of<float>(values)};
  std::vector<std::vector<float>> lists;
  for (const auto& value : values) lists.emplace_back(value.begin(), value.end());
  return {feature.name, std::move(lists)};
}

/// A row group for each episode, as LeRobot reads one at a time.
std::string format_data(const Content& content) {
  std::vector<ParquetColumns> groups;
  for (const std::vector<Row>& rows : content.rows) {
    ParquetColumns& columns = groups.emplace_back();
    for (const Feature& feature : features()) columns.push_back(column_of(feature, rows));
  }
  return format_parquet(groups);
}

/// pandas takes the texts as the table's index, by which LeRobot looks a task up.
std::string format_tasks(const Content& content) {
  std::vector<std::int64_t> indices;
  for (std::size_t i = 0; i < content.tasks.size(); ++i)
    indices.push_back(static_cast<std::int64_t>(i));
  const auto described = [](const char* name, const char* pandas, const char* numpy) {
    return Json{{"name", name},
                {"field_name", name},
                {"pandas_type", pandas},
                {"numpy_type", numpy},
                {"metadata", nullptr}};
  };
  const Json pandas{
      {"index_columns", {"task"}},
      {"column_indexes", Json::array()},
      {"columns",
       {described("task_index", "int64", "int64"), described("task", "unicode", "object")}},
      {"creator", {{"library", "pcavr"}, {"version", PCAVR_VERSION}}},
      {"pandas_version", "1.5.3"}};
  const std::vector<ParquetColumns> table{{{"task_index", indices}, {"task", content.tasks}}};
  return format_parquet(table, {{"pandas", json_text(pandas)}});
}

/// The table of episodes, column by column.
class EpisodeTable {
 public:
  explicit EpisodeTable(const Content& content) : content_(content) {
    whole("episode_index", [](const std::vector<Row>& rows) { return rows.front().episode; });
    std::vector<std::vector<std::string>> tasks;
    for (const auto& rows : content.rows) tasks.push_back({content.tasks[rows.front().task]});
    columns_.push_back({"tasks", std::move(tasks)});
    whole("length", [](const std::vector<Row>& rows) { return rows.size(); });
    zeros("data");
    whole("dataset_from_index", [](const std::vector<Row>& rows) { return rows.front().index; });
    whole("dataset_to_index", [](const std::vector<Row>& rows) { return rows.back().index + 1; });
    if (content.video) {
      const std::string key = std::string("videos/") + kImageKey;
      zeros(key);
      seconds(key + "/from_timestamp", 0);
      seconds(key + "/to_timestamp", 1);
    }
    zeros("meta/episodes");
    for (const Feature& feature : features()) stats(feature);
  }

  [[nodiscard]] std::string format() const { return format_parquet(std::array{columns_}); }

 private:
  template <typename Get>
  void whole(const std::string& name, const Get& get) {
    std::vector<std::int64_t> values;
    for (const auto& rows : content_.rows) values.push_back(static_cast<std::int64_t>(get(rows)));
    columns_.push_back({name, std::move(values)});
  }
  /// In which file an episode is: there is one.
  void zeros(const std::string& name) {
    for (const char* index : {"/chunk_index", "/file_index"})
      whole(name + index, [](const std::vector<Row>&) { return 0; });
  }
  /// In the video, whose pictures are all frames in their order; `after` frames after one.
  void seconds(const std::string& name, std::size_t after) {
    std::vector<double> values;
    for (const auto& rows : content_.rows) {
      const Row& row = after == 0 ? rows.front() : rows.back();
      values.push_back(static_cast<double>(row.index + after) / content_.rate);
    }
    columns_.push_back({name, std::move(values)});
  }
  void stats(const Feature& feature) {
    std::map<std::string, std::vector<std::vector<double>>> by_name;
    std::vector<std::string> names;
    for (const auto& rows : content_.rows) {
      for (auto& [name, values] : column_stats(values_of(feature, rows), width_of(feature))) {
        if (by_name[name].empty()) names.push_back(name);
        by_name[name].push_back(std::move(values));
      }
    }
    for (const std::string& name : names)
      columns_.push_back({"stats/" + feature.name + '/' + name, std::move(by_name[name])});
  }

  const Content& content_;
  ParquetColumns columns_;
};

Json video_stats(const LerobotVideo& video) {
  Json stats;
  const auto add = [&](const char* name, double LerobotVideo::Channel::*value) {
    for (const LerobotVideo::Channel& channel : video.channels)
      stats[name].push_back({{channel.*value}});
  };
  add("min", &LerobotVideo::Channel::min);
  add("max", &LerobotVideo::Channel::max);
  add("mean", &LerobotVideo::Channel::mean);
  add("std", &LerobotVideo::Channel::std);
  stats["count"] = {video.counted};
  return stats;
}

Json stats_json(const Content& content) {
  Json json;
  std::vector<Row> all;
  for (const auto& rows : content.rows) all.insert(all.end(), rows.begin(), rows.end());
  for (const Feature& feature : features()) {
    for (const auto& [name, values] : column_stats(values_of(feature, all), width_of(feature)))
      json[feature.name][name] = values;
  }
  if (content.video) json[kImageKey] = video_stats(*content.video);
  return json;
}

Json feature_json(const Feature& feature) {
  constexpr std::array kTypes{"float32", "int64", "bool"};
  Json json{{"dtype", kTypes.at(static_cast<std::size_t>(feature.kind))},
            {"shape", {width_of(feature)}}};
  json["names"] = feature.components.empty() ? Json(nullptr) : Json(feature.components);
  if (feature.name == "phase") json["values"] = kLerobotPhases;
  return json;
}

Json features_json(const Content& content) {
  Json json;
  if (content.video) {
    const LerobotVideo& video = *content.video;
    json[kImageKey] = {{"dtype", "video"},
                       {"shape", {video.height, video.width, 3}},
                       {"names", {"height", "width", "channels"}},
                       {"info",
                        {{"video.height", video.height},
                         {"video.width", video.width},
                         {"video.codec", video.codec},
                         {"video.pix_fmt", "yuv420p"},
                         {"video.is_depth_map", false},
                         {"video.fps", content.rate},
                         {"video.channels", 3},
                         {"has_audio", false}}}};
  }
  for (const Feature& feature : features()) json[feature.name] = feature_json(feature);
  return json;
}

Json info_json(const Content& content, const Manifest& manifest) {
  Json json{{"codebase_version", "v3.0"}};
  json["robot_type"] = manifest.robot ? Json(manifest.robot->urdf.stem().string()) : Json(nullptr);
  json["total_episodes"] = content.rows.size();
  json["total_frames"] = content.rows.back().back().index + 1;
  json["total_tasks"] = content.tasks.size();
  json["chunks_size"] = kFilesPerChunk;
  json["data_files_size_in_mb"] = kDataFileSize;
  json["video_files_size_in_mb"] = kVideoFileSize;
  json["fps"] = content.rate;
  json["splits"] = {{"train", fmt::format("0:{}", content.rows.size())}};
  json["data_path"] = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet";
  json["video_path"] =
      content.video ? Json("videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4")
                    : Json(nullptr);
  json["features"] = features_json(content);
  return json;
}

/// Whether the episodes fit into one data set.
Expected<void> check_equal(const std::vector<LerobotEpisode>& episodes) {
  const LerobotEpisode& first = episodes.front();
  for (const LerobotEpisode& episode : episodes) {
    const std::string folder = episode.recording.folder.string();
    if (episode.rate != first.rate) {
      return Error{.message = fmt::format("has {} frames per second, and {} has {}", episode.rate,
                                          first.recording.folder.string(), first.rate),
                   .file = folder,
                   .hint = "give one rate with --fps"};
    }
    if (episode.recording.frames.empty() != first.recording.frames.empty()) {
      return Error{.message = "of the recordings, some have images and some do not",
                   .file = folder,
                   .hint = "export these and those into a data set each"};
    }
  }
  return {};
}

Expected<void> create_folder(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) return Error{.message = code.message(), .file = folder.string()};
  return {};
}

Expected<void> write_into(const fs::path& folder, const std::string& name,
                          const std::string& text) {
  const Expected<void> created = create_folder((folder / name).parent_path());
  if (!created) return created;
  return write_file(folder / name, text);
}

}  // namespace

Expected<LerobotSummary> write_lerobot_dataset(const std::vector<LerobotEpisode>& episodes,
                                               const fs::path& folder, const Observer& observer) {
  PCAVR_REQUIRE(!episodes.empty());
  if (const auto equal = check_equal(episodes); !equal) return equal.error();
  Content content = content_of(episodes);
  if (!episodes.front().recording.frames.empty()) {
    const fs::path file = folder / "videos" / kImageKey / "chunk-000/file-000.mp4";
    if (const auto created = create_folder(file.parent_path()); !created) return created.error();
    Expected<LerobotVideo> video = write_lerobot_video(episodes, file, observer);
    if (!video) return video.error();
    content.video = *std::move(video);
  }
  const Manifest& manifest = episodes.front().recording.manifest;
  const std::vector<std::pair<std::string, std::string>> files{
      {kDataFile, format_data(content)},
      {"meta/tasks.parquet", format_tasks(content)},
      {kEpisodesFile, EpisodeTable(content).format()},
      {"meta/stats.json", json_text(stats_json(content), 4) + '\n'},
      {"meta/info.json", json_text(info_json(content, manifest), 4) + '\n'}};
  for (const auto& [name, text] : files) {
    if (const auto written = write_into(folder, name, text); !written) return written.error();
  }
  return LerobotSummary{content.rows.back().back().index + 1, content.rate,
                        content.video ? content.video->codec : std::string()};
}

}  // namespace pcavr
