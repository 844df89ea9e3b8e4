// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/switch_points.h"

#include <algorithm>
#include <array>
#include <map>

#include "data/cells/shape/cell_map.h"
#include "filter/flow/topology/border_edges.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

// Of an edge: what flows out at both ends, and, on walls, the shear along it.
struct Flux {
  Vec3 along, outward;
  double length = 0, speed = 0;
  double out[2] = {0, 0}, shear[2] = {0, 0};
  bool valid = false, wall = false, tangent = false;
};

class Border {
 public:
  Border(const FlowParts& flow, const PlaneFrame& frame, Context& context)
      : flow_(flow), frame_(frame), edges_(border_edges(flow, frame, context)), largest_(flow.largest_speed()) {
    for (const FlowField& f : flow.fields()) maps_.emplace_back(f.dataset());
    for (size_t i = 0; i < edges_.size(); ++i) {
      flux_.push_back(flux_of(edges_[i]));
      starting_.try_emplace(place(edges_[i].at_a), i);
    }
  }

  // Along each border, one stretch of like flow after the other: its first, middle and last edge.
  std::vector<BorderSeed> seeds() const {
    std::vector<BorderSeed> out;
    std::vector<uint8_t> seen(edges_.size(), 0);
    for (size_t first = 0; first < edges_.size(); ++first) {
      if (seen[first]) continue;
      std::vector<size_t> loop;
      for (size_t i = first; !seen[i];) {
        seen[i] = 1, loop.push_back(i);
        const auto next = starting_.find(place(edges_[i].at_b));
        if (next == starting_.end()) break;
        i = next->second;
      }
      for (size_t begin = 0, end; begin < loop.size(); begin = end) {
        end = begin + 1;
        while (end < loop.size() && way(loop[end]) == way(loop[begin])) ++end;
        std::vector<size_t> some{begin, (begin + end) / 2, end - 1};
        some.erase(std::unique(some.begin(), some.end()), some.end());
        for (const size_t k : some) add_seed(loop[k], out);
      }
    }
    return out;
  }

  std::vector<SwitchPoint> points() {
    std::vector<SwitchPoint> out;
    for (size_t i = 0; i < edges_.size(); ++i) {
      const Flux& f = flux_[i];
      if (!f.valid) continue;
      if (f.wall) {
        change(edges_[i], f, f.shear, out);
      } else if (!f.tangent && (f.out[0] > 0) != (f.out[1] > 0)) {
        const double t = f.out[0] / (f.out[0] - f.out[1]);
        touch(edges_[i], lerp(edges_[i].at_a, edges_[i].at_b, t), f.outward,
              velocity(edges_[i], edges_[i].a) * (1 - t) + velocity(edges_[i], edges_[i].b) * t, f.along, f.out[0] > 0, f.length, out);
      }
      corner(i, out);
    }
    return out;
  }

 private:
  using Place = std::array<double, 3>;
  static Place place(Vec3 x) { return {x.x, x.y, x.z}; }
  Vec3 velocity(const BorderEdge& e, int64_t id) const {
    const Vec3 v = flow_.fields()[size_t(e.part)].at_point(size_t(id));
    return v - frame_.normal * dot(frame_.normal, v);
  }

  // 1 in, -1 out, 0 along or standing.
  int way(size_t i) const {
    const Flux& f = flux_[i];
    const double out = 0.5 * (f.out[0] + f.out[1]);
    return !f.valid || f.wall || f.tangent || std::abs(out) <= 1e-3 * f.speed ? 0 : out < 0 ? 1 : -1;
  }
  void add_seed(size_t i, std::vector<BorderSeed>& out) const {
    if (!flux_[i].valid) return;
    const BorderEdge& e = edges_[i];
    const Vec3 at = lerp(e.at_a, e.at_b, 0.5) - 0.2 * flux_[i].length * flux_[i].outward;
    for (const int sign : {1, -1})
      if (way(i) == 0 || way(i) == sign) out.push_back({at, double(sign)});
  }

  Flux flux_of(const BorderEdge& e) {
    Flux f;
    f.along = normalize(e.at_b - e.at_a), f.length = length(e.at_b - e.at_a);
    f.outward = cross(f.along, frame_.normal);
    const Vec3 v[2] = {velocity(e, e.a), velocity(e, e.b)};
    for (int k = 0; k < 2; ++k) f.out[k] = dot(v[k], f.outward);
    f.speed = std::max(sg::length(v[0]), sg::length(v[1]));
    const double noise = 1e-7 * largest_;
    f.valid = f.length > 0 && std::isfinite(f.out[0] + f.out[1]);
    f.tangent = std::abs(f.out[0]) <= noise && std::abs(f.out[1]) <= noise;
    f.wall = f.valid && length(v[0]) <= noise && length(v[1]) <= noise;
    if (f.wall) wall_shear(e, f);
    return f;
  }

