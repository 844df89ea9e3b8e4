// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/bodies/spring_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/cells/cell_reader.h"
#include "simulate/particles/bodies/face_contact.h"
#include "simulate/particles/local_forces.h"
#include "simulate/particles/scheme.h"
#include "simulate/run/frames.h"

namespace sg {

void describe(Schema& s, SpringMeshParams& p) {
  s("stiffness", p.stiffness, "Force per length of each spring.").positive();
  s("damping", p.damping, "Force per speed at which its ends part.").at_least(0);
  s("hold", p.hold, "Numbers of the points that stay where they are.");
  describe(s, static_cast<MotionParams&>(p));
}

namespace swarm {

Springs springs_of(const DatasetPtr& data) {
  if (!data->as<SurfaceMesh>() && !data->as<UnstructuredMesh>())
    fail_usage("it takes surfaces and unstructured meshes", "spring_mesh", "convert it: -f unstructured");
  std::vector<std::pair<uint32_t, uint32_t>> pairs;
  const auto add = [&](int64_t a, int64_t b) {
    if (a != b) pairs.emplace_back(uint32_t(a), uint32_t(b)), pairs.emplace_back(uint32_t(b), uint32_t(a));
  };
  CellReader reader(data);
  for (size_t c = 0; c < data->cell_count(); ++c) {
    reader.open(c);
    const auto ids = reader.ids();
    if (reader.dimension() >= 2 && ids.size() <= 8) {
      for (size_t i = 0; i < ids.size(); ++i)
        for (size_t j = i + 1; j < ids.size(); ++j) add(ids[i], ids[j]);
    } else {
      for (size_t i = 0; i + 1 < ids.size(); ++i) add(ids[i], ids[i + 1]);
      if (reader.dimension() >= 2) add(ids.back(), ids.front());
    }
  }
  if (pairs.empty())
    fail_usage("the mesh has no cells whose edges could be springs", "spring_mesh", "give lines, a surface or solid cells");
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  const Points* points = data->as<SurfaceMesh>() ? &data->as<SurfaceMesh>()->points : &data->as<UnstructuredMesh>()->points;
  Springs s;
  s.begin.assign(data->point_count() + 1, 0);
  for (const auto& [a, b] : pairs) ++s.begin[a + 1], s.other.push_back(b), s.rest.push_back(length(points->at(a) - points->at(b)));
  for (size_t i = 0; i + 1 < s.begin.size(); ++i) s.begin[i + 1] += s.begin[i];
  return s;
}

namespace {

constexpr size_t most_rounds = 20;  // of pushing back in a step; whoever still meets something then stays where the step began

class SpringMeshRun {
 public:
  SpringMeshRun(const SpringMeshParams& p, DatasetPtr data, const std::vector<DatasetPtr>& surfaces, Context& context)
      : params_(p),
        data_(std::move(data)),
        springs_(springs_of(data_)),
        obstacles_(obstacles_of(p, surfaces, "spring_mesh", context)),
        faces_(data_, surfaces, {p.restitution, p.friction}, "spring_mesh", context) {
    check(p, "spring_mesh");
    if (!std::isfinite(p.stiffness + p.damping)) fail_usage("stiffness and damping are finite numbers", "spring_mesh");
    const Points& points = points_of(data_->parts().mesh);
    for (size_t i = 0; i < points.count(); ++i) {
      x_.push_back(points.at(i));
      if (!std::isfinite(x_[i].x + x_[i].y + x_[i].z)) fail_data(fmt::format("point {} is nowhere", i), "spring_mesh");
    }
    v_.assign(x_.size(), {}), held_.assign(x_.size(), 0);
    for (const double h : p.hold) {
      if (!(h >= 0 && h < double(x_.size()) && h == std::floor(h)))
        fail_usage(fmt::format("there is no point {}", exact_number(h)), "spring_mesh hold",
                   fmt::format("points are 0 to {}", x_.size() - 1));
      held_[size_t(h)] = 1;
    }
    local_.gravity = p.gravity.value_or(Vec3(0, 0, -9.81)), local_.drag = p.drag, local_.quadratic = p.quadratic_drag, local_.mass = p.mass;
    surfaces_ = surfaces;
  }

  size_t frame() const { return frame_; }

  void advance(const Context& context) {
    const size_t steps = steps_of(params_, "spring_mesh");
    const double h = params_.frame / double(steps);
    for (size_t k = 0; k < steps; ++k) {
      context.check();
      const std::vector<Vec3> x0 = x_, v0 = v_;
      swarm::advance(
          params_.integrator,
          [&](std::span<const Vec3> x, std::span<const Vec3> v, double t, std::span<Vec3> a) { pull(x, v, t, a, context); }, 0, h, x_, v_,
          scratch_, true);
      for (size_t i = 0; i < x_.size(); ++i)
        if (!std::isfinite(length(x_[i]) + length(v_[i])))
          fail_data(
              fmt::format("point {} grew beyond all numbers in frame {} (time {:.6g})", i, frame_ + 1, double(frame_ + 1) * params_.frame),
              "spring_mesh", "shorter steps, or backward_euler, stand stiff springs");
      keep_out(x0, v0, h, context);
    }
    ++frame_;
  }

