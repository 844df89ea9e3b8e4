// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/ftle.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "data/fields/known_looks.h"
#include "data/memory/memory_budget.h"
#include "filter/flow/flow_parts.h"
#include "filter/flow/geographic.h"
#include "filter/flow/unsteady/particles.h"
#include "filter/probe/resample.h"
#include "filter/tensor/sym_tensor.h"

namespace sg {

void describe(Schema& s, FtleParams& p) {
  s("field", p.field, "Velocity field; default: the active vectors.").takes(fields::vectors);
  s("duration", p.duration,
    "How long seeds are advected; negative: backwards in time. Default: the length of the series, or in a steady flow the time in which "
    "the mean speed covers a tenth of the mesh's diagonal.")
      .unit("time");
  s("start", p.start, "Time at which they start; default: the first of the series (backwards: the last).").unit("time");
  s("times", p.times, "Times of a series computed by a source: FIRST:LAST:COUNT or a list; default: those of the file.");
  s("interpolation", p.interpolation, "Interpolation between time steps.");
  s("dims", p.dims, "Number of seeds along x, y and z; default: from size.").at_least(1);
  s("size", p.size,
    "Number of seeds along the longest axis, the others in proportion; 0: 256, in 3D 64, in the space around a curved surface or curves "
    "32.")
      .range(0, 1e6);
  s("bounds", p.bounds, "Box of the seeds as xmin,xmax,ymin,ymax,zmin,zmax; default: that of the mesh.").unit("length");
  s("offset", p.offset,
    "Compute derivatives from four (3D: six) points at this distance from each seed; default: from the neighbouring seeds.")
      .unit("length");
  s("geographic", p.geographic,
    "x and y are in degrees and the velocity is in m/s: convert it, in the file's unit of time, and measure distances between neighbours "
    "in metres.");
  describe(s, p.integration);
}

namespace {

constexpr int64_t most_steps = 1'000'000;  // of a particle: what needs more is not known
constexpr double most_cells_passed = 1e5;

// Difference of the map along an axis from what is known on both sides of x.
bool difference(const Vec3* less, const Vec3& here, bool here_known, const Vec3* more, double step, Vec3& out) {
  if (less && more) out = (*more - *less) / (2 * step);
  else if (more && here_known) out = (*more - here) / step;
  else if (less && here_known) out = (here - *less) / step;
  else return false;
  return true;
}

struct Stretch {
  double ftle = NAN, values[3] = {NAN, NAN, NAN};
  Vec3 largest{NAN, NAN, NAN}, smallest{NAN, NAN, NAN};
};

// C = F^T F over the axes that count, which span a line, a plane or space.
Stretch stretch_of(const Vec3 f[3], const bool counts[3], int dimension, double duration) {
  const auto c = [&](int a, int b) { return counts[a] && counts[b] ? dot(f[a], f[b]) : 0.0; };
  const Eigen3 e = eigen_of({c(0, 0), c(1, 1), c(2, 2), c(0, 1), c(1, 2), c(0, 2)});
  Stretch s;
  // Axes that do not count have the eigenvalue 0; their vectors come last among equals only when C has no other 0, so take the values
  // by the vectors.
  int last = 0;
  for (int k = 0, n = 0; k < 3 && n < dimension; ++k) {
    bool outside = false;
    for (int a = 0; a < 3; ++a) outside = outside || (!counts[a] && std::abs(e.vector[k][a]) > 0.5);
    if (!outside) s.values[dimension - 1 - n++] = std::max(e.value[k], 0.0), last = k;
  }
  s.largest = e.vector[0], s.smallest = e.vector[last];
  s.ftle = std::log(std::sqrt(s.values[dimension - 1])) / std::abs(duration);
  return s;
}

void check_duration(double duration) {
  if (!(std::abs(duration) > 0) || !std::isfinite(duration)) fail_usage("advects nothing", "duration", "give a time other than 0");
}

// Over a globe: what a step of one in longitude (degrees), latitude and height is in degrees of latitude.
Vec3 globe_scale(double latitude) {
  const double c = std::cos(latitude * M_PI / 180);
  return {c > 1e-6 ? c : NAN, 1, 180 / (M_PI * 6371000)};
}

// The mean speed goes a tenth of the diagonal.
double steady_duration(const Data& data, const FtleParams& p, Context& context) {
  std::string name = p.field.name;
  double seconds = 1;
  for (const DatasetPtr& d : flow_meshes(data, name, "ftle")) seconds = seconds_of_time(*d);
  const FlowParts flow(p.geographic ? geographic_flow(data, name, seconds, "ftle") : data, name, "ftle", context);
  const double speed = flow.mean_speed();
  return speed > 0 ? 0.1 * flow.bounds().diagonal() / speed : 1;
}

}  // namespace

DatasetPtr ftle_of(const UniformGrid& grid, double duration, std::optional<double> offset, const FlowMap& map, bool geographic,
                   const Context* context) {
  check_duration(duration);
  if (offset && !(*offset > 0)) fail_usage("is not a valid distance", "offset", "give a small positive length");
  const std::array<size_t, 3> n = grid.dims;
  const size_t count = n[0] * n[1] * n[2];
  bool counts[3];
  std::vector<int> axes;
  for (int a = 0; a < 3; ++a)
    if ((counts[a] = n[size_t(a)] > 1)) axes.push_back(a);
  const int dimension = int(axes.size());
  if (dimension == 0) fail_usage("one seed has no neighbours", "dims", "give two or more along some axis");
  // The seeds, each followed by its offset points.
  const size_t each = offset ? 1 + 2 * axes.size() : 1;
  const double bytes_a_seed = 200 * double(each) + 60;  // with its neighbours: where they begin and end, particles; what is reported of it
  need_memory(double(n[0]) * double(n[1]) * double(n[2]) * bytes_a_seed, fmt::format("{}x{}x{} seeds", n[0], n[1], n[2]), "ftle",
              "give a smaller size");
  std::vector<Vec3> from(count * each), to;
  std::vector<uint8_t> known;
  parallel_for(
      count, 1 << 12,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          const Vec3 index(double(i % n[0]), double(i / n[0] % n[1]), double(i / (n[0] * n[1])));
          const Vec3 x = from[i * each] = grid.origin + grid.direction * (grid.spacing * index);
          for (size_t k = 1; k < each; ++k)
            from[i * each + k] = x + grid.direction.column(axes[(k - 1) / 2]) * (k % 2 ? -*offset : *offset);
        }
      },
      context);
  map(from, to, known);

  float *value = nullptr, *went = nullptr, *values = nullptr, *largest = nullptr, *smallest = nullptr;
  const auto dims = size_t(dimension);
  Array arrays[5] = {Array::make<float>(count, 1, &value), Array::make<float>(count, 3, &went),
                     Array::make<float>(count, dimension, &values), Array::make<float>(count, 3, &largest),
                     Array::make<float>(count, 3, &smallest)};
  parallel_for(
      count, 1 << 12,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          const size_t index[3] = {i % n[0], i / n[0] % n[1], i / (n[0] * n[1])}, step[3] = {1, n[0], n[0] * n[1]}, here = i * each;
          Vec3 f[3];
          bool all = true;
          for (size_t k = 0; k < axes.size(); ++k) {
            const auto a = size_t(axes[k]);
            const size_t less = offset ? here + 1 + 2 * k : here - step[a], more = offset ? less + 1 : here + step[a];
            const bool has_less = (offset || index[a] > 0) && known[less], has_more = (offset || index[a] + 1 < n[a]) && known[more];
            all = all && difference(has_less ? &to[less] : nullptr, to[here], known[here], has_more ? &to[more] : nullptr,
                                    offset ? *offset : grid.spacing[int(a)], f[a]);
          }
          Vec3 unit(1, 1, 1);
          if (geographic) {
            const Vec3 there = globe_scale(to[here].y);
            unit = globe_scale(from[here].y);
            for (int a = 0; a < 3; ++a) f[a] = f[a] * there / unit[a];
          }
          const Stretch s = all ? stretch_of(f, counts, dimension, duration) : Stretch();
          value[i] = float(s.ftle);
          for (size_t k = 0; k < dims; ++k) values[dims * i + k] = float(s.values[k]);
          for (int k = 0; k < 3; ++k) {
            went[3 * i + size_t(k)] = known[here] ? float(to[here][k]) : NAN;
            largest[3 * i + size_t(k)] = float(s.largest[k] / unit[k]), smallest[3 * i + size_t(k)] = float(s.smallest[k] / unit[k]);
          }
        }
      },
      context);
  DatasetParts parts;
  parts.mesh = grid;
  constexpr const char* names[] = {"ftle", "flow map", "stretch", "stretch direction", "shrink direction"};
  for (int k = 0; k < 5; ++k)
    parts.fields.add({names[k], Association::point, std::move(arrays[k]), k == 0 ? "1/time" : "", k == 0 ? Role::scalars : Role::none,
                      known_look(names[k])});
  return make_dataset(std::move(parts));
}

