// SPDX-License-Identifier: Apache-2.0
#include "serve/session/saved_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "io/file_series.h"

namespace sg::serve {

namespace {

constexpr std::array types{PictureType{"png", "image/png"}, PictureType{"jpg", "image/jpeg"}, PictureType{"webp", "image/webp"}};

std::string without_end(const std::string& name) { return name.substr(0, name.find('.')); }

// The files of the step that reads several as one; none where nothing does.
std::vector<std::string> files_of_series(const PipelineFile& file, const PipelineFile::Step*& step) {
  for (const PipelineFile::Step& s : file.steps) {
    const std::string path = s.reads() ? series_beside(file.origin, word_value(s.words, "path").value_or("")) : "";
    if (!names_series(path)) continue;
    step = &s;
    return series_files(path);
  }
  return {};
}

// Which step of the series is shown: the first one where nothing else is stated.
size_t shown_step(const PipelineFile::Step& reads, const std::optional<FilmTimes>& film, std::optional<size_t> time) {
  if (!time)
    if (const auto stated = parse_double(word_value(reads.words, "time").value_or("")); stated && film && !film->times.empty()) {
      const auto& times = film->times;
      const auto nearer = [&](double a, double b) { return std::abs(a - *stated) < std::abs(b - *stated); };
      time = size_t(std::min_element(times.begin(), times.end(), nearer) - times.begin());
    }
  if (time) return film && *time < film->steps.size() ? film->steps[*time] : *time;
  const auto stated = parse_double(word_value(reads.words, "step").value_or(""));
  return stated && *stated >= 0 ? size_t(*stated) : 0;
}

}  // namespace

PictureType picture_type(const std::string& word) {
  for (const PictureType& t : types)
    if (word == t.word || (word.empty() && &t == &types[0])) return t;
  std::string known;
  for (const PictureType& t : types) known += (known.empty() ? "" : ", ") + std::string(t.word);
  fail_usage(fmt::format("pictures are not saved as '{}'", printable(word)), "type", "there are " + known);
}

std::vector<std::string> picture_types() {
  std::vector<std::string> words;
  for (const PictureType& t : types) words.emplace_back(t.word);
  return words;
}

std::string picture_stem(const std::string& title, const PipelineFile& file, const std::optional<FilmTimes>& film,
                         std::optional<size_t> time) {
  const PipelineFile::Step* reads = nullptr;
  const std::vector<std::string> files = files_of_series(file, reads);
  std::string stem = without_end(title);
  if (!files.empty()) {
    const size_t step = shown_step(*reads, film, time), steps = film ? film->times.size() : files.size();
    if (steps == files.size() && step < files.size()) {
      stem = file_name_of(files[step]);
      stem = stem.substr(0, stem.rfind('.'));
    } else if (const size_t sign = stem.find_first_of("*?{"); sign != stem.npos) {
      stem = stem.substr(0, sign) + fmt::format("{:03}", step);
    }
  }
  return stem.empty() ? "picture" : stem;
}

}  // namespace sg::serve
