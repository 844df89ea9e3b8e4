// SPDX-License-Identifier: Apache-2.0
// The recipe inside a picture: the pipeline as YAML, the version, and a hash of each input.
#include <fmt/core.h>
#include <xxhash.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "base/file/file.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/file_series.h"
#include "io/lent_series.h"
#include "pipeline/file/file_words.h"
#include "pipeline/file/yaml_tree.h"
#include "pipeline/film/film_params.h"
#include "pipeline/graph/key.h"
#include "pipeline/picture/picture.h"
#include "scene/light/environment_params.h"
#include "scene/show/show.h"

namespace sg {

namespace {

// XXH3-64 over the hashes of 4 MiB blocks, so that all cores share the work and the result does not depend on them.
// Of a folder: the names and sizes of the files in it, at any depth (a case may hold many gigabytes).
std::string folder_hash(const std::string& path) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  std::error_code error;
  for (fs::recursive_directory_iterator at(path, error), end; !error && at != end; at.increment(error))
    if (at->is_regular_file(error))
      files.push_back(fmt::format("{} {}\n", at->path().lexically_relative(path).string(), at->file_size(error)));
  std::sort(files.begin(), files.end());
  std::string all;
  for (const std::string& f : files) all += f;
  return fmt::format("{:016x}", XXH3_64bits(all.data(), all.size()));
}

// Of several files: their names and sizes.
std::string series_hash(const std::string& path) {
  std::string all;
  for (const std::string& f : series_files(path)) all += fmt::format("{} {}\n", file_name_of(f), file_state(f).size);
  return fmt::format("{:016x}", XXH3_64bits(all.data(), all.size()));
}

std::string content_hash(const std::string& path) {
  if (names_series(path)) return series_hash(path);
  if (is_folder(path)) return folder_hash(path);
  const MappedFile file(path);
  constexpr size_t block = size_t(4) << 20;
  std::vector<uint64_t> parts((file.size() + block - 1) / block);
  parallel_for(parts.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) parts[i] = XXH3_64bits(file.data() + i * block, std::min(block, file.size() - i * block));
  });
  return fmt::format("{:016x}", XXH3_64bits(parts.data(), parts.size() * sizeof(uint64_t)));
}

// As a recipe names a file whose picture lies in the folder.
std::string named_in_recipe(const std::string& path, const std::string& folder, bool absolute) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path target = fs::weakly_canonical(path, error);
  if (absolute) return target.string();
  const fs::path base = fs::weakly_canonical(folder.empty() ? "." : folder, error);
  const fs::path r = target.lexically_relative(base);
  return r.empty() ? target.string() : r.string();
}

bool is_there(const std::string& path) {
  if (!names_series(path)) return file_exists(path);
  try {
    return !series_files(path).empty();
  } catch (const Error&) {
    return false;
  }
}

// One line of "sightglass-inputs": a name may hold anything, line ends too.
std::string line_text(const std::string& hash, const std::string& path) { return fmt::format("{} xxh3-4m {}\n", hash, yaml_scalar(path)); }

std::string path_in_line(std::string_view text) {
  return text.starts_with('"') ? parse_yaml(text, "sightglass-inputs").text : std::string(text);
}

void replace_path(std::vector<std::string>& words, const std::string& path) {
  for (std::string& w : words)
    if (w.starts_with("path=")) w = "path=" + path;
}

}  // namespace

PipelineFile without_lent(PipelineFile file) {
  for (auto& step : file.steps)
    if (step.reads() && is_lent(word_value(step.words, "path").value_or("")))
      step.operation = memory_step, step.words = {"data=time series of a program"};
  return file;
}

void attach_recipe(Image& image, const PipelineFile& file, const std::string& picture_path) {
  PipelineFile recipe = without_lent(file);
  const auto as_named = [&, folder = folder_of(picture_path)](const std::string& path) {
    return named_in_recipe(path, folder, file.absolute);
  };
  std::string inputs;
  for (auto& step : recipe.steps) {
    if (!step.reads()) {  // the picture is the same without what is written beside it
      std::erase_if(step.words, [](const std::string& w) { return w.starts_with("store="); });
      continue;
    }
    const auto stated = word_value(step.words, "path");
    if (!stated) continue;
    const std::string path = series_beside(file.origin, *stated);
    const std::string named = map_series(path, as_named);
    replace_path(step.words, named);
    inputs += line_text(content_hash(path), named);
  }
  if (const auto words = word_value(recipe.picture, "environment"); words && !environment_file(*words).empty()) {
    const std::string path = path_beside(file.origin, environment_file(*words)), named = as_named(path);
    recipe.picture.push_back("environment=" + with_environment_file(*words, named));  // the last one counts
    inputs += line_text(content_hash(path), named);
  }
  std::erase_if(recipe.picture, [](const std::string& w) { return w.starts_with("output="); });
  for (auto& show : recipe.show) {
    std::erase_if(show.words, [](const std::string& w) { return w.starts_with("save="); });
    if (show.kind == auto_show) continue;
    show.words = map_file_words(show.words, find_show(show.kind).make_params().schema, [&](const std::string& name) {
      const std::string path = path_beside(file.origin, name), named = as_named(path);
      inputs += line_text(content_hash(path), named);
      return named;
    });
  }
  image.text.emplace_back("Software", "Sightglass " SG_VERSION);
  image.text.emplace_back("sightglass", emit_pipeline(recipe));
  if (!inputs.empty()) image.text.emplace_back("sightglass-inputs", inputs);
}

namespace {

const std::string* text_in(const Image& image, std::string_view name) {
  const std::string* last = nullptr;
  for (const auto& [key, value] : image.text)
    if (key == name) last = &value;
  return last;
}

}  // namespace

PipelineFile recipe_in(const Image& image, const std::string& picture_path) {
  const std::string* recipe = text_in(image, "sightglass");
  if (!recipe)
    fail_data("contains no recipe", picture_path, "pictures made by sightglass contain one, unless another program rewrote them");
  return parse_pipeline(*recipe, picture_path, picture_vocabulary());
}

PipelineFile recipe_in(const Image& image, const std::string& picture_path, std::vector<std::string>& changed) {
  PipelineFile file = recipe_in(image, picture_path);
  check_recipe(file, picture_path);
  std::erase_if(file.picture, is_film_word);
  // Only what the recipe reads is looked at, each once.
  std::set<std::string> read;
  for (const auto& step : file.steps)
    if (step.reads()) read.insert(word_value(step.words, "path").value_or(""));
  if (const auto words = word_value(file.picture, "environment"); words && !environment_file(*words).empty())
    read.insert(environment_file(*words));
  for (const auto& show : file.show)
    if (show.kind != auto_show)
      map_file_words(show.words, find_show(show.kind).make_params().schema,
                     [&](const std::string& name) { return *read.insert(name).first; });
  file.absolute = std::any_of(read.begin(), read.end(), [](const std::string& name) { return name.starts_with('/'); });
  if (const std::string* inputs = text_in(image, "sightglass-inputs"))
    for (std::string_view line : split(*inputs, '\n')) {
      const size_t a = line.find(' '), b = a == line.npos ? line.npos : line.find(' ', a + 1);
      if (b == line.npos) continue;
      const std::string named = path_in_line(line.substr(b + 1));
      if (read.erase(named) == 0) continue;
      const std::string path = series_beside(picture_path, named);
      if (is_there(path) && content_hash(path) != line.substr(0, a)) changed.push_back(path);
    }
  return file;
}

}  // namespace sg
