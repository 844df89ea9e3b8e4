// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/fronts/stream_surface.h"

#include <fmt/core.h>

#include "base/parallel.h"
#include "data/fields/known_looks.h"
#include "filter/flow/fronts/default_curve.h"
#include "filter/flow/fronts/front.h"
#include "filter/flow/line_attributes.h"
#include "filter/flow/line_mesh.h"
#include "filter/flow/seeds/noise_speed.h"
#include "filter/flow/seeds/seeds.h"

namespace sg {

void describe(Schema& s, StreamSurfaceParams& p) {
  s("field", p.field, "Velocity: point or cell field of 2 or 3 components; default: the active vectors.").takes(fields::vectors);
  describe(s, p.curve);
  s("direction", p.direction, "Trace along the flow, against it, or both ways.");
  s("front", p.front, "What the points of a front have in common: length travelled, or time.");
  s("spacing", p.spacing,
    "Largest distance between neighbours in a front and between fronts (front=length); default: a 100th of the diagonal.")
      .unit("length")
      .positive();
  s("max_length", p.max_length, "How far the surface extends; default: the mesh's diagonal.").unit("length").positive();
  s("max_time", p.max_time, "front=time: how long to trace; default: the time in which the mean speed covers max_length.")
      .unit("time")
      .positive();
  s("max_angle", p.max_angle, "Largest turn of a front at a point before more points are put in.").unit("deg").range(1, 180);
  s("tear", p.tear, "Gaps wider than this many spacings that cannot be filled are left open.").range(1, 1e6);
  s("min_speed", p.min_speed,
    "The surface ends where the speed is below this fraction of its largest value. The default of 1e-4 becomes 0.02 where most of a grid "
    "is noise, as around the vessels of a scan.")
      .range(0, 1);
  s("tolerance", p.tolerance, "Error per integration step, in local cell sizes.").positive();
  s("max_points", p.max_points, "Maximum number of points of the surface.").range(4, 1e9);
}

namespace {

std::string box_text(const Box3& b) {
  return fmt::format("x {:.6g} to {:.6g}, y {:.6g} to {:.6g}, z {:.6g} to {:.6g}", b.lo.x, b.hi.x, b.lo.y, b.hi.y, b.lo.z, b.hi.z);
}

// Nobody follows noise unless min_speed is stated.
double noise_of(const FlowParts& parts) {
  double most = 0;
  for (const FlowField& f : parts.fields()) most = std::max(most, noise_speed(*f.dataset(), f.dataset()->fields().require(parts.name())));
  return most;
}

constexpr int deepest = 20;                  // halvings of a gap
constexpr uint8_t open_end = 1, parted = 2;  // why a front is torn behind a member: it has ended, or neighbours separated
constexpr double narrowest = 3;              // spacings: between two tears narrower strips are rags

class Growth {
 public:
  Growth(const FlowParts& parts, const SeedCurve& curve, const StreamSurfaceParams& p, double spacing, FrontClock clock, double step,
         size_t levels, Context& context)
      : parts_(parts),
        curve_(curve),
        p_(p),
        spacing_(spacing),
        step_(step),
        levels_(levels),
        clock_(clock),
        context_(context),
        min_speed_(std::max(p.min_speed * parts.largest_speed(), p.min_speed == StreamSurfaceParams().min_speed ? noise_of(parts) : 0)) {}

  std::vector<Vec3> points;
  std::vector<FrontPoint> places;  ///< of the points
  std::vector<double> s;           ///< of the points
  std::vector<int64_t> triangles;

  /// Seeds along the curve, evenly.
  void begin() {
    const double pieces = std::ceil(curve_.whole() / spacing_ - 1e-9);
    if (!(pieces < double(p_.max_points)))
      fail_usage(fmt::format("{:.3g} lines begin on the seed curve, more than max_points = {}", pieces, p_.max_points), "stream_surface",
                 "use a larger spacing");
    const auto n = size_t(pieces) + size_t(!curve_.closed);
    std::vector<double> at;
    for (size_t i = 0; i < std::max<size_t>(n, curve_.closed ? 3 : 2); ++i)
      at.push_back(double(i) / double(std::max<size_t>(n, curve_.closed ? 3 : 2) - size_t(!curve_.closed)));
    seed_at_ = std::move(at);
  }

