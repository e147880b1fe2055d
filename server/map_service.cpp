// SPDX-License-Identifier: BSD-3-Clause
#include "server/map_service.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

namespace cairn {
namespace {

constexpr int kNiceness = 10;              // as the solver's
constexpr std::size_t kMostRequests = 64;  // that wait
constexpr std::size_t kTileMemory = sizeof(Tile<HitMissCell>);

TileAnswer refusal(const TileRequest& request, ErrorCode code, std::string reason) {
  return {.client = request.client,
          .number = request.number,
          .run = request.run,
          .map = request.map,
          .error = code,
          .reason = std::move(reason),
          .tiles = {}};
}

}  // namespace

MapService::MapService(const Journal& journal, Transport& transport, Options options, Calls calls)
    : transport_(transport),
      options_(std::move(options)),
      calls_(std::move(calls)),
      scans_(journal) {}

void MapService::start(std::int64_t run) {
  if (!options_.enabled) return;
  published_ = PublishedTiles(run, options_.resolution_m);
  thread_ = std::thread([this] { this->run(); });
}

void MapService::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void MapService::hear_of_news() {
  const std::lock_guard lock(mutex_);
  news_ = true;
  wake_.notify_all();
}

void MapService::hear_of_payload() {
  const std::lock_guard lock(mutex_);
  ++payloads_;
  if (facts_.missing == 0) return;
  news_ = true;
  wake_.notify_all();
}

void MapService::show(MapBasis snapshot) {
  const std::lock_guard lock(mutex_);
  snapshot_ = std::move(snapshot);
  asked_ = false;
  wake_.notify_all();
}

void MapService::take(TileRequest request) {
  std::optional<TileAnswer> refused;
  {
    const std::lock_guard lock(mutex_);
    const auto same =
        std::find_if(requests_.begin(), requests_.end(),
                     [&](const TileRequest& other) { return other.client == request.client; });
    if (!options_.enabled) {
      refused = refusal(request, ErrorCode::kNotUsable,
                        "this daemon renders no maps; set maps: {enabled: true}");
    } else if (same != requests_.end()) {
      *same = std::move(request);
    } else if (requests_.size() < kMostRequests) {
      requests_.push_back(std::move(request));
    } else {
      refused = refusal(request, ErrorCode::kNotUsable,
                        "busy: " + std::to_string(kMostRequests) +
                            " clients wait for tiles already; ask again later");
    }
    facts_.refusals += refused.has_value();
  }
  wake_.notify_all();
  if (refused) transport_.publish(*refused);
}

MapService::Facts MapService::facts() const {
  const std::lock_guard lock(mutex_);
  return facts_;
}

bool MapService::may_ask() const { return news_ && !asked_ && !snapshot_; }

void MapService::run() {
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNiceness);
  while (true) {
    std::optional<MapBasis> snapshot;
    bool ask = false;
    {
      std::unique_lock lock(mutex_);
      const auto ready = [&] {
        return stopping_ || snapshot_ || !requests_.empty() ||
               (may_ask() && Clock::now() >= next_render_);
      };
      while (!ready()) may_ask() ? (void)wake_.wait_until(lock, next_render_) : wake_.wait(lock);
      if (stopping_) return;
      snapshot = std::exchange(snapshot_, {});
      ask = !snapshot && may_ask() && Clock::now() >= next_render_;
      if (ask) {
        asked_ = true;
        news_ = false;
      }
    }
    if (ask) calls_.ask_for_snapshot();
    answer_one();
    if (snapshot) render(std::move(*snapshot));
  }
}

