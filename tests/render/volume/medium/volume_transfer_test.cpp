// SPDX-License-Identifier: Apache-2.0
// The table of a transfer function: what it says of its own entries, and values that it does not span.
#include "render/volume/medium/transfer.h"

#include <limits>

#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

OpacityCurve bands() { return {{{0.1, 0}, {0.12, 0.5}, {0.14, 0}, {0.5, 0}, {0.50001, 0.7}, {0.50002, 0}, {0.8, 0}, {0.9, 1}}}; }

/// A field from 0 to 1 with some samples set to `value`.
DatasetPtr ramp_with(float value) {
  const UniformGrid g = cube(23, 0, 1);
  std::vector<float> f(g.dims[0] * g.dims[1] * g.dims[2]);
  for (size_t i = 0; i < f.size(); ++i) {
    const size_t x = i % 23, y = i / 23 % 23;
    f[i] = x % 7 == 3 && y % 5 == 2 ? value : float(double(x) / 22);
  }
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::move(f)), "", Role::scalars});
  return make_dataset(g, fields);
}

}  // namespace

TEST_CASE("transfer: the bits of eight entries each tell where something is drawn, and nothing else") {
  for (const OpacityCurve& curve : {bands(), OpacityCurve{{{0, 0}}}, OpacityCurve{{{0, 0.5}}}, OpacityCurve{{{0.99, 0}, {1, 1}}}}) {
    const volume::Transfer t(grey(0, 1), curve, 0.1, 0.01, 0, 1, 0);
    const int count = t.linear_table().count + 3;
    for (int group = 0; group < 512; ++group) {
      bool drawn = false;
      for (int i = 0; i < count; ++i) drawn = drawn || (i / 8 % 512 == group && t.draws(i));
      INFO("entries " << 8 * group << " on");
      REQUIRE((t.drawn_eights()[size_t(group) / 32] >> group % 32 & 1) == uint32_t(drawn));
    }
  }
}

TEST_CASE("transfer: spans the values between its ends") {
  // Nothing changes beyond the data: the table ends there.
  const volume::Transfer whole(grey(-3, 4), bands(), 0.1, 0.01, 0.0, 1.0, 0);
  CHECK(whole.spans(0, 1));
  CHECK(whole.spans(0.25f, 0.75f));
  CHECK_FALSE(whole.spans(-0.01f, 1));
  CHECK_FALSE(whole.spans(0, 1.01f));
  CHECK_FALSE(whole.spans(1, 0));  // no value
  // All that changes lies within a part of the data.
  OpacityCurve inner;
  inner.points = {{0.3, 0}, {0.6, 1}};
  const volume::Transfer part(grey(0.2, 0.7), inner, 0.1, 0.01, 0.0, 1.0, 0);
  CHECK_FALSE(part.spans(0, 1));
  CHECK(part.spans(0.2f, 0.7f));
  const volume::Transfer constant(grey(0, 1), bands(), 0.1, 0.01, 0.5, 0.5, 0);
  CHECK(constant.spans(0.5f, 0.5f));
}

TEST_CASE("transfer: steps by packets draw values beyond the table, infinite ones and holes as single rays do") {
  const float inf = std::numeric_limits<float>::infinity();
  const Projection view = perspective_view(41, 33, 40, {1.9, 1.4, 2.6}, {0.5, 0.5, 0.5});
  for (const float value : {0.4f, 7.0f, -7.0f, 1e30f, 3e38f, inf, -inf, std::nanf("")})
    for (const double hi : {1.0, 0.6})  // of the colours: the table's end, or that of the data
      for (const bool shaded : {false, true}) {
        INFO("samples of " << value << ", colours to " << hi << ", shaded " << shaded);
        VolumeItem v = item(ramp_with(value), grey(0, hi), {}, 0.013);
        v.opacity.points = {{0.1, 0}, {0.2, 0.4}, {0.3, 0}, {0.5, 0.6}};
        v.unit_distance = 0.05, v.shaded = shaded;
        const Scene scene = scene_of({v});
        volume::Knobs all, single;
        all.stop_below = single.stop_below = 0, single.simd = false;
        const Frame packets = draw(scene, view, all);
        CHECK(same_bytes(packets, draw(scene, view, single)));
        CHECK(*std::max_element(packets.rgba.begin(), packets.rgba.end()) > 0.1f);
        const Frame one = draw(scene, view, all, by_single_rays(view));
        // Single rays light every step by itself, and have no means of numbers whose sum is none.
        if (shaded || value == 3e38f) continue;
        // A step at the side of a hole may have it for one and not for the other, by rounding.
        CHECK(largest_difference(packets, one) < (std::isnan(value) ? 0.05f : 2e-3f));
      }
}
