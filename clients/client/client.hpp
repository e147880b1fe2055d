// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cairn/core/result.hpp"
#include "cairn/graph/transaction.hpp"
#include "clients/client/map_follower.hpp"
#include "idl/dds/entity.hpp"
#include "idl/link.hpp"
#include "idl/messages.hpp"

namespace cairn {

struct ClientOptions {
  std::uint32_t domain = 0;
  std::string source{};  ///< 1 to 64 bytes; empty: watch and command, submit nothing
  std::string robot{};   ///< whose constraints these are; may be empty
  /// Empty: $XDG_STATE_HOME/cairn/spool/SOURCE, or ~/.local/state instead.
  std::filesystem::path spool{};
  std::uint64_t spool_most_bytes = 1ull << 30;
  dds::Network network{};                      ///< where CYCLONEDDS_URI is not set
  bool follow_maps = false;                    ///< keep a copy of the daemon's maps
  MapFollower::Options maps{};                 ///< how
  std::chrono::milliseconds retry_first{20};   ///< after a retryable refusal, doubled each time ...
  std::chrono::milliseconds retry_most{5000};  ///< ... up to this
};

/// Everything that changed since the last one; chunks replace those of the same frame and number.
struct PoseUpdate {
  EstimateRevisions revisions;
  std::vector<PoseChunk> chunks;
};

/// The receipt of one transaction, when it comes. Copies wait for the same one.
class Submission {
 public:
  [[nodiscard]] const TransactionKey& key() const;
  /// kUnreachable after the timeout: the transaction is (or will be) in the spool, and is sent
  /// until it is decided; so also while another program lives under the source's name. Another
  /// error means that it is not there and never will be sent (unless its message says otherwise).
  [[nodiscard]] Result<Receipt> wait(std::chrono::milliseconds timeout) const;

  struct State;

 private:
  friend class Client;
  explicit Submission(std::shared_ptr<State> state) : state_(std::move(state)) {}
  std::shared_ptr<State> state_;
};

/// A program's connection to a Cairn daemon. What submit() has taken is on disk, in order, and is
/// sent again until the daemon has decided it: over link losses, restarts of either side, and
/// daemons that lost the end of their store. Any thread may call it. Callbacks come from a thread
/// of the client; they may submit_async() but not wait.
class Client {
 public:
  /// Does not wait for a daemon: submissions are spooled until one is there.
  static Result<Client> connect(const ClientOptions& options);
  /// The same over any link; `make_link` is told who speaks.
  using MakeLink = std::function<std::unique_ptr<Link>(Link::Identity)>;
  static Result<Client> connect(const ClientOptions& options, const MakeLink& make_link);
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;
  /// Leaves nothing behind in memory: what was taken is in the spool.
  ~Client();

  /// Sets the transaction's key and sending time, and waits for the receipt: an acceptance, or a
  /// final refusal. Errors as of submit_async() and Submission::wait().
  Result<Receipt> submit(Transaction transaction, std::chrono::milliseconds timeout);
  /// kNotUsable "spool full" where too much waits; kBadInput where the transaction breaks the
  /// wire's limits. Then nothing was taken.
  Result<Submission> submit_async(Transaction transaction);

  /// Sends a scan or an image (type: "laser_scan/1", ...) and keeps it on disk until the daemon has
  /// stored it. Returns when it is on disk; its hash is what a factor names it by. kNotUsable
  /// "spool full" where too much waits, kBadInput over 16 MB. What the daemon refuses goes to
  /// on_trouble().
  Result<ContentHash> send_payload(const std::string& type, const std::string& bytes);
  /// Payloads that the daemon has not stored yet.
  [[nodiscard]] std::uint64_t unstored_payloads() const;

  /// Called with all poses known so far, then with every change. Replaces the callback before.
  void on_poses(std::function<void(const PoseUpdate&)> callback);
  void on_landmarks(
      std::function<void(const EstimateRevisions&, const std::vector<LandmarkChunk>&)> callback);
  void on_corrections(std::function<void(const Correction&)> callback);
  /// With ClientOptions::follow_maps: called with all tiles known so far, map by map, then with
  /// every change, which replaces the tiles that it names.
  void on_maps(std::function<void(const MapChange&)> callback);
  /// The copy as it is now; empty without ClientOptions::follow_maps.
  [[nodiscard]] std::vector<MapView> maps() const;
  /// Tiles that are nearest to here come first, m in the map. At first: its origin.
  void look_at_map_from(double x_m, double y_m);
  void on_status(std::function<void(const Status&)> callback);
  void on_events(std::function<void(const Event&)> callback);
  /// Final refusals that no Submission of this process waits for: of a run before this one. May
  /// tell the same one again after a restart.
  void on_refusals(std::function<void(const Receipt&)> callback);
  /// What the user should know: peers that do not fit, a daemon that lost what the spool no longer
  /// has, a damaged spool, another program under the source's name (once, until it has ended).
  /// Without a callback it goes to standard error.
  void on_trouble(std::function<void(const Error&)> callback);

  /// Waits for poses that include this revision. kNotUsable where the store has lost its tail
  /// since: the transaction is sent again and gets a new receipt.
  Result<void> wait_for(const Revision& revision, std::chrono::milliseconds timeout);
  /// Waits for a solve that has seen this revision.
  Result<void> wait_solved(const Revision& revision, std::chrono::milliseconds timeout);

  /// A verb of the command line; the daemon's answer, or its error.
  Result<std::string> command(const std::string& text, std::chrono::milliseconds timeout);

  /// What the next submission gets: 1 with a new spool. So a program that was restarted knows how
  /// much of its input it has submitted before.
  [[nodiscard]] std::uint64_t next_sequence() const;
  /// Of the spool: the same until it is deleted.
  [[nodiscard]] std::uint64_t epoch() const;
  /// Taken and not known to be decided: of a run before this one, until a daemon was heard, all
  /// that the spool keeps.
  [[nodiscard]] std::uint64_t undecided() const;

 private:
  class Engine;
  explicit Client(std::unique_ptr<Engine> engine);
  std::unique_ptr<Engine> engine_;
};

}  // namespace cairn
