// SPDX-License-Identifier: Apache-2.0
#include "serve/session/command_text.h"

#include <algorithm>

#include "base/text/text.h"
#include "pipeline/picture/picture.h"

namespace sg::serve {

namespace {

// As a shell takes it for one word.
std::string quoted(const std::string& word) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || std::string_view("_-./,:=+@%").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string r = "'";
  for (const char c : word) r += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return r + "'";
}

// Words of an operation in one text; a value with blanks in double quotes.
std::string joined(const std::vector<std::string>& words) {
  std::string r;
  for (const std::string& w : words) {
    const size_t sign = w.find('=');
    const bool blank = sign != w.npos && w.find(' ') != w.npos;
    r += " " + (blank ? w.substr(0, sign) + "=\"" + w.substr(sign + 1) + "\"" : w);
  }
  return r;
}

}  // namespace

std::string command_text(const PipelineFile& file) {
  const auto reads = std::count_if(file.steps.begin(), file.steps.end(), [](const auto& s) { return s.reads(); });
  if (reads != 1 || !file.steps[0].reads() || !file.scene.empty()) return "";
  const PipelineFile::Step& input = file.steps[0];
  std::string command = "sightglass render " + quoted(word_value(input.words, "path").value_or(""));
  for (const std::string& w : input.words)
    if (!w.starts_with("path=")) {
      const size_t sign = w.find('=');
      command += " --" + w.substr(0, sign) + (sign == w.npos ? "" : " " + quoted(w.substr(sign + 1)));
    }
  for (size_t i = 1; i < file.steps.size(); ++i) {
    const PipelineFile::Step& s = file.steps[i];
    std::string f = s.name + ": " + s.operation;
    const auto name_of = [&](const std::string& from) { return from == input.name ? std::string("input") : from; };
    if (!s.from.empty()) f += " on=" + name_of(s.from[0]);
    for (size_t k = 1; k < s.from.size(); ++k) f += (k == 1 ? " with=" : ",") + name_of(s.from[k]);
    command += " -f " + quoted(f + joined(s.words));
  }
  for (size_t i = 0; i < file.show.size(); ++i) {
    const PipelineFile::Show& s = file.show[i];
    if (s.kind == auto_show && s.words.empty()) continue;
    std::string show = s.kind;
    if (!s.of.empty() && s.of != file.steps.back().name) show += " of=" + (s.of == input.name ? std::string("input") : s.of);
    command += " --show " + quoted(show + joined(s.words));
  }
  for (const std::string& w : file.picture) {
    if (w.starts_with("camera.")) continue;
    command += " --picture " + quoted(w);
  }
  std::string camera;
  for (const std::string& w : words_under(file.picture, "camera")) camera += (camera.empty() ? "" : " ") + w;
  if (!camera.empty()) command += " --camera " + quoted(camera);
  return command + " -o picture.png";
}

}  // namespace sg::serve
