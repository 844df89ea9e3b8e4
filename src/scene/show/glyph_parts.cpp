// SPDX-License-Identifier: Apache-2.0
// One scale for the glyphs of all parts of a collection.

#include <algorithm>
#include <cmath>

#include "scene/show/glyphs.h"

namespace sg {

namespace {

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
void share_count(const std::vector<DatasetPtr>& parts, bool barbs, const std::vector<GlyphsShow*>& params) {
  Box3 whole;
  for (const DatasetPtr& d : parts) whole.add(d->bounds());
  double sum = 0;
  std::vector<double> share;
  for (const DatasetPtr& d : parts) sum += share.emplace_back(d->point_count() > 0 ? share_of(d->bounds(), whole) : 0);
  if (!(sum > 0)) return;
  const double all = barbs ? 180 : axis_count(whole) < 3 ? 900 : 2500;
  for (size_t i = 0; i < parts.size(); ++i)
    if (const auto count = int64_t(std::ceil(all * share[i] / sum)); count < int64_t(parts[i]->point_count()))
      params[i]->glyphs.count = std::max<int64_t>(count, 1);
}

}  // namespace

void share(const std::vector<DatasetPtr>& parts, const std::vector<GlyphsShow*>& params) {
  const GlyphParams g = params[0]->glyphs;
  const bool barbs = known_shape(g.shape) == GlyphShape::barbs;
  if (g.count == 0 && g.spacing == 0 && !g.place) share_count(parts, barbs, params);
  if (g.factor > 0 || params[0]->pixels || barbs) return;
  double longest = 0, most = 0;
  size_t glyphs = 0;
  for (size_t i = 0; i < parts.size(); ++i) {
    if (parts[i]->point_count() == 0) continue;
    Context quiet;
    const GlyphParams& p = params[i]->glyphs;
    if (p.vectors.empty() && p.frames.empty() && !automatic_vectors(*parts[i])) continue;
    const ChosenGlyphs c = choose_glyphs(parts[i], p, false, quiet);
    most = std::max(most, c.of);
    if (c.data->point_count() > glyphs && c.longest > 0) glyphs = c.data->point_count(), longest = c.longest;
  }
  if (!(longest > 0)) return;
  for (GlyphsShow* p : params) {
    p->glyphs.size = most > 0 ? GlyphParams().size : longest;
    if (most > 0) p->glyphs.factor = longest / most;
  }
}

}  // namespace sg
