// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/degenerate/degenerate_points.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "filter/mesh/surface_builder.h"
#include "filter/tensor/tensor_sampler.h"

namespace sg {

namespace {

struct Found {
  Vec3 at;
  double delta = 0, eigenvalue = 0;
  int separatrices = 0;
  Vec3 along[3]{{NAN, NAN, NAN}, {NAN, NAN, NAN}, {NAN, NAN, NAN}};
  int64_t cell = 0;
};

// A corner in the plane of its cell: position, deviator (f, g) and mean of the tensor.
struct Corner {
  double u, w, f, g, mean;
};

struct Plane {
  Vec3 origin, u, w;
  Corner corner(Vec3 at, const SymTensor& d) const {
    const Vec3 off = at - origin;
    const double uu = d.along(u), ww = d.along(w);
    return {dot(off, u), dot(off, w), (uu - ww) / 2, dot(u, d * w), (uu + ww) / 2};
  }
  Vec3 position(double a, double b) const { return origin + u * a + w * b; }
};

Plane plane_of(std::span<const Vec3> ring) {
  Vec3 n;
  for (size_t i = 1; i + 1 < ring.size(); ++i) n += cross(ring[i] - ring[0], ring[i + 1] - ring[0]);
  n = normalize(n);
  // Cells in the xy-plane keep x and y.
  if (std::abs(n.z) == 1) return {ring[0], {1, 0, 0}, {0, 1, 0}};
  const Vec3 u = normalize(ring[1] - ring[0]);
  return {ring[0], u, cross(n, u)};
}

// Directions in which lines of the larger eigenvalue run straight into the point, from the gradients of f and g: along the angle t the
// deviator is (F, G) = (a cos t + b sin t, c cos t + d sin t), and the line is radial where it turns by 2 t.
void find_separatrices(double a, double b, double c, double d, const Plane& plane, Found& out) {
  auto across = [&](double t) {
    return (c * std::cos(t) + d * std::sin(t)) * std::cos(2 * t) - (a * std::cos(t) + b * std::sin(t)) * std::sin(2 * t);
  };
  auto along = [&](double t) {
    return (a * std::cos(t) + b * std::sin(t)) * std::cos(2 * t) + (c * std::cos(t) + d * std::sin(t)) * std::sin(2 * t);
  };
  constexpr int steps = 720;  // roots of a trigonometric polynomial of order 3; two closer than half a degree count as none
  for (int i = 0; i < steps; ++i) {
    double lo = 2 * M_PI * (i + 0.3) / steps, hi = 2 * M_PI * (i + 1.3) / steps, at_lo = across(lo);
    if (at_lo * across(hi) > 0) continue;
    for (int k = 0; k < 50; ++k) {
      const double mid = (lo + hi) / 2, v = across(mid);
      if (at_lo * v <= 0) hi = mid;
      else lo = mid, at_lo = v;
    }
    if (along(lo) > 0 && out.separatrices < 3) out.along[out.separatrices++] = plane.u * std::cos(lo) + plane.w * std::sin(lo);
  }
}

void add(std::vector<Found>& out, const Plane& plane, double u, double w, double mean, const double (&slopes)[4], int64_t cell) {
  Found x;
  x.at = plane.position(u, w), x.eigenvalue = mean, x.cell = cell;
  const auto [a, b, c, d] = slopes;
  x.delta = a * d - b * c;
  find_separatrices(a, b, c, d, plane, x);
  out.push_back(x);
}

// Nothing is rounded away at corners and edges; points found twice are removed later.
constexpr double slack = 1e-12;

bool in_triangle(const Plane& plane, const Corner& p, const Corner& q, const Corner& r, int64_t cell, std::vector<Found>& out) {
  const double f1 = q.f - p.f, f2 = r.f - p.f, g1 = q.g - p.g, g2 = r.g - p.g, det = f1 * g2 - f2 * g1;
  const double size = std::max({std::abs(p.f), std::abs(p.g), std::abs(q.f), std::abs(q.g), std::abs(r.f), std::abs(r.g)});
  if (!(size > 0)) return false;
  if (!(std::abs(det) > 1e-14 * size * size)) return true;
  const double s = (f2 * p.g - g2 * p.f) / det, t = (g1 * p.f - f1 * p.g) / det;
  if (s < -slack || t < -slack || s + t > 1 + slack) return true;
  const double u1 = q.u - p.u, u2 = r.u - p.u, w1 = q.w - p.w, w2 = r.w - p.w, area = u1 * w2 - u2 * w1;
  if (area == 0) return true;
  const double slopes[4] = {(f1 * w2 - f2 * w1) / area, (f2 * u1 - f1 * u2) / area, (g1 * w2 - g2 * w1) / area, (g2 * u1 - g1 * u2) / area};
  add(out, plane, p.u + s * u1 + t * u2, p.w + s * w1 + t * w2, p.mean + s * (q.mean - p.mean) + t * (r.mean - p.mean), slopes, cell);
  return true;
}

double bilinear(const double (&k)[4], double r, double s) { return k[0] + k[1] * r + k[2] * s + k[3] * r * s; }

// Roots in [0, 1] of the quadratic that is left when r is eliminated from two bilinear equations.
int roots_of(const double (&f)[4], const double (&g)[4], double* s) {
  const double a = f[3] * g[2] - f[2] * g[3], b = f[1] * g[2] - f[2] * g[1] + f[3] * g[0] - f[0] * g[3], c = f[1] * g[0] - f[0] * g[1];
  const double disc = b * b - 4 * a * c;
  if (disc < 0) return 0;
  const double q = -(b + (b < 0 ? -1 : 1) * std::sqrt(disc)) / 2;
  int n = 0;
  for (double root : {q / a, c / q})
    if (root >= -slack && root <= 1 + slack && (n == 0 || std::abs(root - s[0]) > 1e-12)) s[n++] = root;
  return n;
}

// Corners in the order (0,0), (1,0), (1,1), (0,1).
bool in_quad(const Plane& plane, const Corner (&k)[4], int64_t cell, std::vector<Found>& out) {
  auto coefficients = [&](double Corner::*m, double(&c)[4]) {
    c[0] = k[0].*m, c[1] = k[1].*m - k[0].*m, c[2] = k[3].*m - k[0].*m, c[3] = k[0].*m - k[1].*m + k[2].*m - k[3].*m;
  };
  double f[4], g[4], u[4], w[4], mean[4], s[2];
  coefficients(&Corner::f, f), coefficients(&Corner::g, g), coefficients(&Corner::u, u), coefficients(&Corner::w, w),
      coefficients(&Corner::mean, mean);
  double size = 0;
  for (const Corner& c : k) size = std::max({size, std::abs(c.f), std::abs(c.g)});
  if (!(size > 0)) return false;
  for (double* c : {f, g})
    for (int i = 0; i < 4; ++i) c[i] /= size;
  const int n = roots_of(f, g, s);
  for (int i = 0; i < n; ++i) {
    // r from whichever equation holds it better.
    const double by_f = f[1] + f[3] * s[i], by_g = g[1] + g[3] * s[i];
    const double r = std::abs(by_f) >= std::abs(by_g) ? -(f[0] + f[2] * s[i]) / by_f : -(g[0] + g[2] * s[i]) / by_g;
    if (!(r >= -slack && r <= 1 + slack)) continue;
    if (std::abs(bilinear(f, r, s[i])) + std::abs(bilinear(g, r, s[i])) > 1e-9) continue;
    const double ur = u[1] + u[3] * s[i], us = u[2] + u[3] * r, wr = w[1] + w[3] * s[i], ws = w[2] + w[3] * r, area = ur * ws - us * wr;
    const double fr = size * by_f, fs = size * (f[2] + f[3] * r), gr = size * by_g, gs = size * (g[2] + g[3] * r);
    if (area == 0 || fr * gs - fs * gr == 0) continue;
    const double slopes[4] = {(fr * ws - fs * wr) / area, (fs * ur - fr * us) / area, (gr * ws - gs * wr) / area,
                              (gs * ur - gr * us) / area};
    add(out, plane, bilinear(u, r, s[i]), bilinear(w, r, s[i]), bilinear(mean, r, s[i]), slopes, cell);
  }
  return true;
}

// False: the tensor is isotropic all over the cell.
bool in_cell(CellReader& reader, const TensorField& t, std::vector<Found>& out, std::vector<uint32_t>& triangles) {
  const auto ids = reader.ids();
  const auto at = reader.at();
  for (int64_t id : ids)
    if (!t.d[size_t(id)].finite()) return true;
  const CellType type = linear_type(reader.type());
  if ((type == CellType::quad || type == CellType::pixel) && ids.size() == 4) {
    const int pixel[4] = {0, 1, 3, 2}, quad[4] = {0, 1, 2, 3};
    const int* order = type == CellType::pixel ? pixel : quad;
    Vec3 ring[4];
    for (int i = 0; i < 4; ++i) ring[i] = at[size_t(order[i])];
    const Plane plane = plane_of(ring);
    Corner k[4];
    for (int i = 0; i < 4; ++i) k[i] = plane.corner(ring[i], t.d[size_t(ids[size_t(order[i])])]);
    return in_quad(plane, k, int64_t(reader.cell()), out);
  }
  triangles.clear();
  tessellate_face(reader.type(), at, triangles, reader.orders());
  bool some = false;
  for (size_t i = 0; i + 2 < triangles.size(); i += 3) {
    Vec3 ring[3];
    for (size_t c = 0; c < 3; ++c) ring[c] = at[triangles[i + c]];
    const Plane plane = plane_of(ring);
    Corner k[3];
    for (size_t c = 0; c < 3; ++c) k[c] = plane.corner(ring[c], t.d[size_t(ids[triangles[i + c]])]);
    some |= in_triangle(plane, k[0], k[1], k[2], int64_t(reader.cell()), out);
  }
  return some;
}

// Of points at one place the one of the first cell.
void drop_doubles(std::vector<Found>& all, double tolerance) {
  std::vector<size_t> order(all.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return all[a].at.x < all[b].at.x; });
  std::vector<uint8_t> gone(all.size());
  for (size_t i = 0; i < order.size(); ++i)
    for (size_t j = i + 1; j < order.size() && all[order[j]].at.x - all[order[i]].at.x <= tolerance; ++j)
      if (length(all[order[i]].at - all[order[j]].at) <= tolerance) gone[std::max(order[i], order[j])] = 1;
  size_t n = 0;
  for (size_t i = 0; i < all.size(); ++i)
    if (!gone[i]) all[n++] = all[i];
  all.resize(n);
}

}  // namespace

