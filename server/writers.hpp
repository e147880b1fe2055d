// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cairn/replay/map_head.hpp"
#include "idl/messages.hpp"
#include "server/transport.hpp"

namespace cairn {

/// A client's clock minus ours, from messages that carry their sending time: what was least delayed
/// in the last one to two minutes knows best. Never from sensors' stamps: recorded logs are old.
class ClockOffset {
 public:
  void add(std::int64_t sent_ns, std::int64_t arrived_ns);
  [[nodiscard]] std::optional<std::int64_t> value_ns() const;

 private:
  std::optional<std::int64_t> newest_, before_;  ///< the highest difference of two periods
  std::int64_t period_began_ns_ = 0;
};

/// Who is there. A source has one live writer, its owner: the first client that says it is this
/// source, until the transport says that it is gone. One thread.
class Writers {
 public:
  /// One run of a spool; what the journal has of it is asked of `highest_decided`.
  using Spool = std::pair<std::string, std::uint64_t>;  ///< source and epoch
  using HighestDecided = std::function<std::uint64_t(const Spool&)>;
  struct Owner {
    ClientState state;  ///< the newest one
    std::uint64_t writer = 0;
    bool alive = false;
    ClockOffset clock{};
  };

  explicit Writers(HighestDecided highest_decided, std::size_t most_strangers = 256)
      : highest_decided_(std::move(highest_decided)), most_strangers_(most_strangers) {}

  /// Somebody uses this spool.
  void hear_of(const Spool& spool);
  /// A client says that it is there. It becomes the owner where there is no live one, or where the
  /// journal knows its epoch and not that of the owner. True: it is the owner now.
  bool arrive(const ClientState& client, const Sender& sender);
  /// Why a transaction cannot be taken from this writer: `busy` with the owner's epoch (a restarted
  /// program, whose old lease has not ended), `foreign source` with another one. `busy` also where
  /// nobody has said that it is there: what it was promised must be known first.
  [[nodiscard]] std::optional<Refusal> refuse(const TransactionKey& key, const Sender& sender);
  /// The end of a writer. Gives the spool of which nothing need be kept any more.
  std::optional<Spool> lose(const std::string& source, std::uint64_t writer);
  /// Spools of which the journal has nothing and that were heard of least recently, where there are
  /// too many.
  std::vector<Spool> remove_excess_strangers();

  [[nodiscard]] const std::map<std::string, Owner>& owners() const { return owners_; }

 private:
  void forget(const Spool& spool);

  HighestDecided highest_decided_;
  std::size_t most_strangers_;
  std::map<std::string, Owner> owners_;
  std::list<Spool> strangers_;  ///< the newest last
  std::map<Spool, std::list<Spool>::iterator> place_of_;
};

}  // namespace cairn
