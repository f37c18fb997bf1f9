// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/cloud/silence_pcl.hpp"

#include <pcl/console/print.h>

namespace pcavr {

SilencePcl::SilencePcl() : previous_level_(pcl::console::getVerbosityLevel()) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
}

SilencePcl::~SilencePcl() {
  pcl::console::setVerbosityLevel(static_cast<pcl::console::VERBOSITY_LEVEL>(previous_level_));
}

}  // namespace pcavr
