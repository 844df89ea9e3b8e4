// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/line_mesh.h"

#include <fmt/core.h>

#include <numeric>

#include "base/parallel.h"
#include "data/fields/known_looks.h"
#include "data/trusted.h"

namespace sg {

namespace {

// The arrays of the mesh, to be filled line by line.
struct LineArrays {
  float *xyz = nullptr, *speed = nullptr, *v = nullptr, *time = nullptr, *arc = nullptr;
  Points points;
  FieldSet fields;

  LineArrays(size_t n, const std::string& velocity_name, const std::string& unit) {
    points.xyz = Array::make<float>(n, 3, &xyz);
    fields.add({own_value("speed", velocity_name), Association::point, Array::make<float>(n, 1, &speed), unit, Role::scalars,
                known_look("speed")});
    fields.add({velocity_name, Association::point, Array::make<float>(n, 3, &v), unit, Role::vectors});
    fields.add({own_value("time", velocity_name), Association::point, Array::make<float>(n, 1, &time), "", Role::none});
    fields.add({own_value("length", velocity_name), Association::point, Array::make<float>(n, 1, &arc), "", Role::none});
  }
  DatasetPtr finish(std::vector<int64_t> begin, std::vector<int64_t> seed, std::vector<uint8_t> stop) {
    SurfaceMesh mesh;
    mesh.points = std::move(points);
    const size_t n = mesh.points.count();
    if (n < size_t(INT32_MAX)) {
      int32_t* id = nullptr;
      mesh.lines.connectivity = Array::make<int32_t>(n, 1, &id);
      parallel_for(n, 1 << 16, [&](size_t from, size_t to) { std::iota(id + from, id + to, int32_t(from)); });
    } else {
      int64_t* id = nullptr;
      mesh.lines.connectivity = Array::make<int64_t>(n, 1, &id);
      parallel_for(n, 1 << 16, [&](size_t from, size_t to) { std::iota(id + from, id + to, int64_t(from)); });
    }
    mesh.lines.offsets = Array::from_vector(std::move(begin));
    fields.add({"seed", Association::cell, Array::from_vector(std::move(seed)), "", Role::none});
    fields.add({"stop", Association::cell, Array::from_vector(std::move(stop)), "", Role::labels});
    DatasetParts parts{std::move(mesh), std::move(fields), {}, {}, {}, {}};
    std::string words;
    for (int r = 0; r <= int(StopReason::error); ++r) words += fmt::format("{}{} {}", r ? ", " : "", r, word_of(StopReason(r)));
    parts.notes.emplace_back("stop", words);
    return make_trusted_dataset(std::move(parts));
  }
};

}  // namespace

std::string own_value(std::string_view value, std::string_view velocity) { return std::string(value) + (value == velocity ? "_2" : ""); }

Vec3 near_origin(const Box3& box) { return !box.empty() && length(box.center()) > 8 * box.diagonal() ? box.center() : Vec3(); }

DatasetPtr lines_dataset(const TracedLines& lines, const std::string& velocity_name, const std::string& unit) {
  std::vector<int64_t> begin{0}, seed;
  std::vector<size_t> first;
  std::vector<uint8_t> stop;
  Box3 box;
  for (size_t l = 0; l < lines.lines(); ++l) {
    const size_t n = lines.begin[l + 1] - lines.begin[l];
    if (n < 2) continue;
    begin.push_back(begin.back() + int64_t(n)), first.push_back(lines.begin[l]);
    seed.push_back(lines.seed[l]), stop.push_back(uint8_t(lines.stop[l]));
    for (size_t i = lines.begin[l]; i < lines.begin[l + 1]; ++i) box.add(lines.points[i]);
  }
  LineArrays out(size_t(begin.back()), velocity_name, unit);
  out.points.origin = near_origin(box);
  parallel_for(first.size(), 64, [&](size_t from, size_t to) {
    for (size_t l = from; l < to; ++l)
      for (size_t i = size_t(begin[l]), k = first[l]; i < size_t(begin[l + 1]); ++i, ++k) {
        const Vec3 x = lines.points[k] - out.points.origin;
        for (int a = 0; a < 3; ++a) out.xyz[3 * i + size_t(a)] = float(x[a]), out.v[3 * i + size_t(a)] = float(lines.velocity[k][a]);
        out.speed[i] = float(length(lines.velocity[k])), out.time[i] = float(lines.time[k]), out.arc[i] = float(lines.arc[k]);
      }
  });
  return out.finish(std::move(begin), std::move(seed), std::move(stop));
}

DatasetPtr lines_dataset(const packets::SeedLines& lines, const std::string& velocity_name, const std::string& unit) {
  using packets::Piece;
  using packets::Record;
  std::vector<int64_t> begin{0}, seed;
  std::vector<uint8_t> stop;
  for (size_t s = 0; s < lines.forward.size(); ++s) {
    const Piece &b = lines.backward[s], &f = lines.forward[s];
    const size_t n = b.count + f.count - (b.count > 0 && f.count > 0);
    if (n < 2) continue;
    begin.push_back(begin.back() + int64_t(n)), seed.push_back(int64_t(s));
    stop.push_back(uint8_t(f.count > 0 ? f.stop : b.stop));
  }
  LineArrays out(size_t(begin.back()), velocity_name, unit);
  const Box3 box = parallel_reduce(
      seed.size(), 256, Box3{},
      [&](size_t from, size_t to) {
        Box3 some;
        for (size_t l = from; l < to; ++l)
          for (const Piece* p : {&lines.backward[size_t(seed[l])], &lines.forward[size_t(seed[l])]})
            for (size_t i = 0; i < p->count; i += 8) {  // nearly: it only separates near from far
              const Record& r = p->first[i];
              some.add(lines.origin + Vec3(double(r.x[0]), double(r.x[1]), double(r.x[2])));
            }
        return some;
      },
      [](Box3 a, Box3 b) {
        a.add(b);
        return a;
      });
  out.points.origin = near_origin(box);
  const Vec3 shift = lines.origin - out.points.origin;
  const auto put = [&](const Record& r, size_t i, float sign) {
    for (int a = 0; a < 3; ++a) out.xyz[3 * i + size_t(a)] = float(shift[a] + double(r.x[a])), out.v[3 * i + size_t(a)] = r.v[a];
    out.speed[i] = std::sqrt(r.v[0] * r.v[0] + r.v[1] * r.v[1] + r.v[2] * r.v[2]), out.time[i] = r.time, out.arc[i] = sign * r.arc;
  };
  parallel_for(seed.size(), 64, [&](size_t from, size_t to) {
    for (size_t l = from; l < to; ++l) {
      const Piece &b = lines.backward[size_t(seed[l])], &f = lines.forward[size_t(seed[l])];
      size_t i = size_t(begin[l]);
      for (size_t k = b.count; k-- > 0;) put(b.first[k], i++, -1);
      for (size_t k = b.count > 0 ? 1 : 0; k < f.count; ++k) put(f.first[k], i++, 1);
    }
  });
  return out.finish(std::move(begin), std::move(seed), std::move(stop));
}

}  // namespace sg
