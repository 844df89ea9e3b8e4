// SPDX-License-Identifier: Apache-2.0
#include "filter/field/elevation.h"

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/point_positions.h"
#include "data/fields/known_looks.h"

namespace sg {

namespace {

constexpr size_t points_per_chunk = 1 << 15;

template <class T>
Array heights(const Array& xyz, Vec3 origin, Vec3 up) {
  T* to = nullptr;
  Array r = Array::make<T>(xyz.count(), 1, &to);
  dispatch(xyz, [&](auto v) {
    parallel_for(v.count, points_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) to[i] = T(dot(Vec3(double(v(i, 0)), double(v(i, 1)), double(v(i, 2))) - origin, up));
    });
  });
  return r;
}

}  // namespace

DatasetPtr elevation(const DatasetPtr& in, const ElevationParams& p, Context&) {
  const double size = length(p.direction);
  if (!(size > 0) || !std::isfinite(size))
    fail_usage("the direction is zero or not finite", "elevation direction", "give one, e.g. direction=0,0,1");
  const Array xyz = point_positions(in->mesh());
  const Vec3 up = p.direction / size;
  return with_result(
      in, {p.name, Association::point,
           xyz.type() == ElementType::f64 ? heights<double>(xyz, p.origin, up) : heights<float>(xyz, p.origin, up), "", Role::none});
}

}  // namespace sg
