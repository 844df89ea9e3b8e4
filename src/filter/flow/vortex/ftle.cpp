// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/ftle.h"

#include "base/parallel.h"
#include "filter/flow/vortex/flow_map.h"
#include "filter/probe/resample.h"
#include "filter/tensor/sym_tensor.h"

namespace sg {

void describe(Schema& s, FtleParams& p) {
  s("field", p.field, "Velocity; default: the active vector.");
  s("duration", p.duration, "How long places are carried; negative: back in time.").unit("time");
  s("start", p.start, "Time at which they start; of a time series.").unit("time");
  s("dims", p.dims, "Seeds along x, y and z; default: from size.").at_least(1);
  s("size", p.size, "Seeds along the longest axis, the others in proportion.").range(2, 1e6);
  s("bounds", p.bounds, "Box of the seeds as xmin,xmax,ymin,ymax,zmin,zmax; default: that of the mesh.").unit("length");
  s("tolerance", p.tolerance, "Error of one step, in sizes of the local cell.").positive();
  s("offset", p.offset, "Derivatives from four (3D: six) places this far beside each seed; default: from the neighbouring seeds.")
      .unit("length");
}

UniformGrid ftle_grid(const Dataset& in, const FtleParams& p) {
  ResampleParams r;
  r.dims = p.dims, r.size = p.size, r.bounds = p.bounds;
  return resample_grid(in, r);
}

namespace {

struct SmallGrid {
  const UniformGrid& g;
  Vec3 at(size_t i, size_t j, size_t k) const { return g.origin + g.direction * (g.spacing * Vec3(double(i), double(j), double(k))); }
};

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

}  // namespace

DatasetPtr ftle_of(const UniformGrid& grid, double duration, std::optional<double> offset, const std::function<Carrier()>& make,
                   Context& context) {
  if (!(std::abs(duration) > 0) || !std::isfinite(duration)) fail_usage("carries nothing", "duration", "a time, positive or negative");
  if (offset && !(*offset > 0)) fail_usage("is no distance", "offset", "a small positive length");
  const std::array<size_t, 3> n = grid.dims;
  const size_t count = n[0] * n[1] * n[2];
  const SmallGrid at{grid};
  bool counts[3];
  Vec3 axis[3];
  int dimension = 0;
  for (int a = 0; a < 3; ++a) {
    counts[a] = n[size_t(a)] > 1, dimension += counts[a];
    axis[a] = grid.direction.column(a);
  }
  if (dimension == 0) fail_usage("one seed has no neighbours", "dims", "two or more along some axis");
  std::vector<Vec3> went(count);
  std::vector<uint8_t> known(count);
  float *value = nullptr, *map = nullptr, *values = nullptr, *largest = nullptr, *smallest = nullptr;
  const auto dims = size_t(dimension);
  Array arrays[5] = {Array::make<float>(count, 1, &value), Array::make<float>(count, 3, &map),
                     Array::make<float>(count, dimension, &values), Array::make<float>(count, 3, &largest),
                     Array::make<float>(count, 3, &smallest)};
  const auto write = [&](size_t i, const Vec3 f[3], bool all) {
    const Stretch s = all ? stretch_of(f, counts, dimension, duration) : Stretch();
    value[i] = float(s.ftle);
    for (size_t k = 0; k < dims; ++k) values[dims * i + k] = float(s.values[k]);
    for (int k = 0; k < 3; ++k) {
      map[3 * i + size_t(k)] = known[i] ? float(went[i][k]) : NAN;
      largest[3 * i + size_t(k)] = float(s.largest[k]), smallest[3 * i + size_t(k)] = float(s.smallest[k]);
    }
  };
  const auto place = [&](size_t i) { return at.at(i % n[0], i / n[0] % n[1], i / (n[0] * n[1])); };
  parallel_for(
      count, 256,
      [&](size_t begin, size_t end) {
        const Carrier carry_to = make();
        for (size_t i = begin; i < end; ++i) {
          const Vec3 x = place(i);
          known[i] = carry_to(x, went[i]);
          if (!offset) continue;
          Vec3 f[3], less, more;
          bool all = true;
          for (int a = 0; a < 3; ++a) {
            if (!counts[a]) continue;
            const bool lo = carry_to(x - axis[a] * *offset, less), hi = carry_to(x + axis[a] * *offset, more);
            all = all && difference(lo ? &less : nullptr, went[i], known[i], hi ? &more : nullptr, *offset, f[a]);
          }
          write(i, f, all);
        }
      },
      &context);
  if (!offset)
    parallel_for(count, 1 << 12, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const size_t index[3] = {i % n[0], i / n[0] % n[1], i / (n[0] * n[1])}, step[3] = {1, n[0], n[0] * n[1]};
        Vec3 f[3];
        bool all = true;
        for (size_t a = 0; a < 3; ++a) {
          if (!counts[a]) continue;
          const Vec3* less = index[a] > 0 && known[i - step[a]] ? &went[i - step[a]] : nullptr;
          const Vec3* more = index[a] + 1 < n[a] && known[i + step[a]] ? &went[i + step[a]] : nullptr;
          all = all && difference(less, went[i], known[i], more, grid.spacing[int(a)], f[a]);
        }
        write(i, f, all);
      }
    });
  DatasetParts parts;
  parts.mesh = grid;
  constexpr const char* names[] = {"ftle", "flow map", "stretch", "stretch direction", "shrink direction"};
  for (int k = 0; k < 5; ++k)
    parts.fields.add({names[k], Association::point, std::move(arrays[k]), k == 0 ? "1/time" : "", k == 0 ? Role::scalars : Role::none});
  return make_dataset(std::move(parts));
}

DatasetPtr ftle(const DatasetPtr& in, const FtleParams& p, Context& context) {
  const FlowField field(in, p.field.name, context);
  const auto make = [&]() -> Carrier {
    auto flow = std::make_shared<FlowCursor>(field);
    return [flow, &p](Vec3 from, Vec3& to) {
      const Carried c = carry(*flow, from, 0, p.duration, p.tolerance);
      to = c.to;
      return c.inside && c.time == p.duration;
    };
  };
  return ftle_of(ftle_grid(*in, p), p.duration, p.offset, make, context);
}

}  // namespace sg
