// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <thread>

namespace pcavr::test {

/// Asks until it is so. A driver's thread takes its time, so the limit is one for what hangs.
template <typename Is>
bool eventually(const Is& is) {
  using namespace std::chrono_literals;
  for (int i = 0; i < 10'000; ++i) {
    if (is()) return true;
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

}  // namespace pcavr::test
