// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/fronts/default_curve.h"

#include "base/error.h"
#include "filter/flow/random_places.h"

namespace sg {

SeedCurveParams across_the_flow(const FlowParts& parts, Context& context) {
  PartsCursor flow(parts);
  const Box3 box = parts.bounds();
  const double much = parts.mean_speed(), least = 0.02 * parts.largest_speed();
  if (!(much > 0)) fail_usage(fmt::format("field '{}' is zero or NaN everywhere: nothing flows", parts.name()), "stream_surface");
  const auto speed = [&](Vec3 x) {
    Vec3 v;
    return flow(x, v) ? length(v) : 0.0;
  };
  Vec3 middle = box.center();
  if (speed(middle) < 0.5 * much) {
    std::vector<DatasetPtr> meshes;
    for (const FlowField& f : parts.fields()) meshes.push_back(f.dataset());
    const std::vector<Vec3> places = random_places(
        meshes, 40, 1, [&](Vec3 x) { return speed(x) >= much; }, context);
    double nearest = HUGE_VAL;
    const Vec3 center = middle;
    for (const Vec3& x : places)
      if (const Vec3 d = x - center; dot(d, d) < nearest) nearest = dot(d, d), middle = x;
  }
  Vec3 v;
  if (!flow(middle, v) || !(length(v) > 0)) fail_usage("nothing flows in the middle of the mesh", "stream_surface", "from=x,y,z to=x,y,z");
  const Vec3 along = normalize(v);
  int axis = 2;
  for (const int a : {1, 0})
    if (std::abs(along[a]) < std::abs(along[axis]) - 0.05) axis = a;
  Vec3 side;
  side[axis] = 1;
  side = normalize(side - along * dot(along, side));
  const double step = box.diagonal() / 400;
  const auto far = [&](double sign) {
    Vec3 x = middle;
    for (int k = 1; k <= 50; ++k) {
      const Vec3 next = middle + side * (sign * step * k);
      if (!(speed(next) > least)) break;
      x = next;
    }
    return x;
  };
  SeedCurveParams p;
  p.from = far(-1), p.to = far(1);
  if (!(length(*p.to - *p.from) > 0)) p.from = middle - side * step, p.to = middle + side * step;
  context.info(
      fmt::format("seeds: a line across the flow, from={:.4g},{:.4g},{:.4g} to={:.4g},{:.4g},{:.4g}; points=, or center= and radius= "
                  "make others",
                  p.from->x, p.from->y, p.from->z, p.to->x, p.to->y, p.to->z));
  return p;
}

}  // namespace sg
