// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/slice/plane_cutter.h"

#include <algorithm>

namespace sg::detail {

double PlaneField::share(int64_t key) const {
  const uint32_t a = key_a(key), b = key_b(key);
  if (a == b) return 0;
  const double da = distance(a), db = distance(b);
  return da / (da - db);
}

Vec3 PlaneField::place(int64_t key) const {
  const uint32_t a = key_a(key), b = key_b(key);
  return a == b ? position(a) : lerp(position(a), position(b), share(key));
}

void PlaneCutter::cross(std::span<const int64_t> ids) {
  d_.clear();
  keys_.clear();
  for (int64_t id : ids) d_.push_back(plane_.distance(size_t(id)));
  for (size_t i = 0; i < ids.size(); ++i) {
    const size_t j = i + 1 < ids.size() ? i + 1 : 0;
    if ((d_[i] >= 0) != (d_[j] >= 0)) keys_.push_back(crossing_key(uint32_t(ids[i]), uint32_t(ids[j])));
  }
}

// Joins the crossings of keys_ in pairs, so that both cells of a face join them alike.
void PlaneCutter::pair_up() {
  if (keys_.size() == 2) {
    segments_.emplace_back(keys_[0], keys_[1]);
    return;
  }
  if (d_.size() == 4) {
    // A warped quad whose corners alternate: join as the saddle of the bilinear distance does (Nielson-Hamann).
    const bool joined = (d_[0] * d_[2] - d_[1] * d_[3]) / ((d_[0] + d_[2]) - (d_[1] + d_[3])) >= 0;
    // `joined`: the positive corners are connected, so the lines go around the negative ones.
    const bool around_first = joined == (d_[0] < 0);
    const int first = around_first ? 3 : 0;  // keys_[i] lies on edge i, i+1
    segments_.emplace_back(keys_[size_t(first)], keys_[size_t((first + 1) % 4)]);
    segments_.emplace_back(keys_[size_t((first + 2) % 4)], keys_[size_t((first + 3) % 4)]);
    return;
  }
  // A many-sided face is flat, so its crossings lie on a line: join 1st and 2nd, 3rd and 4th, ... along it.
  Box3 box;
  for (int64_t k : keys_) box.add(plane_.place(k));
  const Vec3 size = box.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::vector<std::pair<double, int64_t>> along;
  for (int64_t k : keys_) along.emplace_back(plane_.place(k)[axis], k);
  std::sort(along.begin(), along.end());
  for (size_t i = 0; i + 1 < along.size(); i += 2) segments_.emplace_back(along[i].second, along[i + 1].second);
}

void PlaneCutter::add_face(std::span<const int64_t> ids) {
  cross(ids);
  if (!keys_.empty()) pair_up();
}

// A crossing at an end of its edge is that point, whichever edge leads there.
int64_t PlaneCutter::settled(int64_t key) const {
  const uint32_t a = key_a(key), b = key_b(key);
  if (plane_.distance(a) == 0) return crossing_key(a, a);
  if (plane_.distance(b) == 0) return crossing_key(b, b);
  return key;
}

void PlaneCutter::close_loop(int64_t cell) {
  for (int64_t& k : loop_) k = settled(k);
  loop_.erase(std::unique(loop_.begin(), loop_.end()), loop_.end());
  while (loop_.size() > 1 && loop_.front() == loop_.back()) loop_.pop_back();
  if (loop_.size() < 3) return;
  Vec3 area;
  const Vec3 base = plane_.place(loop_[0]);
  Vec3 before = plane_.place(loop_[1]) - base;
  for (size_t i = 2; i < loop_.size(); ++i) {
    const Vec3 here = plane_.place(loop_[i]) - base;
    area += sg::cross(before, here);
    before = here;
  }
  const Vec3 normal = plane_.normal_at ? plane_.normal_at(base) : plane_.normal;
  if (dot(area, normal) < 0) std::reverse(loop_.begin(), loop_.end());
  if (!plane_.normal_at) return out_.polygons.add(loop_, cell);
  for (size_t k = 1; k + 1 < loop_.size(); ++k) {
    const int64_t triangle[3] = {loop_[0], loop_[k], loop_[k + 1]};
    out_.polygons.add(triangle, cell);
  }
}

void PlaneCutter::end_solid(int64_t cell) {
  // Every crossed edge belongs to two faces, so following segments from end to end comes back to the start.
  done_.assign(segments_.size(), 0);
  for (size_t first = 0; first < segments_.size(); ++first) {
    if (done_[first]) continue;
    done_[first] = 1;
    loop_.assign(1, segments_[first].first);
    int64_t at = segments_[first].second;
    bool moved = true;
    while (at != loop_[0] && moved) {
      moved = false;
      for (size_t s = first + 1; s < segments_.size() && !moved; ++s) {
        if (done_[s] || (segments_[s].first != at && segments_[s].second != at)) continue;
        done_[s] = 1;
        loop_.push_back(at);
        at = segments_[s].first == at ? segments_[s].second : segments_[s].first;
        moved = true;
      }
    }
    if (at == loop_[0]) close_loop(cell);  // an open chain comes from a polyhedron that is not closed
  }
}

void PlaneCutter::cut_flat(std::span<const int64_t> outline, int64_t cell) {
  segments_.clear();
  add_face(outline);
  for (auto [a, b] : segments_) {
    const int64_t ends[2] = {settled(a), settled(b)};
    if (ends[0] != ends[1]) out_.lines.add(ends, cell);
  }
}

void PlaneCutter::cut_curve(std::span<const int64_t> ids, int64_t cell) {
  for (size_t i = 0; i + 1 < ids.size(); ++i) {
    if ((plane_.distance(size_t(ids[i])) >= 0) == (plane_.distance(size_t(ids[i + 1])) >= 0)) continue;
    const int64_t key = settled(crossing_key(uint32_t(ids[i]), uint32_t(ids[i + 1])));
    out_.vertices.add(std::span(&key, 1), cell);
  }
}

}  // namespace sg::detail
