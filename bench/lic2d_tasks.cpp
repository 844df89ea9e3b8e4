// SPDX-License-Identifier: Apache-2.0
// Line integral convolution of a picture: the peers' flow and noise of random bytes, 40 steps of a pixel each way.
#include <fmt/core.h>

#include <numbers>

#include "base/random.h"
#include "bench.h"
#include "data/dataset.h"
#include "filter/flow/texture/lic.h"

namespace sg::bench {

namespace {

Task convolution(const char* label, const char* method) {
  return {"lic_1024x1024", "1024x1024", fmt::format("sightglass:{}(40 steps)", label), "pixels", [=] {
            constexpr size_t n = 1024;
            UniformGrid g;
            g.dims = {n, n, 1};
            std::vector<float> v, noise;
            for (size_t j = 0; j < n; ++j)
              for (size_t i = 0; i < n; ++i) {
                // The Arnold-Beltrami-Childress flow, one period on [-1, 1], in the plane z = 0.1.
                const double pi = std::numbers::pi, x = pi * 2 * double(i) / (n - 1), y = pi * 2 * double(j) / (n - 1), z = pi * 1.1;
                v.push_back(float(std::sqrt(3.0) * std::sin(z) + std::cos(y)));
                v.push_back(float(std::sqrt(2.0) * std::sin(x) + std::sqrt(3.0) * std::cos(z)));
                v.push_back(0);
                noise.push_back(float(random_bits(1, j * n + i) >> 56) / 255.0f);
              }
            FieldSet flow, image;
            flow.add({"v", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
            image.add({"noise", Association::point, Array::from_vector(std::move(noise)), "", Role::scalars});
            const DatasetPtr d = make_dataset(g, flow), w = make_dataset(g, image);
            LicParams p;
            p.length = 40, p.step = 1, p.method = *value_of_word<LicMethod>(method), p.contrast = texture::Contrast::none;
            return [=] {
              Context context;
              const DatasetPtr out = lic(d, w, p, context);
              return double(out->fields().require("lic").array.count());
            };
          }};
}

}  // namespace

void add_lic2d_tasks(std::vector<Task>& t) {
  t.push_back(convolution("lic", "plain"));
  t.push_back(convolution("fast lic", "fast"));
}

}  // namespace sg::bench
