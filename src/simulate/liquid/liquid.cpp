// SPDX-License-Identifier: Apache-2.0
#include "simulate/liquid/liquid.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/error.h"
#include "base/text/text.h"

namespace sg::liquid {

namespace {

constexpr double least_alpha = 0.02;
constexpr double width = 1.5;  // of the kernel, in distances between particles
constexpr int wall_layers = 4;

Box3 box_from(const double* b, const char* word) {
  Box3 box;
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = b[2 * a], box.hi[a] = b[2 * a + 1];
    if (!(a == 2 ? box.lo[a] <= box.hi[a] : box.lo[a] < box.hi[a]) || !std::isfinite(box.lo[a]) || !std::isfinite(box.hi[a]))
      fail_usage(fmt::format("the box extends from {} to {} along {}", exact_number(box.lo[a]), exact_number(box.hi[a]), "xyz"[a]),
                 fmt::format("liquid {}", word), "give finite numbers, the lower one first; z may be equal");
  }
  return box;
}

Box3 room_of(const LiquidParams& p) {
  if (p.bounds.empty()) return {{0, 0, 0}, {4, 2, 0}};
  if (p.bounds.size() != 6) fail_usage(fmt::format("{} numbers are no box", p.bounds.size()), "liquid bounds", "give x0,x1,y0,y1,z0,z1");
  return box_from(p.bounds.data(), "bounds");
}

double spacing_of(const LiquidParams& p) {
  const Vec3 s = room_of(p).size();
  return std::max({s.x, s.y, s.z}) / p.size;
}

Box3 with_walls(Box3 box, double by) {
  box.lo -= Vec3(by, by, by), box.hi += Vec3(by, by, by);
  return box;
}

}  // namespace

Liquid::Liquid(const LiquidParams& p, const Context& context)
    : params_(p),
      box_(room_of(p)),
      flat_(box_.size().z == 0),
      spacing_(spacing_of(p)),
      gravity_(p.gravity.value_or(flat_ ? Vec3(0, -9.81, 0) : Vec3(0, 0, -9.81))),
      kernel_(width * spacing_, flat_),
      neighbours_(with_walls(box_, wall_layers * spacing_), kernel_.reach(), flat_) {
  if (!std::isfinite(p.density + p.viscosity + p.sound + p.frame + gravity_.x + gravity_.y + gravity_.z))
    fail_usage("density, viscosity, sound, frame and gravity are finite numbers", "liquid");
  if (flat_) gravity_.z = 0;
  double walls = 1, inside = 1;
  for (int a = 0; a < (flat_ ? 2 : 3); ++a) {
    const double n = std::round(box_.size()[a] / spacing_);
    walls *= n + 2 * wall_layers, inside *= n;
  }
  if (walls - inside > 5e7 || (context.memory_limit && (walls - inside) * 200 > double(context.memory_limit)))
    fail_usage(fmt::format("walls of {:.3g} particles are more than there is memory for", walls - inside), "liquid size", "ask for fewer");
  const int up = flat_ ? 1 : 2;
  std::vector<double> fill = p.fill;
  if (fill.empty()) {
    const Vec3 s = box_.size();
    Box3 column{box_.lo, box_.hi};
    column.hi.x = box_.lo.x + s.x / 4, column.hi[up] = box_.lo[up] + s[up] / 2;
    for (int a = 0; a < 3; ++a) fill.push_back(column.lo[a]), fill.push_back(column.hi[a]);
  }
  if (fill.size() % 6 != 0) fail_usage(fmt::format("{} numbers are no boxes", fill.size()), "liquid fill", "give six of each");
  const double volume = std::pow(spacing_, flat_ ? 2 : 3);
  mass_ = p.density * volume;
  double top = -HUGE_VAL, bottom = HUGE_VAL;  // along the way up, which is against gravity
  const double weight = length(gravity_);
  const Vec3 away = weight > 0 ? gravity_ * (-1 / weight) : Vec3();
  for (size_t b = 0; b < fill.size(); b += 6) {
    const Box3 full = box_from(&fill[b], "fill");
    for (size_t other = 0; other < b; other += 6) {
      const Box3 before = box_from(&fill[other], "fill");
      double common = HUGE_VAL;
      for (int a = 0; a < (flat_ ? 2 : 3); ++a)
        common = std::min(common, std::min(full.hi[a], before.hi[a]) - std::max(full.lo[a], before.lo[a]));
      if (common > 0.5 * spacing_) fail_usage("two boxes of liquid overlap", "liquid fill", "let them touch, not more");
    }
    double many = 1;
    size_t n[3];
    for (int a = 0; a < 3; ++a) {
      const double slack = 1e-9 * spacing_;
      if (full.lo[a] < box_.lo[a] - slack || full.hi[a] > box_.hi[a] + slack)
        fail_usage(fmt::format("there is liquid outside of the box along {}", "xyz"[a]), "liquid fill",
                   fmt::format("the box extends from {} to {}", exact_number(box_.lo[a]), exact_number(box_.hi[a])));
      n[a] = flat_ && a == 2 ? 1 : size_t(std::max(0.0, std::round((full.hi[a] - full.lo[a]) / spacing_)));
      many *= double(n[a]);
    }
    if (many > 5e7 || (context.memory_limit && many * 400 > double(context.memory_limit)))
      fail_usage(fmt::format("{:.3g} particles are more than there is memory for", many), "liquid size", "ask for fewer");
    for (size_t k = 0; k < n[2]; ++k)
      for (size_t j = 0; j < n[1]; ++j)
        for (size_t i = 0; i < n[0]; ++i) {
          Vec3 at = full.lo + spacing_ * Vec3(double(i) + 0.5, double(j) + 0.5, double(k) + 0.5);
          if (flat_) at.z = box_.lo.z;
          x_.push_back(at);
          top = std::max(top, dot(at, away) + spacing_ / 2), bottom = std::min(bottom, dot(at, away) - spacing_ / 2);
        }
  }
  if (x_.empty()) fail_usage("there is no liquid", "liquid fill", "boxes wider than a particle, or a larger size");
  const double height = top - bottom, fall = std::sqrt(2 * weight * height);
  sound_ = p.sound > 0 ? p.sound : 10 * (fall > 0 ? fall : 1);
  stiffness_ = p.density * sound_ * sound_ / tait_exponent;
  // Artificial viscosity alpha h c is nu = alpha h c / 8 in the plane, / 10 in space (Monaghan 2005).
  slip_ = std::max(least_alpha * kernel_.h * sound_, p.viscosity * (flat_ ? 8 : 10));
  v_.assign(x_.size(), {}), a_.assign(x_.size(), {});
  for (size_t i = 0; i < x_.size(); ++i) {  // at rest under what is above it
    pressure_.push_back(p.density * weight * (top - dot(x_[i], away)));
    density_.push_back(density_of(pressure_[i]));
  }
  place_walls();
}

