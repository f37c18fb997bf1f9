// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/replay_page.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/base64.hpp"
#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/output_file.hpp"
#include "pcavr/serve/live_protocol.hpp"

#include "content_text.hpp"
#include "gzip.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using SharedContent = std::shared_ptr<const Content>;

constexpr std::string_view kFilesPlace = "CARRIED_FILES";
constexpr std::string_view kOwner = "SPDX-FileCopyrightText: The pcavr authors";
constexpr char kScenePath[] = "/api/scene.json";
constexpr char kReplayPath[] = "/api/replay.json";
constexpr char kScanTexture[] = "/scene/texture.jpg";
constexpr std::size_t kMaxJson = std::size_t{1} << 28;  ///< [bytes]
constexpr std::size_t kSampledImages = 8;               ///< whose size says how many have room
constexpr double kMaxScanShare = 0.5;                   ///< of the bytes, so that images have room

/// Whether --force may replace the file: a page of pcavr says so in its second line.
bool is_own_page(const fs::path& file) {
  std::array<char, 256> start{};
  std::ifstream(file, std::ios::binary).read(start.data(), start.size());
  return std::string_view(start.data(), start.size()).find(kOwner) != std::string_view::npos;
}

OutputFileOptions page_options(bool replace) {
  return {.replace = replace, .kind = "page of pcavr", .is_replaceable = is_own_page};
}

/// The files that the page carries, by path, and their size in it.
class CarriedFiles {
 public:
  void add(const std::string& path, const Content& content) {
    const Json file = {{"type", content.media_type},
                       {"gzip", content.is_gzipped},
                       {"base64", base64(content.body)}};
    std::string text = json_text(Json(path)) + ':' + json_text(file);
    bytes_ += text.size() + 1;
    texts_.push_back(std::move(text));
  }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] std::string text() const {
    std::string text = "{";
    for (const std::string& file : texts_) text += (text.size() > 1 ? "," : "") + file;
    return text + '}';
  }

 private:
  std::vector<std::string> texts_;
  std::size_t bytes_ = 2;
};

/// [bytes] of a content in the page, nearly.
std::size_t carried_size(const Content& content) { return content.body.size() / 3 * 4 + 100; }

Expected<SharedContent> required_content(const ContentSource& source, const std::string& path) {
  Expected<SharedContent> found = source.find(path);
  if (found && !*found) return Error{.message = "is not there", .file = path};
  return found;
}

Expected<Json> read_json(const ContentSource& source, const std::string& path) {
  const Expected<SharedContent> content = required_content(source, path);
  if (!content) return content.error();
  std::optional<std::string> text = (*content)->body;
  if ((*content)->is_gzipped) text = gunzip((*content)->body, kMaxJson);
  Json json = Json::parse(text.value_or(""), nullptr, false);
  if (json.is_discarded()) return Error{.message = "can't be unpacked", .file = path};
  return json;
}

/// Collects what a page has of one scene and one replay.
class PageFill {
 public:
  PageFill(const ContentSource& scene, const ContentSource& replay, std::size_t max_bytes,
           bool skips_bad)
      : scene_(&scene), replay_(&replay), max_bytes_(max_bytes), skips_bad_(skips_bad) {}

  Expected<void> fill(ReplayPage& page) {
    Expected<Json> scene = read_json(*scene_, kScenePath);
    if (!scene) return scene.error();
    Expected<Json> replay = read_json(*replay_, kReplayPath);
    if (!replay) return replay.error();
    const Expected<void> bodies = add_bodies(*scene);
    if (!bodies) return bodies;
    const Expected<void> scan = add_scan(*scene, page);
    if (!scan) return scan;
    files_.add(kScenePath, make_content(kJsonMedia, json_text(*scene)));
    const Expected<void> rows = add_file(*replay_, "/api/replay.bin");
    if (!rows) return rows;
    const Expected<void> images = add_images(*replay, page);
    if (!images) return images;
    files_.add(kReplayPath, make_content(kJsonMedia, json_text(*replay)));
    return {};
  }

  CarriedFiles& files() { return files_; }

 private:
  Expected<void> add_file(const ContentSource& source, const std::string& path) {
    const Expected<SharedContent> content = required_content(source, path);
    if (!content) return content.error();
    files_.add(path, **content);
    return {};
  }

  /// Objects, the arm's links and the support that nothing has seen.
  Expected<void> add_bodies(Json& scene) {
    std::vector<std::string> paths;
    const auto add = [&](const Json& file) {
      if (file.is_object() && file.contains("path") && file["path"].is_string()) {
        paths.push_back(file["path"]);
      }
      if (file.is_object() && file.contains("texture") && file["texture"].is_string()) {
        paths.push_back(file["texture"]);
      }
    };
    for (const Json& object : scene["objects"]) add(object);
    if (scene["robot"].is_object()) {
      for (const Json& link : scene["robot"]["links"]) add(link);
    }
    add(scene["unseen_support"]);
    for (const std::string& path : paths) {
      const Expected<void> added = add_file(*scene_, path);
      if (!added) return added;
    }
    scene["cloud"] = nullptr;
    scene["occupancy"] = nullptr;
    return {};
  }

