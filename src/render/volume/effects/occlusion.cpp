// SPDX-License-Identifier: Apache-2.0
#include "render/volume/effects/occlusion.h"
#include "render/shade/exp.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace sg::volume {

namespace {

/// Opacities of boxes along one axis.
struct Level {
  size_t n[3] = {1, 1, 1};
  std::vector<float> opacity;
  size_t at(const size_t c[3]) const { return c[0] + n[0] * (c[1] + n[1] * c[2]); }

  /// Trilinear between the middles of the boxes, at a place in cells of this level; nothing beyond.
  float sample(const double place[3]) const {
    long cell[3];
    float f[3];
    for (int a = 0; a < 3; ++a) {
      const double x = place[a] - 0.5;
      if (!(x > -1 && x < double(n[a]))) return 0;
      cell[a] = long(std::floor(x)), f[a] = float(x - double(cell[a]));
    }
    float sum = 0;
    for (int c = 0; c < 8; ++c) {
      size_t i[3];
      float w = 1;
      bool inside = true;
      for (int a = 0; a < 3; ++a) {
        const long at = cell[a] + (c >> a & 1);
        inside = inside && at >= 0 && at < long(n[a]);
        i[a] = size_t(at), w *= c >> a & 1 ? f[a] : 1 - f[a];
      }
      if (inside && w > 0) sum += w * opacity[this->at(i)];
    }
    return sum;
  }
};

/// Boxes twice as large: two behind each other along the axis, the mean of four side by side.
Level coarser(const Level& fine, int axis) {
  Level out;
  for (int a = 0; a < 3; ++a) out.n[a] = (fine.n[a] + 1) / 2;
  out.opacity.resize(out.n[0] * out.n[1] * out.n[2]);
  const int b = (axis + 1) % 3, c = (axis + 2) % 3;
  parallel_for(out.n[2], 4, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k)
      for (size_t j = 0; j < out.n[1]; ++j)
        for (size_t i = 0; i < out.n[0]; ++i) {
          const size_t box[3] = {i, j, k};
          float sum = 0;
          for (size_t side = 0; side < 4; ++side) {
            float pass = 1;
            for (size_t deep = 0; deep < 2; ++deep) {
              size_t child[3];
              child[axis] = 2 * box[axis] + deep, child[b] = 2 * box[b] + (side & 1), child[c] = 2 * box[c] + (side >> 1);
              if (child[0] < fine.n[0] && child[1] < fine.n[1] && child[2] < fine.n[2]) pass *= 1 - fine.opacity[fine.at(child)];
            }
            sum += 1 - pass;
          }
          out.opacity[out.at(box)] = 0.25f * sum;
        }
  });
  return out;
}

struct Frame3 {
  Vec3 lo;
  double cell;
  size_t n[3];
};

/// Opacity of each cell along an axis, the mean over 2 x 2 rays where cells of the lattice are larger than those of the mesh.
Level opacities(const Frame3& f, int axis, const RaySource& source, const DepthIntegral& integral, const std::vector<ClipPlane>& clip,
                const Context* context) {
  Level out;
  for (int a = 0; a < 3; ++a) out.n[a] = f.n[a];
  out.opacity.assign(f.n[0] * f.n[1] * f.n[2], 0.0f);
  const int b = (axis + 1) % 3, c = (axis + 2) % 3;
  const int fine = f.cell > 1.5 * source.edge ? 2 : 1;
  parallel_for(
      f.n[b] * f.n[c], 64,
      [&](size_t begin, size_t end) {
        const auto walker = source.walker();
        std::vector<float> depth(f.n[axis] + 1);
        for (size_t r = begin; r < end; ++r) {
          size_t box[3];
          box[b] = r % f.n[b], box[c] = r / f.n[b];
          for (int s = 0; s < fine * fine; ++s) {
            DepthRay ray;
            ray.direction = {0, 0, 0};
            ray.direction[axis] = 1;
            ray.origin[axis] = f.lo[axis];
            ray.origin[b] = f.lo[b] + (double(box[b]) + (s % fine + 0.5) / fine) * f.cell;
            ray.origin[c] = f.lo[c] + (double(box[c]) + (s / fine + 0.5) / fine) * f.cell;
            ray.clip(clip);
            depths_along(ray, *walker, integral, f.cell, HUGE_VALF, depth);
            for (box[axis] = 0; box[axis] < f.n[axis]; ++box[axis])
              out.opacity[out.at(box)] += (1 - exp_minus(depth[box[axis] + 1] - depth[box[axis]])) / float(fine * fine);
          }
        }
      },
      context);
  return out;
}

}  // namespace

