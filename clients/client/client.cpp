// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/client.hpp"

#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <optional>

#include "clients/client/dds_link.hpp"
#include "clients/client/engine.hpp"
#include "clients/client/spool.hpp"
#include "idl/limits.hpp"

namespace cairn {
namespace {

Result<std::filesystem::path> spool_folder(const ClientOptions& options) {
  if (!options.spool.empty()) return options.spool;
  if (options.source.find('/') != std::string::npos || options.source.front() == '.')
    return Error{ErrorCode::kUsage,
                 "the source's name cannot name a folder; say where the spool is"};
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state != '\0')
    return std::filesystem::path(state) / "cairn" / "spool" / options.source;
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::filesystem::path(home) / ".local/state/cairn/spool" / options.source;
  return Error{ErrorCode::kUsage, "neither HOME nor XDG_STATE_HOME is set; say where the spool is"};
}

Result<std::optional<ClientSpools>> open_spools(const ClientOptions& options) {
  if (options.source.empty()) return std::optional<ClientSpools>();
  if (auto ok = limits::check_name("source", options.source); !ok)
    return Error{ErrorCode::kUsage, ok.error().message};
  auto folder = spool_folder(options);
  if (!folder) return folder.error();
  auto spool = Spool::open(
      {.folder = *folder, .source = options.source, .most_bytes = options.spool_most_bytes});
  if (!spool) return spool.error();
  auto payloads = PayloadSpool::open(*folder / "payloads", options.spool_most_bytes);
  if (!payloads) return payloads.error();
  return std::optional<ClientSpools>(ClientSpools{std::move(*spool), std::move(*payloads)});
}

}  // namespace

const TransactionKey& Submission::key() const { return state_->key; }

Result<Receipt> Submission::wait(std::chrono::milliseconds timeout) const {
  std::unique_lock lock(state_->mutex);
  if (state_->changed.wait_for(lock, timeout, [this] { return state_->outcome.has_value(); }))
    return *state_->outcome;
  return Error{ErrorCode::kUnreachable,
               "no receipt for transaction " + std::to_string(state_->key.sequence) + " within " +
                   std::to_string(timeout.count()) +
                   " ms; it is kept and sent until the daemon decides it",
               state_->key.source};
}

Result<Client> Client::connect(const ClientOptions& options) {
  return connect(options, [&](Link::Identity identity) {
    return make_dds_link({.domain = options.domain, .network = options.network},
                         std::move(identity));
  });
}

Result<Client> Client::connect(const ClientOptions& options, const MakeLink& make_link) {
  auto spools = open_spools(options);
  if (!spools) return spools.error();
  auto engine = std::make_unique<Engine>(options, std::move(*spools), make_link);
  if (auto started = engine->start(); !started) return started.error();
  return Client(std::move(engine));
}

Client::Client(std::unique_ptr<Engine> engine) : engine_(std::move(engine)) {}
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;
Client::~Client() = default;

Result<Receipt> Client::submit(Transaction transaction, std::chrono::milliseconds timeout) {
  if (engine_->in_callback())
    return Error{ErrorCode::kUsage, "submit() waits, and a callback may not: use submit_async()"};
  auto submission = submit_async(std::move(transaction));
  if (!submission) return submission.error();
  return submission->wait(timeout);
}

Result<Submission> Client::submit_async(Transaction transaction) {
  auto state = engine_->submit(std::move(transaction));
  if (!state) return state.error();
  return Submission(std::move(*state));
}

Result<ContentHash> Client::send_payload(const std::string& type, const std::string& bytes) {
  return engine_->send_payload(type, bytes);
}
std::uint64_t Client::unstored_payloads() const { return engine_->unstored_payloads(); }

void Client::on_poses(std::function<void(const PoseUpdate&)> callback) {
  engine_->watch_poses(std::move(callback));
}
void Client::on_landmarks(
    std::function<void(const EstimateRevisions&, const std::vector<LandmarkChunk>&)> callback) {
  engine_->watch_landmarks(std::move(callback));
}
void Client::on_corrections(std::function<void(const Correction&)> callback) {
  engine_->watch_corrections(std::move(callback));
}
void Client::on_maps(std::function<void(const MapChange&)> callback) {
  engine_->watch_maps(std::move(callback));
}
std::vector<MapView> Client::maps() const { return engine_->maps(); }
void Client::look_at_map_from(double x_m, double y_m) { engine_->look_at_map_from(x_m, y_m); }
void Client::on_status(std::function<void(const Status&)> callback) {
  engine_->watch_status(std::move(callback));
}
void Client::on_events(std::function<void(const Event&)> callback) {
  engine_->watch_events(std::move(callback));
}
void Client::on_refusals(std::function<void(const Receipt&)> callback) {
  engine_->watch_refusals(std::move(callback));
}
void Client::on_trouble(std::function<void(const Error&)> callback) {
  engine_->watch_trouble(std::move(callback));
}

Result<void> Client::wait_for(const Revision& revision, std::chrono::milliseconds timeout) {
  return engine_->wait(revision, &EstimateRevisions::graph, timeout);
}
Result<void> Client::wait_solved(const Revision& revision, std::chrono::milliseconds timeout) {
  return engine_->wait(revision, &EstimateRevisions::solved, timeout);
}
Result<std::string> Client::command(const std::string& text, std::chrono::milliseconds timeout) {
  return engine_->command(text, timeout);
}
std::uint64_t Client::epoch() const { return engine_->epoch(); }
std::uint64_t Client::next_sequence() const { return engine_->next_sequence(); }
std::uint64_t Client::undecided() const { return engine_->undecided(); }

}  // namespace cairn
