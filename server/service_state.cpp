// SPDX-License-Identifier: BSD-3-Clause
// What the service says of itself and of its sources.
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <numbers>
#include <utility>

#include "cairn/core/wall_clock.hpp"
#include "server/service.hpp"

namespace cairn {
namespace {

std::string host() {
  char name[256] = "";
  gethostname(name, sizeof(name) - 1);
  return std::string(name) + ", process " + std::to_string(getpid());
}

SourceStatus status_of(const std::string& name, const SourceCounters& counters) {
  SourceStatus status;
  status.source = name;
  status.epoch = counters.epoch;
  status.highest_decided = counters.highest_decided;
  status.accepted = counters.accepted;
  status.refused = counters.refused;
  status.held = counters.held;
  status.last_refusal = counters.last_refusal;
  status.refused_by_code.assign(counters.refused_by_code.begin(), counters.refused_by_code.end());
  return status;
}

std::uint64_t resident_bytes() {
  std::ifstream statistics("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  statistics >> all >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

void Service::announce_opening() {
  const OpenReport& report = journal_.open_report();
  const Revision& head = head_.graph().graph_revision;
  if (report.cut_tail) {
    announce(
        Severity::kWarning, "cut_tail",
        "cut off a write that never finished; nothing acknowledged is lost: " + *report.cut_tail,
        head);
  }
  if (!report.damage) return;
  const OpenReport::Damage& damage = *report.damage;
  damage_ = damage.what + "; records up to " + std::to_string(damage.kept) +
            " are served, clients send the rest again; orders of operators that came after are "
            "lost: give them again" +
            (damage.set_aside.empty() ? "" : ", what was found is kept in " + damage.set_aside);
  announce(Severity::kError, "damage", damage_, head);
}

// One a second: strangers can make any number of them.
void Service::on_trouble(Error error) {
  std::string text = error.to_string();
  {
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (now - trouble_told_ < std::chrono::seconds(1)) {
      ++troubles_untold_;
      return;
    }
    trouble_told_ = now;
    if (const auto untold = std::exchange(troubles_untold_, 0); untold > 0)
      text += "; before it " + std::to_string(untold) + " others within a second of one";
  }
  announce(Severity::kWarning, "transport", std::move(text));
}

void Service::announce(Severity severity, std::string kind, std::string text,
                       const Revision& revision) {
  Event event;
  event.severity = severity;
  event.kind = std::move(kind);
  event.revision = revision;
  event.text = std::move(text);
  announce(std::move(event));
}

// Numbered and stamped here.
void Service::announce(Event event) {
  event.number = ++events_;
  event.time_ns = wall_clock_ns();
  if (options_.on_event) options_.on_event(event);
  transport_.publish(event);
}

// Whoever steers by the map should know before it moves.
void Service::tell_jump(const Correction& correction) {
  char how_far[64];
  std::snprintf(how_far, sizeof how_far, "%.2f m and %.1f deg", correction.jump_m,
                correction.jump_rad * 180.0 / std::numbers::pi);
  announce(Severity::kWarning, "jump",
           "the map moves under " + correction.frame.robot + ", whose newest keyframe goes by " +
               how_far,
           correction.revisions.graph);
}

void Service::publish_state() {
  const auto now = std::chrono::steady_clock::now();
  if (!state_changed_ || now - state_published_ < options_.state_every) return;
  state_changed_ = false;
  state_published_ = now;
  const JournalHead head = journal_.head();
  for (const auto& [source, epoch] : std::exchange(changed_spools_, {}))
    transport_.publish(SourceState{source, epoch, sequencer_.highest_decided(source, epoch),
                                   head.revision, head.chain, started_ns_});
  transport_.publish(make_status());
}

// Once a second. A full disk is no end: clients keep what they have, and try again.
void Service::watch_disk() {
  const auto now = std::chrono::steady_clock::now();
  if (now - disk_watched_ < std::chrono::seconds(1)) return;
  disk_watched_ = now;
  const DiskSpace before = std::exchange(disk_, journal_.space());
  if (disk_ == before) return;
  const Revision& head = head_.graph().graph_revision;
  if (disk_ == DiskSpace::kPlenty) {
    announce(Severity::kInfo, "disk", "more than 10 % of the disk is free again", head);
  } else if (disk_ == DiskSpace::kLow) {
    announce(Severity::kWarning, "disk",
             "under 10 % of the disk is free; under 2 % nothing more is taken", head);
  } else {
    announce(Severity::kError, "disk",
             "under 2 % of the disk is free: nothing is taken until there is room", head);
  }
  state_changed_ = true;
}

Status Service::make_status() const {
  Status status;
  status.started_ns = started_ns_;
  status.version = "0.1.0";
  status.host = host();
  status.state = refill_.active() ? DaemonState::kRefilling : DaemonState::kServing;
  status.head = journal_.head().revision;
  status.estimate = {head_.graph().graph_revision, head_.graph().solved_revision};
  status.variables = head_.graph().nodes.size();
  status.factors = head_.graph().factors.size();
  status.chi2 = chi2_.value_or(0.0);
  status.datum = head_.graph().datum;
  status.memory_bytes = resident_bytes();
  status.disk_free_bytes = journal_.free_bytes();
  const auto mention = [&](const std::string& what) {
    status.message += (status.message.empty() ? "" : "; ") + what;
  };
  if (!damage_.empty()) mention("the store was damaged: " + damage_);
  if (disk_ != DiskSpace::kPlenty) mention("the disk is nearly full");
  std::size_t count = 0;
  for (const auto& [source, own] : head_.quarantined()) count += own;
  if (count > 0)
    mention(std::to_string(count) + (count == 1 ? " loop closure is" : " loop closures are") +
            " quarantined (cairn log --kind verdict)");
  std::map<std::string, SourceStatus> sources;
  for (const auto& [name, counters] : sequencer_.counters())
    sources[name] = status_of(name, counters);
  for (const auto& [name, owner] : writers_.owners()) {
    SourceStatus& source = sources[name];
    source.source = name;
    source.alive = owner.alive;
    source.clock_offset_ns = owner.clock.value_ns().value_or(0);
    if (source.highest_decided == 0) source.epoch = owner.state.epoch;
  }
  for (auto& [name, source] : sources) status.sources.push_back(std::move(source));
  return status;
}

}  // namespace cairn
