// SPDX-License-Identifier: BSD-3-Clause
// What arrives, until the deciding thread looks at it: bounded by bytes.
#include <utility>

#include "server/service.hpp"

namespace cairn {
namespace {

// For names of spools that were answered while the inbox was full.
constexpr std::size_t kRoomForNames = 1u << 20;

constexpr const char* kBehind = "the daemon is behind; what has arrived fills its memory";

}  // namespace

void Service::on_transaction(Transaction transaction, const Sender& sender) {
  post(make_arrival(std::move(transaction)), sender);
}
void Service::on_unreadable_transaction(UnreadableTransaction transaction, const Sender& sender) {
  Arrival arrival;
  arrival.transaction.key = std::move(transaction.key);
  arrival.hash = transaction.content;
  arrival.bytes = sizeof(Arrival) + transaction.reason.size();
  arrival.fault = Refusal{transaction.code, std::move(transaction.reason)};
  post(std::move(arrival), sender);
}
// Clients say it again.
void Service::on_client(ClientState client, const Sender& sender) {
  const std::size_t bytes = sizeof(Message) + client.source.size() + client.robot.size();
  std::string source = client.source;
  if (admit(Seen{std::move(client), sender}, bytes)) return;
  on_trouble({ErrorCode::kNotUsable, kBehind, "source " + std::move(source)});
}
void Service::on_source_lost(std::string source, const Sender& sender) {
  post(Lost{std::move(source), sender.writer});
}
void Service::on_payload(Payload payload, const Sender& sender) {
  post(Brought{std::move(payload), sender});
}
void Service::on_unreadable_payload(Payload payload, std::string reason, const Sender& sender) {
  post(Brought{std::move(payload), sender, std::move(reason)});
}
void Service::on_command(Command command) {
  const CommandKey key = command.key;
  const std::size_t bytes = sizeof(Message) + command.text.size();
  if (admit(std::move(command), bytes)) return;
  transport_.reply({key, ErrorCode::kNotUsable, std::string("busy: ") + kBehind});
}

void Service::on_tile_request(TileRequest request) { maps_.take(std::move(request)); }

// What must not be refused: ends of writers, and solves, of which there is one at a time.
void Service::post(Message message) {
  {
    const std::lock_guard lock(mutex_);
    inbox_.push_back(std::move(message));
  }
  wake_.notify_one();
}

// Moves from `message` where there is room.
bool Service::admit(Message&& message, std::size_t bytes, std::size_t room) {
  {
    const std::lock_guard lock(mutex_);
    if (inbox_bytes_ + bytes > options_.inbox_bytes + room) return false;
    inbox_bytes_ += bytes;
    inbox_.push_back(std::move(message));
  }
  wake_.notify_one();
  return true;
}

void Service::post(Arrival arrival, const Sender& sender) {
  const Receipt refusal{.key = arrival.transaction.key,
                        .revision = {},
                        .refusal = RefusalCode::kOverBudget,
                        .reason = kBehind};
  const std::size_t bytes = arrival.bytes;
  if (admit(Arrived{std::move(arrival), sender, std::chrono::steady_clock::now()}, bytes)) return;
  transport_.publish_receipts({refusal});
  answered_unread({refusal.key.source, refusal.key.epoch});
}

void Service::post(Brought brought) {
  const Payload unread{.source = brought.payload.source,
                       .epoch = brought.payload.epoch,
                       .number = brought.payload.number,
                       .hash = brought.payload.hash};
  const std::size_t bytes = sizeof(Message) + brought.payload.bytes.size() + brought.fault.size();
  if (admit(std::move(brought), bytes)) return;
  payloads_.answer(unread, PayloadAnswer::kBusy, kBehind);
  answered_unread({unread.source, unread.epoch});
}

// The middleware keeps the answer until the spool is forgotten, so it must be known.
void Service::answered_unread(const Writers::Spool& spool) {
  if (!admit(Heard{spool}, sizeof(Message) + spool.first.size(), kRoomForNames))
    transport_.forget(spool.first, spool.second);
}

}  // namespace cairn
