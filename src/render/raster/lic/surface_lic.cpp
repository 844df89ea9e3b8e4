// SPDX-License-Identifier: Apache-2.0
#include "render/raster/lic/surface_lic.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "render/prepare/prepared.h"
#include "render/shade/shade.h"

namespace sg::raster {

namespace {

struct Reference {
  Vec3 right, up, forward, eye;
  explicit Reference(const EyeView& v)
      : right(v.right[0], v.right[1], v.right[2]),
        up(v.up[0], v.up[1], v.up[2]),
        forward(v.forward[0], v.forward[1], v.forward[2]),
        eye(double(v.hi[0]) + double(v.lo[0]), double(v.hi[1]) + double(v.lo[1]), double(v.hi[2]) + double(v.lo[2])) {}
};

Vec3 three(const float* base, size_t i) { return {base[3 * i], base[3 * i + 1], base[3 * i + 2]}; }

double hashed(uint32_t h) {
  h = (h ^ h >> 16) * 0x85EBCA6Bu, h = (h ^ h >> 13) * 0xC2B2AE35u;
  return double((h ^ h >> 16) >> 8) * 0x1p-24 - 0.5;
}

double noise_at(Vec3 p, Vec3 n, double footprint, uint32_t seed) {
  const Vec3 a{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  const bool along_x = a.x > a.y && a.x > a.z, along_y = !along_x && a.y > a.z;
  const double q = along_x ? p.y : p.x, r = along_x || along_y ? p.z : p.y;
  const double u = q * double(noise_turn[0]) - r * double(noise_turn[1]), v = q * double(noise_turn[1]) + r * double(noise_turn[0]);
  const int level = int(std::floor(std::log2(footprint)));
  const double f = footprint / std::ldexp(1.0, level) - 1;
  const auto value = [&](int k) {
    const double cell = std::ldexp(1.0, k);
    const auto place = [&](double q) { return uint32_t(int32_t(std::floor(std::clamp(q / cell + 0.3819660, -1e9, 1e9)))); };
    return hashed((place(u) * 0x9E3779B1u) ^ (place(v) * 0x632BE5ABu + seed * 0x7FEB352Du) ^
                  (along_x   ? 0x2545F491u
                   : along_y ? 0x6C8E9CF5u
                             : 0u) ^
                  (uint32_t(k + 127) * 0x165667B1u));
  };
  return (value(level) * (1 - f) + value(level + 1) * f) / std::sqrt((1 - f) * (1 - f) + f * f);
}

}  // namespace

void pixel_vectors_reference(const VectorJob& job, VectorBatch& b) {
  const EyeView& v = job.view;
  const Reference c(v);
  for (size_t i = 0; i < b.n; ++i) {
    const uint32_t* corner = job.triangles + 3 * size_t(b.triangle[i]);
    const double X = (b.x[i] + 0.5 - double(v.center_x)) / double(v.scale), Y = (double(v.center_y) - b.y[i] - 0.5) / double(v.scale);
    const Vec3 side = c.right * X + c.up * Y, ray = v.parallel ? c.forward : c.forward + side, start = v.parallel ? c.eye + side : c.eye;
    const Vec3 p0 = three(job.xyz, corner[0]), p1 = three(job.xyz, corner[1]), p2 = three(job.xyz, corner[2]);
    const Vec3 plane = cross(p1 - p0, p2 - p0), normal = normalize(plane), hit = start + ray * (dot(p0 - start, plane) / dot(ray, plane));
    const double area = dot(plane, plane), s = std::max(dot(cross(p2 - hit, p0 - hit), plane) / area, 0.0),
                 t = std::max(dot(cross(p0 - hit, p1 - hit), plane) / area, 0.0), r = std::max(1 - s - t, 0.0);
    const double z = dot(hit - c.eye, c.forward);
    Vec3 f;
    if (job.per_cell) f = three(job.vectors, job.cells ? job.cells[b.triangle[i]] : job.first_cell + b.triangle[i]);
    else f = three(job.vectors, corner[0]) * r + three(job.vectors, corner[1]) * s + three(job.vectors, corner[2]) * t;
    const Vec3 way = normalize(f), tangent = way - normal * dot(way, normal);
    const double tz = v.parallel ? 0 : dot(tangent, c.forward);
    const double dx = dot(tangent, c.right) - X * tz, dy = Y * tz - dot(tangent, c.up), size = std::hypot(dx, dy);
    b.word[i] = 0;
    if (std::max({std::abs(f.x), std::abs(f.y), std::abs(f.z)}) > double(job.least) && dot(tangent, tangent) > 1e-6 && size > 1e-5)
      b.word[i] = uint32_t(int(std::nearbyint(2047 * dx / size))) << 20 | (uint32_t(int(std::nearbyint(2047 * dy / size))) & 0xFFF) << 8;
    const double nx = dot(normal, c.right), ny = dot(normal, c.up), nz = dot(normal, c.forward), w = v.parallel ? z : 1 / z;
    const double slope = v.parallel ? -1 / (nz * double(v.scale)) : w / (double(v.scale) * (nx * X + ny * Y + nz));
    const double most = (v.parallel ? 1 : w) * 8 / double(v.scale);
    b.w[i] = float(w), b.wx[i] = float(std::clamp(nx * slope, -most, most)), b.wy[i] = float(std::clamp(-ny * slope, -most, most));
    b.noise[i] = float(noise_at(hit, normal, (v.parallel ? 1 : z) * double(noise_square) * double(job.grain) / double(v.scale), job.seed));
  }
}

namespace {

VectorJob vector_job(const PreparedItem& item, const EyeView& view, double pixel_scale) {
  const TriangleSet& t = item.triangles;
  VectorJob j{};
  j.view = view, j.xyz = t.xyz(), j.triangles = t.indices(), j.cells = t.cell_list(), j.first_cell = t.first_cell;
  j.vectors = reinterpret_cast<const float*>(item.lic_vectors.raw()), j.per_cell = item.lic->association == Association::cell;
  j.least = item.lic_least, j.grain = float(item.lic->grain * pixel_scale), j.seed = uint32_t(item.lic->seed);
  return j;
}

class Builder {
 public:
  Builder(const PreparedScene& scene, const std::vector<EyeView>& views, const uint64_t* keys, double pixel_scale)
      : scene_(scene), views_(views), keys_(keys), pixel_scale_(pixel_scale) {}

