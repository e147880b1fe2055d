// SPDX-License-Identifier: BSD-3-Clause
#include "clients/client/dds_link.hpp"

#include <chrono>
#include <cstring>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "idl/convert_map.hpp"
#include "idl/dds/endpoint.hpp"
#include "idl/limits.hpp"
#include "idl/rounds.hpp"

namespace cairn {
namespace {

// What is meant for this client only. Called on the middleware's threads with samples or keys.
template <class Wire>
bool is_for(const void* sample, void* argument) {
  const auto& wire = *static_cast<const Wire*>(sample);
  const auto& identity = *static_cast<const Link::Identity*>(argument);
  return wire.source != nullptr && identity.source == wire.source && identity.epoch == wire.epoch;
}
bool is_reply_for(const void* sample, void* argument) {
  return static_cast<const cairn_wire_Reply*>(sample)->client ==
         static_cast<const Link::Identity*>(argument)->writer;
}

bool are_tiles_for(const void* sample, void* argument) {
  return static_cast<const cairn_wire_Occupancy_tile*>(sample)->client ==
         static_cast<const Link::Identity*>(argument)->writer;
}

struct Endpoints {
  dds::Reader<cairn_wire_Receipt> receipt;
  dds::Reader<cairn_wire_Source_state> source_state;
  dds::Reader<cairn_wire_Payload_receipt> payload_receipt;
  dds::Reader<cairn_wire_Reply> reply;
  dds::Reader<cairn_wire_Poses> poses;
  dds::Reader<cairn_wire_Landmarks> landmarks;
  dds::Reader<cairn_wire_Correction> correction;
  dds::Reader<cairn_wire_Status> status;
  dds::Reader<cairn_wire_Event> event;
  dds::Writer<cairn_wire_Client_state> client_state;  // first: found before transactions
  dds::Writer<cairn_wire_Transaction> transaction;
  dds::Writer<cairn_wire_Payload> payload;
  dds::Writer<cairn_wire_Command> command;

  static Result<Endpoints> make(const dds::Participant& in, const dds::TroubleHandler* trouble,
                                Link::Identity* identity) {
    return dds::collect<Endpoints>(
        dds::Reader<cairn_wire_Receipt>::make(in, trouble, {is_for<cairn_wire_Receipt>, identity}),
        dds::Reader<cairn_wire_Source_state>::make(in, trouble,
                                                   {is_for<cairn_wire_Source_state>, identity}),
        dds::Reader<cairn_wire_Payload_receipt>::make(
            in, trouble, {is_for<cairn_wire_Payload_receipt>, identity}),
        dds::Reader<cairn_wire_Reply>::make(in, trouble, {is_reply_for, identity}),
        dds::Reader<cairn_wire_Poses>::make(in, trouble),
        dds::Reader<cairn_wire_Landmarks>::make(in, trouble),
        dds::Reader<cairn_wire_Correction>::make(in, trouble),
        dds::Reader<cairn_wire_Status>::make(in, trouble),
        dds::Reader<cairn_wire_Event>::make(in, trouble),
        dds::Writer<cairn_wire_Client_state>::make(in, trouble),
        dds::Writer<cairn_wire_Transaction>::make(in, trouble),
        dds::Writer<cairn_wire_Payload>::make(in, trouble),
        dds::Writer<cairn_wire_Command>::make(in, trouble));
  }
};

// Of links that follow maps.
struct MapEndpoints {
  dds::Reader<cairn_wire_Tile_index> index;
  dds::Reader<cairn_wire_Occupancy_tile> tiles;
  dds::Writer<cairn_wire_Tile_request> request;

  static Result<MapEndpoints> make(const dds::Participant& in, const dds::TroubleHandler* trouble,
                                   Link::Identity* identity) {
    return dds::collect<MapEndpoints>(
        dds::Reader<cairn_wire_Tile_index>::make(in, trouble),
        dds::Reader<cairn_wire_Occupancy_tile>::make(in, trouble, {are_tiles_for, identity}),
        dds::Writer<cairn_wire_Tile_request>::make(in, trouble));
  }
};

class DdsLink final : public Link {
 public:
  DdsLink(const DdsLinkOptions& options, Identity identity)
      : options_(options), identity_(std::move(identity)) {}
  ~DdsLink() override { stop(); }

  Result<void> start(LinkListener& listener) override;
  void stop() noexcept override;

