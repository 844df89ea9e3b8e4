// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/bidirectional/path_of_point.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/trace/light/luminance.h"

namespace sg::trace {

namespace {

using Part = PrimarySpace::Part;

// The vertices of a half that are turn number `level` of it.
template <class F>
void each(const SubPath& path, int level, F&& f) {
  for (int i = 0; i < int(path.vertices.size()); ++i)
    if (path.vertex(i).level == level) f(i);
}

// How many more turns, of which there may be any number: n or more with the chance typical / (typical + n). Light in dense white matter
// falls more slowly with n than any geometric distribution.
struct More {
  int turns;
  double chance;
};
More draw_more(float u) {
  constexpr double typical = 8;
  const double n = std::floor(typical * double(u) / (1 - double(u)));
  return {int(std::min(n, 1e6)), typical / ((typical + n) * (typical + n + 1))};
}

}  // namespace

void PathOfPoint::trace(PrimarySpace& numbers, int kind, Lit& lit) {
  lit.splats.clear(), lit.brightness = 0;
  numbers.begin(Part::way);
  const More more = kind > scene_.bounces ? draw_more(numbers.next()) : More{0, 1};
  const int turns = kind + more.turns, ways = turns + 2;
  if (turns > scene_.turns) return;
  const int s = std::min(int(numbers.next() * float(ways)), ways - 1);
  const auto add = [&](const std::optional<Contribution>& c) {
    if (!c) return;
    const Vec3 value = Vec3(c->value) * (strategies_.weight(*c) * ways / more.chance);
    const double y = double(luminance(Vec3f(value)));
    if (!(y > 0) || !std::isfinite(y)) return;
    lit.splats.push_back({c->pixel, value}), lit.brightness += y;
  };
  const int of_light = std::max(s - 1, 0), of_camera = s == 0 ? turns + 1 : turns - of_light;  // vertices
  if (of_camera > 0) {
    numbers.begin(Part::camera);
    const Vec2f u = numbers.next2();
    walk_from_camera(scene_, strategies_.media(), {u.x * float(scene_.camera.width()), u.y * float(scene_.camera.height())}, of_camera,
                     numbers, camera_);
  }
  if (of_light > 0) {
    numbers.begin(Part::light);
    walk_from_light(scene_, strategies_.media(), of_light, numbers, light_);
  }
  if (s == 0) {
    for (const Stretch& stretch : camera_.stretches)
      if (camera_.vertex(stretch.after).level == turns)
        for (const MetLight& m : strategies_.met_in(stretch)) add(strategies_.met(camera_, stretch, m));
    each(camera_, turns + 1, [&](int j) { add(strategies_.shining(camera_, j)); });
  } else if (s == 1) {
    numbers.begin(Part::light);
    each(camera_, turns, [&](int j) { add(strategies_.asked(camera_, j, numbers)); });
  } else if (of_camera == 0) {
    numbers.begin(Part::between);
    each(light_, turns, [&](int i) { add(strategies_.onto_picture(light_, i, numbers)); });
  } else {
    numbers.begin(Part::between);
    each(light_, of_light,
         [&](int i) { each(camera_, of_camera, [&](int j) { add(strategies_.joined(light_, i, camera_, j, numbers)); }); });
  }
}

}  // namespace sg::trace