  void grow(double sign) {
    paths_.clear();
    sign_ = sign;
    Front front;
    const std::vector<size_t> all = add_paths(seed_at_, 0, 0);
    bool gap = false;
    for (const size_t path : all) {
      if (paths_[path].at.empty()) {
        gap = true;
        continue;
      }
      if (gap && !front.torn.empty()) front.torn.back() = open_end;
      gap = false;
      front.members.push_back(path), front.torn.push_back(0);
    }
    if (!front.members.empty() && (!curve_.closed || gap || paths_[all.front()].at.empty())) front.torn.back() = open_end;
    for (size_t i = 0; i < front.members.size(); ++i) number(front.members[i], 0, sign > 0 || first_numbers_.empty());
    for (size_t k = 0; k + 1 < levels_ && !front.members.empty(); ++k) {
      context_.check();
      context_.progress(double(k) / double(levels_), "stream_surface");
      if (int64_t(points.size()) > p_.max_points)
        fail_usage(fmt::format("the surface has more than {} points", p_.max_points), "stream_surface",
                   "use a larger spacing or a larger max_points");
      front = next(front, k);
    }
  }

 private:
  /// Trajectories from the curve at these parameters, up to a level; those that do not begin in the flow stay empty.
  std::vector<size_t> add_paths(const std::vector<double>& at, size_t level, int depth) {
    const size_t first = paths_.size();
    std::vector<size_t> out;
    for (const double s : at) {
      out.push_back(paths_.size());
      paths_.push_back({s, {}, false, depth});
    }
    parallel_for(
        at.size(), 4,
        [&](size_t begin, size_t end) {
          PartsCursor flow(parts_);
          for (size_t i = begin; i < end; ++i) {
            Trajectory& path = paths_[first + i];
            FrontPoint p;
            p.x = flow.snap(curve_(path.s));
            if (!flow(p.x, p.v) || length(p.v) <= min_speed_) continue;
            path.at.push_back(p);
            while (path.at.size() <= level && !path.ended) advance(flow, path, clock_, step_, sign_, p_.tolerance, min_speed_, 0);
          }
        },
        &context_);
    return out;
  }

  int64_t number(size_t path, size_t level, bool fresh = true) {
    FrontPoint& p = paths_[path].at[level];
    if (p.number >= 0) return p.number;
    if (level == 0 && !fresh)  // the other direction has it already
      for (size_t i = 0; i < first_s_.size(); ++i)
        if (first_s_[i] == paths_[path].s) return p.number = first_numbers_[i];
    p.number = int64_t(points.size());
    points.push_back(p.x), places.push_back(p), s.push_back(paths_[path].s);
    if (level == 0) first_s_.push_back(paths_[path].s), first_numbers_.push_back(p.number);
    return p.number;
  }

  const FrontPoint& at(size_t path, size_t level) const { return paths_[path].at[std::min(level, paths_[path].at.size() - 1)]; }

  /// Parameter half way from member i of the front to the next.
  double between(const Front& f, size_t i) const {
    const double a = paths_[f.members[i]].s;
    double b = paths_[f.members[(i + 1) % f.members.size()]].s;
    if (b <= a) b += 1;
    const double m = (a + b) / 2;
    return m >= 1 && curve_.closed ? m - 1 : m;
  }

  double turn(const Front& f, size_t i, size_t level) const {  // at member i, from the one before to the next
    const size_t n = f.members.size();
    if (f.torn[i] || f.torn[(i + n - 1) % n] || n < 3) return 0;
    const Vec3 in = at(f.members[i], level).x - at(f.members[(i + n - 1) % n], level).x;
    const Vec3 on = at(f.members[(i + 1) % n], level).x - at(f.members[i], level).x;
    const double l = length(in) * length(on);
    return l > 0 ? std::acos(std::clamp(dot(in, on) / l, -1.0, 1.0)) * 180 / 3.14159265358979323846 : 0;
  }

