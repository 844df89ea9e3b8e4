// SPDX-License-Identifier: Apache-2.0
#include "filter/glyph/instances.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/point_positions.h"

namespace sg {

namespace {

constexpr size_t places_per_chunk = 1 << 13;

// A point field as packed doubles, `least` to `most` components.
Array numbers_of(const Dataset& d, const std::string& name, int least, int most, const char* what) {
  const Field& f = with_context(what, [&]() -> const Field& { return d.fields().require(name); });
  if (f.association != Association::point)
    fail_usage(fmt::format("'{}' is a {} field; glyphs are placed at points", f.name, association_name(f.association)), what,
               "glyph_points mode=cells turns cells into points");
  if (f.components() < least || f.components() > most)
    fail_usage(fmt::format("field '{}' has {} component{}", f.name, f.components(), f.components() == 1 ? "" : "s"), what,
               least == most ? fmt::format("it needs {}", least) : fmt::format("it needs {} or {}", least, most));
  return f.array.converted(ElementType::f64).made_packed();
}

struct Inputs {
  Array positions, vectors, frames, sizes, choice, ghost;
};

const double* values(const Array& a) { return a.empty() ? nullptr : reinterpret_cast<const double*>(a.raw()); }

// The 3x3 part; false where there is no glyph.
bool matrix_of(const Inputs& in, const GlyphRule& rule, size_t i, Mat3& m) {
  double factor = rule.scale;
  if (!in.frames.empty()) {
    const double* q = values(in.frames) + 9 * i;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) m.m[r][c] = q[3 * r + c];
  } else if (!in.vectors.empty()) {
    const int n = in.vectors.components();
    const double* q = values(in.vectors) + size_t(n) * i;
    const Vec3 v{q[0], q[1], n == 3 ? q[2] : 0};
    const double l = length(v);
    if (!(l > 0) || !std::isfinite(l)) return false;
    m = turn_to(v, rule.normal);
    if (rule.size == GlyphRule::Size::length) factor *= l;
  } else {
    m = Mat3();
  }
  if (rule.size == GlyphRule::Size::field) factor *= std::abs(values(in.sizes)[i]);
  if (!std::isfinite(factor) || factor == 0) return false;
  if (rule.largest > 0) factor = std::clamp(factor, -rule.largest, rule.largest);
  double sum = 0;
  for (auto& row : m.m)
    for (double& x : row) x *= factor, sum += std::abs(x);
  return sum > 0 && sum < 1e30;
}

GlyphInstances make_instances(const DatasetPtr& data, const GlyphRule& rule, size_t shape_count) {
  const Dataset& d = *data;
  Inputs in;
  in.positions = point_positions(d.mesh());
  if (!rule.frames.empty()) in.frames = numbers_of(d, rule.frames, 9, 9, "glyphs: frames");
  else if (!rule.vectors.empty()) in.vectors = numbers_of(d, rule.vectors, 2, 3, "glyphs: vectors");
  if (rule.size == GlyphRule::Size::length && in.vectors.empty())
    fail_usage("the size is a vector's length, but no vector field is given", "glyphs", "name a field with vectors=");
  if (rule.size == GlyphRule::Size::field) in.sizes = numbers_of(d, rule.size_field, 1, 1, "glyphs: scale");
  if (!rule.choice.empty()) in.choice = numbers_of(d, rule.choice, 1, 1, "glyphs: choice");
  if (!d.point_ghost().empty()) in.ghost = d.point_ghost().converted(ElementType::u8).made_packed();

  const size_t n = d.point_count();
  GlyphInstances out;
  const Box3& box = d.bounds();
  if (const Vec3 middle = box.center(); std::isfinite(middle.x + middle.y + middle.z)) out.origin = middle;
  float* matrices = nullptr;
  uint8_t* shapes = nullptr;
  out.matrices = Array::make<float>(n, 12, &matrices);
  if (!in.choice.empty()) out.shapes = Array::make<uint8_t>(n, 1, &shapes);
  const double* xyz = values(in.positions);
  out.standing = parallel_reduce<size_t>(
      n, places_per_chunk, 0,
      [&](size_t begin, size_t end) {
        size_t standing = 0;
        for (size_t i = begin; i < end; ++i) {
          float* q = matrices + 12 * i;
          Mat3 m;
          const Vec3 p = Vec3(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]) - out.origin;
          bool stands = std::isfinite(p.x + p.y + p.z) && matrix_of(in, rule, i, m);
          if (stands && !in.ghost.empty()) stands = !(in.ghost.view<uint8_t>()[i] & ghost_hidden_point);
          if (shapes) {
            const double c = values(in.choice)[i];
            const bool known = c >= 0 && c < double(shape_count);
            shapes[i] = known ? uint8_t(c) : 0, stands = stands && known;
          }
          for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c) q[4 * r + c] = stands ? float(m.m[r][c]) : NAN;
            q[4 * r + 3] = stands ? float(p[r]) : 0.0f;
          }
          standing += stands;
        }
        return standing;
      },
      [](size_t a, size_t b) { return a + b; });
  return out;
}

