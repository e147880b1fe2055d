// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace cairn::test {

/// What a finished program did.
struct ProcessResult {
  int exit_code = -1;  ///< 128 + signal when one ended it
  std::string out;     ///< standard output
  std::string err;     ///< standard error
};

/// A program that runs beside the test, with its streams in files.
class Process {
 public:
  /// Starts `arguments` (the first is the program) in `folder` with `input` on standard input.
  Process(const std::vector<std::string>& arguments, const std::string& input = "",
          const std::string& folder = ".") {
    const std::string stdin_path = streams_.write("in", input);
    pid_ = fork();
    if (pid_ != 0) return;
    const bool ready = chdir(folder.c_str()) == 0 && redirect(stdin_path, O_RDONLY, STDIN_FILENO) &&
                       redirect(streams_.file("out"), O_WRONLY | O_CREAT, STDOUT_FILENO) &&
                       redirect(streams_.file("err"), O_WRONLY | O_CREAT, STDERR_FILENO);
    std::vector<char*> words;
    for (const std::string& argument : arguments)
      words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    if (ready) execv(words[0], words.data());
    _exit(127);
  }
  Process() = default;  ///< none
  Process(Process&& other) noexcept : Process() { swap(other); }
  Process& operator=(Process&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Process() {
    if (pid_ > 0) end(SIGKILL);
  }

  [[nodiscard]] bool runs() const { return pid_ > 0; }
  [[nodiscard]] pid_t id() const { return pid_; }
  void send(int signal_number) const { kill(pid_, signal_number); }
  /// Sends the signal, also to a stopped process, and waits.
  ProcessResult end(int signal_number) {
    send(signal_number);
    send(SIGCONT);
    return wait();
  }
  /// What it wrote to standard output so far.
  [[nodiscard]] std::string out() const { return read_file(streams_.file("out")); }

  ProcessResult wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    return result(status);
  }
  /// Nothing where it still runs after that time.
  std::optional<ProcessResult> wait(std::chrono::milliseconds timeout) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    int status = 0;
    while (waitpid(pid_, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() > deadline) return std::nullopt;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return result(status);
  }

 private:
  void swap(Process& other) noexcept {
    std::swap(streams_, other.streams_);
    std::swap(pid_, other.pid_);
  }
  ProcessResult result(int status) {
    pid_ = 0;
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return {code, out(), read_file(streams_.file("err"))};
  }
  static bool redirect(const std::string& path, int flags, int descriptor) {
    const int file = open(path.c_str(), flags, 0600);
    return file >= 0 && dup2(file, descriptor) == descriptor;
  }

  TemporaryFolder streams_;
  pid_t pid_ = 0;
};

/// Runs the `cairn` of this build and waits for it. Needs CAIRN_BINARY.
#ifdef CAIRN_BINARY
inline std::vector<std::string> cairn_command(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), CAIRN_BINARY);
  return arguments;
}
inline ProcessResult run_cairn(const std::vector<std::string>& arguments,
                               const std::string& input = "", const std::string& folder = ".") {
  return Process(cairn_command(arguments), input, folder).wait();
}
#endif

}  // namespace cairn::test
