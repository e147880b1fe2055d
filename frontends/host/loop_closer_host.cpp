// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/host/loop_closer_host.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "cairn/core/base64.hpp"

namespace cairn {
namespace {

using Json = nlohmann::json;
using namespace std::chrono_literals;

constexpr std::size_t kMostUndecided = 256;
constexpr std::size_t kMostQueued = 1024;  ///< keyframes, beyond which none is asked for
constexpr std::size_t kMostAtOnce = 32;    ///< before somebody looks whether to go on
constexpr std::chrono::milliseconds kPatience = 5s, kPause = 200ms;

Error not_understood(const std::string& why) {
  return {ErrorCode::kInternal, "the daemon's answer to keyframes is not understood (" +
                                    why.substr(0, 200) +
                                    "); do front-end and daemon have the same version?"};
}

// Throws Json::exception.
RobotKeyframe keyframe_of(const Json& json, std::uint64_t closed) {
  RobotKeyframe keyframe{
      .node = {{json.at("robot").get<std::string>(), json.at("epoch").get<std::uint64_t>()},
               json.at("index").get<std::uint64_t>()},
      .stamp_ns = json.at("stamp_ns").get<std::int64_t>(),
      .is_new = json.at("place").get<std::uint64_t>() >= closed};
  for (const Json& payload : json.at("payloads"))
    if (auto bytes = from_base64(payload.get_ref<const std::string&>()))
      keyframe.payloads.push_back(std::move(*bytes));
  return keyframe;
}

}  // namespace

Result<std::unique_ptr<LoopCloserHost>> LoopCloserHost::connect(const HostOptions& options) {
  std::unique_ptr<LoopCloserHost> host(new LoopCloserHost(options));
  host->source_ = options.robot + "-loops";
  ClientOptions client{.domain = options.domain,
                       .source = host->source_,
                       .robot = options.robot,
                       .network = options.network};
  if (!options.spool.empty()) client.spool = options.spool / host->source_;
  Result<Client> connected = Client::connect(client);
  if (!connected) return connected.error();
  host->client_.emplace(std::move(*connected));
  host->client_->on_poses([raw = host.get()](const PoseUpdate& update) {
    const std::lock_guard lock(raw->mutex_);
    raw->arrived_.revisions = raw->revisions_ = update.revisions;
    for (const PoseChunk& chunk : update.chunks) {
      raw->arrived_.changed.push_back(chunk);
      raw->chunks_[{chunk.frame, chunk.chunk}] = chunk;
    }
  });
  return host;
}

// The client's threads end before what their callbacks use.
LoopCloserHost::~LoopCloserHost() { client_.reset(); }

Result<void> LoopCloserHost::run(const MakeFrontend& make, const std::function<bool()>& keep_going,
                                 std::optional<std::chrono::milliseconds> until_idle) {
  if (auto begun = begin(make); !begun) return begun;
  auto last_news = std::chrono::steady_clock::now();
  while (keep_going()) {
    // What an interrupted run found is in the map before it is asked how far that went.
    const bool asks = client_->undecided() <= undecided_.size() && queue_.size() < kMostQueued;
    const Result<bool> heard = asks ? ask(make) : false;
    if (!heard) return heard.error();
    deliver_snapshot();
    const Result<bool> handed = hand_over();
    if (!handed) return handed.error();
    const auto now = std::chrono::steady_clock::now();
    if (*heard || *handed) last_news = now;
    if (*heard || *handed) continue;
    if (until_idle && everything_ && now - last_news >= *until_idle) break;
    std::this_thread::sleep_for(kPause);
  }
  if (const std::size_t blind = waiting_.size() + queue_.size(); blind > 0)
    std::fprintf(stderr, "warning: of %zu keyframes no scan or no pose has come\n", blind);
  if (auto stopped = frontend_->stop(); !stopped) return stopped;
  return wait_for(0);
}

// With the poses that are known.
Result<void> LoopCloserHost::begin(const MakeFrontend& make) {
  if (frontend_) {
    if (auto stopped = frontend_->stop(); !stopped) return stopped;
  }
  Result<std::unique_ptr<Frontend>> made = make();
  if (!made) return made.error();
  frontend_ = std::move(*made);
  closed_.reset();
  waiting_.clear();
  queue_.clear();
  posed_.clear();
  {
    const std::lock_guard lock(mutex_);
    arrived_ = {revisions_, {}};
    for (const auto& [key, chunk] : chunks_) arrived_.changed.push_back(chunk);
  }
  return frontend_->start(*this);
}

// True where keyframes came. A daemon that does not answer is asked again.
Result<bool> LoopCloserHost::ask(const MakeFrontend& make) {
  const Json question{{"from", place_.next}, {"again", waiting_}, {"source", source_}};
  const Result<std::string> answer = client_->command("keyframes " + question.dump(), kPatience);
  everything_ = false;
  if (!answer && answer.error().code == ErrorCode::kUsage) return answer.error();
  if (!answer) return false;
  const std::size_t before = queue_.size();
  if (auto taken = take(*answer, make); !taken) return taken.error();
  return queue_.size() > before;
}

Result<void> LoopCloserHost::take(const std::string& answer, const MakeFrontend& make) {
  try {
    const Json json = Json::parse(answer);
    Place place{json.at("store").get<std::uint64_t>(), json.at("era").get<std::uint64_t>(),
                json.at("next").get<std::uint64_t>()};
    const auto places = json.at("places").get<std::uint64_t>();
    if (!closed_) closed_ = json.at("closed").get<std::uint64_t>();
    if (place.store != place_.store || place.era != place_.era) {
      const bool is_another = place_.store != 0;
      place_ = {place.store, place.era, is_another ? 0 : place.next};
      if (is_another) return begin(make);  // what was at which place holds no more
    }
    place_ = place;
    for (const Json& keyframe : json.at("keyframes")) {
      waiting_.erase(keyframe.at("place").get<std::uint64_t>());
      queue_.push_back(keyframe_of(keyframe, *closed_));
    }
    for (const Json& waiting : json.at("waiting")) waiting_.insert(waiting.get<std::uint64_t>());
    everything_ = place_.next >= places;
    return {};
  } catch (const Json::exception& wrong) {
    return not_understood(wrong.what());
  }
}

void LoopCloserHost::deliver_snapshot() {
  MapSnapshot snapshot;
  {
    const std::lock_guard lock(mutex_);
    if (arrived_.changed.empty()) return;
    snapshot = std::exchange(arrived_, {});
  }
  for (const PoseChunk& chunk : snapshot.changed)
    for (const PoseEstimate& pose : chunk.poses) posed_[chunk.frame].insert(pose.index);
  frontend_->on_snapshot(snapshot);
}

// Those whose poses are told, in the order of their coming. True where there were any.
Result<bool> LoopCloserHost::hand_over() {
  const auto posed = [&](const RobotKeyframe& keyframe) {
    const auto frame = posed_.find(keyframe.node.frame);
    return frame != posed_.end() && frame->second.contains(keyframe.node.index);
  };
  std::size_t handed = 0;
  std::deque<RobotKeyframe> later;
  for (RobotKeyframe& keyframe : std::exchange(queue_, {})) {
    if (handed == kMostAtOnce || !posed(keyframe)) {
      later.push_back(std::move(keyframe));
      continue;
    }
    ++handed;
    ++counts_.keyframes;
    counts_.robots.insert(keyframe.node.frame.robot);
    deliver_snapshot();
    if (auto done = frontend_->on_keyframe(keyframe); !done) return done.error();
  }
  queue_ = std::move(later);
  return handed > 0;
}

Result<void> LoopCloserHost::submit_keyframe(Transaction /*transaction*/) {
  return Error{ErrorCode::kUsage, "a loop closer makes no keyframes; run it with --role both"};
}

void LoopCloserHost::tell(const std::string& text) {
  std::fprintf(stderr, "%s: %s\n", options_.robot.c_str(), text.c_str());
}

Result<ContentHash> LoopCloserHost::send_payload(const std::string& /*type*/,
                                                 const std::string& /*bytes*/) {
  return Error{ErrorCode::kUsage, "a loop closer sends no scans; run it with --role both"};
}

Result<void> LoopCloserHost::submit_loops(Transaction transaction) {
  const std::size_t loops = transaction.factors.size();
  Result<Submission> taken = client_->submit_async(std::move(transaction));
  if (!taken) return taken.error();
  counts_.loops += loops;
  undecided_.push_back(std::move(*taken));
  return wait_for(kMostUndecided);
}

// Keyframes may have been taken back since: their loops are refused, and no loss.
Result<void> LoopCloserHost::wait_for(std::size_t at_most) {
  while (undecided_.size() > at_most) {
    const Result<Receipt> receipt = undecided_.front().wait(options_.timeout);
    if (!receipt) return receipt.error();
    if (receipt->refusal)
      std::fprintf(stderr, "warning: loops %llu of %s were refused: %s: %s\n",
                   static_cast<unsigned long long>(receipt->key.sequence), source_.c_str(),
                   std::string(to_string(*receipt->refusal)).c_str(), receipt->reason.c_str());
    undecided_.pop_front();
  }
  return {};
}

}  // namespace cairn
