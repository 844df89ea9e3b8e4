// SPDX-License-Identifier: Apache-2.0
#include "data/field_ops.h"

#include "data/fields/field_component.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/nearest_whole.h"
#include "base/parallel.h"

namespace sg {

namespace {

constexpr size_t values_per_chunk = 1 << 15;

template <class Id>
Array gather_any(const Array& a, std::span<const Id> ids) {
  std::byte* out = nullptr;
  Array r = Array::make_raw(a.type(), ids.size(), a.components(), &out);
  dispatch(a, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    T* to = reinterpret_cast<T*>(out);
    const int n = v.components;
    parallel_for(ids.size(), values_per_chunk, [&](size_t begin, size_t end) {
      if (n == 1) {
        for (size_t i = begin; i < end; ++i) to[i] = v[size_t(ids[i])];
        return;
      }
      for (size_t i = begin; i < end; ++i)
        for (int c = 0; c < n; ++c) to[i * size_t(n) + size_t(c)] = v(size_t(ids[i]), c);
    });
  });
  return r;
}

template <class T>
T blended(double v) {
  if constexpr (std::is_floating_point_v<T>) return T(v);
  else return nearest_whole<T>(v);  // there is nothing between two infinities
}

// Directions between those at two points, with interpolated length: blended component by component they would be shorter.
Array interpolate_directions(const Array& a, std::span<const EdgePoint> points) {
  std::byte* out = nullptr;
  Array r = Array::make_raw(a.type(), points.size(), 3, &out);
  dispatch(a, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    T* to = reinterpret_cast<T*>(out);
    parallel_for(points.size(), values_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const EdgePoint p = points[i];
        const Vec3 from(double(v(p.a, 0)), double(v(p.a, 1)), double(v(p.a, 2))),
            behind(double(v(p.b, 0)), double(v(p.b, 1)), double(v(p.b, 2)));
        const double t = p.t;
        Vec3 n = from * (1 - t) + behind * t;
        const double is = length(n), wanted = length(from) * (1 - t) + length(behind) * t;
        if (p.a == p.b) n = from;
        else if (is > 0) n *= wanted / is;
        for (int c = 0; c < 3; ++c) to[3 * i + size_t(c)] = T(n[c]);
      }
    });
  });
  return r;
}

template <class Map>
void carry(FieldSet& out, const FieldSet& in, Association association, Association as, Map&& map) {
  for (const Field& f : in)
    if (f.association == association) out.add(f.with(map(f.array), as));
}

}  // namespace

Array gather(const Array& a, std::span<const int64_t> ids) { return gather_any(a, ids); }
Array gather(const Array& a, std::span<const uint32_t> ids) { return gather_any(a, ids); }

Array interpolate(const Array& a, std::span<const EdgePoint> points) {
  std::byte* out = nullptr;
  Array r = Array::make_raw(a.type(), points.size(), a.components(), &out);
  dispatch(a, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    T* to = reinterpret_cast<T*>(out);
    const int n = v.components;
    parallel_for(points.size(), values_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const EdgePoint p = points[i];
        for (int c = 0; c < n; ++c) {
          const T va = v(p.a, c), vb = v(p.b, c);
          to[i * size_t(n) + size_t(c)] = p.a == p.b ? va : blended<T>(double(va) * (1.0 - double(p.t)) + double(vb) * double(p.t));
        }
      }
    });
  });
  return r;
}

Array combine(const Array& a, std::span<const int64_t> ids, std::span<const double> weights, size_t n) {
  const size_t count = n ? ids.size() / n : 0;
  const bool wide = element_size(a.type()) == 8;
  std::byte* out = nullptr;
  Array r = Array::make_raw(wide ? ElementType::f64 : ElementType::f32, count, a.components(), &out);
  dispatch(a, [&](auto v) {
    parallel_for(count, values_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        for (int c = 0; c < v.components; ++c) {
          double sum = 0;
          for (size_t k = i * n; k < (i + 1) * n; ++k)
            if (weights[k] != 0) sum += weights[k] * double(v(size_t(ids[k]), c));
          const size_t at = i * size_t(v.components) + size_t(c);
          if (wide) reinterpret_cast<double*>(out)[at] = sum;
          else reinterpret_cast<float*>(out)[at] = float(sum);
        }
    });
  });
  return r;
}

void carry_gathered(FieldSet& out, const FieldSet& in, Association association, std::span<const int64_t> ids, Association as) {
  carry(out, in, association, as, [&](const Array& a) { return gather(a, ids); });
}
void carry_gathered(FieldSet& out, const FieldSet& in, Association association, std::span<const uint32_t> ids, Association as) {
  carry(out, in, association, as, [&](const Array& a) { return gather(a, ids); });
}
void carry_interpolated(FieldSet& out, const FieldSet& in, std::span<const EdgePoint> points) {
  for (const Field& f : in) {
    if (f.association != Association::point) continue;
    const ElementType t = f.array.type();
    const bool direction = f.role == Role::normals && f.components() == 3 && (t == ElementType::f32 || t == ElementType::f64);
    out.add(f.with(direction ? interpolate_directions(f.array, points) : interpolate(f.array, points)));
  }
}
void carry_combined(FieldSet& out, const FieldSet& in, Association association, std::span<const int64_t> ids,
                    std::span<const double> weights, size_t n, Association as) {
  carry(out, in, association, as, [&](const Array& a) { return combine(a, ids, weights, n); });
}
void carry_whole(FieldSet& out, const FieldSet& in) {
  carry(out, in, Association::whole, Association::whole, [](const Array& a) { return a; });
}

Array scalar_of(const Field& field, int component, ElementType type) {
  const Array& a = field.array;
  check_component(field, component, "component");
  if (component >= 0 || a.components() == 1) return a.component(std::max(component, 0)).converted(type);
  std::byte* out = nullptr;
  Array r = Array::make_raw(type, a.count(), 1, &out);
  dispatch(a, [&](auto v) {
    parallel_for(v.count, values_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        double sum = 0;
        for (int c = 0; c < v.components; ++c) sum += double(v(i, c)) * double(v(i, c));
        if (type == ElementType::f64) reinterpret_cast<double*>(out)[i] = std::sqrt(sum);
        else reinterpret_cast<float*>(out)[i] = float(std::sqrt(sum));
      }
    });
  });
  return r;
}

}  // namespace sg