  Result<void> send(const Transaction& transaction) override {
    return write(&Endpoints::transaction, transaction, identity_.writer);
  }
  Result<void> send(const ClientState& state) override {
    return write(&Endpoints::client_state, state, identity_.writer);
  }
  Result<void> send(const Payload& payload) override {
    return write(&Endpoints::payload, payload, identity_.writer);
  }
  Result<void> send(const TileRequest& request) override;
  Result<void> send(const Command& command, int timeout_ms) override;

 private:
  template <class Wire, class Message, class... More>
  Result<void> write(dds::Writer<Wire> Endpoints::*writer, const Message& message,
                     const More&... more) {
    return write((*endpoints_).*writer, message, more...);
  }
  template <class Wire, class Message, class... More>
  static Result<void> write(const dds::Writer<Wire>& writer, const Message& message,
                            const More&... more) {
    wire::Arena arena;
    const auto code = writer.write(wire::to_wire(message, more..., arena));
    if (code >= 0) return {};
    return dds::to_error(code, std::string("cannot write ") + dds::Topic<Wire>::kName);
  }

  Result<void> attach_all(LinkListener& listener);
  // Takes everything there is; what can be read goes to `deliver`.
  template <class Wire, class Deliver>
  int take(dds::Reader<Wire>& reader, LinkListener& listener, Deliver deliver);
  template <class Wire, class Chunk>
  int take_round(dds::Reader<Wire> Endpoints::*reader, LinkListener& listener,
                 Rounds<Chunk>& rounds,
                 void (LinkListener::*deliver)(EstimateRevisions, std::vector<Chunk>));
  int take_replies(LinkListener& listener);
  [[nodiscard]] bool daemon_hears_commands() const;

