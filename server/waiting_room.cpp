// SPDX-License-Identifier: BSD-3-Clause
#include "server/waiting_room.hpp"

#include <algorithm>

namespace cairn {

Arrival make_arrival(Transaction transaction) {
  const std::string bytes = encode(transaction);
  // In memory every node and list costs more than its bytes.
  const std::size_t size = 256 + 4 * bytes.size();
  return {std::move(transaction), content_hash(bytes), size, std::nullopt};
}

WaitingRoom::Waiting* WaitingRoom::find(const std::string& source, const Place& place) {
  const auto share = shares_.find(source);
  if (share == shares_.end()) return nullptr;
  const auto at = share->second.line.find(place);
  return at == share->second.line.end() ? nullptr : &at->second;
}

void WaitingRoom::put(Share& share, const Place& place, Waiting waiting) {
  ++share.used.count;
  share.used.bytes += waiting.arrival.bytes;
  share.line.emplace(place, std::move(waiting));
}

void WaitingRoom::add(Arrival arrival, std::int64_t now_ns) {
  const TransactionKey key = arrival.transaction.key;
  ++used_.count;
  used_.bytes += arrival.bytes;
  put(shares_[key.source], {key.epoch, key.sequence}, {std::move(arrival), now_ns, std::nullopt});
}

std::vector<Arrival> WaitingRoom::remove_excess(const std::string& newcomer) {
  std::vector<Arrival> leaving;
  while (used_.count > most_.count || used_.bytes > most_.bytes) {
    const auto holds = [&](const auto& share) {
      const std::size_t much = used_.count > most_.count ? share.second.used.count  //
                                                         : share.second.used.bytes;
      return std::pair(much, share.first == newcomer);
    };
    const auto biggest =
        std::max_element(shares_.begin(), shares_.end(),
                         [&](const auto& a, const auto& b) { return holds(a) < holds(b); });
    leaving.push_back(take_out(biggest, std::prev(biggest->second.line.end())).arrival);
  }
  return leaving;
}

WaitingRoom::Waiting WaitingRoom::take_out(std::map<std::string, Share>::iterator share,
                                           Line::iterator at) {
  Waiting waiting = std::move(at->second);
  for (Room* room : {&used_, &share->second.used}) {
    --room->count;
    room->bytes -= waiting.arrival.bytes;
  }
  share->second.line.erase(at);
  if (share->second.line.empty()) shares_.erase(share);
  return waiting;
}

WaitingRoom::Waiting WaitingRoom::remove(const std::string& source, const Place& place) {
  const auto share = shares_.find(source);
  return take_out(share, share->second.line.find(place));
}

WaitingRoom::Line WaitingRoom::remove_line(const std::string& source) {
  const auto share = shares_.find(source);
  if (share == shares_.end()) return {};
  used_.count -= share->second.used.count;
  used_.bytes -= share->second.used.bytes;
  Line line = std::move(share->second.line);
  shares_.erase(share);
  return line;
}

void WaitingRoom::adopt(const std::string& source, Line line) {
  for (auto& [place, waiting] : line) {
    ++used_.count;
    used_.bytes += waiting.arrival.bytes;
    put(shares_[source], place, std::move(waiting));
  }
}

std::size_t WaitingRoom::count_of(const std::string& source) const {
  const auto share = shares_.find(source);
  return share == shares_.end() ? 0 : share->second.used.count;
}

std::vector<std::string> WaitingRoom::sources() const {
  std::vector<std::string> names;
  for (const auto& [name, share] : shares_) names.push_back(name);
  return names;
}

}  // namespace cairn