  /// The finest level of detail that takes at most its share, or else the coarsest.
  Expected<void> add_scan(Json& scene, ReplayPage& page) {
    Json& levels = scene["mesh"];
    if (levels.empty()) return {};
    const Expected<SharedContent> texture = scene_->find(kScanTexture);
    if (!texture) return texture.error();
    const std::size_t texture_size = *texture ? carried_size(**texture) : 0;
    const auto share = static_cast<std::size_t>(kMaxScanShare * static_cast<double>(max_bytes_));
    std::size_t level = 0;
    for (; level + 1 < levels.size(); ++level) {
      const Expected<SharedContent> mesh = required_content(*scene_, levels[level]["path"]);
      if (!mesh) return mesh.error();
      if (texture_size + carried_size(**mesh) <= share) break;
    }
    const Json kept = levels[level];
    page.triangles = kept["triangles"];
    page.levels_left_out = level;
    levels = Json::array({kept});
    if (*texture) files_.add(kScanTexture, **texture);
    return add_file(*scene_, kept["path"]);
  }

  /// As many images as have room, evenly spaced; the replay's times of images become theirs.
  Expected<void> add_images(Json& replay, ReplayPage& page) {
    const Json times = replay["frames"]["t"];
    page.images_recorded = times.size();
    replay["frames"]["t"] = Json::array();
    const std::size_t reserved = files_.bytes() + json_text(replay).size();
    if (times.empty() || reserved >= max_bytes_) return {};
    const std::size_t room = max_bytes_ - reserved;
    const Expected<std::size_t> size = largest_image(times.size());
    if (!size) return size.error();
    std::vector<SharedContent> images;
    std::vector<std::size_t> chosen;
    std::size_t total = 0;
    for (const std::size_t i : evenly(times.size(), room / *size)) {
      const Expected<SharedContent> image = required_content(*replay_, image_path(i));
      if (!image && skips_bad_) continue;
      if (!image) return image.error();
      total += carried_size(**image);
      if (total > room) break;  // later images are larger than the sampled ones
      chosen.push_back(i);
      images.push_back(*image);
    }
    for (std::size_t k = 0; k < images.size(); ++k) {
      files_.add(image_path(k), *images[k]);
      replay["frames"]["t"].push_back(times[chosen[k]]);
    }
    page.images = images.size();
    return {};
  }

  /// [bytes] in the page, of some of the images.
  Expected<std::size_t> largest_image(std::size_t count) {
    std::size_t largest = 1;
    for (const std::size_t i : evenly(count, kSampledImages)) {
      const Expected<SharedContent> image = required_content(*replay_, image_path(i));
      if (!image && skips_bad_) continue;
      if (!image) return image.error();
      largest = std::max(largest, carried_size(**image));
    }
    return largest;
  }

  static std::string image_path(std::size_t i) { return fmt::format("/api/frames/{}.jpg", i); }

  /// At most `wanted` of `count` indices, the first among them.
  static std::vector<std::size_t> evenly(std::size_t count, std::size_t wanted) {
    std::vector<std::size_t> chosen;
    const std::size_t kept = std::min(count, wanted);
    for (std::size_t k = 0; k < kept; ++k) chosen.push_back(k * count / kept);
    return chosen;
  }

  const ContentSource* scene_;
  const ContentSource* replay_;
  std::size_t max_bytes_;
  bool skips_bad_;
  CarriedFiles files_;
};

Content session_content(const std::string& name, const std::string& version) {
  return make_content(kJsonMedia, json_text(Json{{"protocol", kLiveProtocolVersion},
                                                 {"version", version},
                                                 {"paired", true},
                                                 {"mode", "replay"},
                                                 {"scene", name},
                                                 {"code_picture", false}}));
}

}  // namespace

Expected<void> check_replay_page(const fs::path& file, bool replace) {
  if (file.extension() != ".html") {
    return Error{.message = "is not the name of a page",
                 .file = file.string(),
                 .hint = "use the extension .html"};
  }
  return OutputFile::check(file, page_options(replace));
}

Expected<ReplayPage> write_replay_page(const fs::path& file, const fs::path& page,
                                       const ContentSource& scene, const ContentSource& replay,
                                       const std::string& name, const std::string& version,
                                       const ReplayPageOptions& options) {
  const Expected<void> checked = check_replay_page(file, options.replace);
  if (!checked) return checked.error();
  Expected<std::string> html = read_file(page);
  if (!html) return html.error();
  const std::size_t place = html->find(kFilesPlace);
  if (place == std::string::npos) {
    return Error{.message = "is no page for a replay in one file",
                 .file = page.string(),
                 .hint = "run scripts/build-page"};
  }
  ReplayPage written;
  PageFill fill(scene, replay, options.max_bytes - std::min(options.max_bytes, html->size()),
                options.skip_bad);
  fill.files().add("/api/session", session_content(name, version));
  const Expected<void> filled = fill.fill(written);
  if (!filled) return filled.error();
  html->replace(place, kFilesPlace.size(), fill.files().text());
  if (html->size() > options.max_bytes) {
    return Error{
        .message = fmt::format("would have {:.1f} MB without an image, more than {:.1f} MB",
                               static_cast<double>(html->size()) / 1e6,
                               static_cast<double>(options.max_bytes) / 1e6),
        .file = file.string(),
        .hint = "allow more with --html-size"};
  }
  written.bytes = html->size();
  Expected<OutputFile> output = OutputFile::create(file, page_options(options.replace));
  if (!output) return output.error();
  const Expected<void> done = output->write(*html);
  if (!done) return done.error();
  const Expected<void> committed = output->commit();
  if (!committed) return committed.error();
  return written;
}

}  // namespace pcavr