  /// Advances, puts in, tears, stitches, takes out.
  Front next(const Front& front, size_t level) {
    parallel_for(
        front.members.size(), 4,
        [&](size_t begin, size_t end) {
          PartsCursor flow(parts_);
          for (size_t i = begin; i < end; ++i) {
            Trajectory& path = paths_[front.members[i]];
            if (!path.ended && path.at.size() == level + 1) advance(flow, path, clock_, step_, sign_, p_.tolerance, min_speed_, 0);
          }
        },
        &context_);
    Front to = front;
    refine(to, level + 1);
    band(front, to, level);
    return thin(to, level + 1);
  }

  void refine(Front& f, size_t level) {
    for (int round = 0; round < deepest; ++round) {
      std::vector<double> wanted;
      std::vector<size_t> behind;
      const size_t n = f.members.size();
      for (size_t i = 0; i < n; ++i) {
        if (f.torn[i]) continue;
        const size_t a = f.members[i], b = f.members[(i + 1) % n];
        const double gap = length(at(a, level).x - at(b, level).x);
        const bool bent = gap > 0.2 * spacing_ && (turn(f, i, level) > p_.max_angle || turn(f, (i + 1) % n, level) > p_.max_angle);
        if (gap <= spacing_ && !bent) continue;
        const double m = between(f, i);
        const bool can = std::max(paths_[a].depth, paths_[b].depth) < deepest && m != paths_[a].s && m != paths_[b].s;
        if (can) wanted.push_back(m), behind.push_back(i);
        else if (gap > p_.tear * spacing_) f.torn[i] = parted;
      }
      if (wanted.empty()) return;
      const std::vector<size_t> added = add_paths(wanted, level, 0);
      Front more;
      for (size_t i = 0, k = 0; i < n; ++i) {
        more.members.push_back(f.members[i]), more.torn.push_back(f.torn[i]);
        if (k >= behind.size() || behind[k] != i) continue;
        Trajectory& path = paths_[added[k]];
        path.depth = std::max(paths_[f.members[i]].depth, paths_[f.members[(i + 1) % n]].depth) + 1;
        // One that ends early shows where the flow separates.
        if (path.at.size() > level) more.members.push_back(added[k]), more.torn.push_back(0);
        else more.torn.back() = open_end;
        ++k;
      }
      f = std::move(more);
    }
    for (size_t i = 0; i < f.members.size(); ++i)
      if (!f.torn[i] && length(at(f.members[i], level).x - at(f.members[(i + 1) % f.members.size()], level).x) > p_.tear * spacing_)
        f.torn[i] = parted;
  }

  /// Triangles between two fronts: `to` has the members of `from` and more.
  void band(const Front& from, const Front& to, size_t level) {
    const size_t n = from.members.size();
    size_t j = 0;  // place in `to` of the member
    std::vector<int64_t> below, above;
    for (size_t i = 0; i < n; ++i) {
      while (to.members[j] != from.members[i]) ++j;
      if (from.torn[i]) continue;
      const size_t last = from.members[(i + 1) % n];
      bool torn = false;
      above.clear();
      size_t k = j;
      for (;; k = (k + 1) % to.members.size()) {
        above.push_back(place_above(to.members[k], level));
        if (to.members[k] == last && (k != j || above.size() > 1)) break;
        torn = torn || to.torn[k];
      }
      if (torn) continue;
      below = {number(from.members[i], level), number(last, level)};
      stitch_signed(below, above);
    }
  }

  /// Number of a trajectory's point at the next level; of an ended one the place where it ended.
  int64_t place_above(size_t path, size_t level) {
    const size_t k = std::min(level + 1, paths_[path].at.size() - 1);
    return number(path, k);
  }

  void stitch_signed(const std::vector<int64_t>& below, const std::vector<int64_t>& above) {
    const size_t first = triangles.size();
    stitch(below, above, points, triangles);
    if (sign_ < 0)
      for (size_t t = first; t < triangles.size(); t += 3) std::swap(triangles[t + 1], triangles[t + 2]);
  }