DatasetPtr ftle(const Series& given, const FtleParams& p, Context& context) {
  if (given.times.empty()) fail_usage("the series has no steps", "ftle");
  if (p.duration) check_duration(*p.duration);
  const bool steady = given.times.size() == 1;
  const Data only = steady ? given.load(0) : Data();
  const double whole = steady ? 0 : given.times.back() - p.start.value_or(given.times.front());
  const double duration = p.duration ? *p.duration : steady ? steady_duration(only, p, context) : whole;
  check_duration(duration);
  if (!p.duration) context.info(fmt::format("ftle: duration={:.4g}", duration));
  const int sign = duration < 0 ? -1 : 1;
  Series series = given;
  const double start = p.start.value_or(steady ? 0.0 : sign > 0 ? given.times.front() : given.times.back());
  const double until = start + duration;
  if (steady) {  // steady: the same at both ends of the way
    series.times = {std::min(start, until), std::max(start, until)};
    series.load = [only](size_t) -> Data { return only; };
  } else if (std::min(start, until) < given.times.front() || std::max(start, until) > given.times.back()) {
    fail_usage(fmt::format("from {:.6g} to {:.6g} is outside the series, which lasts from {:.6g} to {:.6g}", start, until,
                           given.times.front(), given.times.back()),
               "ftle", "choose another start or duration");
  }
  UnsteadyFlow flow(series, p.field.name, p.interpolation, context, p.geographic);
  size_t k = flow.interval_of(start, sign);
  const size_t last = flow.interval_of(until, -sign);
  flow.open(k, context);
  if (const FlowField& first = flow.steps()[flow.base()]; !p.geographic) warn_of_degrees(*first.dataset(), first.field(), "ftle", context);
  StopParams stop;
  stop.max_steps = most_steps, stop.closed = false;
  // Nobody sees the ways themselves: only the tolerance limits the steps.
  IntegrationParams integration = p.integration;
  if (!integration.max_step) integration.max_step = 8 * integration.step;
  const TraceOptions options = trace_options(integration, stop, flow.largest_speed());
  check_way(flow.steps()[flow.base()], duration, most_cells_passed, options, "ftle");
  if (const double steps = usual_steps(flow.steps()[flow.base()], duration, options); steps > double(most_steps))
    fail_usage(fmt::format("a particle would take {:.3g} steps to the end of its way, more than {}", steps, most_steps), "ftle step",
               fmt::format("use steps {:.2g} times as large, or more", steps / double(most_steps)));
  ResampleParams r;
  r.dims = p.dims, r.size = p.size == 0 ? 256 : std::max<int64_t>(p.size, 2), r.bounds = p.bounds;
  const Dataset& shape = *flow.steps()[flow.base()].dataset();
  UniformGrid grid = resample_grid(shape, r);
  if (p.size == 0 && p.dims.empty() && std::min({grid.dims[0], grid.dims[1], grid.dims[2]}) > 1) {
    r.size = flow.steps()[flow.base()].dimension() < 3 ? 32 : 64;
    grid = resample_grid(shape, r);
  }
  size_t gone = 0, all = 0;
  const DatasetPtr out = ftle_of(
      grid, duration, p.offset,
      [&](std::span<const Vec3> from, std::vector<Vec3>& to, std::vector<uint8_t>& known) {
        std::vector<Particle> particles;
        particles.reserve(from.size());
        for (size_t i = 0; i < from.size(); ++i) {  // the memory comes with them, which takes longer than computing their places
          if (i % 65536 == 0) context.check();
          particles.push_back({.x = from[i], .t = start});
        }
        for (;; k = size_t(ptrdiff_t(k) + sign)) {
          flow.open(k, context);
          advance(flow, particles, k == last ? until : sign > 0 ? flow.end() : flow.begin(), sign, options, context);
          context.check();
          context.progress(std::min(1.0, std::abs((sign > 0 ? flow.end() : flow.begin()) - start) / std::abs(duration)), "ftle");
          if (k == last) break;
        }
        to.resize(from.size()), known.resize(from.size());
        all = from.size();
        for (size_t i = 0; i < from.size(); ++i) {
          if (i % 65536 == 0) context.check();
          to[i] = particles[i].x, known[i] = particles[i].started && !particles[i].ended;
          gone += !known[i];
        }
      },
      p.geographic, &context);
  if (gone > 0)
    context.info(fmt::format("ftle: {:.3g} % of the particles start outside the flow or leave it within {:.4g}: the result has holes there",
                             100 * double(gone) / double(all), std::abs(duration)));
  return out;
}

}  // namespace sg
