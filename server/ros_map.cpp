// SPDX-License-Identifier: BSD-3-Clause
#include "server/ros_map.hpp"

#include <algorithm>
#include <utility>

#include "cairn/core/wall_clock.hpp"

namespace cairn {
namespace {

template <class Message>
void borrow(Message& message, const std::vector<std::int8_t>& cells) {
  message.data._length = message.data._maximum = static_cast<std::uint32_t>(cells.size());
  message.data._buffer = const_cast<std::int8_t*>(cells.data());  // writing does not change it
}

}  // namespace

Result<std::unique_ptr<RosMap>> RosMap::open(RosMapOptions options, dds::TroubleHandler trouble) {
  std::unique_ptr<RosMap> made(new RosMap(std::move(options), std::move(trouble)));
  if (auto started = made->start(); !started) return started.error();
  return made;
}

Result<void> RosMap::start() {
  for (const auto& [name, topic] :
       {std::pair(&options_.map, &map_topic_), std::pair(&options_.updates, &updates_topic_)}) {
    Result<std::string> known = ros::topic_name(*name);
    if (!known) return known.error();
    *topic = std::move(*known);
  }
  // On flush: the setting would hold for the daemon, too, where both are in one domain.
  auto participant =
      dds::Participant::open(options_.domain, options_.network, dds::Sending::kOnFlush);
  if (!participant) return participant.error();
  participant_.emplace(std::move(*participant));
  auto map = dds::Writer<ros::OccupancyGrid>::make(
      *participant_, ros::describe<ros::OccupancyGrid>(map_topic_, dds::Traffic::kLatest),
      &trouble_);
  if (!map) return map.error();
  map_.emplace(std::move(*map));
  auto updates = dds::Writer<ros::OccupancyGridUpdate>::make(
      *participant_,
      ros::describe<ros::OccupancyGridUpdate>(updates_topic_, dds::Traffic::kTransforms),
      &trouble_);
  if (!updates) return updates.error();
  updates_.emplace(std::move(*updates));
  thread_ = std::thread([this] { run(); });
  return {};
}

RosMap::~RosMap() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void RosMap::take(const std::string& map, const std::map<TileIndex, MapTile>& changed,
                  const std::vector<TileIndex>& gone, double resolution_m) {
  const std::lock_guard lock(mutex_);
  Map& known = maps_[map];
  known.grid.take(changed, gone, resolution_m);
  known.changed_at = Clock::now();
  wake_.notify_all();
}

void RosMap::run() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    const auto now = Clock::now();
    choose(now);
    publish(now, lock);
    const auto tick = options_.updates_every;
    if (stopping_) return;
    const bool nothing_to_do =
        !stale_ && std::none_of(maps_.begin(), maps_.end(),
                                [](const auto& m) { return m.second.grid.has_news(); });
    if (nothing_to_do)
      wake_.wait(lock);
    else
      wake_.wait_for(lock, tick);
  }
}

// Maps of robots that nothing ties together have each an origin of their own: one is published.
void RosMap::choose(Clock::time_point now) {
  std::erase_if(maps_, [](const auto& entry) { return entry.second.grid.is_empty(); });
  const auto current = maps_.find(current_);
  if (current != maps_.end() && now - current->second.changed_at < options_.silence) return;
  const auto newest = std::max_element(
      maps_.begin(), maps_.end(),
      [](const auto& a, const auto& b) { return a.second.changed_at < b.second.changed_at; });
  if (newest == maps_.end() || newest->first == current_) return;
  current_ = newest->first;
  whole_at_ = {};
}

void RosMap::publish(Clock::time_point now, std::unique_lock<std::mutex>& lock) {
  const auto current = maps_.find(current_);
  if (current == maps_.end()) return;
  RosGrid& grid = current->second.grid;
  std::optional<std::vector<RosGrid::Patch>> patches;
  bool whole = stale_ && now - whole_at_ >= options_.renew_every;
  if (whole_at_ == Clock::time_point{}) {
    whole = true;
  } else if (!whole && grid.has_news() && now - updates_at_ >= options_.updates_every) {
    patches = grid.draw_changed();
    whole = !patches && now - whole_at_ >= options_.whole_every;
  }
  std::optional<RosGrid::Image> image;
  if (whole) image = grid.draw();
  const bool too_large = whole && !image;
  lock.unlock();
  if (image) write(*image);
  if (patches)
    for (const RosGrid::Patch& patch : *patches) write(patch);
  if (too_large && !std::exchange(told_size_, true))
    trouble_({ErrorCode::kNotUsable, "the map is too large to be published on " + map_topic_ +
                                         ": its poses lie thousands of kilometres apart"});
  lock.lock();
  if (whole) whole_at_ = now;
  if (image) stale_ = false;
  if (!patches) return;
  updates_at_ = now;
  stale_ = stale_ || !patches->empty();
}

ros::Header RosMap::header() const {
  return {ros::to_time(wall_clock_ns()), const_cast<char*>(options_.frame.c_str())};
}

void RosMap::write(const RosGrid::Image& image) {
  ros::OccupancyGrid message{};
  message.header = header();
  message.info.map_load_time = message.header.stamp;
  message.info.resolution = static_cast<float>(image.resolution_m);
  message.info.width = image.width;
  message.info.height = image.height;
  message.info.origin = ros::to_pose(Se2(image.origin_x_m, image.origin_y_m, 0.0));
  borrow(message, image.cells);
  if (const auto code = map_->write(message); code < 0)
    trouble_(dds::to_error(code, "cannot write " + map_topic_));
}

void RosMap::write(const RosGrid::Patch& patch) {
  ros::OccupancyGridUpdate message{};
  message.header = header();
  message.x = patch.x;
  message.y = patch.y;
  message.width = message.height = patch.side;
  borrow(message, patch.cells);
  if (const auto code = updates_->write(message); code < 0)
    trouble_(dds::to_error(code, "cannot write " + updates_topic_));
}

}  // namespace cairn
