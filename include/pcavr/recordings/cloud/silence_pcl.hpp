// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pcavr {

/// Suppresses PCL's message that it found no model while this object lives, where that is an
/// expected result.
class SilencePcl {
 public:
  SilencePcl();
  ~SilencePcl();
  SilencePcl(const SilencePcl&) = delete;
  SilencePcl& operator=(const SilencePcl&) = delete;

 private:
  int previous_level_;
};

}  // namespace pcavr
