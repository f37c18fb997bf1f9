// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// A recording, sampled at equal times.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "pcavr/base/core/median.hpp"
#include "pcavr/pipeline/lerobot_dataset.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/stream_clocks.hpp"

namespace pcavr {
namespace {

constexpr double kCriticalShare = 0.9;  ///< of the limiting static friction, as in truth/phase.csv
constexpr std::size_t kMinFrames = 2;
enum PhaseIndex : std::int64_t { kFree, kStatic, kCritical, kSliding };

int rate_of(const Recording& recording, const LerobotOptions& options) {
  if (options.rate) return *options.rate;
  if (recording.frames.size() < 2) return kDefaultLerobotRate;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < recording.frames.size(); ++i) {
    intervals.push_back(
        to_seconds(recording.frames[i].color_stamp - recording.frames[i - 1].color_stamp));
  }
  return std::max(1, static_cast<int>(std::lround(1.0 / median(std::move(intervals)))));
}

/// [s] from the recording's start, on the tool's clock.
struct TimeRange {
  double begin = 0.0;
  double end = 0.0;
};

/// What the stamps of force and images are ahead of the tool's clock by [s].
struct StreamShifts {
  double force = 0.0;
  double images = 0.0;
};

/// From when tool, force and images have begun until one of them ends.
TimeRange common_time(const Recording& recording, const StreamShifts& shifts) {
  const Stamp zero = start_of(recording);
  const auto seconds = [&](Stamp stamp) { return to_seconds(stamp - zero); };
  TimeRange range{seconds(recording.tool.poses().front().stamp),
                  seconds(recording.tool.poses().back().stamp)};
  range.begin = std::max(range.begin, seconds(recording.wrench.front().stamp) - shifts.force);
  range.end = std::min(range.end, seconds(recording.wrench.back().stamp) - shifts.force);
  if (!recording.frames.empty()) {
    range.begin =
        std::max(range.begin, seconds(recording.frames.front().color_stamp) - shifts.images);
    range.end = std::min(range.end, seconds(recording.frames.back().color_stamp) - shifts.images);
  }
  return range;
}

std::array<float, 7> state_of(const Pose& T_base_tool) {
  const Eigen::Vector3f p = T_base_tool.translation().cast<float>();
  const Eigen::Quaternionf q = T_base_tool.rotation().cast<float>();
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}

/// Means of the wrench over the frames' times, which ascend.
class WrenchMeans {
 public:
  WrenchMeans(const std::vector<WrenchSample>& samples, Stamp zero, double shift)
      : samples_(samples), zero_(zero), shift_(shift) {}

  /// Over [begin, end); where there is no sample, the last one before.
  [[nodiscard]] std::array<float, 6> mean(double begin, double end) {
    while (next_ + 1 < samples_.size() && time_of(next_ + 1) <= begin) ++next_;
    Vector6d sum = Vector6d::Zero();
    std::size_t count = 0;
    for (std::size_t i = next_; i < samples_.size() && time_of(i) < end; ++i) {
      if (time_of(i) < begin) continue;
      sum += value_of(i);
      ++count;
    }
    const Vector6d mean = count == 0 ? value_of(next_) : Vector6d(sum / static_cast<double>(count));
    std::array<float, 6> result{};
    Eigen::Map<Eigen::Matrix<float, 6, 1>>(result.data()) = mean.cast<float>();
    return result;
  }

 private:
  [[nodiscard]] double time_of(std::size_t i) const {
    return to_seconds(samples_[i].stamp - zero_) - shift_;
  }
  [[nodiscard]] Vector6d value_of(std::size_t i) const {
    Vector6d value;
    value << samples_[i].force, samples_[i].torque;
    return value;
  }