  /// Without those that have ended, and without the middle ones of crowds.
  Front thin(const Front& f, size_t level) const {
    Front out;
    const size_t n = f.members.size();
    bool open = false;
    for (size_t i = 0; i < n; ++i) {
      const Trajectory& path = paths_[f.members[i]];
      if (path.ended || path.at.size() <= level) {
        if (out.members.empty()) open = true;
        else out.torn.back() = open_end;
        continue;
      }
      out.members.push_back(f.members[i]), out.torn.push_back(f.torn[i]);
    }
    if (out.members.empty()) return out;
    if (open) out.torn.back() = open_end;
    drop_rags(out, level);
    if (out.members.empty()) return out;
    Front kept;
    const size_t m = out.members.size();
    bool skipped = false;
    for (size_t i = 0; i < m; ++i) {
      const bool inner = i > 0 && i + 1 < m && !out.torn[i] && !out.torn[i - 1] && !skipped;
      if (inner) {
        const Vec3 a = at(out.members[i - 1], level).x, b = at(out.members[i], level).x, c = at(out.members[i + 1], level).x;
        if (length(a - b) + length(b - c) < 0.5 * spacing_ && turn(out, i, level) < p_.max_angle / 2) {
          skipped = true;
          continue;
        }
      }
      skipped = false;
      kept.members.push_back(out.members[i]), kept.torn.push_back(out.torn[i]);
    }
    return kept;
  }

  /// Takes out what is narrow and next to a gap where the flow parted: a surface that has torn twice in a short front is not a surface.
  void drop_rags(Front& f, size_t level) const {
    const size_t n = f.members.size();
    const auto tear = std::find_if(f.torn.begin(), f.torn.end(), [](uint8_t t) { return t != 0; });
    if (tear == f.torn.end() || std::count(f.torn.begin(), f.torn.end(), parted) == 0) return;
    const auto first = size_t(tear - f.torn.begin()) + 1;  // the pieces one after the other, once round
    std::vector<uint8_t> drop(n, 0);
    for (size_t k = 0; k < n;) {
      const size_t begin = k;
      double wide = 0;
      for (;; ++k) {
        const size_t i = (first + k) % n;
        if (f.torn[i] || k + 1 == n) break;
        wide += length(at(f.members[i], level).x - at(f.members[(i + 1) % n], level).x);
      }
      ++k;
      const bool beside_gap = f.torn[(first + begin + n - 1) % n] == parted || f.torn[(first + k - 1) % n] == parted;
      if (beside_gap && wide < narrowest * spacing_)
        for (size_t m = begin; m < k; ++m) drop[(first + m) % n] = 1;
    }
    Front out;
    for (size_t i = 0; i < n; ++i) {
      if (!drop[i]) out.members.push_back(f.members[i]), out.torn.push_back(f.torn[i]);
      else if (!out.members.empty()) out.torn.back() = parted;
    }
    if (!out.members.empty() && drop[0]) out.torn.back() = std::max(out.torn.back(), parted);
    f = std::move(out);
  }

