// SPDX-License-Identifier: Apache-2.0
// Media that jump: steps of opacity and of colour, and ramps so narrow that they are as good as steps, against brute force.
#include <fmt/core.h>

#include "color/transfer_text.h"
#include "support/property.h"
#include "volume_brute_force.h"

using namespace sg;
using namespace sg::test;

namespace {

ColorScale stops(const char* text, double lo, double hi) {
  ColorScale s = colored(lo, hi);
  parse_color_stops(text, s, true);
  return s;
}

struct Medium {
  const char* name;
  ColorScale color;
  OpacityCurve opacity;
};

/// Over values from 0 to 1.
std::vector<Medium> media() {
  const OpacityCurve even = curve({{0, 0.5}});
  ColorScale cut = colored(0.35, 0.62);
  cut.clamp = false;
  ColorScale bands = colored(0, 1);
  bands.map.kind = MapKind::categorical, bands.map.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {0, 0, 0}};
  ColorScale sampled = colored(0, 1);  // a table in which one step is between two of many samples
  sampled.map.colors.clear();
  for (int i = 0; i <= 1024; ++i) sampled.map.colors.push_back(i < 600 ? Vec3f{0.9f, 0.1f, 0} : Vec3f{0, 0.2f, 1});
  return {
      {"step of opacity", colored(0, 1), curve({{0, 0}, {0.55, 0}, {0.55, 0.6}, {1, 0.6}})},
      {"narrow ramp", colored(0, 1), curve({{0, 0}, {0.47, 0}, {0.4704, 0.7}, {1, 0.7}})},
      {"hollow", colored(0, 1), curve({{0, 0.5}, {0.44, 0.5}, {0.44, 0}, {0.58, 0}, {0.58, 0.4}})},
      {"nothing beyond the scale", cut, even},
      {"step of colour", stops("0:red,0.53:red,0.53:blue,1:blue", 0, 1), even},
      {"steps of colour", stops("0:black,0.311:#202020,0.311:white,0.5:red,0.5:#00ff00,0.77:blue,0.77:white,1:black", 0, 1), even},
      {"narrow ramp of colour", stops("0:red,0.53:red,0.5306:blue,1:blue", 0, 1), even},
      {"step between samples", sampled, even},
      {"bands", bands, even},
      {"both", stops("0:red,0.4:red,0.4:blue,1:blue", 0, 1), curve({{0, 0}, {0.4, 0}, {0.4, 0.8}, {0.6, 0.8}, {0.6, 0.1}})},
  };
}

/// Over all pixels the largest difference to the truth, in any channel.
double worst_of(const Frame& f, const Projection& view, const std::vector<Vec4>& truth) {
  double worst = 0;
  for (size_t i = 0; i < truth.size(); ++i) {
    for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(truth[i][k] - double(f.rgba[4 * i + size_t(k)])));
    worst = std::max(worst, std::abs(1 - truth[i].w - double(f.rgba[4 * i + 3])));
  }
  CHECK(truth.size() == size_t(view.width) * size_t(view.height));
  return worst;
}
std::vector<Vec4> truth_of(const Case& c, const Projection& view, const Scene& scene) {
  std::vector<Vec4> all(size_t(view.width) * size_t(view.height));
  parallel_for(all.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) all[i] = brute_force(c, view, int(i) % view.width, int(i) / view.width, scene);
  });
  return all;
}

/// Each jump on a ray costs brute force up to half a step: pixels that differ by more than half of what is allowed get 30 times as many.
void look_closer(std::vector<Vec4>& truth, Case c, const Frame& f, const Projection& view, const Scene& scene) {
  c.per_cell *= 30;
  for (size_t i = 0; i < truth.size(); ++i) {
    const double want[4] = {truth[i].x, truth[i].y, truth[i].z, 1 - truth[i].w};
    double off = 0;
    for (size_t k = 0; k < 4; ++k) off = std::max(off, std::abs(want[k] - double(f.rgba[4 * i + k])));
    if (off > 0.5 / 512) truth[i] = brute_force(c, view, int(i) % view.width, int(i) / view.width, scene);
  }
}

/// A lattice of noise, with even axes or not.
Lattice noisy(uint64_t seed, bool uneven = false) {
  const auto noise = [seed, n = uint64_t(0)](Vec3) mutable { return random_unit(seed, n++); };
  return lattice_of(7, noise, uneven);
}

/// The points of a lattice as other meshes: one of hexahedra, or of tetrahedra, five to a cube and alternately turned.
DatasetPtr as_cells(const Lattice& l, bool tetrahedra) {
  const size_t n = l.n[0];
  std::vector<double> xyz;
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i)
        for (const double x : {l.x[0][i], l.x[1][j], l.x[2][k]}) xyz.push_back(x);
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(l.v).converted(ElementType::f32), "", Role::scalars});
  if (!tetrahedra) {
    CurvilinearGrid g;
    g.dims = l.n, g.points.xyz = Array::from_vector(xyz, 3);
    return make_dataset(g, fields);
  }
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(xyz, 3), m.single_type = CellType::tetra, m.cells.fixed = 4;
  std::vector<int64_t> ids;
  for (size_t k = 0; k + 1 < n; ++k)
    for (size_t j = 0; j + 1 < n; ++j)
      for (size_t i = 0; i + 1 < n; ++i)
        for (const auto& tet : {std::array{0, 1, 2, 4}, {3, 1, 7, 2}, {5, 1, 4, 7}, {6, 2, 7, 4}, {1, 2, 4, 7}})
          for (int c : tet) {
            c ^= int(i + j + k) % 2;
            ids.push_back(int64_t(i + size_t(c & 1) + n * (j + size_t(c >> 1 & 1) + n * (k + size_t(c >> 2)))));
          }
  m.cells.connectivity = Array::from_vector(ids);
  return make_dataset(m, fields);
}

}  // namespace

