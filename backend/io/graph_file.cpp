// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/io/graph_file.hpp"

#include "cairn/core/output_file.hpp"
#include "cairn/io/compression.hpp"
#include "cairn/io/graph_reader.hpp"
#include "cairn/io/graph_tags.hpp"
#include "cairn/io/input_text.hpp"

namespace cairn {
namespace fs = std::filesystem;
namespace {

Result<fs::path> only_file_ending_in(const fs::path& folder, const std::string& ending) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().filename().string().ends_with(ending)) found.push_back(entry.path());
  }
  if (error) return Error{ErrorCode::kBadInput, "cannot read: " + error.message(), folder.string()};
  if (found.size() == 1) return found.front();
  return Error{ErrorCode::kBadInput,
               "the folder holds " + std::to_string(found.size()) + " files that end in " + ending +
                   "; a dlr folder holds one each that ends in vertices.txt, initial_state.txt and "
                   "edges.txt",
               folder.string()};
}

Result<GraphDocument> read_dlr_folder(const fs::path& folder) {
  std::vector<InputText> inputs;
  std::vector<NamedText> texts;
  for (const char* ending : {"vertices.txt", "initial_state.txt", "edges.txt"}) {
    const auto path = only_file_ending_in(folder, ending);
    if (!path) return path.error();
    auto input = read_input_text(path->string());
    if (!input) return input.error();
    texts.push_back({path->string(), input->view});
    inputs.push_back(std::move(*input));
  }
  return read_dlr_texts({texts[0], texts[1], texts[2]});
}

bool is_folder(const std::string& path) {
  std::error_code ignored;
  return path != "-" && fs::is_directory(path, ignored);
}

}  // namespace

Result<GraphDocument> read_graph(const std::string& path, const ReadOptions& options) {
  return read_graphs({path}, options);
}

Result<GraphDocument> read_graph_text(std::string_view text, const std::string& name,
                                      const ReadOptions& options) {
  return read_graph_texts({{name, text}}, options);
}

Result<GraphDocument> read_graphs(const std::vector<std::string>& paths,
                                  const ReadOptions& options) {
  if (paths.empty()) return Error{ErrorCode::kUsage, "no input file"};
  if (paths.size() == 1 && is_folder(paths[0])) return read_dlr_folder(paths[0]);
  std::vector<InputText> inputs;
  std::vector<NamedText> texts;
  for (const std::string& path : paths) {
    if (is_folder(path)) {
      return Error{ErrorCode::kUsage,
                   "a dlr folder cannot be merged with other files; convert it first", path};
    }
    auto input = read_input_text(path);
    if (!input) return input.error();
    texts.push_back({input_name(path), input->view});
    inputs.push_back(std::move(*input));
  }
  return read_graph_texts(texts, options);
}

Result<void> write_graph(const GraphDocument& document, const std::string& path,
                         GraphFormat format) {
  const auto text = write_graph_text(document, format);
  if (!text) return text.error();
  const Compression compression = compression_for(path);
  return compression == Compression::kNone ? write_file(path, *text)
                                           : write_file(path, compress(*text, compression));
}

}  // namespace cairn
