// SPDX-License-Identifier: BSD-3-Clause
// The daemon: cairnd --data DIR [--config FILE] [--domain N].
#include <CLI/CLI.hpp>
#include <cstdio>

#include "cairn/core/exit_code.hpp"
#include "server/daemon.hpp"

namespace {

constexpr const char* kFooter =
    "Without --domain and --config everything has its default: --dump-config prints it, as a file "
    "to start from.\n"
    "Exit codes: 0 ended by SIGTERM or SIGINT, 1 internal error, 2 usage, or another daemon serves "
    "the folder or the\n"
    "domain, 3 bad configuration, 5 the network cannot be used.";

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Cairn's map server: takes constraints over DDS, keeps them, sends poses back"};
  app.footer(kFooter);
  std::string folder, config_file;
  std::uint32_t domain = 0;
  bool dump = false;
  app.add_option("--data", folder, "folder of the journal; made if absent")->type_name("DIR");
  app.add_option("--config", config_file, "configuration (YAML)")->type_name("FILE");
  CLI::Option* given_domain =
      app.add_option("--domain", domain, "DDS domain")->check(CLI::Range(0, 232))->type_name("N");
  app.add_flag("--dump-config", dump, "print the configuration with its documentation, and end");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  cairn::DaemonConfig config;
  if (!config_file.empty()) {
    if (auto read = cairn::read_config(config_file, config); !read)
      return cairn::fail(read.error());
  }
  if (given_domain->count() > 0) config.domain = domain;
  if (dump) {
    std::fputs(cairn::dump_config(config).c_str(), stdout);
    return 0;
  }
  if (folder.empty()) {
    return cairn::fail({cairn::ErrorCode::kUsage,
                        "name the folder of the journal: cairnd --data DIR; it is made if absent"});
  }
  return cairn::run_daemon(folder, config, {.write_buffer_bytes = config.journal_buffer_bytes});
}