  LicPlanes run(int only, Context& context) {
    const EyeView& view = views_[0];
    p_.width = view.width, p_.height = view.height, p_.stride = size_t(view.width) + 2;
    const size_t size = p_.stride * (size_t(view.height) + 2);
    for (Plane<float>* f : {&p_.w, &p_.wx, &p_.wy, &p_.noise, &p_.value}) f->resize(size);
    p_.item.resize(size), p_.word.resize(size);
    parallel_for(size, 1 << 16, [&](size_t begin, size_t end) {
      std::fill(p_.item.begin() + ptrdiff_t(begin), p_.item.begin() + ptrdiff_t(end), 0u);
      std::fill(p_.word.begin() + ptrdiff_t(begin), p_.word.begin() + ptrdiff_t(end), 0u);
    });
    for (size_t i = 0; i < scene_.items.size(); ++i) {
      const PreparedItem& item = scene_.items[i];
      jobs_.push_back(item.lic ? vector_job(item, views_[i], pixel_scale_) : VectorJob{});
      wanted_.push_back(item.lic && (only < 0 ? !item.translucent : size_t(only) == i));
    }
    const size_t across = size_t(view.width + tile_size - 1) / tile_size, down = size_t(view.height + tile_size - 1) / tile_size;
    parallel_for(
        across * down, 1, [&](size_t t, size_t) { take_vectors(int(t % across) * tile_size, int(t / across) * tile_size); }, &context);
    parallel_for(
        size_t(view.height), 16, [&](size_t begin, size_t end) { connect_pixels(p_, view, int(begin), int(end)); }, &context);
    for (size_t i = 0; i < scene_.items.size(); ++i) {
      if (!wanted_[i]) continue;
      SurfaceTexture texture = *scene_.items[i].lic;
      const int finer = std::max(1, int(std::ceil(pixel_scale_ * texture.step)));  // steps stay below a pixel
      texture.step = texture.step * pixel_scale_ / finer, texture.steps *= finer;
      const LicWeights weights = lic_weights(texture, texture.grain * pixel_scale_ / texture.step);
      const ConvolveJob job{p_.word.data(), p_.noise.data(), p_.value.data(), int(p_.stride), float(texture.step), &weights};
      parallel_for(
          across * down, 1,
          [&](size_t t, size_t) { convolve_tile(job, uint32_t(i + 1), int(t % across) * tile_size, int(t / across) * tile_size); },
          &context);
    }
    return std::move(p_);
  }

 private:
  void take_vectors(int x0, int y0) {
    VectorBatch batch;
    uint32_t item = 0, from = 1, to = 0;
    const auto flush = [&] {
      pixel_vectors(jobs_[item], batch);
      for (size_t k = 0; k < batch.n; ++k) {
        const size_t i = p_.at(batch.x[k], batch.y[k]);
        p_.item[i] = item + 1, p_.word[i] = batch.word[k], p_.noise[i] = batch.noise[k];
        p_.w[i] = batch.w[k], p_.wx[i] = batch.wx[k], p_.wy[i] = batch.wy[k];
      }
      batch.n = 0;
    };
    for (int y = y0; y < std::min(y0 + tile_size, p_.height); ++y)
      for (int x = x0; x < std::min(x0 + tile_size, p_.width); ++x) {
        const uint32_t primitive = uint32_t(keys_[size_t(y) * size_t(p_.width) + size_t(x)]);
        if (primitive == 0xFFFFFFFFu) continue;
        if (primitive < from || primitive >= to) {
          if (batch.n > 0) flush();
          item = scene_.item_of(primitive);
          from = scene_.items[item].first_primitive, to = from + scene_.items[item].primitives;
        }
        if (!wanted_[item]) continue;
        batch.x[batch.n] = x, batch.y[batch.n] = y, batch.triangle[batch.n] = primitive - from;
        if (++batch.n == vector_batch) flush();
      }
    if (batch.n > 0) flush();
  }

  void convolve_tile(const ConvolveJob& job, uint32_t item, int x0, int y0) {
    int32_t pixels[tile_pixels];
    size_t n = 0;
    for (int y = y0; y < std::min(y0 + tile_size, p_.height); ++y)
      for (int x = x0; x < std::min(x0 + tile_size, p_.width); ++x) {
        const size_t i = p_.at(x, y);
        pixels[n] = int32_t(i), n += p_.item[i] == item;
      }
    convolve(job, pixels, n);
  }

  const PreparedScene& scene_;
  const std::vector<EyeView>& views_;
  const uint64_t* keys_;
  const double pixel_scale_;
  LicPlanes p_;
  std::vector<VectorJob> jobs_;
  std::vector<uint8_t> wanted_;
};

}  // namespace

LicPlanes surface_texture(const PreparedScene& scene, const std::vector<EyeView>& views, const uint64_t* keys, int only, double pixel_scale,
                          Context& context) {
  return Builder(scene, views, keys, pixel_scale).run(only, context);
}

}  // namespace sg::raster
