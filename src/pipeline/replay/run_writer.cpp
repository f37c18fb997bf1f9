// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "run_writer.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>

#include <fmt/core.h>

#include "pcavr/recordings/recording/trajectory_rows.hpp"

#include "pipeline/build/follow_objects.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kBufferSize = std::size_t{64} << 10U;  // bytes

Error cannot_write(const fs::path& file) {
  return {.message = std::string("can't be written: ") +
                     (errno != 0 ? std::strerror(errno) : "unknown reason"),
          .file = file.string(),
          .hint = "choose a folder that you may write to, on a disk with space left"};
}

fs::path folder_of(const fs::path& run, const std::string& object) {
  return run / "objects" / object;
}

/// Closes several files; returns the first error.
template <typename Files>
Expected<void> close_all(Files& files) {
  for (StreamedFile& file : files) {
    const Expected<void> closed = file.close();
    if (!closed) return closed;
  }
  return {};
}

}  // namespace

std::vector<std::string> object_names(const Replay& replay) {
  std::vector<std::string> names;
  for (const ReplayedObject& object : replay.objects) names.push_back(object.name);
  return names;
}

Expected<void> StreamedFile::open(const fs::path& file, std::string_view header) {
  std::error_code code;
  fs::create_directories(file.parent_path(), code);
  if (code) {
    return Error{.message = "can't be created: " + code.message(),
                 .file = file.parent_path().string()};
  }
  errno = 0;
  file_ = file;
  stream_.open(file, std::ios::binary | std::ios::trunc);
  if (!stream_) return cannot_write(file_);
  text_ = header;
  return {};
}

Expected<void> StreamedFile::write() {
  errno = 0;
  stream_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
  text_.clear();
  if (!stream_) return cannot_write(file_);
  return {};
}

Expected<void> StreamedFile::write_if_full() {
  if (text_.size() < kBufferSize) return {};
  return write();
}

Expected<void> StreamedFile::close() {
  if (!stream_.is_open()) return {};
  const Expected<void> written = write();
  if (!written) return written;
  errno = 0;
  stream_.close();
  if (!stream_) return cannot_write(file_);
  return {};
}

Expected<void> TrackingWriter::open(const fs::path& folder, const std::vector<std::string>& names) {
  tracked_.resize(names.size());
  tracking_.resize(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const fs::path object_folder = folder_of(folder, names[i]);
    const Expected<void> tracked =
        tracked_[i].open(object_folder / "tracked.txt", trajectory_header());
    if (!tracked) return tracked;
    const Expected<void> tracking =
        tracking_[i].open(object_folder / "tracking.csv",
                          "t,evidence,tags,position_sigma,rotation_sigma,surface_rms,at_rest\n");
    if (!tracking) return tracking;
  }
  return {};
}

Expected<void> TrackingWriter::add(std::size_t object, const ObjectObservation& seen) {
  const double position = std::sqrt(seen.covariance.topLeftCorner<3, 3>().trace());
  const double rotation = std::sqrt(seen.covariance.bottomRightCorner<3, 3>().trace());
  tracking_[object].text() +=
      fmt::format("{},{},{},{:.6f},{:.6f},{:.6f},{:d}\n", format_stamp(seen.stamp),
                  evidence_name(seen.evidence), seen.tags_used, position, rotation,
                  seen.surface_rms, seen.is_at_rest);
  const Expected<void> written = tracking_[object].write_if_full();
  if (!written || seen.evidence == ObjectEvidence::none) return written;
  append_trajectory_row(tracked_[object].text(), seen.stamp, seen.T_base_object);
  return tracked_[object].write_if_full();
}

Expected<void> TrackingWriter::close() {
  const Expected<void> closed = close_all(tracked_);
  if (!closed) return closed;
  return close_all(tracking_);
}

Expected<void> TeleopWriter::open(const fs::path& folder, const std::vector<std::string>& names) {
  names_ = names;
  predicted_.resize(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Expected<void> opened =
        predicted_[i].open(folder_of(folder, names[i]) / "predicted.txt", trajectory_header());
    if (!opened) return opened;
  }
  const Expected<void> forces = forces_.open(folder / "force.csv", "t,object,measured,virtual\n");
  if (!forces) return forces;
  const Expected<void> parameters =
      parameters_.open(folder / "parameters.csv", "t,object,parameter,running,transmitted\n");
  if (!parameters) return parameters;
  return corrections_.open(folder / "corrections.csv", "t,object,case,what,bytes\n");
}

TeleopSink TeleopWriter::sink() {
  return {.take_shown = [this](std::size_t object,
                               const ShownPose& shown) { return add_shown(object, shown); },
          .take_force = [this](const ForceRow& row) { return add_force(row); },
          .take_correction = [this](const SentCorrection& sent) { return add_correction(sent); },
          .take_parameter = [this](const ParameterRow& row) { return add_parameter(row); }};
}

Expected<void> TeleopWriter::add_shown(std::size_t object, const ShownPose& shown) {
  append_trajectory_row(predicted_[object].text(), Stamp::from_seconds(shown.t),
                        shown.T_base_object);
  return predicted_[object].write_if_full();
}

Expected<void> TeleopWriter::add_force(const ForceRow& row) {
  forces_.text() += fmt::format("{:.6f},{},{:.4f},{:.4f}\n", row.t, names_[row.object],
                                row.measured, row.predicted);
  return forces_.write_if_full();
}

Expected<void> TeleopWriter::add_correction(const SentCorrection& sent) {
  corrections_.text() +=
      fmt::format("{:.6f},{},{},{}{},{}\n", sent.t, names_[sent.object], name_of(sent.which),
                  sent.what, sent.is_lost ? "+lost" : "", sent.bytes);
  return corrections_.write_if_full();
}

Expected<void> TeleopWriter::add_parameter(const ParameterRow& row) {
  parameters_.text() += fmt::format("{:.6f},{},{},{:.6g},{:.6g}\n", row.t, names_[row.object],
                                    row.name, row.running, row.transmitted);
  return parameters_.write_if_full();
}

Expected<void> TeleopWriter::close() {
  const Expected<void> closed = close_all(predicted_);
  if (!closed) return closed;
  const Expected<void> forces = forces_.close();
  if (!forces) return forces;
  const Expected<void> parameters = parameters_.close();
  if (!parameters) return parameters;
  return corrections_.close();
}

}  // namespace pcavr
