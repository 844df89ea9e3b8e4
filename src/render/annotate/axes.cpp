// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/axes.h"

#include <algorithm>
#include <cmath>

namespace sg {
namespace {

double length_of(Vec2 v) { return std::sqrt(v.x * v.x + v.y * v.y); }
double dot_of(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }

Vec3 corner(const Box3& b, int i) { return {i & 1 ? b.hi.x : b.lo.x, i & 2 ? b.hi.y : b.lo.y, i & 4 ? b.hi.z : b.lo.z}; }

/// Whether the face of the box on the low or high side of an axis faces the viewer.
bool faces_viewer(const Box3& b, int axis, bool high, const Projection& p) {
  if (p.parallel) return (high ? -1 : 1) * p.forward[axis] > 1e-9;
  const double slack = 1e-9 * (std::abs(p.eye[axis]) + b.diagonal());
  return high ? p.eye[axis] > b.hi[axis] + slack : p.eye[axis] < b.lo[axis] - slack;
}

/// Rectangle of a text whose nearest side touches `at` when seen along `outward`.
Rect beside(Vec2 at, Vec2 outward, TextExtent e) {
  const double reach = std::abs(outward.x) * 0.5 * e.width + std::abs(outward.y) * 0.5 * e.height;
  const Vec2 center = at + outward * reach;
  return {center.x - 0.5 * e.width, center.y - 0.5 * e.height, e.width, e.height};
}

bool is_free(const Rect& r, const Overlay& o, const std::vector<Rect>& taken) {
  if (r.x < 2 || r.y < 2 || r.right() > o.width() - 2 || r.bottom() > o.height() - 2) return false;
  return std::none_of(taken.begin(), taken.end(), [&](const Rect& t) { return t.overlaps(r); });
}

/// Along an edge from one of its ends towards its middle; zero near the middle itself.
Vec2 towards_middle(Vec2 at, Vec2 from, Vec2 to) {
  const Vec2 along = to - from;
  const double l2 = dot_of(along, along), t = l2 > 0 ? dot_of(at - from, along) / l2 : 0.5;
  return std::abs(t - 0.5) < 0.25 ? Vec2{} : along * ((t < 0.5 ? 1 : -1) / std::sqrt(l2));
}

struct PlacedTick {
  Vec2 at;  ///< on the edge
  std::string text;
  Rect rect;
};

/// The most ticks whose numbers all stay apart along this edge. `stretch`: drawn length of a unit.
std::vector<PlacedTick> tick_places(const Overlay& o, const BoxAxis& a, double stretch, const Projection& p, double font,
                                    const TextStyle& style) {
  const Vec3 from = p.to_pixel(a.from), to = p.to_pixel(a.to);
  const double pixels = length_of({to.x - from.x, to.y - from.y});
  const auto [lo, hi] = std::minmax({a.from[a.axis] / stretch, a.to[a.axis] / stretch});
  std::vector<PlacedTick> places;
  for (int wanted = int(std::max(2.0, std::min(7.0, pixels / (3.5 * font)))); wanted >= 1; --wanted) {
    places.clear();
    bool apart = true;
    for (const TickLabel& t : nice_ticks(lo, hi, wanted)) {
      Vec3 world = a.from;
      world[a.axis] = t.value * stretch;
      const Vec3 q = p.to_pixel(world);
      PlacedTick tick{{q.x, q.y}, typeset_number(t.text), {}};
      tick.rect = beside(tick.at + a.outward * (0.85 * font), a.outward, o.measure(tick.text, style));
      for (const PlacedTick& other : places) apart = apart && !other.rect.grown(0.12 * font).overlaps(tick.rect);
      places.push_back(tick);
    }
    if (apart) break;
  }
  return places;
}

/// Where the name goes: beyond the numbers at the middle of the edge, else further along, else further out.
std::optional<Rect> name_place(const Overlay& o, const BoxAxis& a, const Projection& p, double font, const std::vector<PlacedTick>& ticks,
                               TextExtent e, const std::vector<Rect>& taken) {
  const Vec3 from = p.to_pixel(a.from), to = p.to_pixel(a.to);
  const Vec2 middle{0.5 * (from.x + to.x), 0.5 * (from.y + to.y)}, along{to.x - from.x, to.y - from.y};
  double beyond = 0.9 * font;
  for (const PlacedTick& t : ticks) {
    // How far this number reaches out of its edge.
    const Vec2 center{t.rect.x + 0.5 * t.rect.width, t.rect.y + 0.5 * t.rect.height};
    const double reach = std::abs(a.outward.x) * 0.5 * t.rect.width + std::abs(a.outward.y) * 0.5 * t.rect.height;
    beyond = std::max(beyond, dot_of({center.x - t.at.x, center.y - t.at.y}, a.outward) + reach + 0.85 * font);
  }
  for (double out : {beyond, beyond * 0.75, beyond * 0.5, beyond * 1.4})
    for (double shift : {0.0, 0.1, -0.1, 0.2, -0.2, 0.3, -0.3, 0.42, -0.42, 0.5, -0.5}) {
      const Rect r = beside(middle + along * shift + a.outward * out, a.outward, e);
      const Rect room{r.x - 0.8 * font, r.y - 0.3 * font, r.width + 1.6 * font, r.height + 0.6 * font};
      const bool hits = std::any_of(ticks.begin(), ticks.end(), [&](const PlacedTick& t) { return t.rect.overlaps(room); });
      if (!hits && is_free(r, o, taken)) return r;
    }
  return {};
}

Vec2 on_picture(Vec3 direction, const Projection& p) { return {dot(direction, p.right), -dot(direction, p.up)}; }

constexpr double triad_arm = 2.7, triad_margin = 1.0;  // in font sizes

}  // namespace

std::vector<BoxAxis> box_axes(const Box3& box, const Projection& p) {
  std::vector<BoxAxis> axes;
  if (box.empty()) return axes;
  Vec2 center;
  Vec2 corners[8];
  for (int i = 0; i < 8; ++i) {
    const Vec3 q = p.to_pixel(corner(box, i));
    if (!p.parallel && !(q.z > 0)) return axes;
    corners[i] = {q.x, q.y};
    center = center + corners[i] * 0.125;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double best = -HUGE_VAL;
    BoxAxis chosen;
    for (int k = 0; k < 4; ++k) {
      const bool high_u = k & 1, high_v = k & 2;
      if (faces_viewer(box, u, high_u, p) == faces_viewer(box, v, high_v, p)) continue;  // not on the silhouette
      const int i = int(high_u) << u | int(high_v) << v, j = i | 1 << axis;
      const Vec2 along = corners[j] - corners[i];
      const double pixels = length_of(along);
      if (pixels < 24) continue;
      const Vec2 middle = (corners[i] + corners[j]) * 0.5 - center;
      Vec2 outward{along.y / pixels, -along.x / pixels};
      if (dot_of(outward, middle) < 0) outward = outward * -1.0;
      // Below is best, then left: legends stand on the right.
      const double score = 0.85 * outward.y - 0.5 * outward.x;
      if (score > best) best = score, chosen = {axis, corner(box, i), corner(box, j), outward};
    }
    if (best > -HUGE_VAL) axes.push_back(chosen);
  }
  return axes;
}

void draw_box_axes(Overlay& o, const Annotation& annotation, const Projection& p, double font, std::vector<Rect>& taken) {
  if (!annotation.box || !annotation.axes) return;
  TextStyle style;
  style.size = 0.88 * font;
  TextStyle name_style;
  name_style.size = font;
  const double line_width = std::max(1.0, 0.08 * font);
  struct Drawn {
    BoxAxis axis;
    std::vector<PlacedTick> ticks;
  };
  std::vector<Drawn> drawn;
  for (const BoxAxis& a : box_axes(*annotation.box, p)) drawn.push_back({a, tick_places(o, a, annotation.stretch[a.axis], p, font, style)});
  // Names first: a number fewer is a smaller loss than a name.
  for (const Drawn& d : drawn) {
    const std::string& title = annotation.axis_titles[d.axis.axis];
    std::string name = title.empty() ? annotation.axis_names[d.axis.axis] : title;
    if (title.empty() && !annotation.length_unit.empty()) name += (name.empty() ? "[" : " [") + annotation.length_unit + "]";
    if (name.empty()) continue;
    std::vector<Rect> others = taken;
    for (const Drawn& other : drawn)
      if (&other != &d)
        for (const PlacedTick& t : other.ticks) others.push_back(t.rect.grown(1));
    const TextExtent e = o.measure(name, name_style);
    std::optional<Rect> place = name_place(o, d.axis, p, font, d.ticks, e, others);
    const Vec3 from = p.to_pixel(d.axis.from), to = p.to_pixel(d.axis.to);
    const bool tight = !place || place->x < 0.6 * font || place->right() > p.width - 0.6 * font;
    if (tight && std::abs(to.y - from.y) > 3 * std::abs(to.x - from.x)) {  // a long name beside an upright axis: read from below
      TextExtent turned = e;
      std::swap(turned.width, turned.height);
      if (const auto upright = name_place(o, d.axis, p, font, d.ticks, turned, others)) {
        o.text_turned(name, {upright->x + 0.5 * upright->width, upright->y + 0.5 * upright->height}, 0.5 * M_PI, name_style);
        taken.push_back(*upright);
        continue;
      }
    }
    if (!place) place = name_place(o, d.axis, p, font, {}, e, taken);
    if (!place) continue;
    o.text(name, place->x, place->y, name_style, true);
    taken.push_back(*place);
  }
  std::vector<Rect> numbers;  // of the other axes: two in a row want more room than other things, or they read as one
  const auto hits_number = [&](const Rect& r) {
    return std::any_of(numbers.begin(), numbers.end(), [&](const Rect& other) { return other.overlaps(r); });
  };
  for (const Drawn& d : drawn) {
    const Vec3 from = p.to_pixel(d.axis.from), to = p.to_pixel(d.axis.to);
    o.line({from.x, from.y}, {to.x, to.y}, line_width, 0.9);
    std::vector<Rect> own;
    for (const PlacedTick& t : d.ticks) {
      o.line(t.at, t.at + d.axis.outward * (0.5 * font), line_width, 0.9);
      // A number that meets another axis' at a corner moves towards the middle of its own, a little further out, or aside.
      const auto write_at = [&](Vec2 move) {
        const Rect rect{t.rect.x + move.x * font, t.rect.y + move.y * font, t.rect.width, t.rect.height};
        const Rect room{rect.x - 0.7 * font, rect.y - 0.15 * font, rect.width + 1.4 * font, rect.height + 0.3 * font};
        if (!is_free(rect.grown(0.3 * font), o, taken) || hits_number(room)) return false;
        o.text(t.text, rect.x, rect.y, style, true);
        taken.push_back(rect), own.push_back(rect);
        return true;
      };
      const Vec2 n = d.axis.outward, inward = towards_middle(t.at, {from.x, from.y}, {to.x, to.y});
      for (Vec2 move : {Vec2{}, inward * 0.45, inward * 0.9, n * 0.4 + inward * 0.6, n * 0.8, n * 1.2, Vec2{-0.7, 0.1}, Vec2{0.7, 0.1},
                        Vec2{-1.4, 0.3}, Vec2{1.4, 0.3}, n * 1.7})
        if (write_at(move)) break;
    }
    numbers.insert(numbers.end(), own.begin(), own.end());
  }
}

Rect triad_place(int, int height, double font) {
  const double side = 2 * (triad_arm + 1.1) * font;
  return {triad_margin * font - 0.4 * font, height - side - 0.6 * font, side, side};
}

void draw_triad(Overlay& o, const Annotation& annotation, const Projection& p, double font) {
  const Rect place = triad_place(p.width, p.height, font);
  const Vec2 center{place.x + 0.5 * place.width, place.y + 0.5 * place.height};
  const Vec3f light[3] = {{1.0f, 0.42f, 0.38f}, {0.45f, 0.85f, 0.40f}, {0.45f, 0.62f, 1.0f}};
  const Vec3f deep[3] = {{0.80f, 0.15f, 0.15f}, {0.10f, 0.52f, 0.15f}, {0.12f, 0.32f, 0.80f}};
  struct Arrow {
    int axis;
    Vec2 direction;
    double depth;
  };
  Arrow arrows[3];
  for (int i = 0; i < 3; ++i) {
    Vec3 unit;
    unit[i] = annotation.stretch[i] < 0 ? -1 : 1;
    arrows[i] = {i, on_picture(unit, p), dot(unit, p.forward)};
  }
  std::stable_sort(arrows, arrows + 3, [](const Arrow& a, const Arrow& b) { return a.depth > b.depth; });
  Vec2 sum;
  for (const Arrow& a : arrows) sum = sum + a.direction;
  for (const Arrow& a : arrows) {
    const Vec3f color = o.dark() ? light[a.axis] : deep[a.axis];
    const double flat = length_of(a.direction);
    const Vec2 tip = center + a.direction * (triad_arm * font);
    const double head = std::min(0.75 * font, 0.8 * flat * triad_arm * font), half = 0.3 * font;
    Vec2 d{0, 0};
    if (flat > 0.05) {
      d = a.direction * (1 / flat);
      const Vec2 neck = tip - d * head, side{-d.y * half, d.x * half};
      o.colored_line(center, neck, std::max(1.5, 0.16 * font), color);
      o.polygon({tip, neck + side, neck - side}, color, false);
    } else {
      // Seen end on: a dot, and the letter away from the other two.
      std::vector<Vec2> dot;
      for (int k = 0; k < 24; ++k)
        dot.push_back(center + Vec2{std::cos(k * 0.2617993877991494), std::sin(k * 0.2617993877991494)} * (0.28 * font));
      o.polygon(dot, color, false);
      const double l = length_of(sum);
      d = l > 0.05 ? sum * (-1 / l) : Vec2{-0.7071, 0.7071};
    }
    const std::string& name = annotation.axis_names[a.axis];
    if (name.empty() || name.size() > 3) continue;
    TextStyle style;
    style.size = font;
    style.bold = true;
    const TextExtent e = o.measure(name, style);
    const Rect r = beside((flat > 0.05 ? tip : center + d * (0.25 * font)) + d * (0.05 * font), d, e);
    o.colored_text(name, r.x, r.y, style, color);
  }
}

}  // namespace sg
