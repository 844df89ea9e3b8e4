// SPDX-License-Identifier: Apache-2.0
#include "scene/graph/scene_graph.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "filter/glyph/instances.h"

namespace sg {

Affine place_at(std::span<const PlaceKey> keys, double time) {
  if (keys.empty()) return {};
  const auto after = std::find_if(keys.begin(), keys.end(), [&](const PlaceKey& k) { return k.time > time; });
  if (after == keys.begin()) return keys.front().place;
  if (after == keys.end()) return keys.back().place;
  const PlaceKey &a = *(after - 1), &b = *after;
  if (time == a.time || a.place == b.place) return a.place;  // as it is stated, to the last digit
  return interpolate(take_apart(a.place), take_apart(b.place), (time - a.time) / (b.time - a.time));
}

std::vector<Affine> places_at(const DatasetPtr& points, const PointInstancesParams& p) {
  GlyphRule rule;
  rule.vectors = p.vectors.name, rule.frames = p.frames.name, rule.size_field = p.size.name;
  if (!p.size.empty()) rule.size = GlyphRule::Size::field;
  rule.scale = p.scale;
  const auto instances = glyph_instances(points, rule, 1);
  std::vector<Affine> places;
  for (size_t i = 0; i < instances->count(); ++i) {
    if (!instances->stands(i)) continue;
    const float* m = instances->data() + 12 * i;
    Affine& a = places.emplace_back();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) a.linear.m[r][c] = double(m[4 * r + c]);
      a.shift[r] = instances->origin[r] + double(m[4 * r + 3]);
    }
    if (!is_invertible(a)) places.pop_back();  // a frame that flattens
  }
  return places;
}

std::vector<std::vector<Affine>> world_places(std::span<const SceneNode> nodes) {
  constexpr size_t most = 1000000;
  std::vector<std::vector<Affine>> all;
  size_t together = 0;
  for (const SceneNode& n : nodes) {
    std::vector<Affine> world;
    const std::vector<Affine> root{{}};
    const std::vector<Affine>& parents = n.parent < 0 ? root : all.at(size_t(n.parent));
    const bool places = n.visible && !n.instances.empty();
    if (places && parents.size() > (most - together) / n.instances.size())
      fail_usage(fmt::format("{:.0f} more places", double(parents.size()) * double(n.instances.size())), fmt::format("node '{}'", n.name),
                 "all nodes together stand at a million at most; glyphs show more");
    if (places) together += parents.size() * n.instances.size();
    for (const Affine& parent : n.visible ? parents : std::vector<Affine>())
      for (const Affine& instance : n.instances) {
        world.push_back(parent * (n.place * instance));
        if (!is_invertible(world.back()))
          fail_usage("its transform and those of its ancestors together flatten what it places", fmt::format("node '{}'", n.name),
                     "scale factors must not be 0, nor far beyond what numbers hold");
      }
    all.push_back(std::move(world));
  }
  return all;
}

}  // namespace sg
