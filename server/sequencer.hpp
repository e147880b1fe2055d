// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cairn/core/content_hash.hpp"
#include "cairn/graph/transaction.hpp"
#include "cairn/replay/map_head.hpp"
#include "server/waiting_room.hpp"

namespace cairn {

/// What is kept is bounded. Strangers, sources of which nothing was decided yet, have an eighth of
/// the room in which transactions wait: invented names take nothing from those that are known.
struct SequencerLimits {
  std::size_t held = 10'000;                  ///< transactions that wait, in all
  std::size_t held_bytes = 256u << 20;        ///< and their memory
  std::int64_t patience_ns = 60'000'000'000;  ///< for a node of another source
  std::size_t kept_decisions = 4096;          ///< per source; older sequences are stale
  std::size_t sources = 1024;                 ///< known ones
  std::size_t never_accepted = 64;            ///< known ones with refusals only
  std::size_t closed_epochs = 1024;           ///< per source
};

/// What was decided about one transaction. To be journaled, then answered.
struct Decision {
  Transaction transaction;  ///< of a refusal: its key only
  ContentHash content_hash{};
  std::optional<RefusalCode> refusal{};
  std::string reason{};
};

/// Counted per source since the daemon started.
struct SourceCounters {
  std::uint64_t epoch = 0;
  std::uint64_t highest_decided = 0;
  std::uint64_t accepted = 0;
  std::uint64_t refused = 0;
  std::size_t held = 0;
  std::string last_refusal{};
  std::map<RefusalCode, std::uint64_t> refused_by_code{};  ///< retryable ones too
};

/// Decides transactions: those of one source in the order of their sequences, each once. Applies
/// what it accepts to the head at once; the caller makes the records durable before anybody sees
/// them. A new epoch of a source begins when its first transaction is decided, and closes the one
/// before. A pure function of its inputs: it asks no clock. One thread.
class Sequencer {
 public:
  explicit Sequencer(SequencerLimits limits = {});

  /// Restart: a decision that the journal holds.
  void replay(const TransactionKey& key, const ContentHash& hash,
              const std::optional<RefusalCode>& refusal, const std::string& reason,
              const Revision& revision);

  struct Outcome {
    std::vector<Decision> decisions;  ///< in the order of their records
    std::vector<Receipt> answers;     ///< need no record: repetitions, and what may be tried again
  };
  /// One call: its time, what it decides on, and where its decisions go. The n-th decision in
  /// `outcome` is applied with the revision `next` + n.
  struct Turn {
    std::int64_t now_ns;
    MapHead& head;
    Revision next;
    Outcome& outcome;
  };
  /// Takes one transaction and decides what can be decided by it: nothing (held), or it and what
  /// waited for it.
  void take(Arrival arrival, Turn turn);
  /// The source's spool has nothing before `first` any more: what is missing will never come.
  void skip_to(const std::string& source, std::uint64_t epoch, std::uint64_t first, Turn turn);
  /// Refuses what waited too long.
  void expire(Turn turn);
  /// Everything that waits leaves with this answer.
  std::vector<Receipt> turn_away(RefusalCode code, const std::string& reason, const Revision& head);

  /// What waits of a stranger leaves with an answer. Nothing happens to a known source.
  std::vector<Receipt> turn_away_stranger(const std::string& source, const Revision& head);

  /// Refusals that somebody else pronounced. Those of strangers are not counted.
  void count_refusal(const Receipt& receipt);
  [[nodiscard]] std::map<std::string, SourceCounters> counters() const;
  /// Something of this source was decided once.
  [[nodiscard]] bool knows(const std::string& source) const { return sources_.contains(source); }
  /// The highest one of this epoch; 0 where it is not the source's current one.
  [[nodiscard]] std::uint64_t highest_decided(const std::string& source, std::uint64_t epoch) const;
  /// A newer epoch has begun: nothing of this one is decided any more.
  [[nodiscard]] bool is_closed(const std::string& source, std::uint64_t epoch) const;

 private:
  struct Kept {
    ContentHash hash;
    Receipt receipt;
  };
  struct Source {
    std::uint64_t epoch = 0;
    std::set<std::uint64_t> closed_epochs;
    std::uint64_t highest_decided = 0;
    std::map<std::uint64_t, Kept> kept;  ///< by sequence, the newest ones
    bool ever_accepted = false;
    std::uint64_t accepted = 0;
    std::map<RefusalCode, std::uint64_t> refused;
    std::string last_refusal;
  };
  [[nodiscard]] std::optional<Refusal> refuse_at_once(const Source& source, const Arrival& arrival,
                                                      WaitingRoom& room) const;
  [[nodiscard]] const Receipt* first_receipt(const Source& source, const Arrival& arrival) const;
  void answer(const TransactionKey& key, RefusalCode code, const std::string& reason, Turn& turn);
  void advance(const std::string& name, Turn& turn);
  bool advance_one(const std::string& name, Turn& turn);
  [[nodiscard]] std::optional<WaitingRoom::Place> next_of(const std::string& name);
  [[nodiscard]] std::optional<Refusal> no_room_for(const std::string& name, bool accepted) const;
  void decide(const std::string& name, Arrival arrival, std::optional<Refusal> refusal, Turn& turn);
  Source& open_epoch(const TransactionKey& key);
  void remember(Source& source, const TransactionKey& key, Kept kept);
  WaitingRoom& room_of(const std::string& name) { return knows(name) ? room_ : strangers_; }
  [[nodiscard]] const WaitingRoom& room_of(const std::string& name) const {
    return knows(name) ? room_ : strangers_;
  }

  SequencerLimits limits_;
  std::map<std::string, Source> sources_;  ///< the known ones: the journal bounds them
  WaitingRoom room_, strangers_;
  std::map<std::string, WaitingRoom::Place> openers_;  ///< with which another epoch would begin
  std::set<std::string> awaiting_;                     ///< sources whose turn waits for a node
};

}  // namespace cairn
