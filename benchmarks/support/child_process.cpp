// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/support/child_process.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>

namespace cairn::bench {
namespace {

[[noreturn]] void become(const std::vector<std::string>& arguments, int output) {
  std::string program = "/proc/self/exe";
  std::vector<char*> argv{program.data()};
  std::vector<std::string> copies = arguments;
  for (std::string& copy : copies) argv.push_back(copy.data());
  argv.push_back(nullptr);
  dup2(output, STDOUT_FILENO);
  execv(program.c_str(), argv.data());
  _exit(127);
}

std::vector<double> read_numbers(int input) {
  std::vector<double> numbers;
  FILE* file = fdopen(input, "r");
  for (double number; std::fscanf(file, "%lf", &number) == 1;) numbers.push_back(number);
  std::fclose(file);
  return numbers;
}

}  // namespace

std::optional<ChildReport> run_this_program(const std::vector<std::string>& arguments) {
  int ends[2];
  if (pipe(ends) != 0) return std::nullopt;
  const pid_t child = fork();
  if (child < 0) return std::nullopt;
  if (child == 0) {
    close(ends[0]);
    become(arguments, ends[1]);
  }
  close(ends[1]);
  ChildReport report;
  report.numbers = read_numbers(ends[0]);
  int status = 0;
  rusage usage{};
  if (wait4(child, &status, 0, &usage) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
    return std::nullopt;
  report.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);  // Linux counts in KiB
  return report;
}

}  // namespace cairn::bench
