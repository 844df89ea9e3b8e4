// SPDX-License-Identifier: Apache-2.0
#include "io/surface/obj_materials.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"

namespace sg {

namespace {

void add_colors(std::string_view text, std::map<std::string, Vec3f>& colors) {
  std::string name;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trim(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    const auto w = words(line.substr(0, line.find('#')));
    if (w.size() >= 2 && w[0] == "newmtl") name = trim(line.substr(6));
    // One number is a grey. "Kd spectral" and "Kd xyz" have no colour of ours.
    if (name.empty() || w.size() < 2 || w[0] != "Kd") continue;
    const auto r = parse_double(w[1]), g = w.size() > 3 ? parse_double(w[2]) : r, b = w.size() > 3 ? parse_double(w[3]) : r;
    if (!r || !g || !b || !std::isfinite(*r + *g + *b)) continue;
    const auto channel = [](double x) { return float(std::clamp(x, 0.0, 1.0)); };
    colors[name] = {channel(*r), channel(*g), channel(*b)};
  }
}

}  // namespace

std::map<std::string, Vec3f> read_material_colors(const std::string& obj, std::span<const std::string_view> libraries, Context& context) {
  std::map<std::string, Vec3f> colors;
  std::vector<std::string> read;
  for (const std::string_view library : libraries) {
    const std::string name(library);
    if (std::find(read.begin(), read.end(), name) != read.end()) continue;
    read.push_back(name);
    try {
      const MappedFile file(named_file(obj, name));
      add_colors(file.text(), colors);
    } catch (const Error& e) {
      context.warn(fmt::format("{}: its materials have no colours: {}", obj, e.what()));
    }
  }
  return colors;
}

}  // namespace sg
