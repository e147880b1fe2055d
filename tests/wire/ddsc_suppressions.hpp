// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// ThreadSanitizer does not see the locks inside libddsc, which Debian builds without it. Its races
// are suppressed, ours are not.
#if defined(__SANITIZE_THREAD__)
extern "C" inline const char* __tsan_default_suppressions();
extern "C" inline __attribute__((used)) const char* __tsan_default_suppressions() {
  return "race:libddsc.so\nmutex:libddsc.so\ndeadlock:libddsc.so\n";
}
#endif
