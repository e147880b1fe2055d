// SPDX-License-Identifier: BSD-3-Clause
// cairnd that ends itself by SIGKILL at a named point: killable_daemon DATA DOMAIN POINT COUNT
// TOLD. The POINT is passed COUNT times; its name goes into the file TOLD first. Solves, snapshots
// and table files come often, so that few transactions pass all points.
#include <fcntl.h>
#include <rocksdb/file_system.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <string>

#include "server/daemon.hpp"

namespace cairn {
namespace {

class Fate {
 public:
  Fate(std::string point, long count, std::string told)
      : point_(std::move(point)), left_(count), told_(std::move(told)) {}

  void pass(std::string_view point) {
    if (point != point_ || left_.fetch_sub(1) != 1) return;
    const int file = open(told_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (write(file, point_.data(), point_.size()) > 0) kill(getpid(), SIGKILL);
    pause();
  }

 private:
  std::string point_;
  std::atomic<long> left_;
  std::string told_;
};

// A table, log or MANIFEST file of the store begins.
class FatalFiles final : public rocksdb::FileSystemWrapper {
 public:
  explicit FatalFiles(Fate& fate)
      : FileSystemWrapper(rocksdb::FileSystem::Default()), fate_(fate) {}
  [[nodiscard]] const char* Name() const override { return "FatalFiles"; }

  rocksdb::IOStatus NewWritableFile(const std::string& name, const rocksdb::FileOptions& options,
                                    std::unique_ptr<rocksdb::FSWritableFile>* file,
                                    rocksdb::IODebugContext* debug) override {
    const rocksdb::IOStatus status = target()->NewWritableFile(name, options, file, debug);
    fate_.pass("new-file");
    return status;
  }

 private:
  Fate& fate_;
};

std::string_view name_of(ServicePoint point) {
  switch (point) {
    case ServicePoint::kReplayingRecord:
      return "recovery";
    case ServicePoint::kBeforeCommit:
      return "before-commit";
    case ServicePoint::kCommitted:
      return "committed";
    case ServicePoint::kSolving:
      return "solving";
    case ServicePoint::kMeasuringTrust:
      return "measuring-trust";
    case ServicePoint::kBeforeSnapshot:
      return "before-snapshot";
    case ServicePoint::kSnapshotWritten:
      break;
  }
  return "snapshot-written";
}

int run(char** argv) {
  Fate fate(argv[3], std::strtol(argv[4], nullptr, 10), argv[5]);
  DaemonConfig config;
  config.domain = static_cast<std::uint32_t>(std::strtoul(argv[2], nullptr, 10));
  config.log_from = Severity::kError;
  config.service.solve_after_pause = std::chrono::milliseconds(20);
  config.service.snapshot_every = 20;
  config.service.on_point = [&](ServicePoint point) { fate.pass(name_of(point)); };
  JournalOptions journal;
  journal.file_system = std::make_shared<FatalFiles>(fate);
  journal.write_buffer_bytes = 64u << 10;
  return run_daemon(argv[1], config, journal);
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return argc == 6 ? cairn::run(argv) : 2; }