Occlusion::Occlusion(const RaySource& source, Extinction extinction, const std::vector<ClipPlane>& clip, const Plan& plan,
                     const Context* context) {
  const Vec3 extent = source.bounds.hi - source.bounds.lo;
  radius_ = plan.radius > 0 ? plan.radius : length(extent) / 12;
  int levels = 4;
  while (levels > 2 && radius_ / double(1 << levels) < 0.5 * source.edge) --levels;
  cell_ = radius_ / double(1 << levels);
  Frame3 frame{{}, cell_, {1, 1, 1}};
  for (int a = 0; a < 3; ++a) {
    n_[a] = frame.n[a] = size_t(std::max(1.0, std::ceil(extent[a] / cell_ - 1e-9)));
    frame.lo[a] = 0.5 * (source.bounds.lo[a] + source.bounds.hi[a] - double(n_[a]) * cell_);
    first_[a] = frame.lo[a] + 0.5 * cell_;
  }
  const DepthIntegral integral(extinction);
  hidden_.resize(n_[0] * n_[1] * n_[2]);
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Level> pyramid;
    pyramid.push_back(opacities(frame, axis, source, integral, clip, context));
    for (int l = 1; l < levels; ++l) pyramid.push_back(coarser(pyramid.back(), axis));
    parallel_for(
        n_[1] * n_[2], 8,
        [&](size_t begin, size_t end) {
          for (size_t r = begin; r < end; ++r)
            for (size_t i = 0; i < n_[0]; ++i)
              for (int side = 0; side < 2; ++side) {
                const size_t cell[3] = {i, r % n_[1], r / n_[1]};
                // Shell l reaches from 2^l to 2^(l+1) cells; a half one before it, from the boxes of shell 0.
                const auto passes = [&](int level, double away) {
                  const double size = double(1 << level);
                  double place[3];
                  for (int a = 0; a < 3; ++a) place[a] = (double(cell[a]) + 0.5) / size;
                  place[axis] += (side ? away : -away) / size;
                  return 1 - pyramid[size_t(level)].sample(place);
                };
                float pass = std::sqrt(passes(0, 0.75));
                for (int l = 0; l < levels; ++l) pass *= passes(l, 1.5 * double(1 << l));
                hidden_[i + n_[0] * r][size_t(2 * axis + side)] = uint16_t(65535 * (1 - pass) + 0.5f);
              }
        },
        context);
  }
}

float Occlusion::hidden(Vec3 place, Vec3f normal, float surface) const {
  size_t cell[3], next[3];
  float f[3];
  for (int a = 0; a < 3; ++a) {
    const double x = std::clamp((place[a] - first_[a]) / cell_, 0.0, double(n_[a] - 1));
    cell[a] = size_t(x), next[a] = std::min(cell[a] + 1, n_[a] - 1), f[a] = float(x - double(cell[a]));
  }
  float share[6];
  for (int a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side)
      share[2 * a + side] = (1 - surface) * (1.0f / 6) + ((normal[a] > 0) == (side == 1) ? surface * normal[a] * normal[a] : 0);
  float sum = 0;
  for (int c = 0; c < 8; ++c) {
    const float w = (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]);
    if (!(w > 0)) continue;
    const Six& six = hidden_[(c & 1 ? next : cell)[0] + n_[0] * ((c & 2 ? next : cell)[1] + n_[1] * (c & 4 ? next : cell)[2])];
    float at = 0;
    for (size_t d = 0; d < 6; ++d) at += share[d] * float(six[d]);
    sum += w * at;
  }
  return sum * (1.0f / 65535);
}

}  // namespace sg::volume
