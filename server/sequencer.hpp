// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cairn/core/content_hash.hpp"
#include "cairn/graph/transaction.hpp"
#include "cairn/replay/map_head.hpp"

namespace cairn {

/// What waits is bounded in number and time, and shared fairly between sources.
struct SequencerLimits {
  std::size_t held = 10'000;                  ///< transactions in all
  std::int64_t patience_ns = 60'000'000'000;  ///< for a node of another source
  std::size_t kept_decisions = 4096;          ///< per source; older sequences are stale
};

/// What was decided about one transaction. To be journaled, then answered.
struct Decision {
  Transaction transaction;  ///< of a refusal: its key only
  ContentHash content_hash{};
  std::optional<RefusalCode> refusal{};
  std::string reason{};
};

/// An answer that needs no record: a repetition, or a refusal that may be tried again.
struct Answer {
  Receipt receipt;
};

/// Counted per source since the daemon started.
struct SourceCounters {
  std::uint64_t epoch = 0;
  std::uint64_t highest_decided = 0;
  std::uint64_t accepted = 0;
  std::uint64_t refused = 0;
  std::size_t held = 0;
  std::string last_refusal{};
};

/// Decides transactions: those of one source in the order of their sequences, each once. Applies
/// what it accepts to the head at once; the caller makes the records durable before anybody sees
/// them. A pure function of its inputs: it asks no clock. One thread.
class Sequencer {
 public:
  explicit Sequencer(SequencerLimits limits = {}) : limits_(limits) {}

  /// Restart: a decision that the journal holds.
  void replay(const TransactionKey& key, const ContentHash& hash,
              const std::optional<RefusalCode>& refusal, const std::string& reason,
              const Revision& revision);

  struct Outcome {
    std::vector<Decision> decisions;  ///< in the order of their records
    std::vector<Answer> answers;
  };
  /// Takes one transaction and decides what can be decided by it: nothing (held), or it and what
  /// waited for it. `revision_of` the n-th decision from now on is known to the caller: decisions
  /// are applied with `next`, `next` + 1, ...
  void take(Transaction transaction, std::int64_t now_ns, MapHead& head, Revision next,
            Outcome& outcome);
  /// Refuses what waited too long.
  void expire(std::int64_t now_ns, MapHead& head, Revision next, Outcome& outcome);

  [[nodiscard]] std::map<std::string, SourceCounters> counters() const;

 private:
  struct Kept {
    ContentHash hash;
    Receipt receipt;
  };
  struct Held {
    Transaction transaction;
    ContentHash hash;
    std::int64_t since_ns;
    std::optional<NodeId> awaited;  ///< its turn has come, but for this node
  };
  struct Source {
    std::uint64_t epoch = 0;
    std::vector<std::uint64_t> closed_epochs;
    std::uint64_t highest_decided = 0;
    std::map<std::uint64_t, Kept> kept;  ///< by sequence, the newest ones
    std::map<std::uint64_t, Held> held;  ///< by sequence
    std::uint64_t accepted = 0, refused = 0;
    std::string last_refusal;
  };

  [[nodiscard]] std::optional<Receipt> answer_at_once(Source& source,
                                                      const Transaction& transaction,
                                                      const ContentHash& hash,
                                                      const Revision& head) const;
  bool hold(Source& source, Transaction&& transaction, const ContentHash& hash,
            std::int64_t now_ns);
  void advance(const std::string& name, std::int64_t now_ns, MapHead& head, Revision next,
               Outcome& outcome);
  bool advance_one(const std::string& name, std::int64_t now_ns, MapHead& head, Revision next,
                   Outcome& outcome);
  void decide(Source& source, Held held, std::optional<Refusal> refusal, MapHead& head,
              Revision next, Outcome& outcome);
  void remember(Source& source, const TransactionKey& key, Kept kept);
  [[nodiscard]] std::size_t held_count() const;

  SequencerLimits limits_;
  std::map<std::string, Source> sources_;
};

}  // namespace cairn
