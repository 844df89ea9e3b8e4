// SPDX-License-Identifier: Apache-2.0
// Closed forms on sheared boxes of every kind of cell: volumes, areas, integrals, cuts and probes of linear fields are exact.
#include "data/cells/shape/cell_map.h"
#include "filter/field/derivatives/gradient.h"
#include "filter/mesh/clip/clip.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/mesh/slice/slice.h"
#include "filter/mesh/tessellate_cells.h"
#include "filter/probe/probe.h"
#include "filter/scalar/contour/contour.h"
#include "filter/smooth_distortion.h"
#include "filter/stats/integrate.h"

using namespace sg;
using namespace sg::test;

namespace {

double measure_of(const DatasetPtr& d, int dimension) {
  std::vector<double> weights;
  CellMap map(d);
  double sum = 0;
  for (size_t c = 0; c < d->cell_count(); ++c) {
    if (map.reader().hidden(c)) continue;
    map.open(c);
    if (map.dimension() != dimension) continue;
    weights.resize(map.reader().ids().size());
    map.integration_weights(weights);
    for (const double w : weights) sum += w;
  }
  return sum;
}

// Of [-1,1]^3: the volume where n.q <= d, and its derivative by d (Cavalieri: the area of the cut times 1/|n|). Sums over the corners.
void below(Vec3 n, double d, double& volume, double& rate) {
  volume = rate = 0;
  for (int k = 0; k < 8; ++k) {
    const Vec3 corner(k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0);
    // The corner's share has the sign of its place beyond the one where n.q is least.
    double sign = 1;
    for (int a = 0; a < 3; ++a)
      if ((corner[a] > 0) == (n[a] > 0)) sign = -sign;
    const double t = std::max(0.0, d - dot(n, corner));
    volume += sign * t * t * t, rate += sign * 3 * t * t;
  }
  const double scale = 6 * std::abs(n.x * n.y * n.z);
  volume /= scale, rate /= scale;
}

}  // namespace

TEST_CASE(
    "property: on sheared boxes of every kind of cell volumes, areas, integrals, cuts, gradients and probes of linear fields are exact") {
  for (const uint64_t seed : property_seeds(60)) {
    CAPTURE(seed);
    Random random(seed);
    const auto& kinds = solid_meshes();
    const MeshKind& kind = kinds[size_t(random.whole(0, int(kinds.size()) - 1))];
    const DatasetPtr box = kind.make(random.whole(2, 5), 1);
    const bool straight = kind.name.find("bent") == kind.name.npos && kind.name.find("curved") == kind.name.npos;
    if (!box->as<UnstructuredMesh>() || !straight) continue;
    CAPTURE(kind.name);
    const double scale = random.magnitude(1e-6, 1e6);
    Mat3 m = distorted::random_rotation(random);
    const Vec3 stretch(random.in(0.4, 2), random.in(0.4, 2), random.in(0.4, 2));
    const Vec3 columns[3] = {m.column(0) * stretch.x, m.column(1) * stretch.y + m.column(0) * random.in(-0.5, 0.5),
                             m.column(2) * stretch.z + m.column(1) * random.in(-0.5, 0.5)};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m.m[i][j] = columns[j][i] * scale;
    const Vec3 center = Vec3(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)) * (3 * scale);
    const Vec3 slope = Vec3(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1));
    const auto f = [&](Vec3 x) { return 0.7 + dot(slope, (x - center) / scale); };
    DatasetParts parts = box->parts();
    std::get<UnstructuredMesh>(parts.mesh).points = {at_points(parts.mesh, [&](Vec3 q) { return center + m * q; }), {}};
    const DatasetPtr d = with_values(
        make_dataset(std::move(parts)), "f", 1, [&](Vec3 x, double* v) { *v = f(x); }, Role::scalars);
    Context context;
    const double jacobian = std::abs(dot(columns[0], cross(columns[1], columns[2])));

    CHECK(measure_of(d, 3) / (scale * scale * scale) == doctest::Approx(8 * jacobian).epsilon(1e-10));
    const TablePtr t = integrate(d, {{"f"}}, context);
    double integral = NAN;
    for (size_t c = 0; c < t->columns.size(); ++c)
      if (t->columns[c].name == "integral") integral = t->columns[c].array.get(1);
    CHECK(integral / (scale * scale * scale) == doctest::Approx(8 * jacobian * 0.7).epsilon(1e-9));
    double skin = 0;
    for (int a = 0; a < 3; ++a) skin += 8 * length(cross(columns[a], columns[(a + 1) % 3]));
    CHECK(measure_of(faces(d, {}, context), 2) / (scale * scale) == doctest::Approx(skin).epsilon(1e-9));
    CHECK(measure_of(tessellate(d, {}, context), 3) / (scale * scale * scale) == doctest::Approx(8 * jacobian).epsilon(1e-9));

    // In the box's own coordinates f is 0.7 + n.q.
    const Vec3 n(dot(slope, columns[0]), dot(slope, columns[1]), dot(slope, columns[2]));
    if (std::min({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) < 0.05) continue;
    const double most = std::abs(n.x) + std::abs(n.y) + std::abs(n.z), level = random.in(-0.9, 0.9) * most;
    double volume, rate;
    below(n, level, volume, rate);
    const double area = rate * jacobian * length(slope);  // dV = area * dx, f grows by |slope| a length
    const DatasetPtr surface = contour(d, {{"f"}, {0.7 + level}}, context);
    CHECK(measure_of(surface, 2) / (scale * scale) == doctest::Approx(area).epsilon(1e-5));
    SliceParams s;
    s.origin = center + slope * (level * scale / dot(slope, slope)), s.normal = slope;
    const DatasetPtr cut = slice(d, nullptr, s, context);
    CHECK(measure_of(cut, 2) / (scale * scale) == doctest::Approx(area).epsilon(1e-5));
    const Array on_cut = cut->fields().require("f").array;
    for (size_t i = 0; i < on_cut.count(); ++i) CHECK(on_cut.get(i) == doctest::Approx(0.7 + level).epsilon(1e-5));
    ClipParams c;
    c.origin = s.origin, c.normal = slope;
    CHECK(measure_of(single_dataset(clip(d, c, context), "test"), 3) / (scale * scale * scale) ==
          doctest::Approx(volume * jacobian).epsilon(1e-6));

    // Probes at nodes, between nodes of a cell, and anywhere.
    ProbeAtParams at;
    CellMap map(d);
    for (int k = 0; k < 40; ++k) {
      map.open(size_t(random.whole(0, int(d->cell_count()) - 1)));
      const auto nodes = map.reader().at();
      const Vec3 a = nodes[size_t(random.whole(0, int(nodes.size()) - 1))], b = nodes[size_t(random.whole(0, int(nodes.size()) - 1))];
      Vec3 p = k % 3 == 0 ? a : k % 3 == 1 ? (a + b) * 0.5 : center + m * Vec3(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1));
      if (is_bezier(map.reader().type()) && k % 3 == 0) p = (a + center) * 0.5;
      at.points.insert(at.points.end(), {p.x, p.y, p.z});
    }
    const DatasetPtr probed = probe_at(d, at, context);
    const Array values = probed->fields().require("f").array, valid = probed->fields().require("valid").array;
    for (size_t i = 0; i < values.count(); ++i) {
      CHECK(valid.get(i) == 1);
      CHECK(values.get(i) == doctest::Approx(f({at.points[3 * i], at.points[3 * i + 1], at.points[3 * i + 2]})).epsilon(1e-6));
    }
    const Array g = gradient(on_cells(d), {{"f"}, "g"}, context)->fields().require("g").array;
    double worst = 0;
    for (size_t i = 0; i < g.count(); ++i) worst = std::max(worst, length(Vec3(g.get(i, 0), g.get(i, 1), g.get(i, 2)) * scale - slope));
    if (kind.name != "lagrange tetra" && d->cell_count() > 40) CHECK(worst < 1e-6);
  }
}

