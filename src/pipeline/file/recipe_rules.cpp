// SPDX-License-Identifier: Apache-2.0
// What a recipe may not do. The fence around the process (file/file_fence.h) holds whatever is overlooked here; these rules report it
// before anything runs, step by step.
#include <fmt/core.h>

#include <map>

#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/schema/file_params.h"
#include "base/text/text.h"
#include "io/file_series.h"
#include "io/options.h"
#include "pipeline/graph/graph.h"
#include "pipeline/picture/picture.h"
#include "scene/light/environment_params.h"
#include "scene/show/show.h"

namespace sg {

namespace {

enum class FileUse { read, written };
using FileParams = std::map<std::string, FileUse, std::less<>>;  // the parameters that name files

FileParams files_of(const Schema& schema) {
  FileParams files;
  for (const ParamDecl& d : schema.decls())
    if (names_file(d)) files[d.name] = FileUse::read;
    else if (names_new_file(d)) files[d.name] = FileUse::written;
  return files;
}

FileParams files_of_step(const PipelineFile::Step& step) {
  if (step.reads()) {
    ReadParams params;
    return files_of(schema_of(params));
  }
  const Operation* op = known_operation(step.operation);
  return op ? files_of(op->make_params().schema) : FileParams{};  // an unknown one is reported later, with "did you mean"
}

class Rules {
 public:
  explicit Rules(const std::string& picture) : picture_(picture) {}

  void look(const std::string& who, int line, const FileParams& files, const std::vector<std::string>& words) {
    for (const std::string& word : words) {
      const size_t sign = word.find('=');
      const auto file = files.find(trim(std::string_view(word).substr(0, sign)));
      if (file == files.end()) continue;
      const std::string value = sign == word.npos ? "" : word.substr(sign + 1);
      if (file->second == FileUse::written) {
        mistake(line, fmt::format("{}: {}={} would write a file, but a recipe may write only its picture", who, file->first, value));
        continue;
      }
      bool good = true;  // of a long list one is enough
      map_series(value, [&](const std::string& part) {
        good = good && check_path(who, line, part);
        return part;
      });
    }
  }
  void finish() const {
    if (!mistakes_.empty()) fail_usage(mistakes_, fmt::format("the recipe in '{}'", picture_));
  }

 private:
  void mistake(int line, const std::string& text) { mistakes_ += fmt::format("{}line {}: {}", mistakes_.empty() ? "" : "; ", line, text); }

  bool check_path(const std::string& who, int line, const std::string& path) {
    if (path.empty()) return true;
    try {
      const std::string at = file_of_recipe(picture_, path);
      check_may_read(at.substr(0, at.find_first_of("*?{")));  // of a pattern its folder
      return true;
    } catch (const Error& e) {
      mistake(line, fmt::format("{} reads '{}', which lies neither below the picture's folder nor below the working folder; if that is "
                                "intended, use --read-anywhere",
                                who, path));
      return false;
    }
  }

  std::string picture_, mistakes_;
};

}  // namespace

void check_recipe(const PipelineFile& recipe, const std::string& picture_path) {
  Rules rules(picture_path);
  for (const auto& step : recipe.steps) rules.look(fmt::format("step '{}'", step.name), step.line, files_of_step(step), step.words);
  for (const auto& show : recipe.show) {
    ColoringParams coloring;
    rules.look(fmt::format("show {}", show.kind), show.line,
               files_of(show.kind == auto_show ? schema_of(coloring) : find_show(show.kind).make_params().schema), show.words);
  }
  const std::string environment = environment_file(word_value(recipe.picture, "environment").value_or(""));
  rules.look("environment", recipe.picture_line, {{"file", FileUse::read}}, {"file=" + environment});
  rules.finish();
}

}  // namespace sg
