// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/bands.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/cells/cell_topology.h"
#include "data/field_ops.h"
#include "data/fields/known_looks.h"
#include "data/ranks/over_all.h"
#include "filter/field/automatic_values.h"
#include "filter/scalar/contour/cells/cell_cases.h"
#include "filter/surface/polygons.h"

namespace sg {

namespace {

// A point of the result: an input point (lo == hi), or the place on edge lo-hi where the field has value number `level`.
struct Node {
  uint32_t lo, hi;
  int32_t level;
  friend bool operator==(const Node&, const Node&) = default;
  friend bool operator<(const Node& a, const Node& b) {
    return a.lo != b.lo ? a.lo < b.lo : a.hi != b.hi ? a.hi < b.hi : a.level < b.level;
  }
};

using Ring = std::vector<Node>;

struct Pieces {
  std::vector<Node> nodes;
  std::vector<uint32_t> sizes;
  std::vector<int32_t> bands;
  std::vector<int64_t> cells;
  size_t nan = 0;

  void add(const Ring& ring, int32_t band, int64_t cell) {
    if (ring.size() < 3) return;
    nodes.insert(nodes.end(), ring.begin(), ring.end());
    sizes.push_back(uint32_t(ring.size())), bands.push_back(band), cells.push_back(cell);
  }
};

// Cuts one polygon; holds what that needs from one polygon to the next.
class Cutter {
 public:
  Cutter(const std::vector<double>& f, const std::vector<int32_t>& rank, const std::vector<double>& levels)
      : f_(f), rank_(rank), levels_(levels) {}

  /// A polygon whose ranks differ; convex, or a triangle.
  void cut(std::span<const int64_t> p, int64_t cell, Pieces& out) {
    const size_t n = p.size();
    Ring whole;
    int32_t lowest = INT32_MAX, highest = 0;
    for (size_t k = 0; k < n; ++k) {
      const auto a = uint32_t(p[k]), b = uint32_t(p[(k + 1) % n]);
      const int32_t ra = rank_[a], rb = rank_[b];
      lowest = std::min(lowest, ra), highest = std::max(highest, ra);
      whole.push_back({a, a, -1});
      auto cross = [&](int32_t level, uint32_t upper) {  // a corner that has the value is the place itself
        if (f_[upper] != levels_[size_t(level)]) whole.push_back({std::min(a, b), std::max(a, b), level});
      };
      for (int32_t l = ra; l < rb; ++l) cross(l, b);
      for (int32_t l = ra - 1; l >= rb; --l) cross(l, a);
    }
    std::vector<Ring> rings{std::move(whole)};
    divide(p, rings, lowest, highest, cell, out);
  }

 private:
  enum Side : uint8_t { low, high, on };

  // The parts of rings with these ranks, by rising band. From the lowest band on each cut copies what is left, so that many bands are
  // halved first.
  void divide(std::span<const int64_t> p, std::vector<Ring>& rings, int32_t lowest, int32_t highest, int64_t cell, Pieces& out) {
    constexpr int32_t many = 64;
    std::vector<Ring> below, above;
    if (highest - lowest > many) {
      const int32_t middle = lowest + (highest - lowest) / 2;
      for (const Ring& ring : rings)
        split(ring, middle, joins_high(p, middle), [&](Ring part, Side s) { (s == low ? below : above).push_back(std::move(part)); });
      rings.clear();
      divide(p, below, lowest, middle, cell, out);
      return divide(p, above, middle + 1, highest, cell, out);
    }
    for (int32_t level = lowest; level < highest; ++level) {
      above.clear();
      for (const Ring& ring : rings)
        split(ring, level, joins_high(p, level), [&](Ring part, Side s) {
          if (s == low) out.add(part, level, cell);
          else above.push_back(std::move(part));
        });
      std::swap(rings, above);
    }
    for (const Ring& ring : rings) out.add(ring, highest, cell);
  }

  // Whether the saddle of a quadrilateral lies above the level.
  bool joins_high(std::span<const int64_t> p, int32_t level) const {
    const auto at = [&](size_t k) { return f_[size_t(p[k])] - levels_[size_t(level)]; };
    return p.size() == 4 && joined_inside(at(0), at(1), at(2), at(3));
  }

  Side side(const Ring& ring, size_t k, int32_t level) const {
    const Node& node = ring[k];
    if (node.level >= 0) return node.level < level ? low : node.level > level ? high : on;
    if (rank_[node.lo] <= level) return low;
    return f_[node.lo] == levels_[size_t(level)] ? on : high;
  }

