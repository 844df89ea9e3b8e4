// SPDX-License-Identifier: Apache-2.0
// A step of the liquid.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "simulate/liquid/liquid.h"

namespace sg::liquid {

namespace {

constexpr double diffusion = 0.1;
constexpr size_t grain = 256;

}  // namespace

double Liquid::pressure_of(double density) const { return stiffness_ * (std::pow(density / params_.density, tait_exponent) - 1); }
double Liquid::density_of(double pressure) const { return params_.density * std::pow(1 + pressure / stiffness_, 1 / tait_exponent); }

void Liquid::sort() {
  const size_t liquid = x_.size();
  everything_.assign(x_.begin(), x_.end());
  everything_.insert(everything_.end(), wall_.begin(), wall_.end());
  const std::vector<uint32_t>& order = neighbours_.sort(everything_);
  all_.resize(order.size());
  for (size_t k = 0; k < order.size(); ++k) {
    const uint32_t i = order[k];
    const bool wall = i >= liquid;
    all_[k] = {everything_[i], wall ? Vec3() : v_[i], wall ? params_.density : density_[i], wall ? 0 : pressure_[i], i, wall};
  }
}

// p = sum (p_f + rho_f g.(x_w - x_f)) W / sum W over the liquid near a wall particle (Adami, Hu, Adams 2012, equation 27), never a pull.
void Liquid::press_walls(const Context& context) {
  parallel_for(
      all_.size(), grain,
      [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
          Sorted& w = all_[k];
          if (!w.wall) continue;
          double sum = 0, weight = 0;
          neighbours_.around(w.x, [&](uint32_t from, uint32_t to) {
            for (uint32_t j = from; j < to; ++j) {
              const Sorted& f = all_[j];
              if (f.wall) continue;
              const Vec3 d = w.x - f.x;
              const double value = kernel_.value(std::sqrt(dot(d, d)));
              sum += (f.pressure + f.density * dot(gravity_, d)) * value, weight += value;
            }
          });
          w.pressure = weight > 0 ? std::max(0.0, sum / weight) : 0;
          w.density = density_of(w.pressure);
        }
      },
      &context);
}

// Density by continuity, d rho/dt = rho sum m/rho_j (v - v_j).grad W, and diffusion, without what is the weight of the layers between.
void Liquid::press_together(double dt, const Context& context) {
  const double reach2 = kernel_.reach() * kernel_.reach(), even = 2 * diffusion * kernel_.h * sound_;
  parallel_for(
      all_.size(), grain,
      [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
          const Sorted& p = all_[k];
          if (p.wall) continue;
          double growth = 0;
          neighbours_.around(p.x, [&](uint32_t from, uint32_t to) {
            for (uint32_t j = from; j < to; ++j) {
              const Sorted& q = all_[j];
              const Vec3 d = p.x - q.x;
              const double r2 = dot(d, d);
              if (r2 >= reach2) continue;
              const double slope = kernel_.slope_over_r(std::sqrt(r2)) * (mass_ / q.density);
              growth += p.density * dot(p.v - q.v, d) * slope;
              if (!q.wall) growth -= even * (q.density - p.density + params_.density * dot(gravity_, d) / (sound_ * sound_)) * slope;
            }
          });
          density_[p.from] += dt * growth;
          pressure_[p.from] = pressure_of(density_[p.from]);
        }
      },
      &context);
  for (Sorted& p : all_)
    if (!p.wall) p.density = density_[p.from], p.pressure = pressure_[p.from];
}

void Liquid::pull(const Context& context) {
  const double h = kernel_.h, reach2 = kernel_.reach() * kernel_.reach();
  parallel_for(
      all_.size(), grain,
      [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
          const Sorted& p = all_[k];
          if (p.wall) continue;
          Vec3 a = gravity_;
          const double own = std::max(0.0, p.pressure) / (p.density * p.density);
          neighbours_.around(p.x, [&](uint32_t from, uint32_t to) {
            for (uint32_t j = from; j < to; ++j) {
              const Sorted& q = all_[j];
              const Vec3 d = p.x - q.x;
              const double r2 = dot(d, d);
              if (r2 >= reach2) continue;
              double push = own + std::max(0.0, q.pressure) / (q.density * q.density);
              if (!q.wall) push -= slip_ * dot(p.v - q.v, d) / ((p.density + q.density) / 2 * (r2 + 0.01 * h * h));
              a -= (mass_ * push * kernel_.slope_over_r(std::sqrt(r2))) * d;
            }
          });
          a_[p.from] = a;
        }
      },
      &context);
}

// Density from velocities, then velocities from the new density, then places from the new velocities: waves of sound keep their energy.
double Liquid::step(double most, const Context& context) {
  const double h = kernel_.h;
  double push = length(gravity_);
  for (const Vec3& a : a_) push = std::max(push, length(a));
  const double dt = std::min({most, 0.25 * h / (sound_ + fastest_), 0.25 * std::sqrt(h / std::max(push, 1e-300)), 0.125 * h * h / slip_});
  sort();
  press_together(dt, context);
  press_walls(context);
  pull(context);
  fastest_ = 0;
  for (size_t i = 0; i < x_.size(); ++i) {
    v_[i] += dt * a_[i];
    if (flat_) v_[i].z = 0;
    x_[i] += dt * v_[i];
    for (int c = 0; c < (flat_ ? 2 : 3); ++c) {  // should walls ever not hold it
      const double wall = std::clamp(x_[i][c], box_.lo[c], box_.hi[c]);
      if (wall != x_[i][c]) x_[i][c] = wall, v_[i][c] = 0;
    }
    const double speed = length(v_[i]);
    if (!(speed <= 4 * sound_) || !(density_[i] > 0) || !std::isfinite(pressure_[i]))
      fail_data(
          fmt::format("the liquid flew apart in frame {} (time {:.6g}): particle {} reached a speed of {:.3g}, that of sound is {:.3g}",
                      frame_ + 1, double(frame_ + 1) * params_.frame, i, speed, sound_),
          "liquid", params_.sound > 0 ? "let sound be faster" : "more viscosity keeps it together");
    fastest_ = std::max(fastest_, speed);
  }
  return dt;
}

}  // namespace sg::liquid
