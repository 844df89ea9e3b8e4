// SPDX-License-Identifier: Apache-2.0
#include "scene/glyph_parts.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "scene/show_glyphs.h"

namespace sg {

namespace {

GlyphsShow read_words(const std::vector<std::string>& words) {
  GlyphsShow p;
  Schema s = schema_of(p);
  set_params(s, words, "show");
  return p;
}

// Length, area or volume of the box, by the axes along which the whole extends.
double share_of(const Box3& box, const Box3& whole) {
  const Vec3 size = box.size(), all = whole.size();
  const double least = 1e-6 * std::max({all.x, all.y, all.z});
  double share = 1;
  for (int a = 0; a < 3; ++a)
    if (all[a] > least) share *= std::max(size[a], least) / all[a];
  return share;
}

int axis_count(const Box3& box) {
  const Vec3 size = box.size();
  const double least = 1e-6 * std::max({size.x, size.y, size.z});
  return int(size.x > least) + int(size.y > least) + int(size.z > least);
}

// As many glyphs in all as one mesh of that size would have.
void share_count(const std::vector<DatasetPtr>& parts, bool barbs, std::vector<std::vector<std::string>>& words) {
  Box3 whole;
  for (const DatasetPtr& d : parts) whole.add(d->bounds());
  double sum = 0;
  std::vector<double> share;
  for (const DatasetPtr& d : parts) sum += share.emplace_back(d->point_count() > 0 ? share_of(d->bounds(), whole) : 0);
  if (!(sum > 0)) return;
  const double all = barbs ? 180 : axis_count(whole) < 3 ? 900 : 2500;
  for (size_t i = 0; i < parts.size(); ++i)
    if (const auto count = int64_t(std::ceil(all * share[i] / sum)); count < int64_t(parts[i]->point_count()))
      words[i].push_back(fmt::format("count={}", std::max<int64_t>(count, 1)));
}

}  // namespace

void take_one_glyph_scale(const std::vector<DatasetPtr>& parts, std::vector<std::vector<std::string>>& words) {
  const GlyphsShow stated = read_words(words[0]);
  const GlyphParams& g = stated.glyphs;
  const bool barbs = g.shape.shape == "barbs";
  if (g.count == 0 && g.spacing == 0 && g.place == "auto") share_count(parts, barbs, words);
  if (g.factor > 0 || stated.pixels || barbs) return;
  double longest = 0, most = 0;
  size_t glyphs = 0;
  for (size_t i = 0; i < parts.size(); ++i) {
    if (parts[i]->point_count() == 0) continue;
    Context quiet;
    const GlyphsShow p = read_words(words[i]);
    if (p.glyphs.vectors.empty() && p.glyphs.frames.empty() && !automatic_vectors(*parts[i])) continue;
    const ChosenGlyphs c = choose_glyphs(parts[i], p.glyphs, false, quiet);
    most = std::max(most, c.of);
    if (c.data->point_count() > glyphs && c.longest > 0) glyphs = c.data->point_count(), longest = c.longest;
  }
  if (!(longest > 0)) return;
  for (auto& w : words) {
    std::erase_if(w, [](const std::string& word) { return word.starts_with("size="); });
    w.push_back(most > 0 ? "factor=" + exact_number(longest / most) : "size=" + exact_number(longest));
  }
}

}  // namespace sg