  template <class F>
  void each_part(F&& f) {
    std::array<uint64_t, 1> count{frame_};
    f(count), f(x_), f(v_);
    frame_ = count[0];
  }

  DatasetPtr dataset(const Context&) const {
    DatasetParts parts = data_->parts();
    std::vector<double> xyz, velocity;
    for (size_t i = 0; i < x_.size(); ++i)
      for (int a = 0; a < 3; ++a) xyz.push_back(x_[i][a]), velocity.push_back(v_[i][a]);
    auto* const surface = std::get_if<SurfaceMesh>(&parts.mesh);
    Points& points = surface ? surface->points : std::get<UnstructuredMesh>(parts.mesh).points;
    points.origin = {}, points.xyz = Array::from_vector(std::move(xyz), 3);
    parts.fields.add({"velocity", Association::point, Array::from_vector(std::move(velocity), 3), "", Role::vectors});
    parts.time = double(frame_) * params_.frame;
    return make_dataset(std::move(parts));
  }

 private:
  static const Points& points_of(const Mesh& mesh) {
    if (const auto* s = std::get_if<SurfaceMesh>(&mesh)) return s->points;
    return std::get<UnstructuredMesh>(mesh).points;
  }
  void pull(std::span<const Vec3> x, std::span<const Vec3> v, double t, std::span<Vec3> a, const Context& context) const {
    parallel_for(
        x.size(), 1024,
        [&](size_t begin, size_t end) {
          local_(x.subspan(begin, end - begin), v.subspan(begin, end - begin), t, a.subspan(begin, end - begin));
          for (size_t i = begin; i < end; ++i) {
            Vec3 force;
            for (uint32_t k = springs_.begin[i]; k < springs_.begin[i + 1]; ++k) {
              const Vec3 d = x[springs_.other[k]] - x[i];
              const double l = length(d);
              if (!(l > 0)) continue;
              const Vec3 along = d * (1 / l);
              force += (params_.stiffness * (l - springs_.rest[k]) + params_.damping * dot(v[springs_.other[k]] - v[i], along)) * along;
            }
            a[i] = held_[i] ? Vec3() : a[i] + force * (1 / params_.mass);
          }
        },
        &context);
  }

  // The ways of a step end where points, faces and edges meet something.
  void keep_out(const std::vector<Vec3>& x0, const std::vector<Vec3>& v0, double h, const Context& context) {
    std::vector<uint8_t> moved(x_.size(), 1);
    const auto walk = [&] {
      if (obstacles_.empty()) return;
      parallel_for(
          x_.size(), 1024,
          [&](size_t begin, size_t end) {
            Obstacles::Walker walker(obstacles_);
            for (size_t i = begin; i < end; ++i)
              if (moved[i]) walker.walk(x0[i], v0[i], x_[i], v_[i], h);
          },
          &context);
    };
    walk();
    if (faces_.empty()) return;
    for (size_t round = 0; round < most_rounds + x_.size(); ++round) {
      std::fill(moved.begin(), moved.end(), 0);
      if (!faces_.push_back(x0, v0, x_, v_, held_, round >= most_rounds, moved, context)) return;
      walk();
    }
  }

  SpringMeshParams params_;
  DatasetPtr data_;
  std::vector<DatasetPtr> surfaces_;
  Springs springs_;
  Obstacles obstacles_;
  FaceContact faces_;
  LocalForces local_;
  std::vector<Vec3> x_, v_;
  std::vector<uint8_t> held_;
  Scratch scratch_;
  size_t frame_ = 0;
};

}  // namespace
}  // namespace swarm

RunCost cost_of_spring_mesh(const SpringMeshParams& p, uint64_t bytes) {
  swarm::check(p, "spring_mesh");
  const double points = double(bytes) / 72, looks = p.integrator == Integrator::backward_euler ? 60 : order_of(p.integrator);
  return cost_of_run(p, "spring_mesh", bytes + uint64_t(48 * points), points * (looks * 1.5e-7 + 1e-6),
                     double(swarm::steps_of(p, "spring_mesh")));
}

DatasetPtr spring_mesh(const std::vector<Data>& inputs, const SpringMeshParams& p, Context& context) {
  using Run = swarm::SpringMeshRun;
  swarm::check(p, "spring_mesh");
  std::vector<DatasetPtr> data;
  GivenData given;
  for (const Data& d : inputs) data.push_back(single_dataset(d, "spring_mesh")), given.add(data.back());
  return frame_of_run<Run>(
      "spring_mesh", p, [&] { return std::make_unique<Run>(p, data[0], std::vector<DatasetPtr>(data.begin() + 1, data.end()), context); },
      context, given);
}

}  // namespace sg