TEST_CASE("property: a value that crosses a step of the medium and comes back inside a cell is seen, by packets and by single rays") {
  const Projection view = perspective_view(6, 6, 7, {1.9, 1.4, 2.6}, {0, 0, 0});
  for (const uint64_t seed : property_seeds(2))
    for (const bool uneven : {false, true})
      for (const Medium& m : media()) {
        INFO(std::string(m.name), ", seed ", seed, std::string(uneven ? ", uneven axes" : ""));
        Case c{m.name, noisy(seed, uneven), nullptr, m.color, m.opacity, 0.2, false, 600};
        c.data = dataset_of(c.lattice, uneven);
        VolumeItem v = item(c.data, c.color, c.opacity);
        v.unit_distance = c.unit;
        const Scene scene = scene_of({v});
        std::vector<Vec4> truth = truth_of(c, view, scene);
        const Frame packets = draw(scene, view), single = draw(scene, view, {}, by_single_rays(view));
        look_closer(truth, c, packets, view, scene), look_closer(truth, c, single, view, scene);
        CHECK(worst_of(packets, view, truth) < 1.0 / 512);
        CHECK(worst_of(single, view, truth) < 1.0 / 512);
      }
}

TEST_CASE("volume: steps of colour and of opacity in smooth fields, lit or not, in strides and cell by cell") {
  const Projection view = perspective_view(8, 8, 9, {1.9, 1.4, 2.6}, {0, 0, 0});
  for (const bool lit : {false, true})
    for (const size_t n : {12, 40})
      for (const Medium& m : media()) {
        INFO(std::string(m.name), std::string(lit ? ", lit, " : ", "), n);
        Case c{
            m.name, lattice_of(n, [](Vec3 p) { return 0.5 + 0.29 * bumpy(p); }), nullptr, m.color, m.opacity, 0.3, lit, n > 20 ? 150 : 500};
        c.data = dataset_of(c.lattice, false);
        VolumeItem v = item(c.data, c.color, c.opacity);
        v.unit_distance = c.unit, v.shaded = lit;
        const Scene scene = scene_of({v});
        const std::vector<Vec4> truth = truth_of(c, view, scene);
        CHECK(worst_of(draw(scene, view), view, truth) < 1.0 / 512);
        CHECK(worst_of(draw(scene, view, {}, by_single_rays(view)), view, truth) < 1.0 / 512);
      }
}

TEST_CASE("volume: steps of colour and of opacity in hexahedra and in tetrahedra") {
  const Projection view = perspective_view(6, 6, 7, {1.9, 1.4, 2.6}, {0, 0, 0});
  for (const bool tetrahedra : {false, true})
    for (const Medium& m : media()) {
      INFO(std::string(m.name), std::string(tetrahedra ? ", tetrahedra" : ", hexahedra"));
      // What is linear is the same in both.
      const Lattice l = tetrahedra ? lattice_of(5, [](Vec3 p) { return 0.5 + 0.2 * p.x - 0.13 * p.y + 0.11 * p.z; }) : noisy(3);
      const Case c{m.name, l, as_cells(l, tetrahedra), m.color, m.opacity, 0.2, false, 600};
      VolumeItem v = item(c.data, c.color, c.opacity);
      v.unit_distance = c.unit;
      const Scene scene = scene_of({v});
      const std::vector<Vec4> truth = truth_of(c, view, scene);
      CHECK(worst_of(draw(scene, view), view, truth) < 1.0 / 512);
      CHECK(worst_of(draw(scene, view, {}, by_single_rays(view)), view, truth) < 1.0 / 512);
    }
}

TEST_CASE("volume: small fixed steps keep a step of colour where it is") {
  // Along z the value goes from 0 to 1; what a ray sees is the share of its way on either side.
  for (const double at : {0.50003, 0.3333, 0.1251}) {
    const auto data = grid(cube(3, 0, 1), [](Vec3 p) { return p.z; });
    const ColorScale color = stops(fmt::format("0:red,{0}:red,{0}:blue,1:blue", at).c_str(), 0, 1);
    for (const VolumeClassify classify : {VolumeClassify::post, VolumeClassify::integrated}) {
      INFO(at, " ", word_of(classify));
      VolumeItem v = item(data, color, curve({{0, 0.5}}));
      v.sampling.step = 1.0 / 8192, v.sampling.classify = classify;
      const Frame f = look(scene_of({v}), 0.513, 0.517);
      // From z = 1 down: blue first.
      const double blue = 1 - std::pow(0.5, 1 - at), red = std::pow(0.5, 1 - at) - 0.5;
      CHECK(double(f.rgba[0]) - red == doctest::Approx(0).epsilon(0.0002));
      CHECK(double(f.rgba[2]) - blue == doctest::Approx(0).epsilon(0.0002));
    }
  }
}
