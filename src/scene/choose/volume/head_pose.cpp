// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/volume/head_pose.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "data/memory/memo.h"
#include "data/patient/patient_frame.h"
#include "scene/choose/volume/look.h"

namespace sg {

namespace {

// One slice at few samples: what is tissue or bone, and what is bone.
struct Slice {
  size_t nx = 0, ny = 0;
  std::vector<uint8_t> body, bone;
};

Slice slice_of(const Field& field, std::array<size_t, 3> dims, size_t k, double offset) {
  constexpr size_t most = 128;
  constexpr double air = -300, bone = 300;  // Hounsfield units
  const size_t step = std::max<size_t>(1, (std::max(dims[0], dims[1]) + most - 1) / most);
  Slice s{dims[0] / step, dims[1] / step, {}, {}};
  s.body.resize(s.nx * s.ny), s.bone.resize(s.nx * s.ny);
  dispatch(field.array, [&](auto v) {
    for (size_t j = 0; j < s.ny; ++j)
      for (size_t i = 0; i < s.nx; ++i) {
        double middle = 0, densest = -HUGE_VAL;
        for (size_t b = 0; b < step; ++b)
          for (size_t a = 0; a < step; ++a) {
            const double hu = double(v[i * step + a + dims[0] * (j * step + b + dims[1] * k)]) - offset;
            middle += hu / double(step * step), densest = std::max(densest, hu);
          }
        s.body[i + s.nx * j] = middle > air, s.bone[i + s.nx * j] = densest > bone;  // thin bone stays closed
      }
  });
  return s;
}

// What cannot be reached from the border of the slice without crossing a wall.
std::vector<uint8_t> enclosed(const std::vector<uint8_t>& wall, size_t nx, size_t ny) {
  std::vector<uint8_t> inside(wall.size());
  std::transform(wall.begin(), wall.end(), inside.begin(), [](uint8_t w) { return uint8_t(!w); });
  std::vector<size_t> open;
  const auto reach = [&](size_t at) {
    if (inside[at]) inside[at] = 0, open.push_back(at);
  };
  for (size_t i = 0; i < nx; ++i) reach(i), reach(i + nx * (ny - 1));
  for (size_t j = 0; j < ny; ++j) reach(nx * j), reach(nx - 1 + nx * j);
  while (!open.empty()) {
    const size_t at = open.back(), i = at % nx, j = at / nx;
    open.pop_back();
    if (i > 0) reach(at - 1);
    if (i + 1 < nx) reach(at + 1);
    if (j > 0) reach(at - nx);
    if (j + 1 < ny) reach(at + nx);
  }
  return inside;
}

}  // namespace

HeadPose head_pose(const Dataset& data, const Field& field, double offset) {
  const auto* grid = data.as<UniformGrid>();
  constexpr size_t few = 8, looked_at = 32;
  if (!grid || field.association != Association::point || *std::min_element(grid->dims.begin(), grid->dims.end()) < few) return {};
  struct Counts {
    double samples = 0, body = 0, brain = 0, body_y = 0, air_y = 0, air = 0;
  };
  const size_t slices = std::min(grid->dims[2], looked_at);
  std::vector<Counts> counts(slices);
  parallel_for(slices, 1, [&](size_t n, size_t) {
    const Slice s = slice_of(field, grid->dims, n * (grid->dims[2] - 1) / (slices - 1), offset);
    const std::vector<uint8_t> skull = enclosed(s.bone, s.nx, s.ny), cavity = enclosed(s.body, s.nx, s.ny);
    Counts c;
    c.samples = double(s.body.size());
    for (size_t at = 0; at < s.body.size(); ++at) {
      const double y = double(at / s.nx) / double(s.ny);
      if (s.body[at]) c.body += 1, c.body_y += y;
      if (s.body[at] && skull[at]) c.brain += 1;
      if (cavity[at]) c.air_y += y, c.air += 1;
    }
    counts[n] = c;
  });
  std::vector<double> shares;  // of the body that bone encloses, slice by slice
  double body_y = 0, bodies = 0, air_y = 0, airs = 0;
  for (const Counts& c : counts) {
    body_y += c.body_y, bodies += c.body, air_y += c.air_y, airs += c.air;
    constexpr double least = 0.03;  // of the slice: else nothing of the patient is in it
    if (c.body > least * c.samples) shares.push_back(c.brain / c.body);
  }
  HeadPose pose;
  constexpr double aside = 0.02, skull = 0.45;  // of the slice, of the body
  constexpr ptrdiff_t least_slices = 2, clearly = 4;
  const auto middle = shares.begin() + ptrdiff_t(shares.size() / 2);
  const auto is_skull = [](double share) { return share > skull; };
  const ptrdiff_t low = std::count_if(shares.begin(), middle, is_skull), high = std::count_if(middle, shares.end(), is_skull);
  if (high >= least_slices && high >= clearly * low) pose.crown = 1;
  if (low >= least_slices && low >= clearly * high) pose.crown = -1;
  if (pose.crown != 0 && airs > 0 && bodies > 0) {
    const double off = air_y / airs - body_y / bodies;
    if (std::abs(off) > aside) pose.face = off < 0 ? -1 : 1;
  }
  return pose;
}

namespace {

std::optional<HeadPose> pose_of_first_ct(const Dataset& d) {
  for (const Field& f : d.fields())
    if (double offset = 0; looks_like_ct(d, f, &offset)) return head_pose(d, f, offset);
  return {};
}

}  // namespace

std::optional<HeadPose> unstated_pose(const Dataset& d) {
  using Pose = std::optional<HeadPose>;
  if (!d.as<UniformGrid>() || in_patient_frame(d)) return {};
  constexpr const char* key = "unstated head pose";
  if (const auto known = d.memo().find<Pose>(key)) return *known;  // each edit of a window asks again
  return *d.memo().keep(key, pose_of_first_ct(d), sizeof(Pose));
}

bool stand_up(const HeadPose& pose, CameraDefaults& camera) {
  if (pose.crown == 0 || camera.parallel) return false;
  const double up = pose.crown, front = pose.face > 0 ? 1 : -1;
  camera.up = {0, 0, up};
  camera.direction = {0.4, front, 0.25 * up};
  camera.axes = {{0, front, 0}, {-front * up, 0, 0}, {0, 0, up}, {0, front, 0}};
  return true;
}

}  // namespace sg
