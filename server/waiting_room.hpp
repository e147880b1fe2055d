// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cairn/core/content_hash.hpp"
#include "cairn/graph/transaction.hpp"
#include "cairn/replay/map_head.hpp"

namespace cairn {

/// A transaction as it arrived. One that breaks the wire's rules carries its fault: it waits for
/// its turn like any other, is refused then, and so uses up its sequence.
struct Arrival {
  Transaction transaction;  ///< of a faulty one: its key only
  ContentHash hash{};       ///< of everything that was sent
  std::size_t bytes = 0;    ///< about what it takes in memory
  std::optional<Refusal> fault{};
};
/// One that could be read.
Arrival make_arrival(Transaction transaction);

/// Where transactions wait for an earlier one of their source, or for another source. Bounded, and
/// shared fairly: when it is too full, whoever has most in it gives up its last one.
class WaitingRoom {
 public:
  struct Room {
    std::size_t count = 0;
    std::size_t bytes = 0;
  };
  struct Waiting {
    Arrival arrival;
    std::int64_t since_ns = 0;
    std::optional<NodeId> awaited{};  ///< its turn has come, but for this node
  };
  struct Place {
    std::uint64_t epoch = 0;
    std::uint64_t sequence = 0;
    friend auto operator<=>(const Place&, const Place&) = default;
  };
  using Line = std::map<Place, Waiting>;  ///< of one source

  explicit WaitingRoom(Room most) : most_(most) {}

  [[nodiscard]] Waiting* find(const std::string& source, const Place& place);
  void add(Arrival arrival, std::int64_t now_ns);
  /// What has to leave because it is too full; of equals the newcomer's.
  std::vector<Arrival> remove_excess(const std::string& newcomer);
  Waiting remove(const std::string& source, const Place& place);
  /// All of a source, in order.
  Line remove_line(const std::string& source);
  void adopt(const std::string& source, Line line);

  [[nodiscard]] std::size_t count_of(const std::string& source) const;
  [[nodiscard]] std::vector<std::string> sources() const;

 private:
  struct Share {
    Line line;
    Room used;
  };
  static void put(Share& share, const Place& place, Waiting waiting);
  Waiting take_out(std::map<std::string, Share>::iterator share, Line::iterator at);

  Room most_;
  Room used_;
  std::map<std::string, Share> shares_;  ///< none of them is empty
};

}  // namespace cairn
