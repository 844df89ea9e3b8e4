// SPDX-License-Identifier: Apache-2.0
// A system whose energies and places are expressions of its coordinates.
#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "simulate/mechanics/expression.h"
#include "simulate/mechanics/mechanics.h"

namespace sg::mechanics {

namespace {

struct ByExpression {
  std::vector<std::string> names;
  std::vector<double> q, v;
  Expression of_speed, of_place;
  std::vector<Expression> places;  // x, y, z of each body

  int size() const { return int(names.size()); }
  std::string coordinate(int i) const { return names[size_t(i)]; }
  std::vector<double> start() const { return q; }
  std::vector<double> start_speed() const { return v; }
  std::vector<std::pair<int, int>> rods() const {
    std::vector<std::pair<int, int>> r;
    for (int i = 0; i < int(places.size() / 3); ++i) r.emplace_back(i, i + 1);
    return r;
  }
  template <class X>
  X kinetic(std::span<const X> at, std::span<const X> speed) const {
    std::vector<X> all(at.begin(), at.end());
    all.insert(all.end(), speed.begin(), speed.end());
    return of_speed.value<X>(all);
  }
  template <class X>
  X potential(std::span<const X> at) const {
    return of_place.value<X>(at);
  }
  template <class X>
  std::vector<PlaceOf<X>> bodies(std::span<const X> at) const {
    std::vector<PlaceOf<X>> r{{X(0), X(0), X(0)}};
    for (size_t i = 0; i < places.size(); i += 3)
      r.push_back({places[i].value<X>(at), places[i + 1].value<X>(at), places[i + 2].value<X>(at)});
    return r;
  }
};

}  // namespace

std::shared_ptr<const System> expression_system(const MechanicsParams& p) {
  const char* hint = "e.g. coordinates=a kinetic='a_dot^2/2' potential='-9.81*cos(a)' start=1 places='sin(a); -cos(a); 0'";
  if (p.coordinates.empty() || p.kinetic.empty()) fail_usage("no coordinates or no kinetic energy is given", "mechanics", hint);
  std::vector<std::string> both = p.coordinates;
  for (const std::string& name : p.coordinates) both.push_back(name + "_dot");
  for (size_t i = 0; i < both.size(); ++i)
    if (both[i].empty() || std::count(both.begin(), both.end(), both[i]) > 1)
      fail_usage(fmt::format("'{}' is no name, or that of two", both[i]), "mechanics coordinates");
  std::vector<Expression> places;
  for (size_t begin = 0; begin < p.places.size();) {
    const size_t end = std::min(p.places.find(';', begin), p.places.size());
    places.emplace_back(std::string_view(p.places).substr(begin, end - begin), p.coordinates, "places");
    begin = end + 1;
  }
  if (places.empty())  // the coordinates themselves
    for (size_t i = 0; i < 3; ++i)
      places.emplace_back(i < p.coordinates.size() ? "\"" + p.coordinates[i] + "\"" : "0", p.coordinates, "places");
  if (places.size() % 3 != 0)
    fail_usage(fmt::format("{} numbers are no places", places.size()), "mechanics places", "give x; y; z of each");
  const size_t n = p.coordinates.size();
  std::vector<double> q = p.start, v = p.speed;
  if (q.empty()) q.assign(n, 0);
  if (v.empty()) v.assign(n, 0);
  return std::make_shared<SystemOf<ByExpression>>(
      ByExpression{p.coordinates, q, v, Expression(p.kinetic, both, "kinetic"),
                   Expression(p.potential.empty() ? "0" : p.potential, p.coordinates, "potential"), std::move(places)});
}

}  // namespace sg::mechanics