  const std::vector<WrenchSample>& samples_;
  Stamp zero_;
  double shift_;
  std::size_t next_ = 0;
};

/// Mean force of a contact along its direction over [begin, end) [N].
double mean_force(const Contact& episode, double begin, double end) {
  double sum = 0.0;
  std::size_t count = 0;
  auto i = std::lower_bound(episode.t.begin(), episode.t.end(), begin) - episode.t.begin();
  for (; i < std::ssize(episode.t) && episode.t[static_cast<std::size_t>(i)] < end; ++i) {
    sum += episode.force[static_cast<std::size_t>(i)];
    ++count;
  }
  return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

/// The contacts with objects, in order of time, and what is known of these.
class Contacts {
 public:
  Contacts(const IdentificationInput& input, const Identification& found,
           const ParameterTable& parameters)
      : input_(input), parameters_(parameters) {
    for (const Contact& contact : found.contacts) {
      if (contact.object) contacts_.push_back(&contact);
    }
  }

  /// Phase, contact and friction over [begin, end), in frames whose times ascend.
  void describe(double begin, double end, LerobotFrame& frame) {
    const double t = 0.5 * (begin + end);
    while (next_ + 1 < contacts_.size() && contacts_[next_ + 1]->begin <= t) ++next_;
    frame.mu = frame.mu_std = std::numeric_limits<float>::quiet_NaN();
    if (contacts_.empty()) return;
    const Contact& contact = *contacts_[next_];
    const ObjectParameters known = known_of(contact);
    if (const auto& mu = known.sliding_friction_coefficient) {
      frame.mu = static_cast<float>(mu->value);
      if (mu->std) frame.mu_std = static_cast<float>(*mu->std);
    }
    frame.contact = contact.begin <= t && t < contact.end;
    if (frame.contact) frame.phase = phase_of(contact, known, begin, end);
  }

  /// "push NAME and NAME".
  [[nodiscard]] std::string task() const {
    std::set<std::string> names;
    for (const Contact* contact : contacts_) names.insert(input_.objects[*contact->object].name);
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "push " : " and ") + name;
    return text.empty() ? "move the tool" : text;
  }

 private:
  [[nodiscard]] ObjectParameters known_of(const Contact& contact) const {
    const auto found = parameters_.find(input_.objects[*contact.object].name);
    return found == parameters_.end() ? ObjectParameters() : found->second;
  }
  static PhaseIndex phase_of(const Contact& episode, const ObjectParameters& known, double begin,
                             double end) {
    const double t = 0.5 * (begin + end);
    for (const SlideInterval& slide : episode.slides) {
      if (slide.begin <= t && t < slide.end) return kSliding;
    }
    const auto& limit = known.limiting_static_friction;
    const bool is_loaded = limit && episode.kind != ContactKind::press &&
                           mean_force(episode, begin, end) >= kCriticalShare * limit->value;
    return is_loaded ? kCritical : kStatic;
  }

  const IdentificationInput& input_;
  const ParameterTable& parameters_;
  std::vector<const Contact*> contacts_;
  std::size_t next_ = 0;
};

std::size_t nearest_image(const std::vector<FrameFiles>& frames, Stamp stamp) {
  const auto after =
      std::ranges::lower_bound(frames, stamp, std::ranges::less(), &FrameFiles::color_stamp);
  const auto index = static_cast<std::size_t>(after - frames.begin());
  if (index == 0) return 0;
  if (index == frames.size()) return index - 1;
  const bool is_before = stamp - frames[index - 1].color_stamp <= after->color_stamp - stamp;
  return is_before ? index - 1 : index;
}

Error too_short(const Recording& recording, const TimeRange& range) {
  return {.message = "tool, force and images have " +
                     std::to_string(std::max(0.0, range.end - range.begin)) +
                     " s in common, less than two frames",
          .file = recording.folder.string(),
          .hint = "give a higher --fps, or a longer recording"};
}

Expected<LerobotEpisode> sampled(const Recording& recording, const StreamShifts& shifts,
                                 Contacts contacts, const LerobotOptions& options) {
  const Stamp zero = start_of(recording);
  const TimeRange range = common_time(recording, shifts);
  LerobotEpisode episode;
  episode.rate = rate_of(recording, options);
  const double interval = 1.0 / episode.rate;
  WrenchMeans wrench(recording.wrench, zero, shifts.force);
  for (std::size_t k = 0;; ++k) {
    const double t = range.begin + static_cast<double>(k) * interval;
    if (t > range.end) break;
    const Stamp stamp = zero + duration_from_seconds(t);
    // Across a gap of any length: an episode has no missing frames.
    const auto pose = recording.tool.at(stamp, Duration::max());
    if (!pose) break;
    LerobotFrame frame{.state = state_of(*pose)};
    frame.action = frame.state;
    if (k > 0) episode.frames.back().action = frame.state;
    frame.wrench = wrench.mean(t - 0.5 * interval, t + 0.5 * interval);
    contacts.describe(t - 0.5 * interval, t + 0.5 * interval, frame);
    if (!recording.frames.empty())
      frame.image = nearest_image(recording.frames, stamp + duration_from_seconds(shifts.images));
    episode.frames.push_back(frame);
  }
  if (episode.frames.size() < kMinFrames) return too_short(recording, range);
  episode.task = options.task.empty() ? contacts.task() : options.task;
  episode.recording.folder = recording.folder;
  episode.recording.manifest = recording.manifest;
  episode.recording.has_depth = recording.has_depth;
  episode.recording.frames = recording.frames;
  return episode;
}

}  // namespace

Expected<LerobotEpisode> make_lerobot_episode(const Recording& recording,
                                              const IdentificationSources& sources,
                                              const ParameterTable& known,
                                              const IdentificationOptions& identification,
                                              const LerobotOptions& options,
                                              const Observer& observer) {
  const Expected<IdentificationInput> input = identification_input(recording, sources, observer);
  if (!input) return input.error();
  const auto is_known = [&](const IdentifiableObject& object) {
    return known.contains(object.name);
  };
  if (!known.empty() && std::ranges::none_of(input->objects, is_known)) {
    return Error{.message = "the parameters, of " + known.begin()->first +
                            (known.size() > 1 ? " and others" : "") +
                            ", are of none of its objects",
                 .file = recording.folder.string(),
                 .hint = "give the parameter file of these objects"};
  }
  const Expected<Identification> found =
      identify(*input, IdentificationGoal::friction, identification);
  if (!found) {
    Error error = found.error();
    if (!error.file.empty()) error.file = (recording.folder / error.file).string();
    return error;
  }
  for (const std::string& warning : found->warnings)
    observer.on_warning(recording.folder.string() + ": " + warning);
  ParameterTable parameters = found->parameters();
  for (const auto& [name, values] : known) parameters[name] = values;
  // Images in which the bodies are tracked have the tracking's clock.
  const bool is_tracked_in_images = !tracked_folder_of(
      recording, sources.tracked.empty() ? std::nullopt : std::optional(sources.tracked));
  const StreamShifts shifts{found->inputs.force_shift(),
                            is_tracked_in_images ? found->inputs.camera_shift() : 0.0};
  return sampled(recording, shifts, Contacts(*input, *found, parameters), options);
}

}  // namespace pcavr
