// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/sources/emission.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sg::fluid {

template <class T>
Emission<T>::Emission(const SmokeParams& p, const MacGrid& g, Vec3 up, const SmokeInput& given, const Context& context)
    : params_(p), grid_(g) {
  std::vector<double> numbers = p.source;
  if (!given.surface.empty() && given.role == SurfaceRole::source) {
    shares_ = shares_inside<T>(given.surface, g, -1, context);
  } else if (!given.density.empty()) {
    shares_ = density_ = temperature_ = Lattice<T>(g.cells);
    for (size_t i = 0; i < given.density.size(); ++i) {
      if (std::isnan(given.density[i]) || std::isnan(given.temperature[i])) continue;
      if (given.density[i] == 0 && given.temperature[i] == 0) continue;  // or hot air could not pass there
      shares_.values[i] = 1, density_.values[i] = T(given.density[i]), temperature_.values[i] = T(given.temperature[i]);
    }
  } else if (numbers.empty() && p.box.empty() && !given.dust) {
    const Vec3 size = g.h * Vec3(double(g.cells[0]), double(g.cells[1]), g.flat() ? 0 : double(g.cells[2]));
    const double radius = 0.12 * std::min({size.x, size.y, g.flat() ? size.x : size.z});
    Vec3 middle = g.origin + 0.5 * size;
    // Above the ground by its own radius and a little.
    for (int a = 0; a < 3; ++a) middle[a] -= up[a] * (0.5 * std::abs(size[a]) - 1.5 * radius);
    numbers = {middle.x, middle.y, middle.z, radius};
  }
  balls_ = balls_of(numbers, g, "source"), boxes_ = boxes_of(p.box, g, "box");
}

// From cells of which a share, share(places along the axes, in units of h), lies in a source within the box; values(cell) are its density
// and temperature.
template <class T>
template <class Share, class Values>
void Emission<T>::give_off_within(const Box3& box, double dt, Air air, Share&& share, Values&& values) const {
  std::array<size_t, 3> lo{0, 0, 0}, hi = grid_.cells;
  for (int a = 0; a < grid_.axes(); ++a) {
    const double n = double(grid_.cells[size_t(a)]);
    const auto place = [&](double x) { return (x - grid_.origin[a]) / grid_.h; };
    lo[size_t(a)] = size_t(std::clamp(std::floor(place(box.lo[a]) - 1), 0.0, n));
    hi[size_t(a)] = size_t(std::clamp(std::ceil(place(box.hi[a]) + 1), 0.0, n));
  }
  for (size_t k = lo[2]; k < hi[2]; ++k)
    for (size_t j = lo[1]; j < hi[1]; ++j)
      for (size_t i = lo[0]; i < hi[0]; ++i) {
        const Vec3 at{double(i), double(j), double(k)};
        const T c = T(share(at + Vec3(0.5, 0.5, 0.5)));
        if (c > 0) {
          const auto [in_full, heat_in_full] = values(i + grid_.cells[0] * (j + grid_.cells[1] * k));
          const T mass = in_full * c, heat = heat_in_full * c;
          T &density = air.density(i, j, k), &temperature = air.temperature(i, j, k);
          if (params_.rate) {
            density += T(*params_.rate * dt) * mass, temperature += T(*params_.rate * dt) * heat;
          } else {  // cells at the rim of a source have their share of its values, however often that is said
            density = std::max(density, mass);
            temperature = heat > 0 ? std::max(temperature, heat) : std::min(temperature, heat);
          }
        }
        if (params_.jet == Vec3(0, 0, 0)) continue;
        for (int a = 0; a < grid_.axes(); ++a) {  // the lower face across each axis
          const auto s = MacGrid::shift(a);
          const T f = T(share(at + Vec3(s[0], s[1], s[2])));
          T& v = air.velocity[size_t(a)](i, j, k);
          v += f * (T(params_.jet[a]) - v);
        }
      }
}

template <class T>
void Emission<T>::give_off(double dt, Lattice<T>& density, Lattice<T>& temperature, Faces<T>& velocity) const {
  const Air air{density, temperature, velocity};
  const auto place = [&](Vec3 p) { return grid_.origin + grid_.h * p; };
  const auto even = [&](size_t) { return std::array{T(params_.density), T(params_.temperature)}; };
  for (const Ball& b : balls_) {
    const Vec3 r = b.radius * Vec3(1, 1, 1);
    give_off_within(
        {b.middle - r, b.middle + r}, dt, air,
        [&](Vec3 p) {
          Vec3 way = place(p) - b.middle;
          if (grid_.flat()) way.z = 0;
          return std::clamp((b.radius - length(way)) / grid_.h + 0.5, 0.0, 1.0);
        },
        even);
  }
  for (const Box3& b : boxes_)
    give_off_within(
        b, dt, air,
        [&](Vec3 p) {  // the overlap with a cell about the place
          double part = 1;
          for (int a = 0; a < grid_.axes(); ++a) {
            const double x = place(p)[a], overlap = std::min(x + grid_.h / 2, b.hi[a]) - std::max(x - grid_.h / 2, b.lo[a]);
            part *= std::clamp(overlap / grid_.h, 0.0, 1.0);
          }
          return part;
        },
        even);
  if (shares_.values.empty()) return;
  Box3 all;
  all.add(grid_.origin), all.add(place(Vec3(double(grid_.cells[0]), double(grid_.cells[1]), double(grid_.cells[2]))));
  const auto share = [&](Vec3 p) {  // the mean of the cells beside a face
    double sum = 0;
    for (const double side : {-0.25, 0.25}) {
      const auto index = [&](int a) { return size_t(std::clamp(p[a] + side, 0.0, double(grid_.cells[size_t(a)]) - 1)); };
      sum += double(shares_(index(0), index(1), index(2)));
    }
    return sum / 2;
  };
  if (density_.values.empty()) return give_off_within(all, dt, air, share, even);
  give_off_within(all, dt, air, share, [&](size_t cell) {
    return std::array{T(params_.density) * density_.values[cell], T(params_.temperature) * temperature_.values[cell]};
  });
}

template class Emission<float>;
template class Emission<double>;

}  // namespace sg::fluid
