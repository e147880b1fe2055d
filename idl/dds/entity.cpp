// SPDX-License-Identifier: BSD-3-Clause
#include "idl/dds/entity.hpp"

#include <shipped_configurations.hpp>

#include <cstdlib>
#include <map>
#include <mutex>

namespace cairn::dds {
namespace {

constexpr std::uint32_t kLastDomain = 230;  // ports of higher ones lie above 65535

std::mutex
    domains_mutex;  // held while a domain is made or ends: the middleware refuses both at once

std::map<std::uint32_t, std::weak_ptr<Entity>>& domains() {
  static std::map<std::uint32_t, std::weak_ptr<Entity>> all;
  return all;
}

// The shipped configuration for this domain, or null where the environment or somebody else in this
// process has configured it.
Result<std::shared_ptr<Entity>> configure(std::uint32_t domain, Network network) {
  if (const char* uri = std::getenv("CYCLONEDDS_URI"); uri != nullptr && *uri != '\0')
    return std::shared_ptr<Entity>();
  std::weak_ptr<Entity>& known = domains()[domain];
  if (auto living = known.lock()) return living;
  const dds_entity_t handle = dds_create_domain(
      domain, network == Network::kRadio ? kRadioConfiguration : kLoopbackConfiguration);
  if (handle == DDS_RETCODE_PRECONDITION_NOT_MET) return std::shared_ptr<Entity>();
  if (handle < 0) return to_error(handle, "cannot set up DDS domain " + std::to_string(domain));
  const std::shared_ptr<Entity> made(new Entity(handle), [](Entity* entity) {
    const std::lock_guard lock(domains_mutex);
    delete entity;
  });
  known = made;
  return made;
}

}  // namespace

Error to_error(dds_return_t code, const std::string& what) {
  return {ErrorCode::kUnreachable, what + ": " + dds_strretcode(code) + " (Cyclone DDS)"};
}

Result<Participant> Participant::open(std::uint32_t domain, Network network) {
  if (domain > kLastDomain)
    return Error{ErrorCode::kUsage, "domain is " + std::to_string(domain) + "; expected 0 to " +
                                        std::to_string(kLastDomain)};
  std::shared_ptr<Entity> configured;
  {
    const std::lock_guard lock(domains_mutex);
    auto result = configure(domain, network);
    if (!result) return result.error();
    configured = std::move(*result);
  }
  const dds_entity_t handle = dds_create_participant(domain, nullptr, nullptr);
  if (handle < 0)
    return to_error(handle, "cannot join DDS domain " + std::to_string(domain) +
                                " (is the network interface up? are more than 32 programs in it?)");
  return Participant(std::move(configured), Entity(handle));
}

}  // namespace cairn::dds
