// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/fronts/front.h"
#include "filter/flow/fronts/surface_run.h"
#include "filter/flow/unsteady/advance_one.h"

namespace sg {

namespace {

struct Member {
  Particle p;
  double s;        // of the curve
  int64_t number;  // among the points; -1 where the flow has ended
};

// The row of particles that left the curve together, and the surface behind it.
class PathFront {
 public:
  PathFront(CurveRun& r, double tear, Context& context) : r_(r), widest_(tear * r.spacing), context_(context) {
    UnsteadyCursor cursor(r.run.flow);
    size_t begun = 0;
    for (size_t i = 0; i < r.run.seeds.size(); ++i) {
      Particle q;
      q.x = r.run.seeds[i], q.t = r.run.start;
      detail::start_particle(cursor, q);
      front_.push_back({q, r.parameters[i], q.ended ? -1 : add(q, r.parameters[i])});
      begun += !q.ended;
    }
    r.run.require_some(begun);
  }
  size_t points() const { return out_.x.size(); }

  // Moves the front on, joins it to where it was, and fills and thins it.
  void advance_to(double t) {
    std::vector<Particle> moved;
    for (const Member& m : front_) moved.push_back(m.p);
    advance(r_.run.flow, moved, t, 1, r_.run.options, context_);
    UnsteadyCursor cursor(r_.run.flow);
    std::vector<Member> next;
    const size_t n = front_.size();
    for (size_t i = 0; i < n; ++i) {
      const int64_t own = moved[i].ended ? -1 : add(moved[i], front_[i].s);
      next.push_back({moved[i], front_[i].s, own});
      if (i + 1 < n || r_.curve.closed) join(i, (i + 1) % n, moved, cursor, next);
    }
    thin(next);
  }
  Collected take() { return std::move(out_); }

 private:
  int64_t add(const Particle& p, double s) { return out_.add(p, s, r_.run.start); }

  // Triangles between members i and j before and after; new members between the two, evenly, on the chord. i is the last of `next`.
  void join(size_t i, size_t j, const std::vector<Particle>& moved, UnsteadyCursor& cursor, std::vector<Member>& next) {
    if (front_[i].number < 0 || front_[j].number < 0 || moved[i].ended || moved[j].ended) return;
    const Vec3 a = moved[i].x, b = moved[j].x;
    const double gap = length(b - a);
    if (gap > widest_) return;
    const auto more = size_t(std::max(0.0, std::ceil(gap / r_.spacing) - 1));
    double sj = front_[j].s;
    if (sj <= front_[i].s) sj += 1;
    std::vector<int64_t> above{next.back().number};
    for (size_t k = 1; k <= more; ++k) {
      Particle q;
      const double f = double(k) / double(more + 1);
      q.x = lerp(a, b, f), q.t = moved[i].t, q.steps = moved[i].steps;
      if (!detail::start_particle(cursor, q)) return;
      double s = front_[i].s + f * (sj - front_[i].s);
      if (s >= 1 && r_.curve.closed) s -= 1;
      next.push_back({q, s, add(q, s)});
      above.push_back(next.back().number);
    }
    // The point of j is added next; on the last one of a closed front it is there already.
    above.push_back(j == 0 ? next[0].number : int64_t(out_.x.size()));
    if (j != 0) out_.x.push_back(b);  // for the diagonals' lengths
    stitch({front_[i].number, front_[j].number}, above, out_.x, out_.triangles);
    if (j != 0) out_.x.pop_back();
  }

  // Of three within half a spacing the middle one goes from the next front on.
  void thin(const std::vector<Member>& next) {
    front_.clear();
    bool skipped = false;
    for (size_t i = 0; i < next.size(); ++i) {
      const bool inner =
          i > 0 && i + 1 < next.size() && !skipped && next[i].number >= 0 && next[i - 1].number >= 0 && next[i + 1].number >= 0;
      skipped = inner && length(next[i].p.x - next[i - 1].p.x) + length(next[i + 1].p.x - next[i].p.x) < 0.5 * r_.spacing;
      if (!skipped) front_.push_back(next[i]);
    }
  }

  CurveRun& r_;
  double widest_;
  Context& context_;
  std::vector<Member> front_;
  Collected out_;
};

}  // namespace

DatasetPtr path_surface(const Series& series, const std::vector<Data>& others, const PathSurfaceParams& p, Context& context) {
  CurveRun r(series, others, p, p.curve, "path_surface", context);
  PathFront front(r, p.tear, context);
  each_part(
      r.run, r.spacing, p.max_points, "path_surface", [&] { return front.points(); }, [&](double t) { front.advance_to(t); });
  return surface_dataset(front.take(), r.run.velocity(), r.run.start, r.run.time, false);
}

}  // namespace sg
