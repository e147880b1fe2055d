// SPDX-License-Identifier: BSD-3-Clause
// Code in a README.md is copied from a file that is compiled: a block of C++ that follows the line
//   <!-- compiled in tests/graph/own_factor_test.cpp -->
// must occur in that file, but for indentation.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Example {
  std::string place;  // README.md:line
  std::string source;
  std::string code;
};

std::string trimmed(const std::string& line) {
  const std::size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string::npos) return "";
  return line.substr(begin, line.find_last_not_of(" \t\r") - begin + 1);
}

std::string without_indentation(std::istream& text) {
  std::string line, result;
  while (std::getline(text, line)) result += trimmed(line) + "\n";
  return result;
}

std::vector<Example> examples_in(const fs::path& readme) {
  const std::string kMarker = "<!-- compiled in ";
  std::vector<Example> examples;
  std::ifstream file(readme);
  std::string line, source;
  bool inside = false;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.rfind(kMarker, 0) == 0)
      source = line.substr(kMarker.size(), line.find(" -->") - kMarker.size());
    if (inside && line.rfind("```", 0) == 0) inside = false;
    if (inside) examples.back().code += trimmed(line) + "\n";
    if (line.rfind("```cpp", 0) == 0 && !source.empty()) {
      examples.push_back({readme.string() + ":" + std::to_string(number), source, ""});
      source.clear();
      inside = true;
    }
  }
  return examples;
}

TEST(ReadmeExamples, AreTheCodeThatIsCompiled) {
  const fs::path root = CAIRN_SOURCE_DIR;
  std::size_t count = 0;
  for (const char* folder : {"backend", "clients", "datasets", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (entry.path().filename() != "README.md") continue;
      for (const Example& example : examples_in(entry.path())) {
        ++count;
        std::ifstream source(root / example.source);
        ASSERT_TRUE(source) << example.place << ": " << example.source << " does not exist";
        EXPECT_NE(without_indentation(source).find(example.code), std::string::npos)
            << example.place << ": this is not in " << example.source << " any more:\n"
            << example.code;
      }
    }
  }
  EXPECT_GE(count, 3u);
}

}  // namespace
