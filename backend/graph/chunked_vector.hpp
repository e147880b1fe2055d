// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace cairn {

/// An array that is cheap to copy: copies share chunks of elements, and who writes to a shared
/// chunk gets one of his own first. One thread may write to a copy while others read theirs.
template <class T>
class ChunkedVector {
 public:
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const T& operator[](std::size_t i) const {
    return (*chunks_[i / kChunk])[i % kChunk];
  }
  /// For writing.
  [[nodiscard]] T& edit(std::size_t i) { return own(i / kChunk)[i % kChunk]; }
  /// Calls visit(i) for the elements of `before`, an earlier copy that this one may have outgrown,
  /// that are different here. What the copies share is not looked at.
  template <class Visit>
  void for_each_changed(const ChunkedVector& before, const Visit& visit) const {
    for (std::size_t first = 0; first < before.size_; first += kChunk) {
      const auto& now = chunks_[first / kChunk];
      const auto& then = before.chunks_[first / kChunk];
      if (now == then) continue;
      for (std::size_t i = 0; i < then->size(); ++i) {
        if (!((*now)[i] == (*then)[i])) visit(first + i);
      }
    }
  }
  void push_back(T value) {
    if (size_ % kChunk == 0) {
      chunks_.push_back(std::make_shared<Chunk>());
      chunks_.back()->reserve(kChunk);
    }
    own(size_ / kChunk).push_back(std::move(value));
    ++size_;
  }

 private:
  using Chunk = std::vector<T>;
  static constexpr std::size_t kChunk = 2048;

  Chunk& own(std::size_t chunk) {
    std::shared_ptr<Chunk>& shared = chunks_[chunk];
    if (shared.use_count() > 1) {
      auto copy = std::make_shared<Chunk>();
      copy->reserve(kChunk);
      *copy = *shared;
      shared = std::move(copy);
    } else {
      // use_count() orders nothing. To give up another share does: what a thread read from a copy
      // before it dropped it is read before what is written now.
      std::shared_ptr<Chunk>(shared).reset();
    }
    return *shared;
  }

  std::vector<std::shared_ptr<Chunk>> chunks_;
  std::size_t size_ = 0;
};

}  // namespace cairn