struct Remembered {
  std::weak_ptr<const Dataset> owner;
  GlyphRule rule;
  size_t shape_count = 0;
  std::shared_ptr<const GlyphInstances> made;
};

}  // namespace

Mat3 turn_to(Vec3 v, const std::optional<Vec3>& normal) {
  Mat3 m;
  // Lengths near the ends of the range of numbers must not overflow when they are squared.
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0) || !std::isfinite(largest)) return {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
  Vec3 u = normalize(v / largest);
  Vec3 y, z;
  if (normal) {
    z = normalize(*normal), u = u - z * dot(u, z);
    if (!(length(u) > 1e-9)) return {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
    u = normalize(u), y = cross(z, u);
  } else if (u.x < -1 + 1e-12) {
    y = {0, -1, 0}, z = {0, 0, 1};
  } else {
    const double k = 1 / (1 + u.x);
    y = {-u.y, 1 - u.y * u.y * k, -u.y * u.z * k}, z = {-u.z, -u.y * u.z * k, 1 - u.z * u.z * k};
  }
  for (int r = 0; r < 3; ++r) m.m[r][0] = u[r], m.m[r][1] = y[r], m.m[r][2] = z[r];
  return m;
}

std::shared_ptr<const GlyphInstances> glyph_instances(const DatasetPtr& data, const GlyphRule& rule, size_t shape_count) {
  static std::mutex mutex;
  static std::vector<Remembered> memory;
  constexpr size_t most = 8;
  {
    const std::lock_guard lock(mutex);
    std::erase_if(memory, [](const Remembered& m) { return m.owner.expired(); });
    for (const Remembered& m : memory)
      if (m.rule == rule && m.shape_count == shape_count && m.owner.lock() == data) return m.made;
  }
  auto made = std::make_shared<const GlyphInstances>(make_instances(data, rule, shape_count));
  const std::lock_guard lock(mutex);
  if (memory.size() >= most) memory.erase(memory.begin());
  memory.push_back({data, rule, shape_count, made});
  return made;
}

Box3 glyph_bounds(const GlyphInstances& instances, const std::vector<Box3>& boxes) {
  Box3 all = parallel_reduce<Box3>(
      instances.count(), places_per_chunk, Box3{},
      [&](size_t begin, size_t end) {
        Box3 box;
        for (size_t i = begin; i < end; ++i) {
          if (!instances.stands(i)) continue;
          const size_t shape = instances.shape_numbers() ? instances.shape_numbers()[i] : 0;
          if (shape >= boxes.size() || boxes[shape].empty()) continue;
          const float* q = instances.data() + 12 * i;
          const Vec3 c = boxes[shape].center(), h = boxes[shape].size() * 0.5;
          Vec3 middle, reach;
          for (int r = 0; r < 3; ++r) {
            const double a = q[4 * r], b = q[4 * r + 1], e = q[4 * r + 2];
            middle[r] = a * c.x + b * c.y + e * c.z + double(q[4 * r + 3]);
            reach[r] = std::abs(a) * h.x + std::abs(b) * h.y + std::abs(e) * h.z;
          }
          box.add(middle - reach), box.add(middle + reach);
        }
        return box;
      },
      [](Box3 a, const Box3& b) {
        a.add(b);
        return a;
      });
  if (!all.empty()) all.lo += instances.origin, all.hi += instances.origin;
  return all;
}

}  // namespace sg
