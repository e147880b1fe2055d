// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "idl/link.hpp"
#include "server/transport.hpp"

namespace cairn {

/// Daemons and clients of one process, connected without middleware but with the wire's manners:
/// the newest of each instance is kept for those who come later, and goes with its writer. For
/// tests and for ThreadSanitizer. Copies are the same network.
class MemoryNetwork {
 public:
  MemoryNetwork();

  [[nodiscard]] std::unique_ptr<Transport> make_transport() const;
  [[nodiscard]] std::unique_ptr<Link> make_link(Link::Identity identity) const;

  struct State;

 private:
  std::shared_ptr<State> state_;
};

}  // namespace cairn
