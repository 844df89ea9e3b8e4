// SPDX-License-Identifier: Apache-2.0
#include "filter/glyph/shapes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <tuple>

#include "base/error.h"
#include "base/file/file.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/surface.h"

namespace sg {

namespace {

using std::numbers::pi;

constexpr double plate = 0.012;  // half the thickness of flat shapes

/// Points of a solid of revolution about x: rings where the radius is above 0, single points where it is 0.
struct Profile {
  double x, radius;
};

// The profile runs from the tail to the tip, starts and ends on the axis.
void revolve(ShapeBuilder& b, std::span<const Profile> profile, int sides) {
  std::vector<int32_t> before, now;
  for (const Profile& p : profile) {
    now.clear();
    if (p.radius > 0)
      for (int k = 0; k < sides; ++k) {
        const double t = 2 * pi * k / sides;
        now.push_back(b.point({p.x, p.radius * std::cos(t), p.radius * std::sin(t)}));
      }
    else now.push_back(b.point({p.x, 0, 0}));
    const bool from_point = before.size() == 1, to_point = now.size() == 1;
    for (size_t k = 0; !before.empty() && k < size_t(sides) && !(from_point && to_point); ++k) {
      const size_t n = (k + 1) % size_t(sides);
      if (from_point) b.triangle(before[0], now[n], now[k]);
      else if (to_point) b.triangle(before[k], before[n], now[0]);
      else b.triangle(before[k], before[n], now[n]), b.triangle(before[k], now[n], now[k]);
    }
    before = now;
  }
}

void arrow(ShapeBuilder& b, const GlyphShapeParams& p) {
  const double neck = 1 - p.tip_length;

  // The tail is a fan without a point in the middle: one that lies flat anyway.
  std::vector<int32_t> tail, front, wide;
  for (auto [ring, at, r] : {std::tuple{&tail, 0.0, p.shaft_radius}, {&front, neck, p.shaft_radius}, {&wide, neck, p.tip_radius}})
    for (int k = 0; k < p.sides; ++k) {
      const double t = 2 * pi * k / p.sides;
      ring->push_back(b.point({at, r * std::cos(t), r * std::sin(t)}));
    }
  const int32_t tip = b.point({1, 0, 0});
  for (int k = 1; k + 1 < p.sides; ++k) b.triangle(tail[0], tail[size_t(k) + 1], tail[size_t(k)]);
  for (size_t k = 0; k < size_t(p.sides); ++k) {
    const size_t n = (k + 1) % size_t(p.sides);
    b.triangle(tail[k], tail[n], front[n]), b.triangle(tail[k], front[n], front[k]);
    b.triangle(front[k], front[n], wide[n]), b.triangle(front[k], wide[n], wide[k]);
    b.triangle(wide[k], wide[n], tip);
  }
}

// Latitude bands between two poles on the x axis.
void superquadric(ShapeBuilder& b, double alpha, double beta, int sides) {
  const int bands = std::max(sides / 2, 2);
  auto power = [](double v, double e) { return std::copysign(std::pow(std::abs(v), e), v); };
  std::vector<int32_t> before, now;
  for (int j = 0; j <= bands; ++j) {
    now.clear();
    const double f = pi * (1 - double(j) / bands);  // from -x to +x
    const bool pole = j == 0 || j == bands;
    const double cf = pole ? (j == 0 ? -1.0 : 1.0) : power(std::cos(f), beta), sf = pole ? 0 : power(std::sin(f), beta);
    if (pole) now.push_back(b.point({0.5 * cf, 0, 0}));
    else
      for (int k = 0; k < sides; ++k) {
        const double t = 2 * pi * k / sides;
        // Exact zeros where the angle is a quarter: a power below 1 would amplify rounding errors.
        auto clean = [](double v) { return std::abs(v) < 1e-12 ? 0.0 : v; };
        now.push_back(b.point({0.5 * (std::abs(cf) < 1e-9 ? 0.0 : cf), 0.5 * power(clean(std::cos(t)), alpha) * sf,
                               0.5 * power(clean(std::sin(t)), alpha) * sf}));
      }
    for (size_t k = 0; j > 0 && k < size_t(sides); ++k) {
      const size_t n = (k + 1) % size_t(sides);
      if (before.size() == 1) b.triangle(before[0], now[n], now[k]);
      else if (now.size() == 1) b.triangle(before[k], before[n], now[0]);
      else b.triangle(before[k], before[n], now[n]), b.triangle(before[k], now[n], now[k]);
    }
    before = now;
  }
}

void cube(ShapeBuilder& b) {
  for (int c = 0; c < 8; ++c) b.point({c & 1 ? 0.5 : -0.5, c & 2 ? 0.5 : -0.5, c & 4 ? 0.5 : -0.5});
  for (const auto& q : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
    b.triangle(q[0], q[1], q[2]), b.triangle(q[0], q[2], q[3]);
}

// A thin plate: on a surface in its own plane it lies before the surface from both sides.
void flat_arrow(ShapeBuilder& b, const GlyphShapeParams& p) {
  const double neck = 1 - p.tip_length, r = p.shaft_radius, t = p.tip_radius;
  const Vec3 outline[] = {{0, -r, 0}, {neck, -r, 0}, {neck, -t, 0}, {1, 0, 0}, {neck, t, 0}, {neck, r, 0}, {0, r, 0}};
  constexpr int n = 7;
  for (const double z : {-plate, plate})
    for (const Vec3& q : outline) b.point({q.x, q.y, z});
  for (const auto& f : {std::array{0, 1, 5}, {0, 5, 6}, {2, 3, 1}, {1, 3, 5}, {5, 3, 4}}) {
    b.triangle(f[0], f[2], f[1]);
    b.triangle(n + f[0], n + f[1], n + f[2]);
  }
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n;
    b.triangle(k, next, n + next), b.triangle(k, n + next, n + k);
  }
}

void disc(ShapeBuilder& b, int sides) {
  const int32_t middle = b.point({0, 0, 0});
  for (int k = 0; k < sides; ++k) {
    const double t = 2 * pi * k / sides;
    b.point({0, 0.5 * std::cos(t), 0.5 * std::sin(t)});
  }
  for (int k = 0; k < sides; ++k) b.triangle(middle, 1 + k, 1 + (k + 1) % sides);
}

// False for barbs, which are no single shape.
bool build(ShapeBuilder& b, GlyphShape shape, const GlyphShapeParams& p) {
  switch (shape) {
    case GlyphShape::arrow: arrow(b, p); return true;
    case GlyphShape::arrow2d: flat_arrow(b, p); return true;
    case GlyphShape::cone: revolve(b, std::array<Profile, 3>{{{0, 0}, {0, 0.16}, {1, 0}}}, p.sides); return true;
    case GlyphShape::needle: revolve(b, std::array<Profile, 3>{{{0, 0}, {0.35, 0.04}, {1, 0}}}, p.sides); return true;
    case GlyphShape::cylinder: revolve(b, std::array<Profile, 4>{{{-0.5, 0}, {-0.5, 0.5}, {0.5, 0.5}, {0.5, 0}}}, p.sides); return true;
    case GlyphShape::disc: disc(b, p.sides); return true;
    case GlyphShape::sphere: superquadric(b, 1, 1, p.sides); return true;
    case GlyphShape::superquadric: superquadric(b, p.alpha, p.beta, std::max(p.sides, 24)); return true;
    case GlyphShape::cube: cube(b); return true;
    case GlyphShape::line: b.point({0, 0, 0}), b.point({1, 0, 0}), b.line(0, 1); return true;
    case GlyphShape::barbs: return false;
  }
  return false;
}

std::atomic<ShapeReader> shape_reader = nullptr;

DatasetPtr from_file(const std::string& path, Context& context) {
  const ShapeReader read = shape_reader;
  if (!read) fail_usage(fmt::format("no reader for '{}' is available here", path), "glyphs: shape");
  const DatasetPtr d = surface_of(read(path, context), context);
  const Box3& box = d->bounds();
  const Vec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  if (box.empty() || !(longest > 0)) fail_usage(fmt::format("'{}' has no extent and cannot be a shape", path), "glyphs: shape");
  const SurfaceMesh& in = *d->as<SurfaceMesh>();
  DatasetParts parts;
  SurfaceMesh mesh = in;
  std::vector<float> xyz;
  for (size_t i = 0; i < in.points.count(); ++i) {
    const Vec3 p = (in.points.at(i) - box.center()) / longest;
    for (int a = 0; a < 3; ++a) xyz.push_back(float(p[a]));
  }
  mesh.points = {Array::from_vector(std::move(xyz), 3), {}};
  return make_dataset(Mesh(std::move(mesh)));
}

}  // namespace

void describe(Schema& s, GlyphShapeParams& p) {
  s("shape", p.shape,
    "Shape: arrow, cone, needle, line (hedgehog), arrow2d (flat), cylinder, disc, sphere, cube, superquadric, barbs, or a file with a "
    "surface.");
  s("sides", p.sides, "Number of sides of round shapes.").range(3, 256);
  s("anchor", p.anchor, "Part of the glyph at the point; auto: the tail of shapes that point somewhere, the middle of others.");
  s("tip_length", p.tip_length, "Length of an arrow's tip, as a fraction of its length.").range(0, 1);
  s("tip_radius", p.tip_radius, "Radius of an arrow's tip.").range(0, 10);
  s("shaft_radius", p.shaft_radius, "Radius of an arrow's shaft.").range(0, 10);
  s("alpha", p.alpha, "superquadric: exponent around the axis; 1 is round, 0 square.").range(0, 10);
  s("beta", p.beta, "superquadric: exponent along the axis; 1 is round, 0 square.").range(0, 10);
}

void set_shape_reader(ShapeReader reader) { shape_reader = reader; }

std::optional<GlyphShape> known_shape(const GlyphShapeParams& p) { return p.shape ? value_of_word<GlyphShape>(*p.shape) : std::nullopt; }

DatasetPtr ShapeBuilder::made() && {
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  if (!lines.empty()) mesh.lines.fixed = 2, mesh.lines.connectivity = Array::from_vector(std::move(lines));
  if (!triangles.empty()) mesh.polygons.fixed = 3, mesh.polygons.connectivity = Array::from_vector(std::move(triangles));
  return make_dataset(Mesh(std::move(mesh)));
}

DatasetPtr shifted_shape(const DatasetPtr& shape, double by) {
  SurfaceMesh mesh = *shape->as<SurfaceMesh>();
  std::vector<float> xyz;
  for (size_t i = 0; i < mesh.points.count(); ++i) {
    const Vec3 p = mesh.points.at(i);
    xyz.insert(xyz.end(), {float(p.x + by), float(p.y), float(p.z)});
  }
  mesh.points = {Array::from_vector(std::move(xyz), 3), {}};
  return make_dataset(Mesh(std::move(mesh)));
}

DatasetPtr glyph_shape_mesh(const GlyphShapeParams& p, Context& context) {
  ShapeBuilder b;
  DatasetPtr shape;
  const std::optional<GlyphShape> one = p.shape ? known_shape(p) : GlyphShape::arrow;
  if (one && build(b, *one, p)) {
    shape = std::move(b).made();
  } else {
    if (!file_exists(*p.shape)) {
      std::vector<std::string> known;
      for (const Word<GlyphShape>& w : enum_words(GlyphShape())) known.emplace_back(w.word);
      fail_usage(fmt::format("there is neither a shape nor a file '{}'", *p.shape), "glyphs: shape", unknown_name_hint(*p.shape, known));
    }
    shape = from_file(*p.shape, context);
  }
  if (!p.anchor) return shape;
  const Box3& box = shape->bounds();
  const double at = *p.anchor == GlyphAnchor::tail ? box.lo.x : *p.anchor == GlyphAnchor::tip ? box.hi.x : 0.5 * (box.lo.x + box.hi.x);
  return at == 0 ? shape : shifted_shape(shape, -at);
}

}  // namespace sg
