// SPDX-License-Identifier: BSD-3-Clause
#include "server/commands.hpp"

#include <algorithm>
#include <filesystem>

namespace cairn {
namespace {

// Answers that may have to be said again. Longer ones are worked out again.
constexpr std::size_t kRemembered = 64, kRememberedBytes = 64u << 10;
constexpr std::size_t kMostOpen = 32;
// What the middleware holds for slow readers is bounded, too.
constexpr std::size_t kLongestAnswer = 192u << 20;

Result<std::string> back_up(const Question& question, const Journal& journal) {
  if (const auto known = question.check_options({"folder"}); !known) return known.error();
  const std::string folder = question.text("folder");
  if (!std::filesystem::path(folder).is_absolute()) {
    return Error{ErrorCode::kUsage,
                 "backup expects the option folder: an absolute path on the daemon's machine"};
  }
  const Revision head = journal.head().revision;
  if (const Result<void> made = journal.backup(folder); !made) return made.error();
  return "backed up revision " + to_string(head) + " or later to " + folder + '\n';
}

}  // namespace

void CommandDesk::take(const Command& command, const PoseGraph& map) {
  const std::lock_guard lock(mutex_);
  const auto is_it = [&](const auto& other) { return other.key == command.key; };
  if (const auto known = std::find_if(answered_.begin(), answered_.end(), is_it);
      known != answered_.end())
    return transport_.reply(*known);
  if (std::any_of(open_.begin(), open_.end(),
                  [&](const Open& open) { return is_it(open.command); }))
    return;
  if (open_.size() >= kMostOpen) {
    return transport_.reply(
        {command.key, ErrorCode::kNotUsable,
         std::to_string(kMostOpen) + " questions wait for their answers already; ask again later"});
  }
  open_.push_back({command, map});
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  wake_.notify_one();
}

bool CommandDesk::repeat(const CommandKey& key) {
  const std::lock_guard lock(mutex_);
  const auto known = std::find_if(answered_.begin(), answered_.end(),
                                  [&](const Reply& reply) { return reply.key == key; });
  if (known == answered_.end()) return false;
  transport_.reply(*known);
  return true;
}

void CommandDesk::answer(const Reply& reply) {
  {
    const std::lock_guard lock(mutex_);
    remember(reply);
  }
  transport_.reply(reply);
}

bool CommandDesk::stop(std::optional<std::chrono::milliseconds> patience) {
  {
    std::unique_lock lock(mutex_);
    stopping_ = true;
    wake_.notify_all();
    if (patience && !wake_.wait_for(lock, *patience, [this] { return !busy_; })) return false;
  }
  if (thread_.joinable()) thread_.join();
  return true;
}

void CommandDesk::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return stopping_ || !open_.empty(); });
    if (stopping_) return;
    busy_ = true;
    const Open& next = open_.front();  // take() adds behind it, and nobody else removes
    lock.unlock();
    const Reply reply = answer_one(next);
    lock.lock();
    // Before it is sent: who asks again as soon as the answer is out must get one, too.
    remember(reply);
    open_.pop_front();
    lock.unlock();
    if (!stopping_) transport_.reply(reply);
    lock.lock();
    busy_ = false;
    wake_.notify_all();
  }
}

Reply CommandDesk::answer_one(const Open& open) const {
  const auto done = [&]() -> Result<std::string> {
    const Result<Question> question = Question::parse(open.command.text);
    if (!question) return question.error();
    if (question->verb == "backup") return back_up(*question, journal_);
    return cairn::answer(*question, {journal_, [&] { return Result<PoseGraph>(open.map); },
                                     [this] { return !stopping_; }});
  }();
  if (done && done->size() > kLongestAnswer) {
    return {open.command.key, ErrorCode::kNotUsable,
            "the answer has " + std::to_string(done->size() >> 20) +
                " MB, more than travels at once; ask for less or, with --data, a restored backup"};
  }
  if (done) return {open.command.key, {}, *done};
  return {open.command.key, done.error().code, done.error().to_string()};
}

void CommandDesk::remember(const Reply& reply) {
  if (reply.text.size() > kRememberedBytes) return;
  answered_.push_back(reply);
  if (answered_.size() > kRemembered) answered_.pop_front();
}

}  // namespace cairn
