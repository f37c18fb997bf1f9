// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace pcavr::model {

/// A fault in the contents of a mesh file. Thrown by the readers of one type, caught by
/// import_mesh, which makes it an Error of the file.
class MeshFault : public std::runtime_error {
 public:
  /// `line`: 1-based; 0 in a file without lines.
  explicit MeshFault(const std::string& reason, int line = 0, std::string hint = {})
      : std::runtime_error(reason), line_(line), hint_(std::move(hint)) {}

  [[nodiscard]] int line() const { return line_; }
  /// The remedy; empty where exporting the mesh again is enough.
  [[nodiscard]] const std::string& hint() const { return hint_; }

 private:
  int line_;
  std::string hint_;
};

}  // namespace pcavr::model