  void wall_shear(const BorderEdge& e, Flux& f) {
    CellMap& map = maps_[size_t(e.part)];
    map.open(size_t(e.cell));
    const auto ids = map.reader().ids();
    std::vector<Vec3> slope(ids.size());
    for (int k = 0; k < 2; ++k) {
      CellPlace place;
      // A little inside, so that the place is found.
      if (!map.locate((k ? e.at_b : e.at_a) - 1e-6 * f.length * f.outward, place, 1e-3)) {
        f.wall = f.valid = false;
        return;
      }
      map.gradient_weights(place, slope);
      for (size_t i = 0; i < ids.size(); ++i) f.shear[k] += dot(velocity(e, ids[i]), f.along) * dot(slope[i], -f.outward);
    }
    if (!std::isfinite(f.shear[0] + f.shear[1])) f.wall = f.valid = false;
  }

  // The flow runs along the border; from inside, where it goes out before the place and in behind it.
  void touch(const BorderEdge& e, Vec3 at, Vec3 outward, Vec3 v, Vec3 along, bool out_before, double size, std::vector<SwitchPoint>& out) {
    const double with = dot(v, along);
    if (with == 0) return;
    out.push_back({at, -outward, (with > 0) == out_before ? SwitchType::inner : SwitchType::outer, e.cell, size, e.part});
  }

  // Shear along the way from positive to negative: the flow meets there and leaves the wall.
  void change(const BorderEdge& e, const Flux& f, const double* shear, std::vector<SwitchPoint>& out) {
    if (!(shear[0] * shear[1] < 0)) return;
    out.push_back({lerp(e.at_a, e.at_b, shear[0] / (shear[0] - shear[1])), -f.outward,
                   shear[0] > 0 ? SwitchType::detachment : SwitchType::attachment, e.cell, f.length, e.part});
  }

  void corner(size_t i, std::vector<SwitchPoint>& out) {
    const auto next = starting_.find(place(edges_[i].at_b));
    if (next == starting_.end()) return;
    const Flux &f = flux_[i], &g = flux_[next->second];
    if (!g.valid || f.wall != g.wall) return;
    const Vec3 outward = normalize(f.outward + g.outward), at = edges_[i].at_b;
    if (f.wall) {
      if (f.shear[1] * g.shear[0] < 0)
        out.push_back(
            {at, -outward, f.shear[1] > 0 ? SwitchType::detachment : SwitchType::attachment, edges_[i].cell, f.length, edges_[i].part});
    } else if (!f.tangent && !g.tangent && f.out[1] * g.out[0] < 0) {
      touch(edges_[i], at, outward, velocity(edges_[i], edges_[i].b), f.along + g.along, f.out[1] > 0, f.length, out);
    } else if (!f.tangent && !g.tangent && f.out[1] == 0 && f.out[0] * g.out[1] < 0) {
      touch(edges_[i], at, outward, velocity(edges_[i], edges_[i].b), f.along + g.along, f.out[0] > 0, f.length, out);
    }
  }

  const FlowParts& flow_;
  const PlaneFrame& frame_;
  std::vector<BorderEdge> edges_;
  std::vector<CellMap> maps_;
  double largest_;
  std::vector<Flux> flux_;
  std::map<Place, size_t> starting_;
};

}  // namespace

std::string_view switch_type_name(SwitchType t) {
  constexpr std::string_view names[] = {"outer", "inner", "detachment", "attachment"};
  return names[int(t)];
}

std::vector<SwitchPoint> find_switch_points(const FlowParts& flow, const PlaneFrame& frame, Context& context) {
  return Border(flow, frame, context).points();
}

std::vector<BorderSeed> border_seeds(const FlowParts& flow, const PlaneFrame& frame, Context& context) {
  return Border(flow, frame, context).seeds();
}

DatasetPtr switch_points_dataset(const std::vector<SwitchPoint>& points) {
  std::vector<double> xyz;
  std::vector<int32_t> type;
  std::vector<int64_t> cell;
  for (const SwitchPoint& p : points) {
    xyz.insert(xyz.end(), {p.at.x, p.at.y, p.at.z});
    type.push_back(int32_t(p.type)), cell.push_back(p.cell);
  }
  DatasetParts parts;
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::move(xyz), 3);
  parts.mesh = std::move(cloud);
  parts.fields.add({"type", Association::point, Array::from_vector(std::move(type)), "", Role::labels});
  parts.fields.add(id_field("cell", Association::point, std::move(cell)));
  parts.notes.emplace_back("labels of type", "0=outer\n1=inner\n2=detachment\n3=attachment");
  return make_dataset(std::move(parts));
}

}  // namespace sg
