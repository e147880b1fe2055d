// SPDX-License-Identifier: BSD-3-Clause
#include "idl/dds/entity.hpp"

#include <shipped_configurations.hpp>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "cairn/core/check.hpp"

namespace cairn::dds {
namespace {

constexpr std::uint32_t kLastDomain = 230;  // ports of higher ones lie above 65535

std::mutex
    domains_mutex;  // held while a domain is made or ends: the middleware refuses both at once

std::map<std::uint32_t, std::weak_ptr<Entity>>& domains() {
  static std::map<std::uint32_t, std::weak_ptr<Entity>> all;
  return all;
}

void replace(std::string& text, std::string_view part, const std::string& by) {
  const std::size_t at = text.find(part);
  CAIRN_CHECK(at != std::string::npos, "a shipped configuration does not look as it did");
  text.replace(at, part.size(), by);
}

// The shipped configuration, on the interface that is asked for.
std::string configuration_of(const Network& network, Sending sending) {
  const bool radio = network.profile == Profile::kRadio;
  std::string text = radio ? kRadioConfiguration : kLoopbackConfiguration;
  if (sending == Sending::kOnFlush)
    replace(text, "<Internal>", "<Internal><WriteBatch>true</WriteBatch>");
  if (network.interface.empty()) return text;
  const std::string interface = "<NetworkInterface name=\"" + network.interface + "\"/>";
  if (radio) {
    replace(text, "<General>", "<General><Interfaces>" + interface + "</Interfaces>");
  } else {
    replace(text, R"(<NetworkInterface name="lo" multicast="false"/>)", interface);
    replace(text, "<AllowMulticast>false<", "<AllowMulticast>spdp<");
    replace(text, R"(<Peers><Peer Address="127.0.0.1"/></Peers>)", "");
  }
  return text;
}

Result<void> check_interface(const std::string& name) {
  const bool sound = name.size() <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
                       return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' ||
                              c == ':' || c == '-' || c == '_';
                     });
  if (sound) return {};
  return Error{ErrorCode::kUsage,
               "'" + name + "' is no name of a network interface; see `ip link`"};
}

// The shipped configuration for this domain, or null where the environment or somebody else in this
// process has configured it.
Result<std::shared_ptr<Entity>> configure(std::uint32_t domain, const Network& network,
                                          Sending sending) {
  if (const char* uri = std::getenv("CYCLONEDDS_URI"); uri != nullptr && *uri != '\0')
    return std::shared_ptr<Entity>();
  std::weak_ptr<Entity>& known = domains()[domain];
  if (auto living = known.lock()) return living;
  if (auto sound = check_interface(network.interface); !sound) return sound.error();
  const dds_entity_t handle = dds_create_domain(domain, configuration_of(network, sending).c_str());
  if (handle == DDS_RETCODE_PRECONDITION_NOT_MET) return std::shared_ptr<Entity>();
  if (handle < 0)
    return to_error(handle, "cannot set up DDS domain " + std::to_string(domain) +
                                (network.interface.empty()
                                     ? ""
                                     : " (is there an interface " + network.interface + "?)"));
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

Result<Participant> Participant::open(std::uint32_t domain, const Network& network,
                                      Sending sending) {
  if (domain > kLastDomain)
    return Error{ErrorCode::kUsage, "domain is " + std::to_string(domain) + "; expected 0 to " +
                                        std::to_string(kLastDomain)};
  std::shared_ptr<Entity> configured;
  {
    const std::lock_guard lock(domains_mutex);
    auto result = configure(domain, network, sending);
    if (!result) return result.error();
    configured = std::move(*result);
  }
  const dds_entity_t handle = dds_create_participant(domain, nullptr, nullptr);
  if (handle < 0)
    return to_error(handle, "cannot join DDS domain " + std::to_string(domain) +
                                " (is the network interface up? are more than 32 programs in it?)");
  return Participant(std::move(configured), Entity(handle));
}

Result<void> cut_link(std::uint32_t domain, std::chrono::milliseconds time) {
  const Entity participant(dds_create_participant(domain, nullptr, nullptr));
  const auto code =
      participant.handle() < 0
          ? participant.handle()
          : dds_domain_set_deafmute(participant.handle(), true, true, DDS_MSECS(time.count()));
  if (code < 0) return to_error(code, "cannot cut the link of domain " + std::to_string(domain));
  return {};
}

}  // namespace cairn::dds
