// SPDX-License-Identifier: Apache-2.0
#include "render/volume/engines/bricks/brick_packets.h"

#include <cmath>

#include "render/composite/over.h"
#include "render/volume/sources/item_checks.h"

namespace sg::volume {

namespace {

// Faces between bricks are moved by so much of a sample of level 0: a ray that lies in a face, as in views along an axis, belongs to one
// brick, whatever the rounding.
constexpr double aside = 1.0 / 1048576 + 1e-8;

}  // namespace

Volume brick_stage(const BrickedSource& source, const VolumeItem& item, uint32_t id, double unit, float per_scale) {
  Volume v;
  v.id = id, v.mode = item.mode, v.shaded = item.shaded;
  v.edge = source.edge, v.step = item.sampling.step > 0 ? item.sampling.step : 0.5 * source.edge;
  v.shade_plan.per_scale = per_scale;
  // Of the whole.
  v.origin = source.volume().levels[0].origin, v.to_q = source.places().to_fine, v.lo = source.places().lo, v.hi = source.places().hi;
  const Range range = item.data->range(field_of(item), item.component);
  v.transfer.emplace_back(item.color, item.opacity, unit, v.step, range.empty() ? item.color.lo : range.lo,
                          range.empty() ? item.color.hi : range.hi, 0.0);
  v.direct = v.transfer[0].linear() && item.color.labels.empty();
  return v;
}

bool BrickPackets::fits(const BrickedSource& source, const VolumeItem& item, const BrickPlan& plan) {
  for (const size_t n : source.volume().levels[0].dims)
    if (n / BrickedVolume::block >= size_t(1) << 17) return false;
  const bool light = in_packets(plan.light) && (!plan.in_steps || plan.light.material.power == 32);
  return source.volume().levels.size() <= 32 && plan.medium->linear() && item.color.kind == ScaleKind::linear &&
         item.color.labels.empty() && light;
}

BrickPackets::BrickPackets(const BrickedSource& source, const Volume& stage, BrickPlan plan, const Context& context)
    : source_(source), stage_(stage), plan_(std::move(plan)), context_(context) {
  source.expect_lattices();
  const BrickTree& tree = source.tree();
  const Projection& p = plan_.projection;
  const BrickedVolume::Level& fine = source.volume().levels[0];
  for (const int at : tree.front_to_back()) {
    Leaf leaf{at, HUGE_VALF, HUGE_VALF, -HUGE_VALF, -HUGE_VALF, {}, false};
    Vec3 lo, hi;
    tree.box(tree.node(at), lo, hi);
    for (size_t c = 0; c < 8; ++c) {
      const Vec3 u{c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y, c & 4 ? hi.z : lo.z};
      const Vec3 pixel = p.to_pixel(fine.origin + source.volume().direction * (fine.spacing * u));
      leaf.all = leaf.all || (!p.parallel && !(pixel.z > 0.5 * p.near_plane));
      leaf.corner[c] = {pixel.x, pixel.y};
      leaf.x0 = std::min(leaf.x0, float(pixel.x)), leaf.x1 = std::max(leaf.x1, float(pixel.x));
      leaf.y0 = std::min(leaf.y0, float(pixel.y)), leaf.y1 = std::max(leaf.y1, float(pixel.y));
    }
    if (leaf.all) leaf.x0 = leaf.y0 = 0, leaf.x1 = float(p.width), leaf.y1 = float(p.height);
    // For rounding.
    leaf.x0 -= 0.01f, leaf.y0 -= 0.01f, leaf.x1 += 0.01f, leaf.y1 += 0.01f;
    if (leaf.x1 >= 0 && leaf.x0 <= float(p.width) && leaf.y1 >= 0 && leaf.y0 <= float(p.height)) leaves_.push_back(leaf);
  }
}

// Whether the projection of the box, a convex polygon, meets the rectangle. If not, the line through some edge of one lies between them.
bool BrickPackets::meets(const Leaf& leaf, double x0, double y0, double x1, double y1) const {
  if (!(double(leaf.x0) < x1 && double(leaf.x1) > x0 && double(leaf.y0) < y1 && double(leaf.y1) > y0)) return false;
  if (leaf.all) return true;
  for (size_t c = 0; c < 8; ++c)
    for (size_t a = 0; a < 3; ++a) {
      if (c >> a & 1) continue;
      const Vec2 from = leaf.corner[c], to = leaf.corner[c | size_t(1) << a];
      const double nx = to.y - from.y, ny = from.x - to.x, slack = 0.02 * (std::abs(nx) + std::abs(ny));
      double lo = 0, hi = 0;
      for (const Vec2& q : leaf.corner) {
        const double s = nx * (q.x - from.x) + ny * (q.y - from.y);
        lo = std::min(lo, s), hi = std::max(hi, s);
      }
      double near_lo = HUGE_VAL, near_hi = -HUGE_VAL;
      for (int k = 0; k < 4; ++k) {
        const double s = nx * ((k & 1 ? x1 : x0) - from.x) + ny * ((k & 2 ? y1 : y0) - from.y);
        near_lo = std::min(near_lo, s), near_hi = std::max(near_hi, s);
      }
      if (near_lo > hi + slack || near_hi < lo - slack) return false;
    }
  return true;
}

bool BrickPackets::load(const BrickNode& node, Volume& v, LatticePart& part, std::shared_ptr<const BrickLattice>& lattice) const {
  lattice = source_.lattice(node);
  const auto space = spaces_.get(lattice_key(node), [&] {
    auto s = std::make_shared<BrickSpace>(space_of(lattice->samples.fine, source_.invisible));
    const size_t bytes = s->distance.size() + 64;
    return std::pair(std::shared_ptr<const BrickSpace>(std::move(s)), bytes);
  });
  if (space->nothing) return false;
  const BrickedVolume& volume = source_.volume();
  const BrickPlaces& places = source_.places();
  const BrickedVolume::Level& level = volume.levels[node.level];
  v.samples = std::shared_ptr<const LatticeSamples>(lattice, &lattice->samples);
  v.voxels = lattice->samples.voxels;
  v.distance = space->distance, v.any_empty = space->any_empty;
  v.origin = level.origin + volume.direction * (level.spacing * lattice->first);
  Vec3 lo, hi;
  source_.tree().box(node, lo, hi);
  for (int a = 0; a < 3; ++a) {
    const double scale = places.scale[node.level][a], shift = places.shift[node.level][a] - lattice->first[a];
    const double low = lo[a] > places.lo[a] ? lo[a] - aside : lo[a], high = hi[a] < places.hi[a] ? hi[a] - aside : hi[a];
    v.lo[a] = low * scale + shift, v.hi[a] = high * scale + shift;
    part.whole_lo[a] = places.lo[a] * scale + shift, part.whole_hi[a] = places.hi[a] * scale + shift;
    for (int c = 0; c < 3; ++c) v.to_q.m[a][c] = volume.direction.m[c][a] / level.spacing[a];
    v.margin[a] = 1e-3;
  }
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) v.shade_plan.to_world[r][c] = float(v.to_q.m[c][r]);
  // Steps are lit by the change over a cell of the level.
  v.shade_plan.per_scale = stage_.shade_plan.per_scale;
  return true;
}

