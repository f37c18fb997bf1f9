// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace pcavr {

/// The names in the texts of an output: relative paths of files, and names of objects.
class NamedEntries {
 public:
  void add(std::string_view text);
  [[nodiscard]] bool contains(std::string_view name) const { return names_.contains(name); }

 private:
  std::set<std::string, std::less<>> names_;
};

/// Whether `path`, as "objects/box.glb", is one that `pattern` describes: in each of its components
/// `*` is a name that the texts contain, and `#` a number.
[[nodiscard]] bool matches(std::string_view path, std::string_view pattern,
                           const NamedEntries& named);

/// The relative path of a file in the sub-folders of `folder`, to any depth, that the texts in it
/// (`texts`, missing ones are ignored) do not name and no pattern describes: someone else's. Also
/// one that can't be examined. nullopt: there is none.
[[nodiscard]] std::optional<std::string> find_foreign_file(
    const std::filesystem::path& folder, const std::vector<std::string_view>& texts,
    const std::vector<std::string_view>& patterns);

}  // namespace pcavr