  const FlowParts& parts_;
  const SeedCurve& curve_;
  const StreamSurfaceParams& p_;
  double spacing_, step_, sign_ = 1;
  size_t levels_;
  FrontClock clock_;
  Context& context_;
  double min_speed_;
  std::vector<double> seed_at_, first_s_;
  std::vector<int64_t> first_numbers_;
  std::vector<Trajectory> paths_;
};

}  // namespace

Data stream_surface(const std::vector<Data>& inputs, const StreamSurfaceParams& p, Context& context) {
  const FlowParts parts(inputs[0], p.field.name, "stream_surface", context);
  if (parts.dimension() != 3)
    fail_usage("streamlines within a surface do not make a stream surface", "stream_surface", "use streamlines or even_streamlines");
  const DatasetPtr second = seed_mesh_of(inputs, "stream_surface");
  const bool chosen = p.curve.nothing() && !second;
  const SeedCurve curve = seed_curve(chosen ? across_the_flow(parts, "stream_surface", context) : p.curve, second, "stream_surface");
  const double diagonal = parts.bounds().diagonal();
  const double spacing = p.spacing.value_or(std::min(diagonal / 100, chosen ? curve.whole() / 12 : HUGE_VAL));
  const double far = p.max_length.value_or(diagonal);
  // The mean speed on the curve gives the time to travel `far`.
  PartsCursor flow(parts);
  double sum = 0;
  int inside = 0;
  for (int k = 0; k < 64; ++k) {
    Vec3 v;
    if (flow(curve((k + 0.5) / 64), v)) sum += length(v), ++inside;
  }
  if (inside == 0)
    fail_usage("the seed curve lies outside the flow", "stream_surface", fmt::format("the mesh extends over {}", box_text(parts.bounds())));
  const FrontClock clock = p.front;
  const double mean = sum / inside, all = clock == FrontClock::length ? far : p.max_time.value_or(mean > 0 ? far / mean : 0);
  const double step = clock == FrontClock::length ? spacing : mean > 0 ? spacing / mean : 0;
  if (!(step > 0) || !(mean > 0)) fail_usage("there is no flow at the seed curve", "stream_surface");
  const double count = std::ceil(all / step - 1e-9);
  if (count > 1e6)
    fail_usage(fmt::format("{:.3g} fronts are too many", count), "stream_surface", "use a larger spacing or a shorter surface");
  const size_t levels = size_t(count) + 1;
  Growth g(parts, curve, p, spacing, clock, all / count, levels, context);
  g.begin();
  if (p.direction != TraceDirection::backward) g.grow(1);
  if (p.direction != TraceDirection::forward) g.grow(-1);

  SurfaceMesh mesh;
  mesh.points.origin = parts.bounds().center();
  const size_t n = g.points.size();
  float *xyz = nullptr, *v = nullptr, *speed = nullptr, *time = nullptr, *arc = nullptr, *s = nullptr, *st = nullptr;
  mesh.points.xyz = Array::make<float>(n, 3, &xyz);
  FieldSet fields;
  fields.add({own_value("speed", parts.name()), Association::point, Array::make<float>(n, 1, &speed), parts.fields().front().field().unit,
              Role::scalars, known_look("speed")});
  fields.add({own_value("time", parts.name()), Association::point, Array::make<float>(n, 1, &time), "", Role::none});
  fields.add({own_value("length", parts.name()), Association::point, Array::make<float>(n, 1, &arc), "", Role::none});
  fields.add({parts.name(), Association::point, Array::make<float>(n, 3, &v), "", Role::vectors});
  fields.add({own_value("seed parameter", parts.name()), Association::point, Array::make<float>(n, 1, &s), "", Role::none});
  fields.add({own_value("texture coordinates", parts.name()), Association::point, Array::make<float>(n, 2, &st), "", Role::tcoords});
  for (size_t i = 0; i < n; ++i) {
    const FrontPoint& f = g.places[i];
    for (int a = 0; a < 3; ++a) xyz[3 * i + size_t(a)] = float(f.x[a] - mesh.points.origin[a]), v[3 * i + size_t(a)] = float(f.v[a]);
    speed[i] = float(length(f.v)), time[i] = float(f.time), arc[i] = float(f.arc), s[i] = float(g.s[i]);
    st[2 * i] = s[i], st[2 * i + 1] = float((clock == FrontClock::length ? f.arc : f.time) / all);
  }
  mesh.polygons.fixed = 3;
  mesh.polygons.connectivity = Array::from_vector(std::move(g.triangles));
  TracedLines places;
  for (size_t i = 0; i < n; i += 256) {  // stretches of points, so that all threads have work
    places.begin.push_back(std::min(n, i + 256));
    places.seed.push_back(0), places.stop.push_back(StopReason::length);
  }
  for (const FrontPoint& f : g.places) places.velocity.push_back(f.v), places.time.push_back(f.time), places.arc.push_back(f.arc);
  places.points = std::move(g.points);
  for (const Field& f : fields_along(parts, places, parts.name(), context))
    if (!fields.find(f.name, f.association)) fields.add(f);
  DatasetParts out{std::move(mesh), std::move(fields), {}, {}, {}, parts.fields().front().dataset()->time()};
  return make_dataset(std::move(out));
}

}  // namespace sg