void BrickPackets::draw(int x0, int y0, int x1, int y1, Frame& frame) const {
  const auto width = size_t(x1 - x0), height = size_t(y1 - y0);
  // A little picture of its own, with what was gathered so far; rays end at what is opaque in the frame.
  Frame gathered(x1 - x0, y1 - y0);
  std::vector<float> half(width * height, HUGE_VALF);
  for (size_t y = 0; y < height; ++y)
    for (size_t x = 0; x < width; ++x) gathered.depth[y * width + x] = frame.depth[(size_t(y0) + y) * size_t(frame.width) + size_t(x0) + x];
  Projection p = plan_.projection;
  p.shift_x -= x0, p.shift_y -= y0;
  Volume volume = stage_;
  const PrimaryRays rays{volume, p, plan_.simd};
  LatticePart part{half.data(), {}, {}, plan_.budget.stop_below};
  const MarchingPlan steps{rays, plan_.light, plan_.stop_below, plan_.skip_empty, nullptr, &part};
  const StridingPlan integral{{rays, plan_.light, plan_.medium, plan_.budget}, nullptr, plan_.skip_empty, &part};
  std::shared_ptr<const BrickLattice> lattice;
  for (const Leaf& leaf : leaves_) {
    if (!meets(leaf, x0, y0, x1, y1)) continue;
    // Corners near the eye may lie anywhere: first cut to the tile, then made whole numbers.
    const auto within = [](float v, int from, int to) { return int(std::clamp(v, float(from), float(to))) - from; };
    const int left = within(std::floor(leaf.x0), x0, x1), right = within(std::ceil(leaf.x1), x0, x1);
    const int top = within(std::floor(leaf.y0), y0, y1), bottom = within(std::ceil(leaf.y1), y0, y1);
    bool light = false;
    for (int y = top; y < bottom && !light; ++y)
      for (int x = left; x < right && !light; ++x) light = 1 - gathered.rgba[4 * (size_t(y) * width + size_t(x)) + 3] >= part.stop_below;
    context_.check();
    if (!light || !load(source_.tree().node(leaf.node), volume, part, lattice)) continue;
    if (plan_.in_steps) draw_tile(steps, left, top, right, bottom, gathered);
    else draw_tile(integral, left, top, right, bottom, gathered);
  }
  for (size_t y = 0; y < height; ++y)
    for (size_t x = 0; x < width; ++x) {
      const size_t from = y * width + x, to = (size_t(y0) + y) * size_t(frame.width) + size_t(x0) + x;
      const float* in = &gathered.rgba[4 * from];
      float* out = &frame.rgba[4 * to];
      Gathered sum{in[0], in[1], in[2], 1 - in[3]};
      sum.behind(out);
      out[0] = sum.r, out[1] = sum.g, out[2] = sum.b, out[3] = 1 - sum.transmittance;
      if (half[from] < HUGE_VALF && !(frame.depth[to] < HUGE_VALF)) frame.depth[to] = half[from], frame.ids[to] = stage_.id;
    }
}

}  // namespace sg::volume
