// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>

#include "fuzz/targets.hpp"

// PCAVR_FUZZ_TARGET names one function of targets.hpp; one fuzzer for each.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pcavr::fuzz::PCAVR_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
