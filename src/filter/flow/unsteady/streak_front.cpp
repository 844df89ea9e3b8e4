// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/unsteady/streak_front.h"

#include <algorithm>

#include "base/parallel.h"

namespace sg {

namespace {

constexpr size_t seeds_per_chunk = 64;
constexpr int most_passes = 12;

bool under_way(const Particle& p) { return p.started && !p.ended; }

// A place by release time: the polynomial through the nodes nearest to t, three or four of them.
struct Node {
  double born;
  Vec3 x;
};
Vec3 place_at(std::span<const Node> nodes, double t) {
  Vec3 x;
  for (size_t i = 0; i < nodes.size(); ++i) {
    double w = 1;
    for (size_t j = 0; j < nodes.size(); ++j)
      if (j != i) w *= (t - nodes[j].born) / (nodes[i].born - nodes[j].born);
    x += nodes[i].x * w;
  }
  return x;
}

}  // namespace

StreakFront::StreakFront(const std::vector<Vec3>& seeds, const std::vector<double>& times) {
  const std::vector<size_t> order = space_order(seeds);
  slot_.resize(seeds.size()), seed_.resize(seeds.size());
  all_.resize(seeds.size() * times.size()), born_.resize(all_.size());
  for (size_t i = 0; i < seeds.size(); ++i) {
    slot_[order[i]] = i, seed_[i] = seeds[order[i]];
    first_.push_back(i * times.size());
    for (size_t k = 0; k < times.size(); ++k) {
      const size_t at = first_[i] + k;
      all_[at].x = seed_[i], all_[at].t = born_[at] = times[k];
    }
  }
  first_.push_back(all_.size());
}

void StreakFront::bury(double t) {
  for (size_t i = 0; i < all_.size(); ++i)
    if (born_[i] < t) all_[i].ended = true;
}

size_t StreakFront::started() const {
  return size_t(std::count_if(all_.begin(), all_.end(), [](const Particle& p) { return p.started; }));
}

// New particles of one seed, in order.
std::vector<StreakFront::Insertion> StreakFront::wanted(size_t slot, double begin, double until, const Refinement& r) const {
  std::vector<Insertion> out;
  const double turn = std::cos(r.angle);
  const auto joined = [&](size_t i) {  // with the next
    return i >= first_[slot] && i < first_[slot + 1] - 1 && under_way(all_[i]) && under_way(all_[i + 1]) && born_[i + 1] <= until;
  };
  const auto bends = [&](size_t i) {  // at particle i
    if (!joined(i) || i == first_[slot] || !joined(i - 1)) return false;
    const Vec3 a = all_[i].x - all_[i - 1].x, b = all_[i + 1].x - all_[i].x;
    return dot(a, b) < turn * length(a) * length(b);
  };
  for (size_t i = first_[slot]; i + 1 < first_[slot + 1]; ++i) {
    if (!joined(i)) continue;
    const double gap = length(all_[i + 1].x - all_[i].x), a = born_[i], b = born_[i + 1];
    if (!(gap > r.spacing || (gap > r.shortest && (bends(i) || bends(i + 1))))) continue;
    const bool apart = b - a > 1e-13 * std::max(std::abs(a), std::abs(b));
    if (!apart && b > begin) continue;
    Insertion n;
    n.after = i, n.particle.steps = all_[i].steps, n.particle.x = seed_[slot];
    // The seed's own place is where the line is at the beginning of the interval.
    if (b > begin) {
      n.born = n.particle.t = a < begin ? begin : (a + b) / 2;
    } else {
      n.born = (a + b) / 2, n.particle.t = begin;
      const Vec3 middle = n.particle.x = (before_[i].x + before_[i + 1].x) / 2;
      // Older ones released at numerically the same time are two points all the same: the middle of the chord lies between them.
      if (apart) {
        std::vector<Node> nodes;
        if (joined(i - 1)) nodes.push_back({born_[i - 1], before_[i - 1].x});
        nodes.push_back({a, before_[i].x}), nodes.push_back({b, before_[i + 1].x});
        if (joined(i + 1) && born_[i + 2] <= begin) nodes.push_back({born_[i + 2], before_[i + 2].x});
        else if (b < begin) nodes.push_back({begin, seed_[slot]});
        const Vec3 x = place_at(nodes, n.born);
        // Where nodes lie too far apart for a cubic, it may leave the line, and the mesh.
        if (length(x - middle) <= 0.5 * length(before_[i + 1].x - before_[i].x)) n.particle.x = x;
      }
    }
    out.push_back(n);
  }
  return out;
}

void StreakFront::insert(const std::vector<std::vector<Insertion>>& more, std::vector<Particle>& advanced) {
  std::vector<Particle> all, before;
  std::vector<double> born;
  const size_t n = all_.size() + advanced.size();
  all.reserve(n), before.reserve(n), born.reserve(n);
  size_t next = 0;
  for (size_t s = 0; s < more.size(); ++s) {
    const size_t begin = all.size();
    size_t k = 0;
    for (size_t i = first_[s]; i < first_[s + 1]; ++i) {
      all.push_back(all_[i]), before.push_back(before_[i]), born.push_back(born_[i]);
      if (k == more[s].size() || more[s][k].after != i) continue;
      const Particle& p = advanced[next++];
      // One that is not in the flow (on land) tears the line.
      all.push_back(p), before.push_back(more[s][k].particle), born.push_back(more[s][k].born);
      ++k;
    }
    first_[s] = begin;
  }
  first_.back() = all.size();
  all_ = std::move(all), before_ = std::move(before), born_ = std::move(born);
}

void StreakFront::advance(const UnsteadyFlow& flow, double until, const TraceOptions& options, const Refinement* refinement,
                          Context& context) {
  const double begin = flow.begin();
  if (refinement) before_ = all_;
  sg::advance(flow, all_, until, 1, options, context);
  if (!refinement) return;
  for (int pass = 0; pass < most_passes && !full_; ++pass) {
    std::vector<std::vector<Insertion>> more(seed_.size());
    parallel_for(seed_.size(), seeds_per_chunk, [&](size_t from, size_t to) {
      for (size_t s = from; s < to; ++s) more[s] = wanted(s, begin, until, *refinement);
    });
    std::vector<Particle> fresh;
    for (const auto& of_seed : more)
      for (const Insertion& n : of_seed) fresh.push_back(n.particle);
    if (fresh.empty()) break;
    full_ = all_.size() + fresh.size() > refinement->most;
    if (full_) break;
    sg::advance(flow, fresh, until, 1, options, context);
    insert(more, fresh);
  }
  before_ = {};
}

}  // namespace sg
