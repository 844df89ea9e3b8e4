// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/bricks/mip_source.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/error.h"
#include "base/parallel.h"
#include "data/memory/memo.h"
#include "render/volume/medium/optical_depth.h"
#include "render/volume/sources/bricks/bricked_source.h"
#include "render/volume/sources/lattice/reconstructed_ray.h"
#include "render/volume/sources/lattice/samples.h"

namespace sg::volume {

namespace {

using Dims = std::array<size_t, 3>;

struct Pyramid {
  std::vector<Dims> dims;
  std::vector<std::vector<float>> means;  // of level 1 and on; level 0 is the lattice's own
};

/// Means of 2 x 2 x 2 of the samples that have a value.
template <class From>
std::vector<float> halved(const Dims& n, const Dims& half, const From& from, const Context& context) {
  std::vector<float> out(half[0] * half[1] * half[2]);
  parallel_for(
      half[1] * half[2], 16,
      [&](size_t begin, size_t end) {
        for (size_t r = begin; r < end; ++r)
          for (size_t i = 0; i < half[0]; ++i) {
            double sum = 0;
            int count = 0;
            for (size_t c = 0; c < 8; ++c) {
              const size_t x = 2 * i + (c & 1), y = 2 * (r % half[1]) + (c >> 1 & 1), z = 2 * (r / half[1]) + (c >> 2);
              if (x >= n[0] || y >= n[1] || z >= n[2]) continue;
              const float v = from(x + n[0] * (y + n[1] * z));
              if (v == v) sum += double(v), ++count;
            }
            out[i + half[0] * r] = count ? float(sum / count) : NAN;
          }
      },
      &context);
  return out;
}

Pyramid make_pyramid(const Array& samples, const Dims& dims, const Context& context) {
  Pyramid p;
  p.dims.push_back(dims);
  while (*std::max_element(p.dims.back().begin(), p.dims.back().end()) > 8) {
    const Dims n = p.dims.back(), half{(n[0] + 1) / 2, (n[1] + 1) / 2, (n[2] + 1) / 2};
    if (p.means.empty())
      with_samples(samples, [&](auto* v) {
        p.means.push_back(halved(
            n, half, [v](size_t i) { return float(v[i]); }, context));
      });
    else
      p.means.push_back(halved(
          n, half, [&v = p.means.back()](size_t i) { return v[i]; }, context));
    p.dims.push_back(half);
  }
  return p;
}

/// A dataset that stands for the pyramid.
DatasetPtr bricked_dataset(const UniformGrid& g, const Array& samples, const Dims& dims, const Context& context) {
  const auto pyramid = std::make_shared<const Pyramid>(make_pyramid(samples, dims, context));
  auto v = std::make_shared<BrickedVolume>();
  v->field = "f", v->direction = g.direction;
  BrickedVolume::Level level{dims, g.origin, g.spacing, {1, 1, 1}};
  for (int a = 0; a < 3; ++a)
    if (level.spacing[a] < 0) {
      level.spacing[a] = -level.spacing[a];
      for (int r = 0; r < 3; ++r) v->direction.m[r][a] = -v->direction.m[r][a];
    }
  v->levels.push_back(level);
  for (size_t l = 1; l < pyramid->dims.size(); ++l) {
    for (size_t a = 0; a < 3; ++a)
      if (pyramid->dims[l - 1][a] > 1) {
        Vec3 half{0, 0, 0};
        half[int(a)] = 0.5 * level.spacing[int(a)];
        level.origin += v->direction * half, level.spacing[int(a)] *= 2, level.coarseness[a] *= 2;
      }
    level.dims = pyramid->dims[l];
    v->levels.push_back(level);
  }
  BlockExtremes extremes(dims);
  extremes.add(samples, 0, dims[2]);
  v->extremes = extremes.take();
  v->read = [pyramid, samples](size_t l, Dims lo, Dims n, std::byte* out) {
    auto* to = reinterpret_cast<float*>(out);
    const Dims& d = pyramid->dims[l];
    const auto copy = [&](auto* from) {
      for (size_t k = 0; k < n[2]; ++k)
        for (size_t j = 0; j < n[1]; ++j)
          for (size_t i = 0; i < n[0]; ++i) *to++ = float(from[lo[0] + i + d[0] * (lo[1] + j + d[1] * (lo[2] + k))]);
    };
    if (l == 0) with_samples(samples, copy);
    else copy(pyramid->means[l - 1].data());
  };
  DatasetParts parts;
  UniformGrid coarse;
  coarse.dims = level.dims, coarse.origin = level.origin, coarse.spacing = level.spacing, coarse.direction = v->direction;
  parts.mesh = coarse;
  const std::vector<float> last = pyramid->means.empty() ? std::vector<float>(dims[0] * dims[1] * dims[2]) : pyramid->means.back();
  parts.fields.add({"f", Association::point, Array::from_vector(last), "", Role::scalars});
  return make_dataset(std::move(parts), v);
}

class MipSource final : public RaySource {
 public:
  MipSource(DatasetPtr data, std::unique_ptr<RaySource> bricks, const Volume& lattice)
      : data_(std::move(data)), bricks_(std::move(bricks)) {
    base = lattice.base, bounds = lattice.bounds, edge = lattice.edge;
  }
  std::unique_ptr<RayField> walker() const override {
    std::call_once(once_, [&] { bricks_->invisible = invisible; });
    return bricks_->walker();
  }

