// SPDX-License-Identifier: Apache-2.0
#include "render/trace/geometry/instances.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "render/trace/geometry/surface_point.h"
#include "render/trace/tree/wide_bvh.h"

namespace sg::trace {

namespace {

Vec3 shape_point(const raster::GlyphShape& s, uint32_t i) { return {s.x[i], s.y[i], s.z[i]}; }

/// The cofactors: they turn normals as the matrix turns what they stand on, mirrored ones, too.
Mat3 cofactors(const Mat3& m) {
  const Vec3 x = m.column(0), y = m.column(1), z = m.column(2), a = cross(y, z), b = cross(z, x), c = cross(x, y);
  return {{{a.x, b.x, c.x}, {a.y, b.y, c.y}, {a.z, b.z, c.z}}};
}

double largest(const Mat3& m) {
  double most = 0;
  for (const auto& row : m.m)
    for (const double v : row) most = std::max(most, std::abs(v));
  return most;
}

/// False for a matrix that makes something flat.
bool inverted(const Mat3& m, Mat3& out) {
  const double size = largest(m);
  const Mat3 c = cofactors(m);
  const double det = dot(m.column(0), c.column(0));
  if (!(size > 0) || !std::isfinite(size) || !(std::abs(det) > 1e-30 * size * size * size)) return false;
  for (int r = 0; r < 3; ++r)
    for (int k = 0; k < 3; ++k) out.m[r][k] = c.m[k][r] / det;
  return true;
}

}  // namespace

Instances::Matrix Instances::matrix(uint32_t instance) const {
  const float* m = set_.instances->data() + 12 * size_t(instance);
  Matrix out;
  for (int r = 0; r < 3; ++r) {
    for (int k = 0; k < 3; ++k) out.linear.m[r][k] = m[4 * r + k] * factor_;
    out.at[r] = m[4 * r + 3];
  }
  return out;
}

const Instances::Shape& Instances::shape_of(uint32_t instance) const {
  const uint8_t* s = set_.instances->shape_numbers();
  return shapes_[s ? s[instance] : 0];
}

Instances::Instances(const raster::GlyphSet& set, double factor, Context& context) : set_(set), factor_(factor) {
  std::vector<Box3> shape_boxes;
  for (const auto& glyph : set.shapes) {
    std::vector<float> xyz(3 * glyph->points);
    Box3 box;
    for (uint32_t i = 0; i < glyph->points; ++i) {
      const Vec3 p = shape_point(*glyph, i);
      for (int a = 0; a < 3; ++a) xyz[3 * size_t(i) + size_t(a)] = float(p[a]);
      box.add(p);
    }
    Shape s;
    s.placement = Placement::of(box), s.glyph = glyph;
    s.triangles = Triangles({xyz.data(), glyph->triangle_list.data(), glyph->triangles, s.placement.middle, s.placement.scale}, context);
    shapes_.push_back(std::move(s)), shape_boxes.push_back(box);
  }
  // The box of a turned box.
  const size_t n = set.instances->count();
  std::vector<Box3> boxes(n);
  parallel_for(n, 1 << 12, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Mat3 inverse;
      const Matrix m = matrix(uint32_t(i));
      const Box3& s = shape_boxes[size_t(&shape_of(uint32_t(i)) - shapes_.data())];
      if (!set.instances->stands(i) || s.empty() || !inverted(m.linear, inverse)) continue;
      for (int corner = 0; corner < 8; ++corner)
        boxes[i].add(m.at + m.linear * Vec3(corner & 1 ? s.hi.x : s.lo.x, corner & 2 ? s.hi.y : s.lo.y, corner & 4 ? s.hi.z : s.lo.z));
    }
  });
  Box3 all;
  for (const Box3& b : boxes) all.add(b);
  local_ = Placement::of(all);
  std::vector<Box3f> local(n);
  parallel_for(n, 1 << 12, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (boxes[i].empty()) continue;
      // Wider than what the ray's change of coordinates may be off.
      const Vec3 lo = (boxes[i].lo - local_.middle) * local_.scale, hi = (boxes[i].hi - local_.middle) * local_.scale;
      const auto reach = [](Vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
      const double more = std::max(reach(lo), reach(hi)) * 4 * half_unit;
      for (int a = 0; a < 3; ++a) local[i].lo[a] = float(lo[a] - more), local[i].hi[a] = float(hi[a] + more);
    }
  });
  tree_ = WideBvh(Bvh(local, {.most = wide, .least = 1, .of_node = 0.1f}, context).take());
}

