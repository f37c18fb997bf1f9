// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// A plugin that throws an exception, which is not allowed.
#include <stdexcept>

#include "pcavr/teleoperation/devices/device_plugin.h"

namespace {

int some_device = 0;

void* open(const char*, char*, size_t) { return &some_device; }
void close(void*) {}
int exchange(void*, double, double, const pcavr_device_feedback*, pcavr_device_sample*) {
  throw std::runtime_error("from a plugin");
}

constexpr pcavr_device_plugin kPlugin = {
    sizeof(pcavr_device_plugin), PCAVR_DEVICE_PLUGIN_ABI, nullptr, open, close, exchange};

}  // namespace

const pcavr_device_plugin* pcavr_get_device_plugin(void) { return &kPlugin; }
