// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot/urdfdom_model.hpp"

#include <exception>
#include <mutex>

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

namespace pcavr::robot {
namespace {

/// Keeps the errors of the log as long as it lives; libraries do not print.
class LogCapture : public console_bridge::OutputHandler {
 public:
  LogCapture() : previous_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  LogCapture(const LogCapture&) = delete;
  LogCapture& operator=(const LogCapture&) = delete;
  ~LogCapture() override { console_bridge::useOutputHandler(previous_); }

  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/,
           int /*line*/) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) errors.push_back(text);
  }

  std::vector<std::string> errors;

 private:
  console_bridge::OutputHandler* previous_;
};

}  // namespace

UrdfdomResult parse_by_urdfdom(const std::string& text) {
  static std::mutex mutex;
  const std::lock_guard<std::mutex> lock(mutex);
  LogCapture log;
  UrdfdomResult result;
  try {
    result.model = urdf::parseURDF(text);
  } catch (const std::exception& exception) {
    log.errors.emplace_back(exception.what());
  }
  result.errors = std::move(log.errors);
  return result;
}

}  // namespace pcavr::robot
