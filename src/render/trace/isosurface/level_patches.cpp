// SPDX-License-Identifier: Apache-2.0
#include "render/trace/isosurface/level_patches.h"

#include <array>
#include <utility>
#include <vector>

#include "render/trace/sampling/local_frame.h"

namespace sg::trace {

using raster::PictureSet;
using raster::PlacedPicture;

struct LevelPatches::Patch {
  explicit Patch(const CellLocator& locator) : cursor(locator) {}

  /// Values at points of the data, and at the three corners.
  struct Values {
    const float* all;
    float* corners;
    int components;
  };
  void add(Array& values, int components) {
    if (values.empty()) return;
    const auto* all = reinterpret_cast<const float*>(values.raw());
    float* corners = nullptr;
    kept.push_back(std::exchange(values, Array::make<float>(3, components, &corners)));
    this->values.push_back({all, corners, components});
  }

  /// Of the place that the cursor found.
  void take(size_t corner) {
    const auto ids = cursor.ids();
    const auto weights = cursor.weights();
    for (const Values& v : values)
      for (int c = 0; c < v.components; ++c) {
        double sum = 0;
        for (size_t i = 0; i < ids.size(); ++i) sum += weights[i] * double(v.all[size_t(ids[i]) * size_t(v.components) + size_t(c)]);
        v.corners[corner * size_t(v.components) + size_t(c)] = float(sum);
      }
  }
  /// What is beyond the first corner from another one.
  void turn_over(size_t corner) {
    for (const Values& v : values)
      for (size_t c = 0; c < size_t(v.components); ++c)
        v.corners[corner * size_t(v.components) + c] = 2 * v.corners[c] - v.corners[corner * size_t(v.components) + c];
  }
  void repeat_first(size_t corner) {
    for (const Values& v : values) std::copy_n(v.corners, v.components, v.corners + corner * size_t(v.components));
  }

  LocatorCursor cursor;
  raster::PreparedItem item;
  float* xyz = nullptr;
  std::vector<Array> kept;
  std::vector<Values> values;
};

LevelPatches::LevelPatches(const SurfacePictures& pictures, const SurfaceMaterial& made_of, const DatasetPtr& data, double reach,
                           Context& context)
    : locator_(data, context), reach_(reach), patches_([this] { return make(); }) {
  whole_.made_of = made_of;
  whole_.pictures = raster::place_pictures(pictures, data);
}

LevelPatches::~LevelPatches() = default;

std::unique_ptr<LevelPatches::Patch> LevelPatches::make() const {
  auto patch = std::make_unique<Patch>(locator_);
  raster::PreparedItem& item = patch->item;
  item = whole_;
  item.triangles.positions = Array::make<float>(3, 3, &patch->xyz);
  uint32_t* corners = nullptr;
  item.triangles.triangles = Array::make<uint32_t>(1, 3, &corners);
  for (uint32_t k = 0; k < 3; ++k) corners[k] = k;
  item.triangles.count = 1;
  auto set = std::make_shared<PictureSet>(*whole_.pictures);
  for (std::optional<PlacedPicture>* p : {&set->color, &set->emission, &set->normal, &set->occlusion})
    if (*p) patch->add((*p)->coordinates, 2);
  for (raster::PlacedFactors& f : set->factors) patch->add(f.picture.coordinates, 2);
  if (set->isolines) patch->add(set->isolines->values, 1);
  patch->add(set->stretched_along, 3);
  item.pictures = std::move(set);
  return patch;
}

std::shared_ptr<const raster::PreparedItem> LevelPatches::at(Vec3 place, Vec3 normal, Vec4f color) const {
  auto loan = patches_.borrow();
  const auto give_back = loan.get_deleter();
  const std::shared_ptr<Patch> patch(loan.release(), give_back);
  if (patch->cursor.find(place) < 0) return nullptr;
  patch->take(0);
  const LocalFrame frame = LocalFrame::about(Vec3f(normal));
  const std::array<Vec3, 2> steps{Vec3(frame.to_world({1, 0, 0})) * reach_, Vec3(frame.to_world({0, 1, 0})) * reach_};
  std::fill_n(patch->xyz, 3, 0.f);
  for (size_t k = 0; k < 2; ++k) {
    for (int a = 0; a < 3; ++a) patch->xyz[3 * (k + 1) + size_t(a)] = float(steps[k][a]);
    if (patch->cursor.find(place + steps[k]) >= 0) patch->take(k + 1);
    else if (patch->cursor.find(place - steps[k]) >= 0) patch->take(k + 1), patch->turn_over(k + 1);
    else patch->repeat_first(k + 1);
  }
  patch->item.triangles.origin = place, patch->item.color.constant = color;
  return {patch, &patch->item};
}

}  // namespace sg::trace
