// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Rooms = std::set<std::string>;

// Which rooms of the backend each room may include. A room that is not listed fails the test:
// decide, then add it.
const std::map<std::string, Rooms>& allowed_rooms() {
  static const Rooms kModel{"core", "geometry", "graph"};
  static const auto with = [](Rooms rooms, const Rooms& more) {
    rooms.insert(more.begin(), more.end());
    return rooms;
  };
  static const std::map<std::string, Rooms> kAllowed{
      {"core", {}},
      {"geometry", {"core"}},
      {"graph", {"core", "geometry"}},
      {"factors", kModel},
      {"linear", {"core"}},                  // knows no poses
      {"solver", with(kModel, {"linear"})},  // names no concrete factor
      {"maps", {"core", "geometry"}},
      {"drawing", kModel},
      {"io", with(kModel, {"factors", "maps"})},
      {"journal", with(kModel, {"factors"})},
      {"replay", with(kModel, {"factors", "linear", "solver"})},
      {"history", with(kModel, {"factors", "io", "journal", "linear", "maps", "replay", "solver"})},
      {"evaluation", with(kModel, {"factors", "io", "linear", "solver"})},
      {"diagnostics", with(kModel, {"factors", "io", "linear", "solver"})},
  };
  return kAllowed;
}

struct Include {
  std::string file;  // relative to the source tree
  int line;
  std::string header;
};

fs::path source_root() { return CAIRN_SOURCE_DIR; }

bool is_source(const fs::path& path) {
  return path.extension() == ".cpp" || path.extension() == ".hpp";
}

std::vector<fs::path> sources_under(const std::string& folder) {
  std::vector<fs::path> files;
  if (!fs::exists(source_root() / folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(source_root() / folder)) {
    if (entry.is_regular_file() && is_source(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<Include> includes_under(const std::string& folder) {
  std::vector<Include> includes;
  for (const fs::path& path : sources_under(folder)) {
    std::ifstream file(path);
    std::string text;
    for (int line = 1; std::getline(file, text); ++line) {
      if (text.rfind("#include", 0) != 0) continue;
      const std::size_t begin = text.find_first_of("<\""), end = text.find_last_of(">\"");
      if (begin == std::string::npos || end <= begin) continue;
      includes.push_back({fs::relative(path, source_root()).string(), line,
                          text.substr(begin + 1, end - begin - 1)});
    }
  }
  return includes;
}

// The n-th folder of a path: part("backend/io/g2o.cpp", 1) = "io".
std::string part(const std::string& name, int n) {
  const fs::path path(name);
  auto folder = path.begin();
  std::advance(folder, n);
  return folder->string();
}

bool starts_with_any(const std::string& text, const std::vector<std::string>& prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(),
                     [&](const std::string& p) { return text.rfind(p, 0) == 0; });
}

std::string place(const Include& include) {
  return include.file + ":" + std::to_string(include.line);
}

TEST(IncludeDirection, RoomsOfTheBackendIncludeOnlyTheRoomsBelowThem) {
  const std::vector<Include> includes = includes_under("backend");
  ASSERT_GT(includes.size(), 50u) << "the sources were not found under " << source_root();
  for (const Include& include : includes) {
    const std::string room = part(include.file, 1);
    const auto allowed = allowed_rooms().find(room);
    ASSERT_NE(allowed, allowed_rooms().end())
        << place(include) << ": room '" << room << "' has no rule here";
    if (include.header.rfind("cairn/", 0) != 0) continue;
    const std::string other = part(include.header, 1);
    EXPECT_TRUE(other == room || allowed->second.contains(other))
        << place(include) << ": " << room << " must not include " << include.header;
  }
}

TEST(IncludeDirection, BackendKnowsNothingOfClientsTestsOrSimulators) {
  for (const Include& include : includes_under("backend")) {
    EXPECT_FALSE(starts_with_any(include.header, {"clients/", "tests/", "datasets/", "benchmarks/",
                                                  "server/", "frontends/"}))
        << place(include) << " includes " << include.header;
    EXPECT_EQ(include.header.find("../"), std::string::npos)
        << place(include) << ": include as cairn/<room>/<header>";
  }
}

TEST(IncludeDirection, BackendUsesNoMiddlewareAndVisionHeadersOutsideIo) {
  for (const Include& include : includes_under("backend")) {
    EXPECT_FALSE(starts_with_any(include.header, {"dds/", "ddsc/", "ddscxx/"})) << place(include);
    if (part(include.file, 1) == "io") continue;
    EXPECT_FALSE(starts_with_any(include.header, {"opencv", "pcl/"})) << place(include);
  }
}

TEST(IncludeDirection, OnlyTheLinearRoomAndTheSolverSpeakToSolverLibraries) {
  for (const Include& include : includes_under("backend")) {
    const std::string room = part(include.file, 1);
    if (room == "linear" || room == "solver") continue;
    EXPECT_FALSE(starts_with_any(include.header, {"cholmod", "suitesparse/", "ceres/"}))
        << place(include);
  }
}

TEST(Solver, NamesNoConcreteFactor) {
  // The type names of the factors room: "struct Name {".
  std::vector<std::string> factors;
  for (const fs::path& path : sources_under("backend/factors")) {
    std::ifstream file(path);
    std::string text;
    while (std::getline(file, text)) {
      if (text.rfind("struct ", 0) == 0 && text.ends_with(" {"))
        factors.push_back(text.substr(7, text.size() - 9));
    }
  }
  ASSERT_GT(factors.size(), 15u);
  for (const fs::path& path : sources_under("backend/solver")) {
    std::ifstream file(path);
    std::string text;
    for (int line = 1; std::getline(file, text); ++line) {
      for (const std::string& factor : factors) {
        EXPECT_EQ(text.find(factor + "{"), std::string::npos)
            << path << ":" << line << ": " << factor;
        EXPECT_EQ(text.find("<" + factor + ">"), std::string::npos)
            << path << ":" << line << ": " << factor;
      }
    }
  }
}

TEST(Sources, StartWithTheirLicenseAndStayBelowFourHundredLines) {
  for (const char* folder :
       {"backend", "clients", "datasets", "frontends", "tests", "benchmarks"}) {
    for (const fs::path& path : sources_under(folder)) {
      std::ifstream file(path);
      std::string text;
      int lines = 0;
      while (std::getline(file, text)) {
        if (++lines == 1) {
          EXPECT_EQ(text, "// SPDX-License-Identifier: BSD-3-Clause") << path;
        }
      }
      EXPECT_LE(lines, 400) << path << ": split it";
    }
  }
}

}  // namespace
