// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dds/dds.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "cairn/core/result.hpp"

/// A thin layer over Cyclone DDS's C interface: ownership, results instead of codes, and one way to
/// take samples. Return codes end here.
namespace cairn::dds {

/// kUnreachable with what was tried and the middleware's words for `code`.
Error to_error(dds_return_t code, const std::string& what);

/// Owns a DDS entity (and with it everything made from it).
class Entity {
 public:
  Entity() = default;
  explicit Entity(dds_entity_t handle) : handle_(handle) {}
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Entity() {
    if (handle_ > 0) dds_delete(handle_);
  }
  [[nodiscard]] dds_entity_t handle() const { return handle_; }

 private:
  dds_entity_t handle_ = 0;
};

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

/// Datagrams of 64 kB for this machine or a wired network, or of 1400 bytes for radio links.
enum class Profile { kLocal, kRadio };

/// Which shipped configuration holds, and on which network interface, unless the environment sets
/// CYCLONEDDS_URI.
struct Network {
  Profile profile = Profile::kLocal;
  std::string interface {};  ///< "eth0"; empty: loopback, for radio the machine's first
};

/// Told, from threads of the middleware, of peers that do not fit and writes that failed.
using TroubleHandler = std::function<void(Error)>;

/// When what a process writes leaves it.
enum class Sending {
  kAtOnce,
  kOnFlush,  ///< many samples share a datagram; holds for all of the process, also for writers that
             ///< are not ours and do not know
};

/// One participant of a domain. The first of a process in a domain sets that domain up; the last
/// one tears it down.
class Participant {
 public:
  static Result<Participant> open(std::uint32_t domain, const Network& network,
                                  Sending sending = Sending::kAtOnce);
  Participant(Participant&&) noexcept = default;
  Participant& operator=(Participant&&) = delete;

  [[nodiscard]] dds_entity_t handle() const { return entity_.handle(); }

 private:
  Participant(std::shared_ptr<Entity> domain, Entity entity)
      : domain_(std::move(domain)), entity_(std::move(entity)) {}

  std::shared_ptr<Entity> domain_;  // null where another library of the process made the domain
  Entity entity_;
};

/// Nothing this process sends in the domain leaves it, and nothing reaches it, for so long: a link
/// outage, for tests and demonstrations. Returns at once. The process is in the domain already.
Result<void> cut_link(std::uint32_t domain, std::chrono::milliseconds time);

}  // namespace cairn::dds
