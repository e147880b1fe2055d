// SPDX-License-Identifier: BSD-3-Clause
// What an operator watches: latencies, queues, the solver, and how honest sources are.
#include "server/service.hpp"
#include "server/status_json.hpp"

namespace cairn {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostClosures = 4096;
constexpr std::chrono::seconds kTrustEvery{30};  // while input goes on

Json to_json(const LatencyWindow::Summary& summary) {
  return {{"count", summary.count},
          {"p50_ms", summary.p50_ms},
          {"p99_ms", summary.p99_ms},
          {"max_ms", summary.most_ms}};
}

Json to_json(const MapService::Facts& facts, const MapService::Options& options,
             const Revision& head) {
  if (!options.enabled) return nullptr;
  return {{"resolution_m", options.resolution_m},
          {"maps", facts.maps},
          {"tiles", facts.tiles},
          {"tile_bytes", facts.tile_bytes},
          {"tile_revision", facts.tile_revision},
          {"scans", facts.scans},
          {"missing", facts.missing},
          {"rendered_revision", facts.estimate.graph.number},
          {"behind", head.number - std::min(head.number, facts.estimate.graph.number)},
          {"rendering", facts.rendering},
          {"render_s", facts.render_s},
          {"full", facts.full},
          {"requests", facts.answers},
          {"refused", facts.refusals}};
}

}  // namespace

// What has just been answered. What somebody else's transaction has waited for counts from when
// that one came.
void Service::note_answered(std::size_t decisions) {
  const auto now = Clock::now();
  for (std::size_t i = 0; i < std::min(decisions, decided_.size()); ++i)
    receipt_latency_.add(now, now - decided_[i]);
  while (closures_.size() > kMostClosures) closures_.pop_front();
}

// The poses of a solve of that record are published.
void Service::note_solved_closures(std::uint64_t base) {
  const auto now = Clock::now();
  for (; !closures_.empty() && closures_.front().first <= base; closures_.pop_front())
    closure_latency_.add(now, now - closures_.front().second);
}

// Nothing waits for the solver, and there is a solve of which it is not known.
bool Service::trust_is_due(bool idle) const {
  return head_.graph().solved_revision.number != trust_at_ && !awaits_live_solve() &&
         (idle || Clock::now() - trust_began_ >= kTrustEvery);
}

void Service::measure_trust_beside() {
  trust_at_ = head_.graph().solved_revision.number;
  trust_began_ = Clock::now();
  on_solver_thread([this, map = head_.graph()]() -> std::optional<Message> {
    pass(ServicePoint::kMeasuringTrust);
    std::vector<SourceTrust> trust = measure_trust(map);
    const std::lock_guard lock(mutex_);
    trust_ = std::move(trust);
    return std::nullopt;
  });
}

Json Service::status_json() const {
  const Status status = make_status();
  const auto now = Clock::now();
  Json json = to_json(status, false);
  Json& solver = json["solver"];
  solver["running"] = solving_;
  solver["kind"] = !solving_                              ? Json()
                   : solving_kind_ == SolveKind::kSettled ? Json("settle")
                                                          : Json("live");
  solver["seconds"] =
      solving_ ? Json(std::chrono::duration<double>(now - solve_began_).count()) : Json();
  std::size_t held = 0;
  for (const SourceStatus& source : status.sources) held += source.held;
  const auto [payloads, payload_bytes] = payloads_.waiting();
  std::vector<SourceTrust> trust;
  {
    const std::lock_guard lock(mutex_);
    json["queues"] = {{"inbox_messages", inbox_.size()},
                      {"inbox_bytes", inbox_bytes_},
                      {"held", held},
                      {"closures_to_solve", closures_.size()},
                      {"commands_awaiting_solve", awaiting_solution_.size()},
                      {"payloads", payloads},
                      {"payload_bytes", payload_bytes}};
    trust = trust_;
  }
  json["latency"] = {{"window_s", (LatencyWindow::kSlice * LatencyWindow::kSlices).count()},
                     {"receipt", to_json(receipt_latency_.summarize(now))},
                     {"closure_to_poses", to_json(closure_latency_.summarize(now))}};
  json["maps"] = to_json(maps_.facts(), options_.maps, head_.graph().graph_revision);
  add_judgement(json, head_, quarantined_, trust);
  return json;
}

}  // namespace cairn