void MapService::render(MapBasis snapshot) {
  const auto began = Clock::now();
  bool look_for_missing = false;
  {
    const std::lock_guard lock(mutex_);
    facts_.rendering = true;
    look_for_missing = std::exchange(payloads_seen_, payloads_) != payloads_;
  }
  const EstimateRevisions estimate{snapshot.graph.graph_revision, snapshot.graph.solved_revision};
  const ScanBook::Placed placed = scans_.place(snapshot.graph, snapshot.map_of, look_for_missing);
  calls_.give_back(std::move(snapshot.graph));  // soon: of what is shared, the writer makes copies
  const bool complete =
      render_layers(placed, snapshot.settled ? Precision::kExact : Precision::kTolerant);
  if (stopping_) return;
  publish(estimate);
  const auto now = Clock::now();
  std::size_t scans = 0;
  for (const auto& [name, layer] : layers_) scans += layer.map.rendered_poses().size();
  {
    const std::lock_guard lock(mutex_);
    next_render_ = now + options_.render_every;
    facts_.maps = layers_.size();
    facts_.tiles = published_.tiles();
    facts_.tile_bytes = published_.bytes();
    facts_.scans = scans;
    facts_.missing = scans_.missing();
    facts_.tile_revision = published_.revision();
    facts_.estimate = estimate;
    facts_.render_s = std::chrono::duration<double>(now - began).count();
    facts_.rendering = false;
    facts_.full = !complete;
    // Came while it was being looked for.
    news_ |= facts_.missing > 0 && payloads_seen_ != payloads_;
  }
  if (complete || std::exchange(told_full_, true)) return;
  calls_.tell(Severity::kWarning,
              "the maps' counts take all of maps: most_mb (" +
                  std::to_string(options_.most_bytes >> 20) +
                  " MB): what is new is not rendered; allow more, or set larger cells");
}

// False where it was left half way: the service stops, or memory does not suffice.
bool MapService::render_layers(const ScanBook::Placed& placed, Precision precision) {
  for (const auto& [name, scans] : placed) layers_.try_emplace(name, options_.resolution_m);
  for (auto& [name, layer] : layers_) {
    const auto wanted = placed.find(name);
    const std::size_t others = tiles_of_others(name);
    const auto keep_going = [&, &grid = layer.map.grid()] {
      answer_one();
      return !stopping_ && (others + grid.size()) * kTileMemory <= options_.most_bytes;
    };
    RenderReport report = layer.map.render(
        wanted == placed.end() ? std::span<const PlacedScan>() : wanted->second,
        [this](ScanId scan) { return scans_.read(scan); }, precision, keep_going);
    layer.changed.merge(report.changed);
    if (!report.finished) return false;
  }
  return true;
}

std::size_t MapService::tiles_of_others(const std::string& map) const {
  std::size_t tiles = 0;
  for (const auto& [name, layer] : layers_)
    if (name != map) tiles += layer.map.grid().size();
  return tiles;
}

// All that a rendering has changed has one revision, and goes out at once.
void MapService::publish(const EstimateRevisions& estimate) {
  published_.begin_revision();
  std::vector<MapChange> changes;
  for (auto& [name, layer] : layers_) {
    MapChange change{name, estimate, options_.resolution_m, {}, {}};
    for (const TileIndex& index : std::exchange(layer.changed, {})) {
      const auto found = layer.map.grid().find(index);
      std::optional<MapTile> tile;
      if (found != layer.map.grid().end()) tile = read_tile(found->second, MapModel::kOccupancy);
      if (!published_.put(name, index, tile ? &*tile : nullptr)) continue;
      if (tile)
        change.changed.emplace(index, *tile);
      else
        change.gone.push_back(index);
    }
    if (!change.changed.empty() || !change.gone.empty()) changes.push_back(std::move(change));
  }
  std::erase_if(layers_, [](const auto& entry) { return entry.second.map.grid().empty(); });
  transport_.publish_tile_index(published_.take_changed_blocks(estimate));
  if (!options_.on_map) return;
  for (const MapChange& change : changes) options_.on_map(change);
}

// One at a time: who asks without end does not keep a map from being rendered.
void MapService::answer_one() {
  TileRequest request;
  {
    const std::lock_guard lock(mutex_);
    if (requests_.empty()) return;
    request = std::move(requests_.front());
    requests_.pop_front();
  }
  const TileAnswer answer = published_.answer(request);
  {
    const std::lock_guard lock(mutex_);
    ++facts_.answers;
    facts_.refusals += answer.error.has_value();
  }
  transport_.publish(answer);
}

}  // namespace cairn
