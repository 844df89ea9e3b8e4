// SPDX-License-Identifier: Apache-2.0
// Seeds: places where lines, particles and fronts begin.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// Where seeds lie; mesh: at the points of a second input; pixels: in the middle of the pixels of a plane.
enum class SeedKind { random, points, line, plane, sphere, ball, grid, mesh, pixels };
constexpr auto enum_words(SeedKind) {
  using enum SeedKind;
  return std::array{Word{"random", random}, Word{"points", points}, Word{"line", line}, Word{"plane", plane},  Word{"sphere", sphere},
                    Word{"ball", ball},     Word{"grid", grid},     Word{"mesh", mesh}, Word{"pixels", pixels}};
}

/// Shared by every operation that starts at seeds.
struct SeedParams {
  std::optional<SeedKind> seeds;
  std::vector<double> points;
  std::optional<Vec3> from, to;
  std::optional<Vec3> center, normal;
  std::optional<double> radius;
  std::vector<double> size;
  std::vector<int64_t> counts;
  int64_t count = 0;  ///< 0: by kind, see seed_count()
  int64_t random_seed = 1;
};
void describe(Schema& s, SeedParams& p);

/// `seeds`, or the kind that the other parameters imply: mesh when there is one, points, line, sphere, plane, grid by what is given; else
/// random.
SeedKind seed_kind(const SeedParams& p, bool mesh);

/// count, or its default: 200, on a line 40, at random in meshes of surfaces 60 (their lines lie side by side).
int64_t seed_count(const SeedParams& p, SeedKind kind, int dimension);

/// Whether a seed may be placed there. Called from one thread.
using SeedPlace = std::function<bool(Vec3)>;

/// The seeds about the meshes `parts` (those of one dimension; their box places what has no place of its own). `mesh`: the points of a
/// second input, or null. `accept` (may be empty) chooses among random ones only; random seeds lie in cells of the mesh, evenly by volume,
/// area or length, the same for any number of threads. Reports by context.info what was chosen by default. Throws Error(usage)
/// for numbers that make no seeds.
std::vector<Vec3> make_seeds(const SeedParams& p, const std::vector<DatasetPtr>& parts, const DatasetPtr& mesh, const SeedPlace& accept,
                             Context& context);

struct SeedsParams {
  SeedParams seeds;
};
inline void describe(Schema& s, SeedsParams& p) { describe(s, p.seeds); }
/// seeds: they as a PointCloud with the point field "seed", their number. A second input is a mesh whose points they are.
Data seeds(const std::vector<Data>& inputs, const SeedsParams& p, Context& context);

/// All points of any mesh.
std::vector<Vec3> points_of(const Dataset& mesh);
/// The second input of an operation as the mesh of its seeds: null when there is one input only. Throws Error(usage).
DatasetPtr seed_mesh_of(const std::vector<Data>& inputs, std::string_view who);

}  // namespace sg
