// SPDX-License-Identifier: Apache-2.0
#include "filter/glyph/points.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "data/cells/cell_reader.h"
#include "data/cells/point_positions.h"
#include "data/field_ops.h"
#include "data/memory/memory_budget.h"
#include "filter/field/sampling/point_cell.h"
#include "filter/glyph/points_along.h"
#include "filter/mesh/surface.h"
#include "filter/probe/probe.h"

namespace sg {

namespace {

Vec3 at(const Array& xyz, size_t i) { return {xyz.get(i, 0), xyz.get(i, 1), xyz.get(i, 2)}; }

DatasetPtr cloud(const std::vector<Vec3>& places, Vec3 origin, FieldSet fields) {
  std::vector<float> xyz;
  xyz.reserve(3 * places.size());
  for (const Vec3& p : places)
    for (int a = 0; a < 3; ++a) xyz.push_back(float(p[a] - origin[a]));
  return make_dataset(Mesh(PointCloud{{Array::from_vector(std::move(xyz), 3), origin}}), std::move(fields));
}

Vec3 middle_of(const Dataset& d) { return d.bounds().empty() ? Vec3{} : d.bounds().center(); }

// Some points of the mesh with their fields.
DatasetPtr chosen(const DatasetPtr& data, const std::vector<int64_t>& ids) {
  const Array xyz = point_positions(data->mesh());
  std::vector<Vec3> places;
  for (const int64_t i : ids) places.push_back(at(xyz, size_t(i)));
  FieldSet fields;
  carry_gathered(fields, data->fields(), Association::point, std::span<const int64_t>(ids), Association::point);
  carry_whole(fields, data->fields());
  return cloud(places, middle_of(*data), std::move(fields));
}

std::vector<int64_t> visible_points(const Dataset& d, int64_t every) {
  std::vector<int64_t> ids;
  const Array& ghost = d.point_ghost();
  for (size_t i = 0; i < d.point_count(); i += size_t(every))
    if (ghost.empty() || !(int(ghost.get(i)) & ghost_hidden_point)) ids.push_back(int64_t(i));
  return ids;
}

bool all_finite(Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

// Whether positions between the points can be probed: solids, and what is flat along an axis.
bool fills_its_box(const Dataset& d, const Box3& box) {
  if (d.as<PointCloud>() || d.cell_count() == 0) return false;
  const int axes = extended_axes(box);
  if (const auto* s = d.as<SurfaceMesh>()) return axes == 2 && s->polygons.size() + s->strips.size() > 0;
  if (axes < 2) return false;
  const CellReader first(DatasetPtr(&d, [](const Dataset*) {}));
  CellReader reader = first;
  int most = 0;  // a few cells give the dimension of the mesh
  for (size_t k = 0; k < 64; ++k) {
    reader.open(k * (d.cell_count() - 1) / 63);
    most = std::max(most, reader.dimension());
  }
  return most >= axes;
}

// Before `n` places are made and probed for the fields of the data.
void check_places(const Dataset& d, double n) {
  double bytes = 100;
  for (const Field& f : d.fields()) bytes += 8 * double(f.components());
  need_memory(n * bytes, fmt::format("{:.0f} glyphs", n), "glyph_points", "use fewer: count, spacing");
}

// Those of the places that lie in the mesh, with its fields.
DatasetPtr inside(const DatasetPtr& data, const std::vector<Vec3>& places, size_t most, Context& context) {
  const Vec3 origin = middle_of(*data);
  Context quiet(context, 0, 1);
  quiet.on_log = [](LogLevel, std::string_view) {};  // that many places lie outside is what is expected
  const DatasetPtr probed = probe(cloud(places, origin, {}), data, {}, quiet);
  const Field& valid = probed->fields().require("valid", Association::point);
  std::vector<int64_t> ids;
  for (size_t i = 0; i < places.size() && ids.size() < most; ++i)
    if (valid.array.get(i) != 0) ids.push_back(int64_t(i));
  DatasetPtr kept = chosen(probed, ids);
  DatasetParts parts = kept->parts();
  parts.fields.remove("valid", Association::point);
  for (const Field& f : data->fields())  // probing makes point fields of all; what they are for is kept
    if (const Field* g = parts.fields.find(f.name, Association::point); g && g->role == Role::none && f.role != Role::none) {
      Field copy = *g;
      copy.role = f.role;
      parts.fields.add(std::move(copy));
    }
  return make_dataset(std::move(parts));
}

std::vector<Vec3> grid_places(const Dataset& data, const Box3& box, double h, size_t limit, const Context& context) {
  size_t n[3];
  for (int a = 0; a < 3; ++a) {
    const double boxes = std::round(box.size()[a] / h);  // no number where sizes are beyond the largest one
    n[a] = boxes >= 1 ? size_t(std::min(boxes, 1e6)) : 1;
  }
  if (n[0] * n[1] > limit || n[0] * n[1] * n[2] > limit)
    fail_usage(fmt::format("a grid of {} x {} x {} positions is too fine", n[0], n[1], n[2]), "glyph_points", "use a larger spacing");
  check_places(data, double(n[0] * n[1] * n[2]));
  std::vector<Vec3> places;
  for (size_t k = 0; k < n[2]; ++k)
    for (size_t j = 0; j < n[1]; ++j) {
      context.check();
      for (size_t i = 0; i < n[0]; ++i)
        places.push_back(box.lo + box.size() * Vec3((double(i) + 0.5) / double(n[0]), (double(j) + 0.5) / double(n[1]),
                                                    (double(k) + 0.5) / double(n[2])));
    }
  return places;
}

DatasetPtr even_inside(const DatasetPtr& data, const GlyphPointsParams& p, const Box3& box, Context& context) {
  const int axes = extended_axes(box);
  double measure = 1;
  for (int a = 0; a < 3; ++a)
    if (box.size()[a] > 1e-6 * box.diagonal()) measure *= box.size()[a];
  double h = p.spacing > 0 ? p.spacing : std::pow(measure / double(p.count), 1.0 / axes);
  const size_t limit = std::max<size_t>(size_t(p.count) * 64, p.spacing > 0 ? 20'000'000 : 1'000'000);
  DatasetPtr out = inside(data, grid_places(*data, box, h, limit, context), SIZE_MAX, context);
  // The mesh may fill a part of its box only.
  for (int round = 0; round < 2 && p.spacing == 0 && double(out->point_count()) < 0.75 * double(p.count) && out->point_count() > 0;
       ++round) {
    h *= std::pow(double(out->point_count()) / double(p.count), 1.0 / axes);
    const double boxes = measure / std::pow(h, axes);
    if (boxes > double(limit)) break;
    out = inside(data, grid_places(*data, box, h, limit, context), SIZE_MAX, context);
  }
  return out;
}

// Of the points in each box of a grid the one nearest to its middle; the edge of the boxes is found by halving.
DatasetPtr even_points(const DatasetPtr& data, const GlyphPointsParams& p, const Box3& box) {
  const Array xyz = point_positions(data->mesh());
  std::vector<int64_t> ids = visible_points(*data, 1);
  std::erase_if(ids, [&](int64_t i) { return !all_finite(at(xyz, size_t(i))); });
  if (ids.size() <= size_t(p.count) && p.spacing == 0) return chosen(data, ids);
  auto box_of = [&](Vec3 q, double h) {
    uint64_t key = 0;
    for (int a = 0; a < 3; ++a) key = key << 21 | uint64_t(std::clamp((q[a] - box.lo[a]) / h, 0.0, 2e6));
    return key;
  };
  auto boxes = [&](double h) {
    std::vector<uint64_t> keys;
    for (const int64_t i : ids) keys.push_back(box_of(at(xyz, size_t(i)), h));
    std::sort(keys.begin(), keys.end());
    return size_t(std::unique(keys.begin(), keys.end()) - keys.begin());
  };
  double h = p.spacing;
  if (h == 0) {
    double lo = box.diagonal() * 1e-6, hi = box.diagonal();
    for (int round = 0; round < 24; ++round) {
      h = std::sqrt(lo * hi);
      const size_t n = boxes(h);
      if (n > size_t(p.count)) lo = h;
      else hi = h;
      if (double(n) > 0.97 * double(p.count) && double(n) < 1.03 * double(p.count)) break;
    }
  }
  struct Candidate {
    uint64_t key;
    double distance;
    int64_t id;
  };
  std::vector<Candidate> all;
  for (const int64_t i : ids) {
    const Vec3 q = at(xyz, size_t(i));
    Vec3 middle;
    for (int a = 0; a < 3; ++a) middle[a] = box.lo[a] + (std::floor((q[a] - box.lo[a]) / h) + 0.5) * h;
    all.push_back({box_of(q, h), dot(q - middle, q - middle), i});
  }
  std::sort(all.begin(), all.end(),
            [](const Candidate& a, const Candidate& b) { return std::tie(a.key, a.distance, a.id) < std::tie(b.key, b.distance, b.id); });
  std::vector<int64_t> kept;
  for (size_t k = 0; k < all.size(); ++k)
    if (k == 0 || all[k].key != all[k - 1].key) kept.push_back(all[k].id);
  std::sort(kept.begin(), kept.end());
  return chosen(data, kept);
}

DatasetPtr cell_middles(const DatasetPtr& data, Context& context) {
  // A cloud is read as vertices, but has no cells that could carry fields.
  if (data->cell_count() == 0) return cloud({}, middle_of(*data), {});
  CellReader reader(data);
  std::vector<Vec3> places;
  std::vector<int64_t> ids;
  for (size_t c = 0; c < reader.count(); ++c) {
    if (reader.hidden(c)) continue;
    reader.open(c);
    if (reader.at().empty()) continue;
    Vec3 sum;
    for (const Vec3& q : reader.at()) sum += q;
    sum = sum / double(reader.at().size());
    if (!all_finite(sum)) continue;
    places.push_back(sum), ids.push_back(int64_t(c));
  }
  const DatasetPtr averaged = point_to_cell(data, {}, context);
  FieldSet fields;
  carry_gathered(fields, averaged->fields(), Association::cell, std::span<const int64_t>(ids), Association::point);
  for (const Field& f : data->fields())  // the cells' own go before the means of points
    if (f.association == Association::cell) {
      Field g = f;
      g.association = Association::point, g.array = gather(f.array, std::span<const int64_t>(ids));
      fields.add(std::move(g));
    }
  carry_whole(fields, data->fields());
  return cloud(places, middle_of(*data), std::move(fields));
}

// Uniform by area: the triangle by a random share of the sum, the place in it by two more.
DatasetPtr random_on_surface(const DatasetPtr& data, const GlyphPointsParams& p) {
  const SurfaceMesh& mesh = *data->as<SurfaceMesh>();
  const Triangles t = triangles_of(mesh);
  std::vector<double> sum(t.count());
  double area = 0;
  for (size_t i = 0; i < t.count(); ++i) {
    const Vec3 a = mesh.points.at(t.indices[3 * i]), b = mesh.points.at(t.indices[3 * i + 1]), c = mesh.points.at(t.indices[3 * i + 2]);
    const double own = 0.5 * length(cross(b - a, c - a));
    sum[i] = area += std::isfinite(own) ? own : 0;
  }
  if (!(area > 0)) fail_usage("the surface has no area", "glyph_points", "use mode=all for its points");
  check_places(*data, double(p.count));
  std::vector<Vec3> places;
  std::vector<int64_t> ids, cells;
  std::vector<double> weights;
  for (uint64_t k = 0; k < uint64_t(p.count); ++k) {
    const auto seed = uint64_t(p.seed);
    const double share = random_unit(seed, 3 * k) * area;
    const size_t i = std::min(size_t(std::upper_bound(sum.begin(), sum.end(), share) - sum.begin()), t.count() - 1);
    const double r = std::sqrt(random_unit(seed, 3 * k + 1)), s = random_unit(seed, 3 * k + 2);
    const double w[3] = {1 - r, r * (1 - s), r * s};
    Vec3 q;
    for (size_t c = 0; c < 3; ++c) {
      q += mesh.points.at(t.indices[3 * i + c]) * w[c];
      ids.push_back(int64_t(t.indices[3 * i + c])), weights.push_back(w[c]);
    }
    places.push_back(q), cells.push_back(int64_t(t.cell(i) + (t.cells.empty() ? mesh.vertices.size() + mesh.lines.size() : 0)));
  }
  FieldSet fields;
  carry_gathered(fields, data->fields(), Association::cell, std::span<const int64_t>(cells), Association::point);
  carry_combined(fields, data->fields(), Association::point, ids, weights, 3, Association::point);
  carry_whole(fields, data->fields());
  return cloud(places, middle_of(*data), std::move(fields));
}

DatasetPtr random_places(const DatasetPtr& data, const GlyphPointsParams& p, const Box3& box, Context& context) {
  const auto* surface = data->as<SurfaceMesh>();
  if (surface && surface->polygons.size() + surface->strips.size() > 0) return random_on_surface(data, p);
  const auto seed = uint64_t(p.seed);
  if (fills_its_box(*data, box)) {
    // Random places of the box until enough of them lie in the mesh.
    size_t tried = size_t(p.count);
    for (int round = 0;; ++round) {
      check_places(*data, double(tried));
      std::vector<Vec3> places;
      for (uint64_t k = 0; k < tried; ++k)
        places.push_back(box.lo + box.size() * Vec3(random_unit(seed, 3 * k), random_unit(seed, 3 * k + 1), random_unit(seed, 3 * k + 2)));
      DatasetPtr out = inside(data, places, size_t(p.count), context);
      if (out->point_count() == size_t(p.count) || round == 4 || tried > 100'000'000) return out;
      const double share = std::max(double(out->point_count()) / double(tried), 0.01);
      tried = size_t(double(p.count) / share * 1.1) + 64;
    }
  }
  // The points with the smallest random numbers.
  std::vector<int64_t> ids = visible_points(*data, 1);
  auto before = [&](int64_t a, int64_t b) {
    return std::pair(random_bits(seed, uint64_t(a)), a) < std::pair(random_bits(seed, uint64_t(b)), b);
  };
  if (ids.size() > size_t(p.count)) {
    std::nth_element(ids.begin(), ids.begin() + p.count, ids.end(), before);
    ids.resize(size_t(p.count));
  }
  std::sort(ids.begin(), ids.end(), before);
  return chosen(data, ids);
}

DatasetPtr apart_places(const DatasetPtr& data, const GlyphPointsParams& p, const Box3& box) {
  const Array xyz = point_positions(data->mesh());
  std::vector<double> diameter(data->point_count(), p.spacing > 0 ? p.spacing : typical_spacing(*data, 2000));
  if (!p.diameter.empty()) {
    const Field& f = data->fields().require(p.diameter.name, Association::point);
    const Array sizes = scalar_of(f, f.components() > 1 ? -1 : 0, ElementType::f64);
    for (size_t i = 0; i < diameter.size(); ++i) diameter[i] = std::abs(sizes.get(i)) * p.scale;
  }
  std::vector<int64_t> ids = visible_points(*data, 1);
  std::erase_if(
      ids, [&](int64_t i) { return !all_finite(at(xyz, size_t(i))) || !std::isfinite(diameter[size_t(i)]) || !(diameter[size_t(i)] > 0); });
  std::stable_sort(ids.begin(), ids.end(), [&](int64_t a, int64_t b) { return diameter[size_t(a)] > diameter[size_t(b)]; });
  if (ids.empty()) return chosen(data, ids);
  const Vec3 away = p.view ? normalize(*p.view) : Vec3{};
  if (p.view && !(length(away) > 0)) fail_usage("the viewing direction has no length", "glyph_points: view");
  auto place = [&](int64_t i) {
    const Vec3 q = at(xyz, size_t(i)) - box.center();
    return q - away * dot(q, away);
  };
  NeighbourGrid grid(diameter[size_t(ids[0])]);
  std::vector<int64_t> kept;
  for (const int64_t i : ids) {
    const Vec3 q = place(i);
    const double own = diameter[size_t(i)];
    if (!grid.any(q, [&](Vec3 other, int64_t j) { return length(other - q) < 0.5 * (own + diameter[size_t(j)]); })) {
      grid.add(q, i);
      kept.push_back(i);
    }
  }
  std::sort(kept.begin(), kept.end());
  return chosen(data, kept);
}

}  // namespace

int extended_axes(const Box3& box, int* flat_axis) {
  int axes = 0;
  for (int a = 0; a < 3; ++a) {
    if (!box.empty() && box.size()[a] > 1e-6 * box.diagonal()) ++axes;
    else if (flat_axis) *flat_axis = a;
  }
  return axes;
}

double typical_spacing(const Dataset& d, size_t places) {
  const Box3& box = d.bounds();
  const int axes = extended_axes(box);
  if (axes == 0 || places == 0) return 1;
  double measure = 1;
  for (int a = 0; a < 3; ++a)
    if (box.size()[a] > 1e-6 * box.diagonal()) measure *= box.size()[a];
  const auto* s = d.as<SurfaceMesh>();
  if (axes < 3 || !s || s->polygons.size() + s->strips.size() == 0) return std::pow(measure / double(places), 1.0 / axes);
  const Triangles t = triangles_of(*s);
  double area = 0;
  for (size_t i = 0; i < t.count(); ++i) {
    const Vec3 a = s->points.at(t.indices[3 * i]);
    const double own = 0.5 * length(cross(s->points.at(t.indices[3 * i + 1]) - a, s->points.at(t.indices[3 * i + 2]) - a));
    if (std::isfinite(own)) area += own;
  }
  return area > 0 ? std::sqrt(area / double(places)) : std::pow(measure / double(places), 1.0 / axes);
}

DatasetPtr glyph_points(const DatasetPtr& data, const GlyphPointsParams& p, Context& context) {
  const Box3& box = data->bounds();
  if (p.mode == GlyphPlaces::all) return chosen(data, visible_points(*data, 1));
  if (p.mode == GlyphPlaces::every) return chosen(data, visible_points(*data, p.every));
  if (p.mode == GlyphPlaces::cells) return cell_middles(data, context);
  if (p.mode == GlyphPlaces::lines) return points_along_lines(data, p);
  if (box.empty()) return chosen(data, {});
  if (p.mode == GlyphPlaces::random) return random_places(data, p, box, context);
  if (p.mode == GlyphPlaces::apart) return apart_places(data, p, box);
  return fills_its_box(*data, box) ? even_inside(data, p, box, context) : even_points(data, p, box);
}

}  // namespace sg
