// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/host/frame_source.hpp"

#include <utility>
#include <vector>

#include "frontends/carmen/carmen_log.hpp"

namespace cairn {
namespace {

class LogSource final : public FrameSource {
 public:
  explicit LogSource(std::vector<LaserScan> scans) : scans_(std::move(scans)) {}
  Result<std::optional<SensorFrame>> next() override {
    if (next_ == scans_.size()) return std::optional<SensorFrame>();
    return std::optional<SensorFrame>(std::move(scans_[next_++]));
  }

 private:
  std::vector<LaserScan> scans_;
  std::size_t next_ = 0;
};

}  // namespace

Result<std::unique_ptr<FrameSource>> open_log(const std::string& path) {
  std::vector<LaserScan> scans;
  const Result<void> read =
      read_carmen_log(path, [&](LaserScan&& scan) { scans.push_back(std::move(scan)); });
  if (!read) return read.error();
  if (scans.empty())
    return Error{ErrorCode::kBadInput,
                 "no laser scan in it; expected FLASER or ROBOTLASER1 lines of a CARMEN log", path};
  return std::unique_ptr<FrameSource>(std::make_unique<LogSource>(std::move(scans)));
}

}  // namespace cairn
