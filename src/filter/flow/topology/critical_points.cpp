// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/critical_points.h"

#include <fmt/core.h>

#include <algorithm>
#include <tuple>

#include "base/parallel.h"
#include "filter/flow/seeds/noise_speed.h"
#include "filter/flow/topology/mean_divergence.h"
#include "filter/flow/topology/zeros/cell_scan.h"
#include "filter/flow/topology/zeros/cell_zeros.h"
#include "filter/flow/topology/zeros/surface_zeros.h"
#include "filter/flow/topology/zeros/winding.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

struct Found {
  CellZero zero;
  int64_t cell;
  int32_t part;
};

struct Search {
  std::vector<Found> zeros;  // in order of cells
  std::vector<int64_t> spread_points;
  size_t spread = 0;
};

Search search_cells(const FlowField& flow, int32_t number, const PlaneFrame* frame, double min_speed, Context& context) {
  const std::vector<uint64_t> cells = cells_that_may_vanish(flow, frame, context);
  constexpr size_t grain = 64;
  std::vector<Search> parts((cells.size() + grain - 1) / grain);
  parallel_for(
      cells.size(), grain,
      [&](size_t begin, size_t end) {
        CellZeros finder(flow, frame, min_speed);
        Search& part = parts[begin / grain];
        std::vector<CellZero> found;
        for (size_t i = begin; i < end; ++i) {
          found.clear();
          part.spread += finder.find(cells[i], found) == CellZeros::Result::spread;
          std::sort(found.begin(), found.end(), [](const CellZero& a, const CellZero& b) {
            return std::tuple(a.rst.z, a.rst.y, a.rst.x, a.at.x, a.at.y, a.at.z) <
                   std::tuple(b.rst.z, b.rst.y, b.rst.x, b.at.x, b.at.y, b.at.z);
          });
          for (const CellZero& z : found) part.zeros.push_back({z, int64_t(cells[i]), number});
        }
        part.spread_points = std::move(finder.spread_points());
      },
      &context);
  Search all;
  for (Search& p : parts) {
    all.zeros.insert(all.zeros.end(), p.zeros.begin(), p.zeros.end());
    all.spread_points.insert(all.spread_points.end(), p.spread_points.begin(), p.spread_points.end());
    all.spread += p.spread;
  }
  std::sort(all.spread_points.begin(), all.spread_points.end());
  all.spread_points.erase(std::unique(all.spread_points.begin(), all.spread_points.end()), all.spread_points.end());
  // A point of zero velocity in an area of zeros is not isolated.
  std::erase_if(all.zeros, [&](const Found& f) {
    return f.zero.node >= 0 && std::binary_search(all.spread_points.begin(), all.spread_points.end(), f.zero.node);
  });
  return all;
}

// The same zero? Those on borders of cells are found by each of them. Those of several parts may be one anywhere: parts may lie over each
// other. Interpolants of two levels or parts need not agree at their common border: there zeros of one index within a tenth of a cell are
// one.
bool are_one(const Found& f, const Found& g, bool several, bool flat) {
  const CellZero &a = f.zero, &b = g.zero;
  const double small = std::min(a.size, b.size), d = length(a.at - b.at);
  if (f.cell == g.cell && f.part == g.part) return false;
  const bool apart = several && (f.part != g.part || std::max(a.size, b.size) > 1.5 * small);
  if (d <= 1e-5 * small) return apart || (a.border && b.border);
  auto negative = [&](const Mat3& m) {
    if (!flat) return determinant(m) < 0;
    double product = 0;  // of the two eigenvalues other than the zero across the plane
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < i; ++j) product += m.m[i][i] * m.m[j][j] - m.m[i][j] * m.m[j][i];
    return product < 0;
  };
  return apart && d <= 0.1 * small && negative(a.gradient) == negative(b.gradient);
}

