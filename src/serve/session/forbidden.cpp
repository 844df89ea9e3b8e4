// SPDX-License-Identifier: Apache-2.0
#include "serve/session/forbidden.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/schema/file_params.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "color/map_files/colormap_file.h"
#include "pipeline/file/transfer_file.h"
#include "scene/light/environment_params.h"
#include "serve/session/params_of.h"

namespace sg::serve {

namespace {

struct NamedFiles {
  std::vector<std::string> read;
  bool written = false;
};

void collect_files(const ParamSet& params, const std::vector<std::string>& words, NamedFiles& files) {
  for (const std::string& w : words) {
    const size_t sign = w.find('=');
    const ParamDecl* d = params.schema.find(trim(std::string_view(w).substr(0, sign)));
    if (!d || sign == w.npos) continue;
    const std::string value = w.substr(sign + 1);
    if (names_file(*d) || (d->name == "map" && names_colormap_file(value)) || (d->name == "transfer" && names_transfer_file(value)))
      files.read.push_back(value);
    else if (names_new_file(*d)) files.written = true;
  }
}

NamedFiles files_of(const PipelineFile& file) {
  NamedFiles files;
  for (const PipelineFile::Step& s : file.steps)
    if (s.reads() || known_operation(s.operation)) collect_files(params_of_step(s), s.words, files);
  for (const PipelineFile::Show& s : file.show) collect_files(params_of_show(s.kind), s.words, files);
  if (const std::string hall = environment_file(word_value(file.picture, "environment").value_or("")); !hall.empty())
    files.read.push_back(hall);
  files.written = files.written || word_value(file.picture, "output");
  return files;
}

}  // namespace

std::vector<std::string> files_read(const PipelineFile& file) { return files_of(file).read; }

std::vector<EditMistake> forbidden(const PipelineFile& before, const PipelineFile& after) {
  std::vector<EditMistake> mistakes;
  const NamedFiles known = files_of(before), wanted = files_of(after);
  if (wanted.written && !known.written)
    mistakes.push_back({"", "", "a window writes no files here: the browser saves pictures and pipelines"});
  for (const std::string& path : wanted.read)
    if (std::find(known.read.begin(), known.read.end(), path) == known.read.end())
      mistakes.push_back(
          {"", "", fmt::format("'{}' is no file of this session; files are chosen where a session is opened", printable(path))});
  return mistakes;
}

}  // namespace sg::serve
