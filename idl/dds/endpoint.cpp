// SPDX-License-Identifier: BSD-3-Clause
#include "idl/dds/endpoint.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace cairn::dds {
namespace {

struct ListenerDeleter {
  void operator()(dds_listener_t* listener) const { dds_delete_listener(listener); }
};
using Listener = std::unique_ptr<dds_listener_t, ListenerDeleter>;

void report_misfit(dds_entity_t endpoint, std::uint32_t policy, void* argument) {
  std::array<char, 128> name{};
  const dds_entity_t topic = dds_get_topic(endpoint);
  if (topic > 0) dds_get_name(topic, name.data(), name.size());
  const auto& trouble = *static_cast<const TroubleHandler*>(argument);
  if (trouble)
    trouble({ErrorCode::kUnreachable,
             "a peer's quality of service or type does not fit (DDS policy " +
                 std::to_string(policy) + "); " +
                 (std::string_view(name.data()).starts_with("rt/")
                      ? "what fits stands in idl/README.md, ROS 2"
                      : "is it another version of Cairn?"),
             name.data()});
}

void on_reader_misfit(dds_entity_t reader, const dds_requested_incompatible_qos_status_t status,
                      void* argument) {
  report_misfit(reader, status.last_policy_id, argument);
}
void on_writer_misfit(dds_entity_t writer, const dds_offered_incompatible_qos_status_t status,
                      void* argument) {
  report_misfit(writer, status.last_policy_id, argument);
}

// Attached when the endpoint is made: what happens before a later attachment is never told.
Listener make_listener(Endpoint::Role role, const TroubleHandler* trouble) {
  Listener listener(dds_create_listener(const_cast<TroubleHandler*>(trouble)));
  if (role == Endpoint::Role::kReader)
    dds_lset_requested_incompatible_qos(listener.get(), on_reader_misfit);
  else
    dds_lset_offered_incompatible_qos(listener.get(), on_writer_misfit);
  return listener;
}

std::int32_t depth_of(Traffic traffic) {
  if (traffic == Traffic::kSensor) return 20;
  return traffic == Traffic::kTransforms || traffic == Traffic::kFixedTransforms ? 100 : 1;
}

}  // namespace

Qos make_qos(Traffic traffic) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(
      qos.get(),
      traffic == Traffic::kSensor ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE,
      DDS_MSECS(100));
  dds_qset_writer_data_lifecycle(qos.get(), false);  // who dies has not deleted anything
  if (traffic == Traffic::kEvery)
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
  else
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth_of(traffic));
  if (traffic == Traffic::kLatest || traffic == Traffic::kFixedTransforms) {
    dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, depth_of(traffic),
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  return qos;
}

Result<Endpoint> Endpoint::make(const Participant& participant, const Description& description,
                                Role role, const TroubleHandler* trouble, Filter filter) {
  const std::string what = "cannot open topic " + std::string(description.name);
  Entity topic(
      dds_create_topic(participant.handle(), description.type, description.name, nullptr, nullptr));
  if (topic.handle() < 0) return to_error(topic.handle(), what);
  if (filter.keep != nullptr) {
    dds_topic_filter extended{};
    extended.mode = DDS_TOPIC_FILTER_SAMPLE_ARG;
    extended.f.sample_arg = filter.keep;
    extended.arg = filter.argument;
    if (const auto code = dds_set_topic_filter_extended(topic.handle(), &extended); code < 0)
      return to_error(code, what);
  }
  const Qos qos = make_qos(description.traffic);
  const Listener listener = make_listener(role, trouble);
  Entity endpoint(
      role == Role::kReader
          ? dds_create_reader(participant.handle(), topic.handle(), qos.get(), listener.get())
          : dds_create_writer(participant.handle(), topic.handle(), qos.get(), listener.get()));
  if (endpoint.handle() < 0) return to_error(endpoint.handle(), what);
  return Endpoint(std::move(topic), std::move(endpoint));
}

Result<std::unique_ptr<WaitLoop>> WaitLoop::make(const Participant& participant) {
  Entity waitset(dds_create_waitset(participant.handle()));
  if (waitset.handle() < 0) return to_error(waitset.handle(), "cannot make a waitset");
  Entity guard(dds_create_guardcondition(participant.handle()));
  if (guard.handle() < 0) return to_error(guard.handle(), "cannot make a guard condition");
  if (const auto code = dds_waitset_attach(waitset.handle(), guard.handle(), -1); code < 0)
    return to_error(code, "cannot attach a guard condition");
  return std::unique_ptr<WaitLoop>(new WaitLoop(std::move(waitset), std::move(guard)));
}

Result<void> WaitLoop::attach(dds_entity_t reader, std::function<int()> handler) {
  Entity condition(dds_create_readcondition(reader, DDS_ANY_STATE));
  if (condition.handle() < 0) return to_error(condition.handle(), "cannot make a read condition");
  if (const auto code = dds_waitset_attach(waitset_.handle(), condition.handle(),
                                           static_cast<dds_attach_t>(sources_.size()));
      code < 0)
    return to_error(code, "cannot attach a read condition");
  sources_.push_back({std::move(condition), std::move(handler)});
  return {};
}

void WaitLoop::run(const TroubleHandler& trouble) {
  std::vector<dds_attach_t> ready(sources_.size() + 1);
  while (!stopped_) {
    const auto count =
        dds_waitset_wait(waitset_.handle(), ready.data(), ready.size(), DDS_INFINITY);
    if (count < 0) return trouble(to_error(count, "cannot wait for messages"));
    std::sort(ready.begin(), ready.begin() + count);  // who was attached first goes first
    for (int i = 0; i < count && !stopped_; ++i) {
      if (ready[i] < 0) continue;
      if (const int code = sources_[ready[i]].handler(); code < 0)
        trouble(to_error(code, "cannot take messages"));
    }
  }
}

void WaitLoop::stop() {
  stopped_ = true;
  dds_set_guardcondition(guard_.handle(), true);
}

}  // namespace cairn::dds
