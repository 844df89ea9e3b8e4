// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/lines/line_sections.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"

namespace sg {

namespace {

// Axes and half lengths of the section at a line point; u, v and the tangent are right-handed.
struct Frame {
  Vec3 u, v;
  double a = 0, b = 0;
};

void others(int k, int& i, int& j) { i = k == 0 ? 1 : 0, j = k == 2 ? 1 : 2; }

std::vector<Frame> frames_of(const TensorLines& lines, size_t begin, size_t end, int k, const SectionOptions& o, size_t& limited) {
  int i = 0, j = 0;
  others(k, i, j);
  std::vector<Frame> frames;
  for (size_t p = begin; p < end; ++p) {
    const Eigen3& e = lines.eigen[p];
    const Vec3 t = lines.tangent[p];
    Vec3 u = e.vector[i], v = cross(t, u);
    double a = std::abs(e.value[i]) * o.factor, b = std::abs(e.value[j]) * o.factor;
    if (!frames.empty()) {
      // (u,v), (v,-u), (-u,-v), (-v,u): quarter turns of the same ellipse.
      Frame best;
      double most = -HUGE_VAL;
      for (int turn = 0; turn < 4; ++turn) {
        const double fit = dot(u, frames.back().u) + dot(v, frames.back().v);
        if (fit > most) most = fit, best = {u, v, a, b};
        const Vec3 old = u;
        u = v, v = -old;
        std::swap(a, b);
      }
      u = best.u, v = best.v, a = best.a, b = best.b;
    }
    const double larger = std::max(a, b);
    if (larger > o.max_radius) a *= o.max_radius / larger, b *= o.max_radius / larger, ++limited;
    frames.push_back({u, v, std::max(a, o.min_radius), std::max(b, o.min_radius)});
  }
  return frames;
}

struct Writer {
  float* xyz;
  float* normals;
  Vec3 origin;
  void put(size_t vertex, Vec3 at, Vec3 normal) const {
    const Vec3 p = at - origin, n = normalize(normal);
    for (int c = 0; c < 3; ++c) xyz[3 * vertex + size_t(c)] = float(p[c]), normals[3 * vertex + size_t(c)] = float(n[c]);
  }
};

Vec3 on_ellipse(const Frame& f, double angle) { return f.u * (f.a * std::cos(angle)) + f.v * (f.b * std::sin(angle)); }

void put_tube(const TensorLines& lines, size_t begin, const std::vector<Frame>& frames, int sides, const Writer& out, size_t first) {
  const size_t n = frames.size();
  for (size_t p = 0; p < n; ++p)
    for (int s = 0; s < sides; ++s) {
      const double angle = 2 * M_PI * s / sides;
      const Frame& f = frames[p];
      // The normal leans where the tube widens: across the directions along and around.
      const size_t before = p > 0 ? p - 1 : 0, after = p + 1 < n ? p + 1 : p;
      const Vec3 along =
          lines.points[begin + after] + on_ellipse(frames[after], angle) - lines.points[begin + before] - on_ellipse(frames[before], angle);
      const Vec3 round = f.u * (-f.a * std::sin(angle)) + f.v * (f.b * std::cos(angle));
      const Vec3 outward = f.u * (f.b * std::cos(angle)) + f.v * (f.a * std::sin(angle));
      Vec3 normal = cross(round, along);
      if (dot(normal, outward) <= 0) normal = outward;
      if (!(length(normal) > 0)) normal = f.u * std::cos(angle) + f.v * std::sin(angle);
      out.put(first + p * size_t(sides) + size_t(s), lines.points[begin + p] + on_ellipse(f, angle), normal);
    }
}

void put_cross(const TensorLines& lines, size_t begin, const std::vector<Frame>& frames, const Writer& out, size_t first) {
  for (size_t p = 0; p < frames.size(); ++p) {
    const Frame& f = frames[p];
    const Vec3 at = lines.points[begin + p];
    out.put(first + 4 * p, at - f.u * f.a, f.v);
    out.put(first + 4 * p + 1, at + f.u * f.a, f.v);
    out.put(first + 4 * p + 2, at - f.v * f.b, f.u);
    out.put(first + 4 * p + 3, at + f.v * f.b, f.u);
  }
}

struct Polygons {
  std::vector<int32_t> ids, offsets{0};
  std::vector<int64_t> line;
  void quad(size_t a, size_t b, size_t c, size_t d, size_t of) {
    for (size_t x : {a, b, c, d}) ids.push_back(int32_t(x));
    close(of);
  }
  void close(size_t of) {
    offsets.push_back(int32_t(ids.size()));
    line.push_back(int64_t(of));
  }
};

void add_tube_polygons(Polygons& out, size_t first, size_t sections, int sides, size_t line) {
  const auto id = [&](size_t p, int s) { return first + p * size_t(sides) + size_t(s % sides); };
  for (size_t p = 0; p + 1 < sections; ++p)
    for (int s = 0; s < sides; ++s) out.quad(id(p, s), id(p, s + 1), id(p + 1, s + 1), id(p + 1, s), line);
  for (int s = sides; s-- > 0;) out.ids.push_back(int32_t(id(0, s)));
  out.close(line);
  for (int s = 0; s < sides; ++s) out.ids.push_back(int32_t(id(sections - 1, s)));
  out.close(line);
}

}  // namespace

double usual_half_axis(const TensorLines& lines, int k) {
  int i = 0, j = 0;
  others(k, i, j);
  std::vector<double> r;
  for (const Eigen3& e : lines.eigen) r.push_back(std::max(std::abs(e.value[i]), std::abs(e.value[j])));
  if (r.empty()) return 0;
  const auto at = r.begin() + ptrdiff_t(0.9 * double(r.size() - 1));
  std::nth_element(r.begin(), at, r.end());
  return *at;
}

SurfaceMesh lines_as_mesh(const TensorLines& lines) {
  SurfaceMesh mesh;
  double* xyz = nullptr;
  mesh.points.xyz = Array::make<double>(lines.points.size(), 3, &xyz);
  for (Vec3 p : lines.points) *xyz++ = p.x, *xyz++ = p.y, *xyz++ = p.z;
  std::vector<int64_t> ids, offsets{0};
  for (size_t l = 0; l < lines.lines(); ++l) {
    if (lines.begin[l + 1] - lines.begin[l] < 2) continue;
    for (size_t p = lines.begin[l]; p < lines.begin[l + 1]; ++p) ids.push_back(int64_t(p));
    offsets.push_back(int64_t(ids.size()));
  }
  if (offsets.size() > 1)
    mesh.lines.connectivity = Array::from_vector(std::move(ids)), mesh.lines.offsets = Array::from_vector(std::move(offsets));
  return mesh;
}

LineSurface sections_around(const TensorLines& lines, int k, const SectionOptions& o, Context& ctx) {
  LineSurface out;
  const bool ellipse = o.shape == SectionOptions::Shape::ellipse;
  out.per_section = ellipse ? size_t(o.sides) : 4;
  const size_t vertices = lines.points.size() * out.per_section;
  if (vertices >= (size_t(1) << 31) / 4)
    fail_usage(fmt::format("{} vertices are too many for one surface", vertices), "hyperstreamlines",
               "use fewer seeds, a larger step or fewer sides");
  float *xyz = nullptr, *normals = nullptr;
  out.mesh.points.xyz = Array::make<float>(vertices, 3, &xyz);
  out.normals = Array::make<float>(vertices, 3, &normals);
  Box3 box;
  for (Vec3 p : lines.points) box.add(p);
  if (!box.empty()) out.mesh.points.origin = box.center();
  const Writer writer{xyz, normals, out.mesh.points.origin};
  out.limited = parallel_reduce(
      lines.lines(), 4, size_t(0),
      [&](size_t begin, size_t end) {
        size_t limited = 0;
        for (size_t l = begin; l < end; ++l) {
          const size_t first = lines.begin[l];
          const std::vector<Frame> frames = frames_of(lines, first, lines.begin[l + 1], k, o, limited);
          if (ellipse) put_tube(lines, first, frames, o.sides, writer, first * out.per_section);
          else put_cross(lines, first, frames, writer, first * out.per_section);
        }
        return limited;
      },
      [](size_t a, size_t b) { return a + b; }, &ctx);
  Polygons polygons;
  for (size_t l = 0; l < lines.lines(); ++l) {
    const size_t sections = lines.begin[l + 1] - lines.begin[l], first = lines.begin[l] * out.per_section;
    if (sections < 2) continue;
    if (ellipse) {
      add_tube_polygons(polygons, first, sections, o.sides, l);
      continue;
    }
    for (size_t p = 0; p + 1 < sections; ++p)
      for (size_t band : {size_t(0), size_t(2)}) {
        const size_t a = first + 4 * p + band;
        polygons.quad(a, a + 1, a + 5, a + 4, l);
      }
  }
  if (!polygons.line.empty()) {
    out.mesh.polygons.connectivity = Array::from_vector(std::move(polygons.ids));
    out.mesh.polygons.offsets = Array::from_vector(std::move(polygons.offsets));
  }
  out.line = std::move(polygons.line);
  return out;
}

}  // namespace sg
