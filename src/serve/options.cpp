// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/serve/content.hpp"
#include "pcavr/serve/live_world.hpp"
#include "pcavr/serve/scene_world.hpp"
#include "pcavr/serve/server.hpp"

namespace pcavr {
namespace {

constexpr auto kSceneWorldFields = std::to_array<OptionField<SceneWorldOptions>>({
    {"tool_radius", &SceneWorldOptions::tool_radius, 0.01, 1e-4, 0.5, "m",
     "radius of the tool's tip where the replay has none",
     "lower: a scan's noise is felt; higher: the tool does not fit between objects"},
    // Free of contact, and so near that the first drag of the ring pushes.
    {"start_clearance", &SceneWorldOptions::start_clearance, 0.04, 1e-3, 1.0, "m",
     "distance of the tool from the object beside which it starts",
     "lower: the ring lies on the object; higher: a drag is long before it pushes"},
    // The height is free of contact, and in view.
    {"start_height", &SceneWorldOptions::start_height, 0.1, 0.0, 10.0, "m",
     "height of the tool above the movable objects, where there is no free place beside one",
     "lower: it may start in contact; higher: it starts out of reach"},
    // Measured: the proxy search runs at 1 kHz with this many.
    {"max_triangles", &SceneWorldOptions::max_triangles, 1'000'000, 1000, 100'000'000, "",
     "triangles of the mesh that is used for contact",
     "lower: a coarser level of detail is felt; higher: cycles are late on slow machines"},
    // The force is above any push on a table.
    {"max_shown_force", &SceneWorldOptions::max_shown_force, 100.0, 0.1, 1000.0, "N",
     "limit of the displayed force where no device renders it",
     "lower: strong pushes look alike; higher: a jump of the hand hits bodies hard"},
    {"min_full_scale_force", &SceneWorldOptions::min_full_scale_force, 5.0, 0.1, 1000.0, "N",
     "least force of the strongest continuous vibration",
     "lower: light objects vibrate fully; higher: weak contacts do not vibrate"},
});
static_assert(are_valid_fields(kSceneWorldFields));

constexpr auto kVibrationFields = std::to_array<OptionField<VibrationOptions>>({
    // A page polls 60 to 90 times a second and would miss a pulse shorter than two of its frames.
    {"pulse_duration", &VibrationOptions::pulse_duration, 0.03, 0.0, 1.0, "s",
     "duration of a pulse at full amplitude", "lower: a page misses pulses; higher: pulses merge"},
    {"decay_time", &VibrationOptions::decay_time, 0.02, 1e-3, 1.0, "s",
     "time constant of a pulse's exponential decay",
     "lower: pulses end as clicks; higher: they hide the continuous vibration"},
    // Half of the range, so that a pulse stands out.
    {"max_vibration", &VibrationOptions::max_vibration, 0.5, 0.0, 1.0, "",
     "amplitude of the strongest continuous vibration",
     "lower: forces are not felt; higher: pulses do not stand out"},
    // A tip that chatters on a noisy scan loses contact for some cycles.
    {"min_time_without_contact", &VibrationOptions::min_time_without_contact, 0.05, 0.0, 10.0, "s",
     "time without contact after which a contact gives a pulse again",
     "lower: a noisy scan pulses all the time; higher: tapping gives no pulses"},
});
static_assert(are_valid_fields(kVibrationFields));

constexpr auto kHandToolFields = std::to_array<OptionField<HandToolOptions>>({
    {"length", &HandToolOptions::length, 0.0, 0.0, 2.0, "m",
     "from the hand's grip to the tool's tip",
     "lower: no torque is felt; higher: small forces saturate the device's torque"},
    {"mass", &HandToolOptions::mass, 0.0, 0.0, 20.0, "kg",
     "mass of the tool, whose weight the hand feels",
     "lower: the tool is weightless; higher: less of the device's force is left for contacts"},
    {"centre_share", &HandToolOptions::centre_share, 0.5, 0.0, 1.0, "",
     "from the grip to the tool's centre of mass, over its length",
     "lower: the tool is balanced in the hand; higher: it pulls the tip down"},
});
static_assert(are_valid_fields(kHandToolFields));

constexpr auto kLiveWorldFields = std::to_array<OptionField<LiveWorldOptions>>({
    {"cycle", &LiveWorldOptions::cycle, 0.001, 1e-4, 0.1, "s", "period of the world's thread",
     "lower: cycles are late; higher: stiff contacts are unstable to render"},
    // The priority is above ordinary programs, below the kernel's interrupt threads (50 and above).
    {"thread_priority", &LiveWorldOptions::thread_priority, 20, 1, 99, "",
     "real-time priority (SCHED_FIFO) of the world's thread",
     "lower: other real-time programs delay it; higher: it delays the kernel's threads"},
    // The device samples of a longer one are out of date.
    {"time_scale", &LiveWorldOptions::time_scale, 1.0, 0.1, 1.0, "", "simulated over real time",
     "lower: slow motion, weaker forces; higher: real time"},
    {"max_backlog", &LiveWorldOptions::max_backlog, 20, 0, 10'000, "cycles",
     "late cycles that are still run; a longer backlog is skipped",
     "lower: simulation time stays behind the clock; higher: the world jumps after a stall"},
});
static_assert(are_valid_fields(kLiveWorldFields));

constexpr auto kServerFields = std::to_array<OptionField<ServerOptions>>({
    // Frame rates of headsets.
    {"rate", &ServerOptions::rate, 90.0, 60.0, 90.0, "Hz", "states sent to each page",
     "lower: motion is coarse and late; higher: more network traffic"},
    {"max_pages", &ServerOptions::max_pages, 32, 1, 10'000, "", "pages at the same time",
     "lower: viewers are rejected; higher: states for all of them exceed the network"},
    {"max_connections", &ServerOptions::max_connections, 256, 1, 60'000, "",
     "connections of all kinds at the same time",
     "lower: pages cannot load their files; higher: the process runs out of files"},
    // Four viewers behind one address each still have their files and their states.
    {"max_address_share", &ServerOptions::max_address_share, 0.25, 0.01, 1.0, "",
     "share of these pages and connections that one address may have",
     "lower: viewers behind one router are rejected; higher: one address locks out the others"},
    {"max_write_time", &ServerOptions::max_write_time, 5.0, 0.01, 600.0, "s",
     "write timeout of a message to a page",
     "lower: stutters of the network disconnect pages; higher: pages that do not read stay"},
    {"read_timeout", &ServerOptions::read_timeout, 20.0, 0.1, 600.0, "s",
     "timeout of a request, and of a TLS handshake",
     "lower: slow clients are disconnected; higher: idle connections take up places"},
    {"response_timeout", &ServerOptions::response_timeout, 30.0, 0.1, 3600.0, "s",
     "timeout of a response, in addition to its transfer time",
     "lower: slow clients are disconnected; higher: stalled ones take up places"},
    {"min_download_rate", &ServerOptions::min_download_rate, 65536.0, 1.0, 1e9, "bytes/s",
     "transfer rate below which a download times out",
     "lower: stalled downloads take up places; higher: slow networks cannot load a scene"},
    {"handshake_timeout", &ServerOptions::handshake_timeout, 10.0, 0.1, 600.0, "s",
     "timeout of a WebSocket's handshake",
     "lower: slow clients are disconnected; higher: stalled ones take up places"},
    // A page sends it with its first packet.
    {"hello_timeout", &ServerOptions::hello_timeout, 2.0, 0.1, 60.0, "s",
     "time after the handshake in which a page must send a valid hello",
     "lower: pages on slow networks are disconnected; higher: silent clients take up places"},
    {"idle_timeout", &ServerOptions::idle_timeout, 20.0, 0.1, 3600.0, "s",
     "time after which a page that does not answer is disconnected",
     "lower: sleeping pages are disconnected; higher: lost pages take up places"},
    {"tool_timeout", &ServerOptions::tool_timeout, 0.5, 0.02, 60.0, "s",
     "time without a sample after which a page with a closed clutch loses the tool (watchdog)",
     "lower: stutters of the network release it; higher: a lost page blocks it for others"},
    // A pause to look and think, and not so long that the next one gives up.
    {"tool_idle_time", &ServerOptions::tool_idle_time, 10.0, 0.0, 3600.0, "s",
     "time with an open clutch after which the tool goes to another page that requests it",
     "lower: a short pause loses the tool; higher: a forgotten page blocks it for others"},
    {"shutdown_timeout", &ServerOptions::shutdown_timeout, 0.2, 0.0, 60.0, "s",
     "time for the closing handshakes with the pages",
     "lower: pages see an error instead of an end; higher: stopping takes long"},
    {"max_queued_messages", &ServerOptions::max_queued_messages, 16, 1, 10'000, "",
     "messages queued for a page while one is written; of more, it counts as not reading",
     "lower: slow pages are disconnected; higher: memory for pages that do not read"},
    // A page sends some 70 to 90 samples a second.
    {"max_messages_per_tick", &ServerOptions::max_messages_per_tick, 20, 1, 10'000, "",
     "messages read from a page between two states (rate limit)",
     "lower: samples are delayed; higher: one page can occupy the network thread"},
    // Some 50 ms of states.
    {"send_buffer", &ServerOptions::send_buffer, 8192, 2048, 100'000'000, "bytes",
     "send buffer of a page's socket",
     "lower: fewer states on networks with latency; higher: late states on slow networks"},
});
static_assert(are_valid_fields(kServerFields));

constexpr auto kContentFields = std::to_array<OptionField<ContentOptions>>({
    // A headset renders this many at 72 Hz.
    {"max_points", &ContentOptions::max_points, 500'000, 1000, 100'000'000, "",
     "points of the cloud that a page gets",
     "lower: the cloud is sparse; higher: headsets drop frames, and loading takes long"},
    {"max_cells", &ContentOptions::max_cells, 4'000'000, 1000, 100'000'000, "",
     "occupied cells that a page can draw",
     "lower: fine occupancy maps cannot be served; higher: the page runs out of memory"},
    // The step is below a depth camera's resolution: finer steps would store its noise.
    {"min_point_step", &ContentOptions::min_point_step, 0.00025, 1e-6, 0.1, "m",
     "quantization of the cloud's points",
     "lower: noise is stored, and compresses badly; higher: visible steps"},
    // A million triangles take about a second.
    {"packing_timeout", &ContentOptions::packing_timeout, 30.0, 0.1, 3600.0, "s",
     "time for the compression of one mesh by gltfpack",
     "lower: large meshes are served uncompressed; higher: a stalled gltfpack delays the start"},
    // Enough for scrubbing around one moment of a replay; at 640 x 480 some 5 MB.
    {"max_cached_frames", &ContentOptions::max_cached_frames, 32, 1, 100'000, "",
     "augmented images that are kept in memory",
     "lower: scrubbing renders them again; higher: memory"},
});
static_assert(are_valid_fields(kContentFields));

}  // namespace

SceneWorldOptions::SceneWorldOptions() { set_defaults(*this, kSceneWorldFields); }
OptionSection section_of(SceneWorldOptions& options) {
  return make_section("serve.scene", options, kSceneWorldFields);
}

VibrationOptions::VibrationOptions() { set_defaults(*this, kVibrationFields); }
OptionSection section_of(VibrationOptions& options) {
  return make_section("serve.vibration", options, kVibrationFields);
}

HandToolOptions::HandToolOptions() { set_defaults(*this, kHandToolFields); }
double HandToolOptions::weight() const { return mass * kStandardGravity; }
OptionSection section_of(HandToolOptions& options) {
  return make_section("serve.tool", options, kHandToolFields);
}

LiveWorldOptions::LiveWorldOptions()
    : p_base_tool_start(Eigen::Vector3d::Zero()),
      full_scale_force(SceneWorldOptions().min_full_scale_force) {
  set_defaults(*this, kLiveWorldFields);
}
OptionSection section_of(LiveWorldOptions& options) {
  return make_section("serve.world", options, kLiveWorldFields);
}

ServerOptions::ServerOptions()
    : host("127.0.0.1"),
      port(8080),
      is_replay(false),
      ends_on_signals(false),
      tool_radius(SceneWorldOptions().tool_radius) {
  set_defaults(*this, kServerFields);
}
OptionSection section_of(ServerOptions& options) {
  return make_section("serve.network", options, kServerFields);
}

ContentOptions::ContentOptions() { set_defaults(*this, kContentFields); }
OptionSection section_of(ContentOptions& options) {
  return make_section("serve.content", options, kContentFields);
}

}  // namespace pcavr