void Liquid::place_walls() {
  long long n[3];
  for (int a = 0; a < 3; ++a) n[a] = flat_ && a == 2 ? 0 : std::llround(box_.size()[a] / spacing_);
  const long long deep = flat_ ? 0 : wall_layers;
  for (long long k = -deep; k < std::max(n[2], 1LL) + deep; ++k)
    for (long long j = -wall_layers; j < n[1] + wall_layers; ++j)
      for (long long i = -wall_layers; i < n[0] + wall_layers; ++i) {
        const bool inside = i >= 0 && i < n[0] && j >= 0 && j < n[1] && (flat_ || (k >= 0 && k < n[2]));
        if (inside) continue;
        // Equally far from each wall, where the box is no whole number of particles wide.
        const auto along = [&](long long c, int a) {
          const double half = (double(c) + 0.5) * spacing_;
          return c < n[a] ? box_.lo[a] + half : box_.hi[a] + half - double(n[a]) * spacing_;
        };
        wall_.push_back({along(i, 0), along(j, 1), flat_ ? box_.lo.z : along(k, 2)});
      }
}

void Liquid::advance(const Context& context) {
  double left = params_.frame;
  while (left > 1e-9 * params_.frame) {
    context.check();
    left -= step(left, context);
  }
  ++frame_;
}

DatasetPtr Liquid::dataset(const Context&) const {
  std::vector<double> xyz, velocity;
  for (size_t i = 0; i < x_.size(); ++i)
    for (int c = 0; c < 3; ++c) xyz.push_back(x_[i][c]), velocity.push_back(v_[i][c]);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::move(xyz), 3);
  DatasetParts parts;
  parts.mesh = std::move(cloud);
  parts.time = double(frame_) * params_.frame;
  parts.fields.add({"pressure", Association::point, Array::from_vector(pressure_), "", Role::scalars});
  parts.fields.add({"velocity", Association::point, Array::from_vector(std::move(velocity), 3), "", Role::vectors});
  parts.fields.add({"density", Association::point, Array::from_vector(density_), "", Role::none});
  return make_dataset(std::move(parts));
}

}  // namespace sg::liquid

namespace sg {

RunCost cost_of_liquid(const LiquidParams& p) {
  const Box3 box = liquid::room_of(p);
  const bool flat = box.size().z == 0;
  const double spacing = liquid::spacing_of(p), weight = length(p.gravity.value_or(Vec3(0, 0, -9.81)));
  double inside = 1, walls = 1;
  for (int a = 0; a < (flat ? 2 : 3); ++a) inside *= box.size()[a] / spacing, walls *= box.size()[a] / spacing + 2 * liquid::wall_layers;
  double count = p.fill.empty() ? inside / 8 : 0, height = box.size()[flat ? 1 : 2] / (p.fill.empty() ? 2 : 1);
  for (size_t b = 0; b + 5 < p.fill.size(); b += 6) {
    double part = 1;
    for (size_t a = 0; a < (flat ? 2u : 3u); ++a) part *= (p.fill[b + 2 * a + 1] - p.fill[b + 2 * a]) / spacing;
    count += std::max(part, 0.0);
  }
  const double fall = std::sqrt(2 * weight * height), sound = p.sound > 0 ? p.sound : 10 * (fall > 0 ? fall : 1);
  return cost_of_run(p, "liquid", uint64_t(std::min(count, 1e12)) * 64, 3.5e-7 * (count + walls - inside),
                     equal_steps(p.frame, 0.25 * liquid::width * spacing / (sound + fall / 2)));
}

DatasetPtr liquid_source(const LiquidParams& p, Context& context) {
  using Run = liquid::Liquid;
  return frame_of_run<Run>(
      "liquid", p, [&] { return std::make_unique<Run>(p, context); }, context);
}

}  // namespace sg