// One for all that are the same, of the finest cell, with the mean of the gradients. `several`: parts or levels.
std::vector<Found> merged(std::vector<Found> zeros, bool several, bool flat) {
  std::vector<size_t> order;
  for (size_t i = 0; i < zeros.size(); ++i)
    if (zeros[i].zero.border || several) order.push_back(i);
  std::sort(order.begin(), order.end(),
            [&](size_t a, size_t b) { return std::tuple(zeros[a].zero.at.x, a) < std::tuple(zeros[b].zero.at.x, b); });
  std::vector<size_t> first(zeros.size());
  for (size_t i = 0; i < first.size(); ++i) first[i] = i;
  auto root = [&](size_t i) {
    while (first[i] != i) i = first[i] = first[first[i]];
    return i;
  };
  for (size_t i = 0; i < order.size(); ++i) {
    const Found& f = zeros[order[i]];
    for (size_t j = i + 1; j < order.size(); ++j) {
      const Found& g = zeros[order[j]];
      if (g.zero.at.x - f.zero.at.x > (several ? 0.1 : 1e-5) * f.zero.size) break;
      if (!are_one(f, g, several, flat)) continue;
      const size_t p = root(order[i]), q = root(order[j]);
      first[std::max(p, q)] = std::min(p, q);
    }
  }
  std::vector<Mat3> sum(zeros.size());
  std::vector<int> count(zeros.size(), 0);
  std::vector<size_t> finest(zeros.size());
  for (size_t i = 0; i < zeros.size(); ++i) {
    const size_t r = root(i);
    if (count[r] == 0 || zeros[i].zero.size < 0.999 * zeros[finest[r]].zero.size) finest[r] = i;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) sum[r].m[a][b] = (count[r] ? sum[r].m[a][b] : 0) + zeros[i].zero.gradient.m[a][b];
    ++count[r];
  }
  std::vector<Found> out;
  for (size_t i = 0; i < zeros.size(); ++i) {
    if (root(i) != i) continue;
    Found f = zeros[finest[i]];
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) f.zero.gradient.m[a][b] = sum[i].m[a][b] / count[i];
    out.push_back(f);
  }
  return out;
}

// Where the gradient does not decide the index: by a walk around the point.
int index_about(PartsCursor& cursor, const PlaneFrame& frame, Vec3 at, double radius) {
  constexpr size_t n = 720;
  std::vector<Vec2> v;
  for (size_t i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * double(i) / double(n);
    Vec3 u;
    if (!cursor(at + radius * (std::cos(angle) * frame.e1 + std::sin(angle) * frame.e2), u)) return 0;
    v.push_back(frame.project(u));
  }
  return winding_index(v).value_or(0);
}

// Of slow points those that are crowded are noise: in a sufficiently sampled flow its few cells are far apart.
void drop_noise(CriticalPoints& r, double slow) {
  const auto& points = r.points;
  std::vector<size_t> order(points.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return std::pair(points[a].at.x, a) < std::pair(points[b].at.x, b); });
  double largest = 0;
  for (const CriticalPoint& c : points) largest = std::max(largest, c.size);
  std::vector<uint8_t> crowded(points.size(), 0);
  for (size_t i = 0; i < order.size(); ++i)
    for (size_t j = i + 1; j < order.size(); ++j) {
      const CriticalPoint &a = points[order[i]], &b = points[order[j]];
      if (b.at.x - a.at.x > 3 * largest) break;
      const double d = length(a.at - b.at);
      if (d < 3 * a.size) crowded[order[i]] = 1;
      if (d < 3 * b.size) crowded[order[j]] = 1;
    }
  size_t kept = 0;
  for (size_t i = 0; i < r.points.size(); ++i) {
    if (crowded[i] && r.points[i].speed < slow) continue;
    if (kept != i) {
      r.points[kept] = r.points[i];
      if (!r.normal.empty()) r.normal[kept] = r.normal[i];
    }
    ++kept;
  }
  r.noise = r.points.size() - kept;
  if (r.noise > 0) r.slow = slow;
  r.points.resize(kept);
  if (!r.normal.empty()) r.normal.resize(kept);
}

