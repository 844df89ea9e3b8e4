// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/switch_points.h"

#include <algorithm>
#include <unordered_map>

#include "data/cell_map.h"
#include "data/cell_topology.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

struct Edge {
  int64_t a, b;  // the mesh lies to the left
  Vec3 at_a, at_b;
  int64_t cell;
};

// Edges that one cell alone has, in order of the cells.
std::vector<Edge> border_edges(const DatasetPtr& d, const PlaneFrame& frame, Context& context) {
  CellReader reader(d);
  std::vector<Edge> all;
  std::vector<uint32_t> ring;
  for (size_t c = 0; c < reader.count(); ++c) {
    if (c % 65536 == 0) context.check();
    if (reader.hidden(c)) continue;
    reader.open(c);
    if (reader.dimension() != 2) continue;
    const auto ids = reader.ids();
    const auto at = reader.at();
    ring.clear();
    std::vector<std::vector<uint32_t>> rings;
    if (reader.type() == CellType::triangle_strip) {
      for (uint32_t k = 0; k + 2 < ids.size(); ++k) rings.push_back({k, k + 1, k + 2});
    } else {
      face_outline(reader.type(), ids.size(), ring, reader.orders());
      rings.push_back(ring);
    }
    for (const auto& r : rings) {
      double area = 0;
      for (size_t k = 0; k < r.size(); ++k) area += dot(frame.normal, cross(at[r[k]] - at[r[0]], at[r[(k + 1) % r.size()]] - at[r[0]]));
      for (size_t k = 0; k < r.size(); ++k) {
        const uint32_t p = area >= 0 ? r[k] : r[(k + 1) % r.size()], q = area >= 0 ? r[(k + 1) % r.size()] : r[k];
        if (ids[p] != ids[q]) all.push_back({ids[p], ids[q], at[p], at[q], int64_t(c)});
      }
    }
  }
  std::vector<size_t> order(all.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  auto key = [&](size_t i) { return std::pair(std::min(all[i].a, all[i].b), std::max(all[i].a, all[i].b)); };
  std::sort(order.begin(), order.end(), [&](size_t i, size_t j) { return std::pair(key(i), i) < std::pair(key(j), j); });
  std::vector<size_t> single;
  for (size_t i = 0; i < order.size();) {
    size_t j = i;
    while (j < order.size() && key(order[j]) == key(order[i])) ++j;
    if (j == i + 1) single.push_back(order[i]);
    i = j;
  }
  std::sort(single.begin(), single.end());
  std::vector<Edge> out;
  for (const size_t i : single) out.push_back(all[i]);
  return out;
}

// Of an edge: what flows out at both ends, and, on walls, the shear along it.
struct Flux {
  Vec3 along, outward;
  double length = 0;
  double out[2] = {0, 0}, shear[2] = {0, 0};
  bool valid = false, wall = false, tangent = false;
};

class Border {
 public:
  Border(const FlowField& flow, const PlaneFrame& frame, Context& context)
      : flow_(flow), frame_(frame), edges_(border_edges(flow.dataset(), frame, context)), map_(flow.dataset()) {
    for (size_t i = 0; i < edges_.size(); ++i) {
      flux_.push_back(flux_of(edges_[i]));
      starting_.try_emplace(edges_[i].a, i);
    }
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
        touch(edges_[i], lerp(edges_[i].at_a, edges_[i].at_b, t), f.outward, velocity(edges_[i].a) * (1 - t) + velocity(edges_[i].b) * t,
              f.along, f.out[0] > 0, f.length, out);
      }
      corner(i, out);
    }
    return out;
  }

 private:
  Vec3 velocity(int64_t id) const {
    const Vec3 v = flow_.at_point(size_t(id));
    return v - frame_.normal * dot(frame_.normal, v);
  }

  Flux flux_of(const Edge& e) {
    Flux f;
    f.along = normalize(e.at_b - e.at_a), f.length = length(e.at_b - e.at_a);
    f.outward = cross(f.along, frame_.normal);
    const Vec3 v[2] = {velocity(e.a), velocity(e.b)};
    for (int k = 0; k < 2; ++k) f.out[k] = dot(v[k], f.outward);
    const double noise = 1e-7 * flow_.largest_speed();
    f.valid = f.length > 0 && std::isfinite(f.out[0] + f.out[1]);
    f.tangent = std::abs(f.out[0]) <= noise && std::abs(f.out[1]) <= noise;
    f.wall = f.valid && length(v[0]) <= noise && length(v[1]) <= noise;
    if (f.wall) wall_shear(e, f);
    return f;
  }

  void wall_shear(const Edge& e, Flux& f) {
    map_.open(size_t(e.cell));
    const auto ids = map_.reader().ids();
    std::vector<Vec3> slope(ids.size());
    for (int k = 0; k < 2; ++k) {
      CellPlace place;
      // A little inside, so that the place is found.
      if (!map_.locate((k ? e.at_b : e.at_a) - 1e-6 * f.length * f.outward, place, 1e-3)) {
        f.wall = f.valid = false;
        return;
      }
      map_.gradient_weights(place, slope);
      for (size_t i = 0; i < ids.size(); ++i) f.shear[k] += dot(velocity(ids[i]), f.along) * dot(slope[i], -f.outward);
    }
    if (!std::isfinite(f.shear[0] + f.shear[1])) f.wall = f.valid = false;
  }

  // The flow runs along the border; from inside, where it goes out before the place and in behind it.
  void touch(const Edge& e, Vec3 at, Vec3 outward, Vec3 v, Vec3 along, bool out_before, double size, std::vector<SwitchPoint>& out) {
    const double with = dot(v, along);
    if (with == 0) return;
    out.push_back({at, -outward, (with > 0) == out_before ? SwitchType::inner : SwitchType::outer, e.cell, size});
  }

  // Shear along the way from positive to negative: the flow meets there and leaves the wall.
  void change(const Edge& e, const Flux& f, const double* shear, std::vector<SwitchPoint>& out) {
    if (!(shear[0] * shear[1] < 0)) return;
    out.push_back({lerp(e.at_a, e.at_b, shear[0] / (shear[0] - shear[1])), -f.outward,
                   shear[0] > 0 ? SwitchType::detachment : SwitchType::attachment, e.cell, f.length});
  }

  void corner(size_t i, std::vector<SwitchPoint>& out) {
    const auto next = starting_.find(edges_[i].b);
    if (next == starting_.end()) return;
    const Flux &f = flux_[i], &g = flux_[next->second];
    if (!g.valid || f.wall != g.wall) return;
    const Vec3 outward = normalize(f.outward + g.outward), at = edges_[i].at_b;
    if (f.wall) {
      if (f.shear[1] * g.shear[0] < 0)
        out.push_back({at, -outward, f.shear[1] > 0 ? SwitchType::detachment : SwitchType::attachment, edges_[i].cell, f.length});
    } else if (!f.tangent && !g.tangent && f.out[1] * g.out[0] < 0) {
      touch(edges_[i], at, outward, velocity(edges_[i].b), f.along + g.along, f.out[1] > 0, f.length, out);
    } else if (!f.tangent && !g.tangent && f.out[1] == 0 && f.out[0] * g.out[1] < 0) {
      touch(edges_[i], at, outward, velocity(edges_[i].b), f.along + g.along, f.out[0] > 0, f.length, out);
    }
  }

  const FlowField& flow_;
  const PlaneFrame& frame_;
  std::vector<Edge> edges_;
  CellMap map_;
  std::vector<Flux> flux_;
  std::unordered_map<int64_t, size_t> starting_;
};

}  // namespace

std::string_view switch_type_name(SwitchType t) {
  constexpr std::string_view names[] = {"outer", "inner", "detachment", "attachment"};
  return names[int(t)];
}

std::vector<SwitchPoint> find_switch_points(const FlowField& flow, const PlaneFrame& frame, Context& context) {
  if (flow.dataset()->as<AmrGrid>()) return {};
  return Border(flow, frame, context).points();
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