  // Gives the parts below the level, and those above it. Runs of nodes on one side are cut off by a straight line between the places on
  // the level before and behind them.
  template <class Give>
  void split(const Ring& ring, int32_t level, bool join_high, Give&& give) {
    const size_t n = ring.size();
    side_.resize(n);
    size_t runs[2] = {0, 0};
    for (size_t k = 0; k < n; ++k) side_[k] = side(ring, k, level);
    for (size_t k = 0; k < n; ++k)
      if (const Side s = side_[k]; s != on && side_[(k + n - 1) % n] != s) ++runs[s];
    const bool any_low = std::count(side_.begin(), side_.end(), low) > 0, any_high = std::count(side_.begin(), side_.end(), high) > 0;
    if (!any_low || !any_high) return give(ring, any_low ? low : high);
    // Each run of `cut_off` becomes a polygon; what is left is one.
    const Side cut_off = runs[low] == 1 ? low : runs[high] == 1 ? high : join_high ? low : high;
    Ring rest;
    for (size_t k = 0; k < n; ++k) {
      if (side_[k] != cut_off) rest.push_back(ring[k]);
      if (side_[k] != cut_off || side_[(k + n - 1) % n] == cut_off) continue;
      Ring part{ring[(k + n - 1) % n]};
      size_t e = k;
      while (side_[e % n] == cut_off) part.push_back(ring[e++ % n]);
      if (!(ring[e % n] == part.front())) part.push_back(ring[e % n]);
      give(part, cut_off);
    }
    give(rest, cut_off == low ? high : low);
  }

  const std::vector<double>& f_;
  const std::vector<int32_t>& rank_;
  const std::vector<double>& levels_;
  std::vector<Side> side_;
};

// Turns left at every corner, seen along its normal?
bool is_convex(std::span<const Vec3> at) {
  const size_t n = at.size();
  const Vec3 normal = polygon_vector_area(at);
  for (size_t k = 0; k < n; ++k)
    if (dot(cross(at[(k + 1) % n] - at[k], at[(k + 2) % n] - at[(k + 1) % n]), normal) < 0) return false;
  return true;
}

std::vector<double> sorted_limits(std::vector<double> v) {
  for (double x : v)
    if (!std::isfinite(x)) fail_usage(fmt::format("{} is not a valid band limit", x), "bands values", "give finite numbers");
  std::sort(v.begin(), v.end());
  v.erase(std::unique(v.begin(), v.end()), v.end());
  return v;
}

const Field& band_field(const Dataset& s, const BandsParams& p) {
  const Field* f = nullptr;
  if (p.field.empty()) {
    f = s.fields().active(1);
    if (!f || f->association != Association::point)
      fail_usage("the mesh has no scalar point field", "bands",
                 "name one with field=NAME; cell_to_point turns cell fields into point fields");
  } else {
    f = s.fields().find(p.field.name, Association::point);
    if (!f) {
      const Field& other = with_context("bands", [&]() -> const Field& { return s.fields().require(p.field.name); });
      fail_usage(fmt::format("field '{}' is defined on the {}; bands need values at the points", other.name,
                             other.association == Association::cell ? "cells" : "whole mesh"),
                 "bands", other.association == Association::cell ? "cell_to_point turns it into a point field" : "");
    }
  }
  if (p.component >= f->components())
    fail_usage(fmt::format("field '{}' has {} components, not component {}", f->name, f->components(), p.component), "bands component");
  return *f;
}

std::vector<Pieces> cut_all(const SurfaceMesh& mesh, const std::vector<Vec3>& at, const std::vector<double>& f,
                            const std::vector<double>& levels, const Context& ctx) {
  std::vector<int32_t> rank(f.size());
  parallel_for(f.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) rank[i] = int32_t(std::upper_bound(levels.begin(), levels.end(), f[i]) - levels.begin());
  });
  const CellsView polygons = cells_view(mesh.polygons);
  const auto first = int64_t(mesh.vertices.size() + mesh.lines.size());
  constexpr size_t grain = 4096;
  std::vector<Pieces> parts((polygons.count + grain - 1) / grain);
  parallel_for(
      polygons.count, grain,
      [&](size_t begin, size_t end) {
        Pieces& out = parts[begin / grain];
        Cutter cutter(f, rank, levels);
        std::vector<int64_t> p;
        std::vector<Vec3> corner;
        std::vector<uint32_t> local;
        for (size_t c = begin; c < end; ++c) {
          p.clear();
          bool nan = false, same = true;
          for (size_t k = polygons.begin(c); k < polygons.end(c); ++k) {
            const int64_t id = polygons.connectivity[k];
            p.push_back(id);
            nan = nan || std::isnan(f[size_t(id)]);
            same = same && rank[size_t(id)] == rank[size_t(p[0])];
          }
          if (nan) ++out.nan;
          if (nan || p.size() < 3) continue;
          if (same) {
            Ring ring;
            for (int64_t id : p) ring.push_back({uint32_t(id), uint32_t(id), -1});
            out.add(ring, rank[size_t(p[0])], first + int64_t(c));
            continue;
          }
          if (p.size() > 3) {
            corner.clear();
            for (int64_t id : p) corner.push_back(at[size_t(id)]);
            if (!is_convex(corner)) {
              local.clear();
              tessellate_face(CellType::polygon, corner, local);
              for (size_t t = 0; t + 2 < local.size(); t += 3) {
                const int64_t three[3] = {p[local[t]], p[local[t + 1]], p[local[t + 2]]};
                cutter.cut(three, first + int64_t(c), out);
              }
              continue;
            }
          }
          cutter.cut(p, first + int64_t(c), out);
        }
      },
      &ctx);
  return parts;
}

}  // namespace