bool Instances::into(const Ray& ray, uint32_t instance, Ray& out) const {
  const Matrix m = matrix(instance);
  Mat3 inverse;
  if (!inverted(m.linear, inverse)) return false;
  const Placement& shape = shape_of(instance).placement;
  const Vec3 origin = inverse * (local_.world(ray.origin) - m.at);
  out.origin = shape.traced(origin);
  out.direction = Vec3f(inverse * Vec3(ray.direction) * (shape.scale / local_.scale));  // not of unit length: t stays what it is
  out.t_max = ray.t_max;
  return true;
}

bool Instances::nearest(const Ray& ray, Hit& hit) const {
  bool found = false;
  walk_leaves(tree_, ray, hit.t, true, [&](uint32_t first, uint32_t count) {
    for (uint32_t i = first; i < first + count; ++i) {
      const uint32_t instance = tree_.order()[i];
      Ray inner;
      Hit h;
      h.t = hit.t;
      if (!into(ray, instance, inner) || !shape_of(instance).triangles.nearest(inner, h)) continue;
      const uint32_t number = (instance << set_.shift) + h.primitive;
      if (h.t == hit.t && found && number > hit.primitive) continue;
      hit = {h.t, hit.object, number, h.u, h.v}, found = true;
    }
    return false;
  });
  return found;
}

bool Instances::blocked(const Ray& ray) const {
  bool found = false;
  walk_leaves(tree_, ray, ray.t_max, false, [&](uint32_t first, uint32_t count) {
    Ray inner;
    for (uint32_t i = first; i < first + count && !found; ++i)
      found = into(ray, tree_.order()[i], inner) && shape_of(tree_.order()[i]).triangles.blocked(inner);
    return found;
  });
  return found;
}

InstancePoint Instances::point(const Hit& hit) const {
  const uint32_t instance = hit.primitive >> set_.shift, triangle = hit.primitive & ((uint32_t(1) << set_.shift) - 1);
  const Shape& s = shape_of(instance);
  const Matrix m = matrix(instance);
  const auto c = s.triangles.corners(triangle);
  const Vec3 a(c[0]), ab = Vec3(c[1]) - a, ac = Vec3(c[2]) - a;
  const Vec3 local = a + ab * double(hit.u) + ac * double(hit.v), x = s.placement.middle + local / s.placement.scale;
  InstancePoint p;
  p.place = m.at + m.linear * x;
  // A ray that starts there is rounded in the shape's coordinates: what that is worth here.
  const Vec3 size(std::abs(local.x), std::abs(local.y), std::abs(local.z));
  for (int r = 0; r < 3; ++r)
    for (int k = 0; k < 3; ++k) p.error[r] += std::abs(m.linear.m[r][k]) * (size[k] * half_unit + 0x1p-42) / s.placement.scale;
  const Mat3 turn = cofactors(m.linear);
  p.normal = normalize(turn * cross(ab, ac) / (largest(turn) * std::max(length(cross(ab, ac)), 1e-300)));
  p.along = m.linear * ab;
  // The smooth normal is a linear function of the place in the shape (glyph_set.h).
  const float* f = &s.glyph->faces[raster::GlyphShape::row * size_t(triangle)];
  Vec3 n;
  for (int r = 0; r < 3; ++r) n[r] = f[3 + r] + f[6 + 3 * r] * x.x + f[7 + 3 * r] * x.y + f[8 + 3 * r] * x.z;
  p.shading = normalize(turn * normalize(n) / largest(turn));
  if (!(dot(p.shading, p.shading) > 0.5)) p.shading = p.normal;
  return p;
}

size_t Instances::bytes() const {
  size_t sum = tree_.bytes();
  for (const Shape& s : shapes_) sum += s.triangles.bytes();
  return sum;
}

}  // namespace sg::trace
