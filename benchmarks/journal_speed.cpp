// SPDX-License-Identifier: BSD-3-Clause
// How fast does the journal make records durable, and start? JOURNAL_FOLDER names the disk.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "cairn/core/stopwatch.hpp"
#include "cairn/journal/journal.hpp"
#include "tests/support/transactions.hpp"

namespace {

namespace fs = std::filesystem;
using namespace cairn;

double percentile_ms(std::vector<double> seconds, double part) {
  std::sort(seconds.begin(), seconds.end());
  return 1e3 * seconds[static_cast<std::size_t>(part * static_cast<double>(seconds.size() - 1))];
}

std::vector<RecordBody> records(std::uint64_t first, std::uint64_t count) {
  std::vector<RecordBody> records;
  for (std::uint64_t n = first; n < first + count; ++n)
    records.push_back(TransactionRecord{test::some_transaction(n), {}, 0});
  return records;
}

std::unique_ptr<Journal> open_or_exit(const std::string& folder) {
  auto journal = Journal::open(folder);
  if (journal) return std::move(*journal);
  std::fprintf(stderr, "%s\n", journal.error().to_string().c_str());
  std::exit(1);
}

void measure_disk(const std::string& folder) {
  const std::string block(600, 'x'), file = folder + "/fdatasync";
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  std::vector<double> seconds;
  for (int i = 0; i < 1000; ++i) {
    const Stopwatch watch;
    if (::write(descriptor, block.data(), block.size()) < 0 || ::fdatasync(descriptor) < 0) break;
    seconds.push_back(watch.seconds());
  }
  ::close(descriptor);
  std::printf("fdatasync of 600 bytes: p50 %.2f ms, p99 %.2f ms\n\n", percentile_ms(seconds, 0.5),
              percentile_ms(seconds, 0.99));
}

void measure_appends(const std::string& folder, std::uint64_t group) {
  const auto journal = open_or_exit(folder + "/group-" + std::to_string(group));
  std::vector<double> seconds;
  const Stopwatch whole;
  std::uint64_t next = 1;
  for (; whole.seconds() < 5.0; next += group) {
    const std::vector<RecordBody> batch = records(next, group);
    const Stopwatch watch;
    if (!journal->append(batch)) std::exit(1);
    seconds.push_back(watch.seconds());
  }
  std::printf("| %llu | %.0f | %.2f | %.2f |\n", static_cast<unsigned long long>(group),
              static_cast<double>(next - 1) / whole.seconds(), percentile_ms(seconds, 0.5),
              percentile_ms(seconds, 0.99));
}

void measure_start(const std::string& folder) {
  constexpr std::uint64_t kRecords = 100'000;
  {
    const auto journal = open_or_exit(folder);
    for (std::uint64_t n = 1; n <= kRecords; n += 250)
      if (!journal->append(records(n, 250))) std::exit(1);
  }
  for (const bool snapshot : {false, true}) {
    if (snapshot && !open_or_exit(folder)->write_snapshot(kRecords, std::string(8u << 20, 's')))
      std::exit(1);
    const Stopwatch watch;
    const auto journal = open_or_exit(folder);
    const double opened = watch.seconds();
    const std::uint64_t from = snapshot ? journal->newest_snapshot()->number + 1 : 1;
    if (!journal->for_each(from, [](const Record&) -> Result<void> { return {}; })) std::exit(1);
    std::printf("start with 100,000 transactions, %s snapshot: open %.2f s, with decoding %.2f s\n",
                snapshot ? "with a" : "without", opened, watch.seconds());
  }
}

}  // namespace

int main() {
  const char* given = std::getenv("JOURNAL_FOLDER");
  const std::string folder = std::string(given ? given : ".") + "/journal-benchmark";
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::printf("## Journal speed\nAn encoded record has %zu bytes.\n",
              encode_record(2, 0, records(2, 1)[0], {}).size());
  measure_disk(folder);
  std::printf("| group | durable records/s | commit p50, ms | p99, ms |\n|---|---|---|---|\n");
  for (const std::uint64_t group : {1, 25, 256}) measure_appends(folder, group);
  std::printf("\n");
  measure_start(folder + "/start");
  fs::remove_all(folder);
  return 0;
}
