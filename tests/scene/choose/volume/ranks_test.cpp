// SPDX-License-Identifier: Apache-2.0
// A volume whose pieces lie with several ranks looks as the whole does.
#include <cmath>

#include "scene/show/show.h"
#include "scene/show/volume.h"
#include "support/ranks.h"
#include "support/test.h"

using namespace sg;

namespace {

// Of 40 layers along x those from `first` on; a bright ball in the middle of a noisy background, so that no half is like the whole.
DatasetPtr layers(size_t first, size_t count) {
  UniformGrid g;
  g.dims = {count, 40, 40}, g.origin = {double(first), 0, 0};
  std::vector<float> v;
  for (size_t k = 0; k < 40; ++k)
    for (size_t j = 0; j < 40; ++j)
      for (size_t i = first; i < first + count; ++i) {
        const double r = std::hypot(double(i) - 12, double(j) - 20, double(k) - 20);
        v.push_back(float(100 / (1 + std::exp(r - 9)) + double((i * 7 + j * 13 + k * 29) % 5) + 0.02 * double(i * i)));
      }
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  return make_dataset(g, fields);
}

VolumeItem shown(const DatasetPtr& d, const std::vector<std::string>& words, Context& context) {
  Scene scene;
  const ParamSet params = show_params(show_kind<VolumeShow>(), words);
  add(scene, d, params.as<VolumeShow>(), context);
  return std::get<VolumeItem>(scene.items.at(0));
}

}  // namespace

TEST_CASE("volumes on ranks: opacity, colours and levels are chosen from all pieces") {
  for (const std::vector<std::string>& words : {std::vector<std::string>{}, std::vector<std::string>{"transfer=boundaries"},
                                                std::vector<std::string>{"method=ray", "mode=isosurface"}}) {
    Context alone;
    const VolumeItem whole = shown(layers(0, 40), words, alone);
    std::vector<VolumeItem> pieces(2);
    test::on_ranks(2, [&](int rank, Context& context) { pieces[size_t(rank)] = shown(layers(rank ? 20 : 0, 20), words, context); });
    CAPTURE(words.size());
    for (const VolumeItem& piece : pieces) {
      CHECK(piece.color.lo == whole.color.lo);
      CHECK(piece.color.hi == whole.color.hi);
      REQUIRE(piece.opacity.points.size() == whole.opacity.points.size());
      // Derivatives differ a little along the cut, and the order of samples; histograms do not.
      const double near = words.empty() ? 0 : 0.05 * (whole.color.hi - whole.color.lo);
      for (size_t i = 0; i < piece.opacity.points.size(); ++i) {
        CHECK(std::abs(piece.opacity.points[i].x - whole.opacity.points[i].x) <= near);
        CHECK(std::abs(piece.opacity.points[i].y - whole.opacity.points[i].y) <= 0.05);
      }
      REQUIRE(piece.levels.size() == whole.levels.size());
      for (size_t i = 0; i < piece.levels.size(); ++i) CHECK(std::abs(piece.levels[i] - whole.levels[i]) <= near);
      CHECK(piece.opacity.points[0].x == pieces[0].opacity.points[0].x);
    }
  }
}
