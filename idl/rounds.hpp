// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "idl/messages.hpp"

namespace cairn {

/// Puts chunks that arrive in any order together to whole rounds. A round is over when its end has
/// arrived and nothing of a newer round has.
template <class Chunk>
class Rounds {
 public:
  void add(const EstimateRevisions& revisions, Chunk chunk) {
    raise(newest_, revisions);
    pending_[{chunk.frame, chunk.chunk}] = std::move(chunk);
  }
  void end(const EstimateRevisions& revisions) {
    raise(newest_, revisions);
    ended_ = revisions;
  }
  /// Once everything that has arrived was added: the changes since the last whole round, if one is
  /// complete.
  std::optional<std::pair<EstimateRevisions, std::vector<Chunk>>> take() {
    if (!ended_ || order(*ended_) < order(*newest_)) return std::nullopt;
    std::pair<EstimateRevisions, std::vector<Chunk>> round{*ended_, {}};
    round.second.reserve(pending_.size());
    for (auto& [key, chunk] : pending_) round.second.push_back(std::move(chunk));
    pending_.clear();
    ended_.reset();
    newest_.reset();  // a restarted daemon may begin lower
    return round;
  }

 private:
  static auto order(const EstimateRevisions& revisions) {
    return std::tie(revisions.graph.era, revisions.graph.number, revisions.solved.era,
                    revisions.solved.number);
  }
  static void raise(std::optional<EstimateRevisions>& to, const EstimateRevisions& revisions) {
    if (!to || to->graph.store != revisions.graph.store || order(*to) < order(revisions))
      to = revisions;
  }

  std::map<std::pair<OdometryFrame, std::uint32_t>, Chunk> pending_;
  std::optional<EstimateRevisions> ended_;
  std::optional<EstimateRevisions> newest_;
};

}  // namespace cairn
