// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/scene/picture_scene.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/alike_notes.h"
#include "data/memory/memory_budget.h"
#include "filter/mesh/transform/transform.h"

namespace sg {

namespace {

template <class P>
Affine place_in(const std::vector<std::string>& words, const std::string& owner, P& p) {
  Schema schema = schema_of(p);
  set_params(schema, words, owner);
  return affine_of(p.place, schema, owner);
}

SceneNode scene_node(const PipelineFile::Node& stated) {
  const std::string owner = fmt::format("node '{}'", stated.name);
  SceneNode n;
  NodeParams p;
  n.name = stated.name, n.parent = stated.parent;
  n.place = place_in(stated.words, owner, p);
  n.visible = p.visible;
  std::vector<PlaceKey> keys;
  for (const auto& words : stated.keys) {
    KeyParams k;
    const Affine place = place_in(words, owner + " keys", k);
    if (!std::isfinite(k.time)) fail_usage("a time is not finite", owner + " keys");
    if (!keys.empty() && !(k.time > keys.back().time))
      fail_usage(fmt::format("time {} does not come after {}", k.time, keys.back().time), owner + " keys",
                 "give them in the order of their times");
    keys.push_back({k.time, place});
  }
  if (p.time && keys.empty()) fail_usage("time is stated, but there are no keys", owner, "give keys: [{time: 0}, {time: 1, angle: 90}]");
  // Motion is in the frame that the node's own words give.
  if (!keys.empty()) n.place = n.place * place_at(keys, p.time.value_or(keys.front().time));
  if (!stated.instances.empty()) n.instances.clear();
  for (const auto& words : stated.instances) {
    InstanceParams i;
    n.instances.push_back(place_in(words, owner + " instances", i));
  }
  if (!stated.at.empty()) {
    PointInstancesParams i;
    Schema schema = schema_of(i);
    set_params(schema, stated.at_words, owner + " instances");
  }
  return n;
}

std::vector<SceneNode> nodes_with_points(const PipelineFile& file, const std::vector<Data>& points) {
  std::vector<SceneNode> nodes = stated_scene(file);
  size_t next = 0;
  for (size_t i = 0; i < nodes.size(); ++i) {
    const PipelineFile::Node& stated = file.scene[i];
    if (stated.at.empty()) continue;
    const std::string owner = fmt::format("node '{}' instances", stated.name);
    PointInstancesParams p;
    Schema schema = schema_of(p);
    set_params(schema, stated.at_words, owner);
    nodes[i].instances.clear();
    with_context(owner, [&] {
      for_each_dataset(points.at(next), [&](const std::string&, const DatasetPtr& d) {
        const std::vector<Affine> some = places_at(d, p);
        nodes[i].instances.insert(nodes[i].instances.end(), some.begin(), some.end());
      });
    });
    ++next;
  }
  return nodes;
}

TransformParams params_of(const Affine& a) {
  TransformParams p;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) p.matrix.push_back(r == 3 ? double(c == 3) : c == 3 ? a.shift[r] : a.linear.m[r][c]);
  return p;
}

Data placed_data(const Data& data, const std::vector<Affine>& places, const std::string& owner, Copies* copies, Context& context) {
  if (places.size() == 1 && places[0] == Affine()) return data;
  double points = 0;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { points += double(d->point_count()); });
  constexpr double bytes_of_point = 48;  // its place, two corners of cells about it, a normal
  if (places.size() > 1)
    need_memory(points * double(places.size()) * bytes_of_point, fmt::format("{} copies of {} points", places.size(), points), owner,
                "simplify what is copied, or show it as glyphs");
  auto all = std::make_shared<Collection>();
  AlikeNotes notes;  // of all copies, told once
  Context each(context, 0, 1);
  each.on_log = [&](LogLevel level, std::string_view text) { notes.add(level, text); };
  for_each_dataset(data, [&](const std::string& name, const DatasetPtr& d) {
    for (size_t i = 0; i < places.size(); ++i) {
      context.check();
      const DatasetPtr moved = places[i] == Affine() ? d : with_context(owner, [&] { return transform(d, params_of(places[i]), each); });
      if (copies && places.size() > 1 && moved->as<SurfaceMesh>())
        copies->emplace(moved.get(), std::make_shared<SurfaceCopy>(SurfaceCopy{d, places[i]}));
      all->parts.push_back({places.size() > 1 ? fmt::format("{} {}", name, i + 1) : name, moved});
    }
  });
  notes.tell(context);
  if (all->parts.size() == 1) return all->parts[0].data;
  return CollectionPtr(all);
}

}  // namespace

std::vector<SceneNode> stated_scene(const PipelineFile& file) {
  std::vector<SceneNode> nodes;
  std::string problems;
  for (const PipelineFile::Node& n : file.scene) {
    try {
      nodes.push_back(scene_node(n));
    } catch (const Error& e) {
      problems += (problems.empty() ? "" : "; ") + std::string(n.line > 0 ? fmt::format("{}:{}: ", file.origin, n.line) : "") + e.what();
      nodes.emplace_back();
    }
  }
  if (!problems.empty()) fail_usage(problems);
  return nodes;
}

std::vector<Target> place_targets(const PipelineGraph& graph) {
  std::vector<Target> targets;
  for (const NodeId n : graph.places)
    if (n >= 0) targets.push_back({n, {}});
  return targets;
}

std::vector<Data> placed(const PipelineFile& file, const std::vector<Data>& points, std::vector<Data> results, Copies* copies,
                         Context& context) {
  if (file.scene.empty()) return results;
  const std::vector<std::vector<Affine>> places = world_places(nodes_with_points(file, points));
  for (size_t i = 0; i < results.size(); ++i) {
    const int node = file.show[i].node;
    if (node < 0) continue;
    // A table has no place; what shows it says so.
    if (std::holds_alternative<TablePtr>(results[i])) continue;
    results[i] = placed_data(results[i], places[size_t(node)], fmt::format("node '{}'", file.scene[size_t(node)].name), copies, context);
  }
  return results;
}

std::vector<Data> placed(const PipelineFile& file, std::vector<Data> results, const StepResults& at_hand, Context& context) {
  if (file.scene.empty()) return results;
  const PipelineGraph built = build_graph(file, {}, at_hand);
  return placed(file, built.graph.evaluate(place_targets(built), context), std::move(results), nullptr, context);
}

std::vector<Affine> places_of_show(const PipelineFile& file, size_t show, const std::shared_ptr<Cache>& cache, Context& context) {
  if (show >= file.show.size() || file.show[show].node < 0) return {Affine()};
  GraphOptions options;
  options.cache = cache;
  const PipelineGraph built = build_graph(file, options);
  const std::vector<Data> points = built.graph.evaluate(place_targets(built), context);
  return world_places(nodes_with_points(file, points))[size_t(file.show[show].node)];
}

}  // namespace sg