  DdsLinkOptions options_;
  Identity identity_;  // also the filters' argument
  dds::TroubleHandler trouble_;
  std::optional<dds::Participant> participant_;
  std::optional<Endpoints> endpoints_;
  std::optional<MapEndpoints> map_endpoints_;
  std::unique_ptr<dds::WaitLoop> loop_;
  std::thread thread_;
  Rounds<PoseChunk> pose_rounds_;
  Rounds<LandmarkChunk> landmark_rounds_;
  Reply reply_;  // of which not all parts are here yet
};

Result<void> DdsLink::start(LinkListener& listener) {
  if (participant_) return Error{ErrorCode::kUsage, "the link was started before"};
  trouble_ = [&listener](Error error) { listener.on_trouble(std::move(error)); };
  auto participant = dds::Participant::open(options_.domain, options_.network);
  if (!participant) return participant.error();
  participant_.emplace(std::move(*participant));
  auto endpoints = Endpoints::make(*participant_, &trouble_, &identity_);
  if (!endpoints) return endpoints.error();
  endpoints_.emplace(std::move(*endpoints));
  if (identity_.follows_maps) {
    auto maps = MapEndpoints::make(*participant_, &trouble_, &identity_);
    if (!maps) return maps.error();
    map_endpoints_.emplace(std::move(*maps));
  }
  auto loop = dds::WaitLoop::make(*participant_);
  if (!loop) return loop.error();
  loop_ = std::move(*loop);
  if (auto attached = attach_all(listener); !attached) return attached;
  thread_ = std::thread([this] { loop_->run(trouble_); });
  return {};
}

void DdsLink::stop() noexcept {
  if (thread_.joinable()) {
    loop_->stop();
    thread_.join();
  }
  loop_.reset();
  map_endpoints_.reset();
  endpoints_.reset();  // and their listeners, which report to who may be gone
}

template <class Wire, class Deliver>
int DdsLink::take(dds::Reader<Wire>& reader, LinkListener& listener, Deliver deliver) {
  int count = 0;
  do {
    count = reader.take([&](const Wire& sample, const dds_sample_info_t& info) {
      if (!info.valid_data) return;
      auto message = wire::from_wire(sample);
      if (message) return deliver(std::move(*message));
      Error error = message.error();
      error.place = dds::Topic<Wire>::kName;
      listener.on_trouble(std::move(error));
    });
  } while (count == static_cast<int>(dds::kTake));
  return count;
}

template <class Wire, class Chunk>
int DdsLink::take_round(dds::Reader<Wire> Endpoints::*reader, LinkListener& listener,
                        Rounds<Chunk>& rounds,
                        void (LinkListener::*deliver)(EstimateRevisions, std::vector<Chunk>)) {
  int count = 0;
  do {
    count = ((*endpoints_).*reader).take([&](const Wire& sample, const dds_sample_info_t& info) {
      if (!info.valid_data) return;
      const EstimateRevisions revisions = wire::from_wire(sample.revisions);
      if (sample.robot == nullptr || *sample.robot == '\0') return rounds.end(revisions);
      auto chunk = wire::from_wire(sample);
      if (chunk) return rounds.add(revisions, std::move(*chunk));
      Error error = chunk.error();
      error.place = dds::Topic<Wire>::kName;
      listener.on_trouble(std::move(error));
    });
    // The end of a round may be taken before chunks of it that are there too.
  } while (count > 0);
  if (auto round = rounds.take()) (listener.*deliver)(round->first, std::move(round->second));
  return count;
}

int DdsLink::take_replies(LinkListener& listener) {
  return endpoints_->reply.take([&](const cairn_wire_Reply& sample, const dds_sample_info_t& info) {
    if (!info.valid_data) return;
    const CommandKey key{.client = sample.client, .number = sample.number};
    if (sample.part == 0) reply_ = Reply{.key = key, .error = {}, .text = {}};
    if (reply_.key != key) return;  // its beginning was written before we were there
    if (sample.text != nullptr) reply_.text += sample.text;
    if (sample.error_code != 0) reply_.error = static_cast<ErrorCode>(sample.error_code);
    if (sample.last) listener.on_reply(std::exchange(reply_, Reply{}));
  });
}

Result<void> DdsLink::attach_all(LinkListener& listener) {
  Result<void> attached;
  const auto attach = [&](const auto& reader, std::function<int()> handler) {
    if (attached) attached = loop_->attach(reader.handle(), std::move(handler));
  };
  const auto every = [&](auto& reader, auto deliver) {
    attach(reader, [this, &listener, &reader, deliver] {
      return take(reader, listener, [&](auto message) { (listener.*deliver)(std::move(message)); });
    });
  };
  const auto each = [&](auto reader, auto deliver) { every((*endpoints_).*reader, deliver); };
  // Poses before receipts and states: who waits for a revision finds its poses.
  attach(endpoints_->poses, [&] {
    return take_round(&Endpoints::poses, listener, pose_rounds_, &LinkListener::on_poses);
  });
  attach(endpoints_->landmarks, [&] {
    return take_round(&Endpoints::landmarks, listener, landmark_rounds_,
                      &LinkListener::on_landmarks);
  });
  each(&Endpoints::correction, &LinkListener::on_correction);
  each(&Endpoints::receipt, &LinkListener::on_receipt);
  each(&Endpoints::source_state, &LinkListener::on_source_state);
  each(&Endpoints::payload_receipt, &LinkListener::on_payload_receipt);
  each(&Endpoints::status, &LinkListener::on_status);
  each(&Endpoints::event, &LinkListener::on_event);
  attach(endpoints_->reply, [&] { return take_replies(listener); });
  if (!map_endpoints_) return attached;
  every(map_endpoints_->index, &LinkListener::on_tile_index);
  every(map_endpoints_->tiles, &LinkListener::on_tiles);
  return attached;
}

// Both directions are matched here, and the daemon's reader is the one that has answered.
bool DdsLink::daemon_hears_commands() const {
  dds_publication_matched_status_t commands{};
  dds_subscription_matched_status_t replies{};
  return dds_get_publication_matched_status(endpoints_->command.handle(), &commands) >= 0 &&
         dds_get_subscription_matched_status(endpoints_->reply.handle(), &replies) >= 0 &&
         commands.current_count > 0 && replies.current_count > 0;
}

Result<void> DdsLink::send(const TileRequest& request) {
  if (map_endpoints_) return write(map_endpoints_->request, request);
  return Error{ErrorCode::kUsage, "this client follows no maps"};
}

Result<void> DdsLink::send(const Command& command, int timeout_ms) {
  if (command.text.size() > limits::kText)
    return Error{ErrorCode::kUsage, "the command has more than 1 MB"};
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(timeout_ms);
  while (!daemon_hears_commands()) {
    if (std::chrono::steady_clock::now() > end)
      return Error{ErrorCode::kUnreachable, "no daemon answers in domain " +
                                                std::to_string(options_.domain) +
                                                "; is cairnd running with --domain " +
                                                std::to_string(options_.domain) + "?"};
    dds_sleepfor(DDS_MSECS(1));  // matching has no condition that both ends share
  }
  for (;;) {
    const auto written = write(&Endpoints::command, command);
    if (written || std::chrono::steady_clock::now() > end) return written;
  }
}

}  // namespace

std::unique_ptr<Link> make_dds_link(const DdsLinkOptions& options, Link::Identity identity) {
  return std::make_unique<DdsLink>(options, std::move(identity));
}

}  // namespace cairn