 private:
  DatasetPtr data_;
  std::unique_ptr<RaySource> bricks_;
  mutable std::once_flag once_;
};

}  // namespace

bool is_mip_source(const RaySource& source) { return dynamic_cast<const MipSource*>(&source) != nullptr; }

std::unique_ptr<RaySource> mip_source(const VolumeItem& item, const Volume* lattice, const Projection& projection, Context& context) {
  const auto* g = item.data->as<UniformGrid>();
  const char* instead = "use antialias=none; --picture samples=4 takes more rays per pixel for any mesh";
  if (!g || !lattice)
    fail_usage(fmt::format("antialias=mip needs a uniform grid; this is a {} mesh", item.data->kind()), "volume", instead);
  if (lattice->dual) fail_usage("antialias=mip needs a point field", "volume", "-f cell_to_point converts");
  if (!lattice->hidden().empty()) fail_usage("antialias=mip does not support blanked cells", "volume", instead);
  if (wants_reconstruction(item.sampling))
    fail_usage("antialias=mip supports only the linear kernel and central gradients", "volume", "leave out kernel and gradient");
  if (item.detail.second == SecondAxis::field) fail_usage("antialias=mip does not support a second field", "volume", instead);
  const Dims& dims = lattice->voxels.dims;
  if (lattice->nearest || std::min({dims[0], dims[1], dims[2]}) < 2) return nullptr;
  double farthest = projection.near_plane;
  for (int c = 0; c < 8; ++c) {
    const Box3& b = lattice->bounds;
    farthest = std::max(farthest, projection.to_eye({c & 1 ? b.hi.x : b.lo.x, c & 2 ? b.hi.y : b.lo.y, c & 4 ? b.hi.z : b.lo.z}).z);
  }
  const double pixel = (projection.parallel ? 1 : farthest) / projection.scale;
  if (std::max({std::abs(g->spacing.x), std::abs(g->spacing.y), std::abs(g->spacing.z)}) >= pixel) return nullptr;

  std::string key = item.field + '|';
  append_numbers(key, {double(item.component)});
  const auto kept = item.data->memo().keep("volume mip pyramids", Recent<DatasetPtr>(), 0);
  const DatasetPtr data = *kept->get(key, 1, [&] { return bricked_dataset(*g, lattice->voxels.array, dims, context); });
  VolumeItem bricks;
  bricks.data = data, bricks.field = "f";
  const size_t bytes = 4 * dims[0] * dims[1] * dims[2];
  auto source = bricked_source(bricks, projection, std::max(bytes / 3, size_t(64) << 20), context);
  return std::make_unique<MipSource>(data, std::move(source), *lattice);
}

}  // namespace sg::volume