// x + a y^2 and y + b z^2 keep volumes, and polynomial cells of order two and more hold this map exactly.
TEST_CASE("property: curved cells of every order keep the volume of a box that slides in parabolas, and come to it when they are cut") {
  for (const uint64_t seed : property_seeds(6)) {
    CAPTURE(seed);
    Random random(seed);
    using enum CellType;
    const CellType type = random.one_of({lagrange_tetra, lagrange_hexahedron, lagrange_wedge, quadratic_tetra, quadratic_hexahedron,
                                         quadratic_wedge, triquadratic_hexahedron, biquadratic_quadratic_wedge});
    const bool lattice = type == lagrange_tetra || type == lagrange_hexahedron || type == lagrange_wedge;
    const int order = lattice ? random.whole(2, type == lagrange_hexahedron ? 4 : 5) : 2;
    CAPTURE(int(type));
    CAPTURE(order);
    const double a = random.in(-0.6, 0.6), b = random.in(-0.6, 0.6);
    const auto slide = [&](Vec3 q) {
      const Vec3 p = 2 * q - Vec3(1, 1, 1);
      return Vec3(p.x + a * p.y * p.y, p.y + b * p.z * p.z, p.z);
    };
    const DatasetPtr d = with_values(
        flow::moved(meshes::solid_box(type, random.whole(1, 2), order), slide), "f", 1, [](Vec3 x, double* v) { *v = x.z; }, Role::scalars);
    Context context;
    CHECK(measure_of(d, 3) == doctest::Approx(8).epsilon(1e-10));
    const TablePtr t = integrate(d, {{"f"}}, context);
    for (const Field& c : t->columns)
      if (c.name == "integral") CHECK(std::abs(c.array.get(1)) < 1e-10);
    double before = 0;
    for (const double tolerance : {1e-2, 1e-3}) {
      TessellateParams p;
      p.tolerance = tolerance;
      const double off = std::abs(measure_of(tessellate(d, p, context), 3) - 8);
      CHECK(off < 40 * tolerance);
      if (before > 1e-2) CHECK(off < before);
      before = off;
    }
    // z is as it was: every cut across it has area 4, what lies below has 4 times its height.
    const double level = random.in(-0.9, 0.9);
    CHECK(measure_of(contour(d, {.field = {"f"}, .values = {level}, .tolerance = 1e-4}, context), 2) == doctest::Approx(4).epsilon(1e-2));
    ClipParams c;
    c.field.name = "f", c.value = level, c.keep = ClipSide::outside, c.tolerance = 1e-3;
    CHECK(measure_of(single_dataset(clip(d, c, context), "test"), 3) == doctest::Approx(4 * (level + 1)).epsilon(2e-2));
  }
}