// Spirals whose slow growth is an error of interpolation: the mean divergence about them is not half as large, or has the other sign.
bool centre_but_for_errors(PartsCursor& flow, const CriticalPoint& c, Vec3 normal) {
  using enum CriticalType;
  if (c.flow.type != attracting_focus && c.flow.type != repelling_focus) return false;
  const double growth = c.flow.re[0];
  if (std::abs(growth) > 0.1 * std::abs(c.flow.im[0])) return false;
  for (const double radius : {1.5 * c.size, 0.75 * c.size})
    if (const auto d = mean_divergence(flow, c.at, normal, radius)) return !(0.5 * *d * growth > 0.5 * growth * growth);
  return false;
}

void find_in_cells(const FlowParts& flow, const CriticalOptions& options, CriticalPoints& r, Context& context) {
  const PlaneFrame* frame = r.plane ? &*r.plane : nullptr;
  std::vector<Found> zeros;
  for (size_t k = 0; k < flow.count(); ++k) {
    Search s = search_cells(flow.fields()[k], int32_t(k), frame, options.min_speed * flow.largest_speed(), context);
    r.spread += s.spread;
    zeros.insert(zeros.end(), s.zeros.begin(), s.zeros.end());
  }
  std::optional<PartsCursor> cursor;
  const bool several = flow.count() > 1 || flow.fields()[0].dataset()->as<AmrGrid>();
  for (const Found& f : merged(std::move(zeros), several, frame)) {
    CriticalPoint c;
    c.at = f.zero.at, c.gradient = f.zero.gradient, c.cell = f.cell, c.part = f.part, c.size = f.zero.size, c.speed = f.zero.speed;
    c.flow = frame ? linearise_in_plane(c.gradient, frame->e1, frame->e2, options.centre) : linearise(c.gradient, options.centre);
    c.index = c.flow.index;
    if (frame && c.flow.type == CriticalType::degenerate) {
      if (!cursor) cursor.emplace(flow);
      c.index = index_about(*cursor, *frame, c.at, 0.02 * c.size);
    }
    if (frame && options.centre > 0) {
      if (!cursor) cursor.emplace(flow);
      if (centre_but_for_errors(*cursor, c, frame->normal)) c.flow.type = CriticalType::centre;
    }
    r.points.push_back(c);
    if (frame) r.normal.push_back(frame->normal);
  }
}

}  // namespace

CriticalPoints find_critical_points(const FlowParts& flow, const CriticalOptions& options, Context& context) {
  CriticalPoints r;
  r.dimension = flow.dimension();
  if (r.dimension < 2)
    fail_usage("the mesh has no cells with area or volume", "critical_points", "use a grid or a mesh of 2D or solid cells");
  if (r.dimension == 2) {
    std::vector<const Dataset*> parts;
    for (const FlowField& f : flow.fields()) parts.push_back(f.dataset().get());
    r.plane = plane_of(parts);
  }
  if (r.dimension == 2 && !r.plane) find_surface_zeros(flow, options, r, context);
  else find_in_cells(flow, options, r, context);
  if (options.noise > 0) drop_noise(r, options.noise * flow.largest_speed());
  return r;
}

void describe(Schema& s, CriticalPointsParams& p) {
  s("field", p.field, "Velocity field; default: the active vectors.").takes(fields::vectors);
  describe(s, p.options);
}

void describe(Schema& s, CriticalOptions& p) {
  s("centre", p.centre,
    "A spiral whose growth rate (real part) is at most this fraction of its rotation rate (imaginary part) counts as a centre, since "
    "sampled divergence-free flows have exact centres only up to rounding. In flat meshes so does a slow spiral whose growth is not "
    "confirmed by the flux around it; 0: neither.")
      .at_least(0);
  s("min_speed", p.min_speed,
    "Cells slower than this fraction of the largest speed at all their points are left out: noise has many zeros.")
      .range(0, 1);
  s("noise", p.noise,
    "In cells slower than this fraction of the largest speed at all their points, critical points with another one within three cells are "
    "left out as noise; isolated ones stay, however slow. In scans that are mostly noise, 0 means 0.02.")
      .range(0, 1);
}