void describe(Schema& s, DegeneratePointsParams& p) { describe_tensors(s, p.tensors); }

DatasetPtr degenerate_points(const DatasetPtr& in, const DegeneratePointsParams& p, Context& ctx) {
  if (const int dimension = dimension_of_cells(in); dimension != 2)
    fail_usage(fmt::format("a mesh ({}) with cells of dimension {} has no degenerate points", in->kind(), dimension), "degenerate_points",
               dimension == 3 ? "slice it first, or use degenerate_lines" : "use a flat mesh or a surface");
  const TensorField t = read_point_tensors(in, p.tensors, "degenerate_points", ctx);
  const CellReader all_cells(in);
  constexpr size_t grain = 4096;
  const size_t n = all_cells.count();
  std::vector<std::vector<Found>> chunks(n / grain + 1);
  const size_t isotropic = parallel_reduce(
      n, grain, size_t(0),
      [&](size_t begin, size_t end) {
        CellReader reader = all_cells;
        std::vector<uint32_t> triangles;
        size_t none = 0;
        for (size_t c = begin; c < end; ++c) {
          if (reader.hidden(c)) continue;
          reader.open(c);
          if (reader.dimension() == 2) none += !in_cell(reader, t, chunks[begin / grain], triangles);
        }
        return none;
      },
      [](size_t a, size_t b) { return a + b; }, &ctx);
  if (isotropic > 0) ctx.info(fmt::format("degenerate_points: {} cells are degenerate throughout and have no points", isotropic));
  std::vector<Found> found;
  for (const auto& c : chunks) found.insert(found.end(), c.begin(), c.end());
  drop_doubles(found, 1e-9 * in->bounds().diagonal());
  const auto wedges = std::count_if(found.begin(), found.end(), [](const Found& f) { return f.delta > 0; });
  ctx.info(fmt::format("degenerate_points: {} trisectors, {} wedges", found.size() - size_t(wedges), wedges));

  PointCloud cloud;
  std::vector<double> xyz, index, delta, eigenvalue, along[3];
  std::vector<int32_t> type, separatrices;
  std::vector<int64_t> cell;
  for (const Found& x : found) {
    xyz.insert(xyz.end(), {x.at.x, x.at.y, x.at.z});
    index.push_back(x.delta < 0 ? -0.5 : 0.5), type.push_back(x.delta < 0 ? 0 : 1);
    delta.push_back(x.delta), eigenvalue.push_back(x.eigenvalue), separatrices.push_back(x.separatrices), cell.push_back(x.cell);
    for (int k = 0; k < 3; ++k) along[k].insert(along[k].end(), {x.along[k].x, x.along[k].y, x.along[k].z});
  }
  cloud.points.xyz = Array::from_vector(std::move(xyz), 3);
  FieldSet f;
  f.add({"index", Association::point, Array::from_vector(std::move(index)), "", Role::scalars});
  f.add({"type", Association::point, Array::from_vector(std::move(type)), "", Role::labels});
  f.add({"delta", Association::point, Array::from_vector(std::move(delta)), "", Role::none});
  f.add({"eigenvalue", Association::point, Array::from_vector(std::move(eigenvalue)), t.field.unit, Role::none});
  f.add({"separatrices", Association::point, Array::from_vector(std::move(separatrices)), "", Role::labels});
  for (int k = 0; k < 3; ++k)
    f.add({fmt::format("separatrix {}", k + 1), Association::point, Array::from_vector(std::move(along[k]), 3), "", Role::none});
  f.add(id_field("original_cell", Association::point, std::move(cell)));
  return make_dataset(cloud, std::move(f));
}

}  // namespace sg
