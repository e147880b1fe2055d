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
    }
    return *shared;
  }

  std::vector<std::shared_ptr<Chunk>> chunks_;
  std::size_t size_ = 0;
};

}  // namespace cairn
