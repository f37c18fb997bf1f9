// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/yaml_map.hpp"

#include "run_files.hpp"

namespace pcavr {
namespace {

/// [byte] Ten hours of streaming a hundred objects at 1 kHz are 1e11.
constexpr InputRange kTraffic{"traffic", 0.0, 1e12, "byte", "far beyond any run"};

std::optional<double> number_at(const YamlValue& map, const std::string& key,
                                const InputRange& range) {
  const std::optional<YamlValue> value = map.find(key);
  return value ? std::optional(value->number_in(range)) : std::nullopt;
}

std::optional<bool> boolean_at(const YamlValue& map, const std::string& key) {
  const std::optional<YamlValue> value = map.find(key);
  return value ? std::optional(value->boolean()) : std::nullopt;
}

std::vector<std::string> texts_of(const YamlValue& list) {
  std::vector<std::string> texts;
  for (const YamlValue& item : list.items()) texts.push_back(item.text());
  return texts;
}

RunSettings settings_of(const YamlValue& root) {
  RunSettings settings;
  if (const auto file = root.find("parameters")) settings.parameters = file->text();
  settings.forward_delay = number_at(root, "forward_delay", ranges::kDelay);
  settings.backward_delay = number_at(root, "backward_delay", ranges::kDelay);
  settings.jitter = number_at(root, "jitter", ranges::kJitter);
  settings.loss = number_at(root, "loss", ranges::kShare);
  settings.corrections = boolean_at(root, "corrections");
  settings.identifies = boolean_at(root, "identifies");
  if (const auto traffic = root.find("traffic")) {
    settings.correction_bytes = number_at(*traffic, "correction_bytes", kTraffic);
    settings.streaming_bytes = number_at(*traffic, "streaming_bytes", kTraffic);
  }
  if (const auto assumed = root.find("assumed")) {
    for (const auto& [object, list] : assumed->entries()) {
      settings.assumed[object] = texts_of(list);
    }
  }
  if (const auto notes = root.find("notes")) settings.notes = texts_of(*notes);
  return settings;
}

}  // namespace

Expected<RunSettings> parse_run_settings(const std::string& text, const std::string& file) {
  return parse_yaml<RunSettings>(text, file, settings_of);
}

}  // namespace pcavr
