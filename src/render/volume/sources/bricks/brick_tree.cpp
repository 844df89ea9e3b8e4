// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/bricks/brick_tree.h"

#include <algorithm>
#include <cmath>

namespace sg::volume {

namespace {
constexpr uint32_t edge = BrickedVolume::block;
}

std::array<uint32_t, 3> BrickTree::bricks(size_t level) const {
  std::array<uint32_t, 3> n{};
  for (size_t a = 0; a < 3; ++a) {
    const size_t width = edge * volume_.levels[level].coarseness[a];
    n[a] = uint32_t(std::max<size_t>(1, (volume_.levels[0].dims[a] - 1 + width - 1) / width));
  }
  return n;
}

BrickTree::BrickTree(const BrickedVolume& volume, const Projection& projection, double pixels, uint64_t most_bytes,
                     const Invisible& invisible)
    : volume_(volume), projection_(projection), invisible_(invisible) {
  const size_t levels = volume.levels.size();
  if (!volume.extremes.empty()) {
    extremes_.push_back(volume.extremes);
    for (size_t l = 1; l < levels; ++l) {
      const auto n = bricks(l), fine = bricks(l - 1);
      const auto &c = volume.levels[l].coarseness, &f = volume.levels[l - 1].coarseness;
      std::vector<BrickedVolume::Extremes> e(size_t(n[0]) * n[1] * n[2], {HUGE_VALF, -HUGE_VALF});
      for (size_t k = 0; k < fine[2]; ++k)
        for (size_t j = 0; j < fine[1]; ++j)
          for (size_t i = 0; i < fine[0]; ++i) {
            const auto& from = extremes_[l - 1][i + fine[0] * (j + fine[1] * k)];
            auto& to = e[i * f[0] / c[0] + n[0] * (j * f[1] / c[1] + n[1] * (k * f[2] / c[2]))];
            to.lo = std::min(to.lo, from.lo), to.hi = std::max(to.hi, from.hi);
          }
      extremes_.push_back(std::move(e));
    }
  }
  roots_ = bricks(levels - 1);
  // Half a level at a time until the bricks that may be seen are few enough, or there is nothing coarser.
  for (pixels_ = pixels; !grow(pixels_, most_bytes) && pixels_ < pixels * 1e9;) pixels_ *= std::sqrt(2.0);
  balance();
  blend();
  bytes_ = 0;
  for (const BrickNode& n : nodes_)
    if (n.seen && n.children < 0) bytes_ += brick_bytes(n);
}

void BrickTree::box(const BrickNode& node, Vec3& lo, Vec3& hi) const {
  for (int a = 0; a < 3; ++a) {
    const size_t n = volume_.levels[0].dims[size_t(a)];
    const double width = double(edge * volume_.levels[node.level].coarseness[size_t(a)]);
    lo[a] = n == 1 ? -0.5 : double(node.at[size_t(a)]) * width;
    hi[a] = std::min(last_place(n), n == 1 ? 0.5 : lo[a] + width);
  }
}

uint64_t BrickTree::brick_bytes(const BrickNode& node) const {
  Vec3 lo, hi;
  box(node, lo, hi);
  uint64_t bytes = std::min<size_t>(4, element_size(volume_.type));
  for (int a = 0; a < 3; ++a) bytes *= uint64_t((hi[a] - lo[a]) / double(volume_.levels[node.level].coarseness[size_t(a)])) + 3;
  return bytes;
}

void BrickTree::describe(BrickNode& n) const {
  const auto count = bricks(n.level);
  n.exists = n.at[0] < count[0] && n.at[1] < count[1] && n.at[2] < count[2];
  if (!n.exists) return;
  n.lo = -HUGE_VALF, n.hi = HUGE_VALF;
  bool empty = false;
  if (!extremes_.empty()) {
    const auto& e = extremes_[n.level][n.at[0] + size_t(count[0]) * (n.at[1] + size_t(count[1]) * n.at[2])];
    n.lo = e.lo, n.hi = e.hi;
    empty = !(e.lo <= e.hi);
  }
  double nearest;
  n.seen = !empty && !invisible_(n.lo, n.hi) && in_view(n, nearest);
}

bool BrickTree::in_view(const BrickNode& node, double& nearest) const {
  Vec3 lo, hi;
  box(node, lo, hi);
  const BrickedVolume::Level& fine = volume_.levels[0];
  nearest = HUGE_VAL;
  // Outside when all corners lie beyond the left or right side of the picture, or behind it; corners behind the eye are beyond none. Above
  // and below do not count: a picture may be drawn in bands, and all must choose the same levels.
  bool left = true, right = true, behind = true;
  for (int c = 0; c < 8; ++c) {
    const Vec3 u{c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y, c & 4 ? hi.z : lo.z};
    const Vec3 e = projection_.to_eye(fine.origin + volume_.direction * (fine.spacing * u));
    nearest = std::min(nearest, e.z);
    const double s = projection_.parallel ? projection_.scale : projection_.scale / std::max(e.z, 1e-300);
    const bool front = projection_.parallel || e.z > 0;
    const double x = projection_.middle_x() + s * e.x;
    left = left && front && x < -1, right = right && front && x > projection_.width + 1;
    behind = behind && e.z < projection_.near_plane;
  }
  return !(left || right || behind);
}

bool BrickTree::too_coarse(const BrickNode& node, double nearest, double pixels) const {
  if (node.level == 0) return false;
  // Only axes that the finer level resolves better count.
  double voxel = 0;
  for (size_t a = 0; a < 3; ++a)
    if (volume_.levels[node.level].coarseness[a] > volume_.levels[node.level - 1u].coarseness[a])
      voxel = std::max(voxel, volume_.levels[node.level].spacing[int(a)]);
  const double pixel = projection_.parallel ? 1 / projection_.scale : std::max(nearest, projection_.near_plane) / projection_.scale;
  return voxel > pixels * pixel * (1 + 1e-9);
}

void BrickTree::split(int at) {
  const BrickNode parent = nodes_[size_t(at)];
  nodes_[size_t(at)].children = int32_t(nodes_.size());
  const auto &c = volume_.levels[parent.level].coarseness, &f = volume_.levels[parent.level - 1u].coarseness;
  const uint32_t r[3] = {uint32_t(c[0] / f[0]), uint32_t(c[1] / f[1]), uint32_t(c[2] / f[2])};
  for (uint32_t k = 0; k < r[2]; ++k)
    for (uint32_t j = 0; j < r[1]; ++j)
      for (uint32_t i = 0; i < r[0]; ++i) {
        BrickNode n;
        n.at = {parent.at[0] * r[0] + i, parent.at[1] * r[1] + j, parent.at[2] * r[2] + k};
        n.level = uint8_t(parent.level - 1);
        describe(n);
        nodes_.push_back(n);
      }
}

bool BrickTree::grow(double pixels, uint64_t most_bytes) {
  nodes_.clear();
  const auto top = uint8_t(volume_.levels.size() - 1);
  for (uint32_t k = 0; k < roots_[2]; ++k)
    for (uint32_t j = 0; j < roots_[1]; ++j)
      for (uint32_t i = 0; i < roots_[0]; ++i) {
        BrickNode n;
        n.at = {i, j, k}, n.level = top;
        describe(n);
        nodes_.push_back(n);
      }
  uint64_t bytes = 0;
  bool split_any = false;
  for (size_t i = 0; i < nodes_.size(); ++i) {  // grows while it goes
    const BrickNode n = nodes_[i];
    if (!n.exists || !n.seen) continue;
    double nearest;
    in_view(n, nearest);
    if (too_coarse(n, nearest, pixels)) {
      split(int(i));
      split_any = true;
    } else {
      bytes += brick_bytes(n);
    }
    if (bytes > most_bytes && split_any) return false;
  }
  return true;
}

int BrickTree::find(Vec3 u) const {
  const size_t top = volume_.levels.size() - 1;
  uint64_t i[3];
  for (int a = 0; a < 3; ++a) {
    const double width = double(edge * volume_.levels[top].coarseness[size_t(a)]);
    i[a] = uint64_t(std::clamp(std::floor(u[a] / width), 0.0, double(roots_[size_t(a)] - 1)));
  }
  size_t at = i[0] + roots_[0] * (i[1] + roots_[1] * i[2]);
  while (nodes_[at].children >= 0) {
    const BrickNode& n = nodes_[at];
    const auto &c = volume_.levels[n.level].coarseness, &f = volume_.levels[n.level - 1u].coarseness;
    size_t child[3], r[3];
    for (size_t a = 0; a < 3; ++a) {
      r[a] = c[a] / f[a];
      const double width = double(edge * f[a]), first = double(n.at[a]) * double(edge * c[a]);
      child[a] = size_t(std::clamp(std::floor((u[int(a)] - first) / width), 0.0, double(r[a] - 1)));
      // Behind the last brick there is none; the outermost sample belongs to the one before it.
      while (child[a] > 0 && first + double(child[a]) * width >= last_place(volume_.levels[0].dims[a])) --child[a];
    }
    at = size_t(n.children) + child[0] + r[0] * (child[1] + r[1] * child[2]);
  }
  return int(at);
}

// Bricks that touch differ by one level at most, as far as both are seen.
void BrickTree::balance() {
  std::vector<int> pending;
  for (size_t i = 0; i < nodes_.size(); ++i)
    if (nodes_[i].children < 0 && nodes_[i].seen) pending.push_back(int(i));
  while (!pending.empty()) {
    const int at = pending.back();
    pending.pop_back();
    const BrickNode n = nodes_[size_t(at)];
    if (n.children >= 0) continue;
    Vec3 size, lo;
    for (int a = 0; a < 3; ++a)
      size[a] = double(edge * volume_.levels[n.level].coarseness[size_t(a)]), lo[a] = double(n.at[size_t(a)]) * size[a];
    for (int d = 0; d < 27; ++d) {
      if (d == 13) continue;
      const Vec3 place = lo + size * Vec3(d % 3 - 0.5, d / 3 % 3 - 0.5, d / 9 - 0.5);
      bool inside = true;
      for (int a = 0; a < 3; ++a)
        inside = inside && place[a] >= 0 && place[a] - 0.5 * size[a] < last_place(volume_.levels[0].dims[size_t(a)]);
      if (!inside) continue;
      // The middle of the neighbouring box may lie beyond the grid; its corner towards this one does not.
      Vec3 probe = place;
      for (int a = 0; a < 3; ++a) probe[a] = std::min(probe[a], last_place(volume_.levels[0].dims[size_t(a)]));
      for (int beside = find(probe); nodes_[size_t(beside)].seen && nodes_[size_t(beside)].level > n.level + 1; beside = find(probe)) {
        const size_t first = nodes_.size();
        split(beside);
        for (size_t i = first; i < nodes_.size(); ++i)
          if (nodes_[i].exists && nodes_[i].seen) pending.push_back(int(i));
      }
    }
  }
}

void BrickTree::blend() {
  for (BrickNode& n : nodes_) {
    if (n.children >= 0 || !n.seen || n.level + 1u >= volume_.levels.size()) continue;
    Vec3 lo, hi;
    box(n, lo, hi);
    for (int c = 0; c < 8; ++c)
      for (int o = 0; o < 8; ++o) {
        Vec3 u;
        bool inside = true;
        for (int a = 0; a < 3; ++a) {
          u[a] = (c >> a & 1 ? hi[a] : lo[a]) + (o >> a & 1 ? 0.25 : -0.25);
          inside = inside && u[a] > first_place(volume_.levels[0].dims[size_t(a)]) && u[a] < last_place(volume_.levels[0].dims[size_t(a)]);
        }
        if (!inside) continue;
        const BrickNode& beside = nodes_[size_t(find(u))];
        if (beside.seen && beside.level > n.level) n.blend |= uint8_t(1 << c);
      }
  }
}

std::array<uint32_t, 3> BrickTree::parent(const BrickNode& n) const {
  const auto &c = volume_.levels[n.level + 1u].coarseness, &f = volume_.levels[n.level].coarseness;
  std::array<uint32_t, 3> at{};
  for (size_t a = 0; a < 3; ++a) at[a] = uint32_t(n.at[a] / (c[a] / f[a]));
  return at;
}

namespace {

// Places 0 .. n-1 of boxes of one width along an axis, so that a ray meets them in this order whichever way it goes from the eye. A
// ray never meets boxes on both sides of the eye.
std::vector<uint32_t> along_axis(uint32_t first, uint32_t n, double width, double eye, double along, bool parallel) {
  std::vector<uint32_t> order(n);
  for (uint32_t i = 0; i < n; ++i) order[i] = first + i;
  if (parallel) {
    if (along < 0) std::reverse(order.begin(), order.end());
    return order;
  }
  const auto apart = [&](uint32_t i) { return std::max({0.0, i * width - eye, eye - (i + 1) * width}); };
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return apart(a) < apart(b); });
  return order;
}

}  // namespace