std::string summary(const CriticalPoints& found) {
  size_t count[critical_types] = {};
  int sum = 0;
  for (const CriticalPoint& c : found.points) ++count[size_t(c.flow.type)], sum += c.index;
  std::string text = fmt::format("{} critical point{}", found.points.size(), found.points.size() == 1 ? "" : "s");
  const char* sign = ": ";
  for (int t = 0; t < critical_types; ++t) {
    if (!count[t]) continue;
    text += fmt::format("{}{} {}", sign, count[t], critical_type_name(CriticalType(t)));
    sign = "; ";
  }
  if (!found.points.empty()) text += fmt::format("; indices sum to {}", sum);
  if (found.noise > 0) text += fmt::format("; {} left out as noise", found.noise);
  if (found.spread > 0)
    text += fmt::format("; {} cell{} with lines or areas of zeros left out", found.spread, found.spread == 1 ? "" : "s");
  return text;
}

DatasetPtr critical_points_dataset(const CriticalPoints& found) {
  const size_t n = found.points.size();
  const size_t vectors = found.dimension == 3 ? 3 : 2;
  std::vector<double> xyz, re, im, gradient, normal;
  std::vector<std::vector<double>> vector(vectors);
  std::vector<int32_t> type, index, part;
  std::vector<int64_t> cell;
  auto push = [](std::vector<double>& to, Vec3 v) { to.insert(to.end(), {v.x, v.y, v.z}); };
  for (size_t i = 0; i < n; ++i) {
    const CriticalPoint& c = found.points[i];
    push(xyz, c.at);
    type.push_back(int32_t(c.flow.type)), index.push_back(c.index), cell.push_back(c.cell), part.push_back(c.part);
    for (size_t k = 0; k < vectors; ++k) {
      re.push_back(c.flow.re[k]), im.push_back(c.flow.im[k]);
      push(vector[k], c.flow.vector[k]);
    }
    for (const auto& row : c.gradient.m) gradient.insert(gradient.end(), row, row + 3);
    if (!found.normal.empty()) push(normal, found.normal[i]);
  }
  DatasetParts parts;
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::move(xyz), 3);
  parts.mesh = std::move(cloud);
  auto add = [&](std::string name, Array a, Role role = Role::none) {
    parts.fields.add({std::move(name), Association::point, std::move(a), "", role});
  };
  add("type", Array::from_vector(std::move(type)), Role::labels);
  add("index", Array::from_vector(std::move(index)));
  add("eigenvalues real", Array::from_vector(std::move(re), int(vectors)));
  add("eigenvalues imaginary", Array::from_vector(std::move(im), int(vectors)));
  for (size_t k = 0; k < vectors; ++k) add(fmt::format("eigenvector {}", k + 1), Array::from_vector(std::move(vector[k]), 3));
  add("gradient", Array::from_vector(std::move(gradient), 9), Role::tensors);
  if (!found.normal.empty()) add("normal", Array::from_vector(std::move(normal), 3), Role::normals);
  parts.fields.add(id_field("cell", Association::point, std::move(cell)));
  if (std::any_of(part.begin(), part.end(), [](int32_t k) { return k > 0; }))
    add("part", Array::from_vector(std::move(part)), Role::labels);
  std::string names;
  for (int t = 0; t < critical_types; ++t) names += fmt::format("{}{}={}", t ? "\n" : "", t, critical_type_name(CriticalType(t)));
  parts.notes.emplace_back("labels of type", names);
  return make_dataset(std::move(parts));
}

DatasetPtr critical_points(const Data& in, const CriticalPointsParams& p, Context& context) {
  const FlowParts flow(in, p.field.name, "critical_points", context);
  CriticalOptions options = p.options;
  if (options.noise == 0)  // not given
    for (const FlowField& f : flow.fields())
      if (noise_speed(*f.dataset(), f.field()) > 0) {
        options.noise = 0.02;
        context.info(
            fmt::format("most of '{}' is noise: in cells slower than 2 % of its largest speed only isolated critical points are kept; "
                        "noise=1e-9 keeps all",
                        flow.name()));
        break;
      }
  const CriticalPoints found = find_critical_points(flow, options, context);
  context.info("critical_points: " + summary(found));
  return critical_points_dataset(found);
}

}  // namespace sg
