// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "idl/dds/topics.hpp"

namespace cairn::dds {

/// Keeps samples for which it returns false out of a reader. Runs on threads of the middleware.
struct Filter {
  bool (*keep)(const void* sample, void* argument) = nullptr;
  void* argument = nullptr;  ///< lives longer than the reader
};

/// Topic, endpoint and the listener that reports peers that do not fit; the non-template part.
class Endpoint {
 public:
  enum class Role { kReader, kWriter };
  struct Description {
    const char* name;
    const dds_topic_descriptor_t* type;
    Traffic traffic;
  };
  /// `trouble` lives longer than the endpoint.
  static Result<Endpoint> make(const Participant& participant, const Description& description,
                               Role role, const TroubleHandler* trouble, Filter filter = {});

  [[nodiscard]] dds_entity_t handle() const { return endpoint_.handle(); }

 private:
  Endpoint(Entity topic, Entity endpoint)
      : topic_(std::move(topic)), endpoint_(std::move(endpoint)) {}

  Entity topic_;
  Entity endpoint_;
};

template <class T>
Endpoint::Description describe() {
  return {Topic<T>::kName, Topic<T>::descriptor(), Topic<T>::kTraffic};
}

/// Writes samples of T. write() may be called from any thread.
template <class T>
class Writer {
 public:
  static Result<Writer> make(const Participant& participant, const TroubleHandler* trouble) {
    return make(participant, describe<T>(), trouble);
  }
  static Result<Writer> make(const Participant& participant,
                             const Endpoint::Description& description,
                             const TroubleHandler* trouble) {
    auto endpoint = Endpoint::make(participant, description, Endpoint::Role::kWriter, trouble);
    if (!endpoint) return endpoint.error();
    return Writer(std::move(*endpoint));
  }
  /// Not OK means not written. DDS_RETCODE_TIMEOUT: a reader is too slow (kEvery only), try again.
  [[nodiscard]] dds_return_t write(const T& sample) const {
    const dds_return_t written = write_held(sample);
    flush();
    return written;
  }
  /// The same, but it may stay here until flush().
  [[nodiscard]] dds_return_t write_held(const T& sample) const {
    return dds_write(endpoint_.handle(), &sample);
  }
  void flush() const { (void)dds_write_flush(endpoint_.handle()); }
  /// Keeps nothing any more of the instance that has the key of `sample`.
  [[nodiscard]] dds_return_t forget(const T& sample) const {
    const dds_instance_handle_t instance = dds_lookup_instance(endpoint_.handle(), &sample);
    if (instance == DDS_HANDLE_NIL) return DDS_RETCODE_OK;
    const dds_return_t gone = dds_unregister_instance_ih(endpoint_.handle(), instance);
    flush();
    return gone;
  }
  [[nodiscard]] dds_entity_t handle() const { return endpoint_.handle(); }

 private:
  explicit Writer(Endpoint endpoint) : endpoint_(std::move(endpoint)) {}
  Endpoint endpoint_;
};

/// How many samples one take may return. Cyclone DDS 0.10.2 writes beyond the caller's array when a
/// reader is ever asked for fewer than before, so this is the only number there is.
constexpr std::uint32_t kTake = 64;

/// Takes samples of T on loan. One thread at a time.
template <class T>
class Reader {
 public:
  static Result<Reader> make(const Participant& participant, const TroubleHandler* trouble,
                             Filter filter = {}) {
    return make(participant, describe<T>(), trouble, filter);
  }
  static Result<Reader> make(const Participant& participant,
                             const Endpoint::Description& description,
                             const TroubleHandler* trouble, Filter filter = {}) {
    auto endpoint =
        Endpoint::make(participant, description, Endpoint::Role::kReader, trouble, filter);
    if (!endpoint) return endpoint.error();
    return Reader(std::move(*endpoint));
  }
  /// Calls `visit(sample, info)` for up to kTake samples, ordered by instance; where
  /// info.valid_data is false only the key can be read. Returns how many, or a negative code.
  template <class Visit>
  int take(Visit visit) {
    void* samples[kTake];
    dds_sample_info_t infos[kTake];
    samples[0] = nullptr;  // ask for a loan
    const int count = dds_take(handle(), samples, infos, kTake, kTake);
    if (count <= 0) return count;
    const Loan loan{handle(), samples, count};
    for (int i = 0; i < count; ++i) visit(*static_cast<const T*>(samples[i]), infos[i]);
    return count;
  }
  [[nodiscard]] dds_entity_t handle() const { return endpoint_.handle(); }

 private:
  struct Loan {
    dds_entity_t reader;
    void** samples;
    int count;
    ~Loan() { (void)dds_return_loan(reader, samples, count); }
  };
  explicit Reader(Endpoint endpoint) : endpoint_(std::move(endpoint)) {}
  Endpoint endpoint_;
};

/// An aggregate of endpoints from their making, or the last error.
template <class Endpoints, class... E>
Result<Endpoints> collect(Result<E>... made) {
  std::optional<Error> error;
  ((made ? void() : void(error = made.error())), ...);
  if (error) return *error;
  return Endpoints{std::move(*made)...};
}

/// Runs handlers of readers on the thread that calls run(), when there is something to take.
class WaitLoop {
 public:
  static Result<std::unique_ptr<WaitLoop>> make(const Participant& participant);

  /// Before run(). `handler` returns how many samples it took, or a negative code.
  Result<void> attach(dds_entity_t reader, std::function<int()> handler);
  /// Returns after stop(). A handler that fails is reported to `trouble`.
  void run(const TroubleHandler& trouble);
  /// From any thread, also before run().
  void stop();

 private:
  struct Source {
    Entity condition;
    std::function<int()> handler;
  };
  WaitLoop(Entity waitset, Entity guard) : waitset_(std::move(waitset)), guard_(std::move(guard)) {}

  Entity waitset_;
  Entity guard_;
  std::vector<Source> sources_;
  std::atomic<bool> stopped_ = false;
};

}  // namespace cairn::dds