void BrickTree::visit(int at, Vec3 eye, Vec3 along, std::vector<int>& leaves) const {
  const BrickNode& n = nodes_[size_t(at)];
  if (!n.exists || !n.seen) return;
  if (n.children < 0) return leaves.push_back(at);
  const auto &c = volume_.levels[n.level].coarseness, &f = volume_.levels[n.level - 1u].coarseness;
  std::vector<uint32_t> order[3];
  uint32_t r[3];
  for (size_t a = 0; a < 3; ++a) {
    r[a] = uint32_t(c[a] / f[a]);
    order[a] = along_axis(n.at[a] * r[a], r[a], double(edge * f[a]), eye[int(a)], along[int(a)], projection_.parallel);
  }
  for (const uint32_t k : order[2])
    for (const uint32_t j : order[1])
      for (const uint32_t i : order[0])
        visit(n.children + int(i - n.at[0] * r[0] + r[0] * (j - n.at[1] * r[1] + r[1] * (k - n.at[2] * r[2]))), eye, along, leaves);
}

std::vector<int> BrickTree::front_to_back() const {
  const BrickedVolume::Level& fine = volume_.levels[0];
  const Vec3 moved = transpose(volume_.direction) * (projection_.eye - fine.origin),
             way = transpose(volume_.direction) * projection_.forward;
  Vec3 eye, along;
  for (int a = 0; a < 3; ++a) eye[a] = moved[a] / fine.spacing[a], along[a] = way[a] / fine.spacing[a];
  const auto& c = volume_.levels.back().coarseness;
  std::vector<uint32_t> order[3];
  for (size_t a = 0; a < 3; ++a) order[a] = along_axis(0, roots_[a], double(edge * c[a]), eye[int(a)], along[int(a)], projection_.parallel);
  std::vector<int> leaves;
  for (const uint32_t k : order[2])
    for (const uint32_t j : order[1])
      for (const uint32_t i : order[0]) visit(int(i + roots_[0] * (j + roots_[1] * k)), eye, along, leaves);
  return leaves;
}

double coarser_share(const BrickNode& n, Vec3 lo, Vec3 hi, Vec3 u) {
  double f[3];
  for (int a = 0; a < 3; ++a) f[a] = std::clamp((u[a] - lo[a]) / std::max(hi[a] - lo[a], 1e-300), 0.0, 1.0);
  double w = 0;
  for (int c = 0; c < 8; ++c)
    if (n.blend >> c & 1) w += (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]);
  return w;
}

}  // namespace sg::volume