std::vector<double> choose_band_limits(const Dataset& in, const BandsParams& p, const Context& ctx) {
  return even_values(range_over_all(in, band_field(in, p), p.component, ctx), p.count - 1);
}

DatasetPtr bands(const DatasetPtr& in, const BandsParams& p, Context& ctx) {
  const DatasetPtr s = surface::polygon_surface(in, "bands", ctx);
  const SurfaceMesh& mesh = *s->as<SurfaceMesh>();
  const Field& field = band_field(*s, p);
  const Range range = range_over_all(*s, field, p.component, ctx);
  const std::vector<double> levels = sorted_limits(p.values.empty() ? choose_band_limits(*s, p, ctx) : p.values);
  const Array samples = scalar_of(field, field.components() > 1 ? p.component : 0, ElementType::f64);
  const std::vector<double> f(samples.view<double>().data, samples.view<double>().data + samples.count());
  const std::vector<Vec3> at = surface::positions(mesh.points);
  std::vector<Pieces> parts = cut_all(mesh, at, f, levels, ctx);

  // Number the points: those of the input that are used, then the cuts in order of their edges.
  std::vector<Node> cuts;
  std::vector<int64_t> number(at.size(), -1);
  const auto last_band = int32_t(levels.size());
  auto stays = [&](int32_t band) { return p.outside || (band > 0 && band < last_band); };
  auto each = [&](auto&& visit) {
    for (const Pieces& part : parts) {
      size_t k = 0;
      for (size_t i = 0; i < part.sizes.size(); k += part.sizes[i++])
        if (stays(part.bands[i])) visit(std::span(part.nodes).subspan(k, part.sizes[i]), part.bands[i], part.cells[i]);
    }
  };
  each([&](std::span<const Node> ring, int32_t, int64_t) {
    for (const Node& n : ring)
      if (n.level < 0) number[n.lo] = 0;
      else cuts.push_back(n);
  });
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  std::vector<EdgePoint> points;
  std::vector<double> xyz, exact;
  auto add = [&](uint32_t a, uint32_t b, double t, double value) {
    points.push_back({a, b, float(t)});
    const Vec3 x = a == b ? at[a] : at[a] + (at[b] - at[a]) * t;
    xyz.insert(xyz.end(), {x.x, x.y, x.z});
    exact.push_back(value);
  };
  for (size_t i = 0; i < number.size(); ++i)
    if (number[i] == 0) number[i] = int64_t(points.size()), add(uint32_t(i), uint32_t(i), 0, f[i]);
  const auto kept = int64_t(points.size());
  for (const Node& n : cuts) {
    const double v = levels[size_t(n.level)];
    add(n.lo, n.hi, (v - f[n.lo]) / (f[n.hi] - f[n.lo]), v);
  }
  std::vector<int64_t> cells;
  std::vector<int32_t> ids, offsets{0}, band;
  std::vector<double> low, high;
  each([&](std::span<const Node> ring, int32_t b, int64_t cell) {
    for (const Node& n : ring)
      ids.push_back(int32_t(n.level < 0 ? number[n.lo] : kept + (std::lower_bound(cuts.begin(), cuts.end(), n) - cuts.begin())));
    if (ids.size() > size_t(INT32_MAX)) fail_usage("the bands have more than 2^31 corners", "bands", "use fewer at a time");
    offsets.push_back(int32_t(ids.size())), band.push_back(b), cells.push_back(cell);
    low.push_back(b > 0 ? levels[size_t(b - 1)] : range.lo), high.push_back(b < last_band ? levels[size_t(b)] : range.hi);
  });
  size_t nan = 0;
  for (const Pieces& part : parts) nan += part.nan;
  if (nan > 0) ctx.info(fmt::format("bands: {} polygons with a corner without a value were left out", nan));
  if (band.empty() && mesh.polygons.size() > 0)
    ctx.info(fmt::format("bands: nothing is left; '{}' ranges from {} to {}", field.name, short_number(range.lo), short_number(range.hi)));

  DatasetParts out;
  carry_interpolated(out.fields, s->fields(), points);
  if (field.components() == 1) out.fields.add(field.with(Array::from_vector(std::move(exact)), Association::point));
  carry_gathered(out.fields, s->fields(), Association::cell, cells, Association::cell);
  carry_whole(out.fields, s->fields());
  out.fields.add({"band", Association::cell, Array::from_vector(std::move(band)), "", Role::labels, known_look("band")});
  mark_result(out.fields, "band", Association::cell);
  out.fields.add({"band low", Association::cell, Array::from_vector(std::move(low)), field.unit, Role::none});
  out.fields.add({"band high", Association::cell, Array::from_vector(std::move(high)), field.unit, Role::none});
  SurfaceMesh r;
  r.points.xyz = Array::from_vector(std::move(xyz), 3);
  r.polygons = {Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
  out.mesh = std::move(r);
  out.notes = s->notes();
  out.time = s->time();
  return make_dataset(std::move(out));
}

}  // namespace sg
