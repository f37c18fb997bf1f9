// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <thread>

namespace pcavr::test {

/// Polls until the condition is true, with a timeout that is far longer than a driver's latency.
template <typename Condition>
bool eventually(const Condition& condition) {
  using namespace std::chrono_literals;
  for (int i = 0; i < 10'000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

}  // namespace pcavr::test
