// SPDX-License-Identifier: Apache-2.0
// Rows of lattices that share places in the first cache.
#include "render/volume/engines/packets/cache_rows.h"

#include <map>

#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

/// Counted: the most that begin at the same distance from the begin of a page.
size_t counted(size_t rows, size_t layers, size_t row_bytes, size_t layer_bytes) {
  std::map<size_t, size_t> at;
  size_t most = 0;
  for (size_t k = 0; k < layers; ++k)
    for (size_t j = 0; j < rows; ++j) most = std::max(most, ++at[(j * row_bytes + k * layer_bytes) % 4096]);
  return most;
}

/// Sixteen parallel rays along x, 4 across (y) and 4 down (z), so many cells apart.
volume::RayPacket packet(float apart) {
  volume::RayPacket r{};
  for (int n = 0; n < 16; ++n) {
    const auto i = size_t(n);
    r.entry[0][i] = 0, r.entry[1][i] = 10 + apart * float(n % 4), r.entry[2][i] = 10 + apart * float(n / 4);
    r.along[0][i] = 1, r.length[i] = 100, r.enter[i] = 3, r.leave[i] = 103;
  }
  return r;
}

volume::Voxels lattice(size_t n) { return {Array::from_vector(std::vector<float>(n * n * n)), {n, n, n}}; }

}  // namespace

TEST_CASE("volume cache rows: never fewer than there are, and exact for cubes of floats") {
  for (const size_t n : {64, 100, 256, 384, 500, 512, 520, 1024})
    for (const size_t rows : {1, 3, 5, 8})
      for (const size_t layers : {1, 4, 6}) {
        const size_t found = volume::rows_on_one_line(rows, layers, 4 * n, 4 * n * n), there = counted(rows, layers, 4 * n, 4 * n * n);
        INFO(n << "^3, " << rows << " rows, " << layers << " layers: " << found << " told, " << there << " there");
        CHECK(found >= there);
        if (n >= 256 && n % 128 == 0) CHECK(found == there);  // layers whole pages apart
      }
}

TEST_CASE("volume cache rows: rays far apart crowd in lattices whose layers lie pages apart, near ones and other lattices do not") {
  CHECK(volume::crowded(lattice(128), packet(4), 4, 16));        // 14 rows by 14 layers, 64 KB apart
  CHECK_FALSE(volume::crowded(lattice(128), packet(1), 4, 16));  // 5 by 5, 8 rows on a page
  CHECK_FALSE(volume::crowded(lattice(131), packet(4), 4, 16));
  // The place counts, not where rays enter: the same rays, told from further on.
  volume::RayPacket late = packet(4);
  for (size_t n = 0; n < 16; n += 2) late.enter[n] += 10, late.entry[0][n] += 10;
  CHECK(volume::crowded(lattice(128), late, 4, 16));
}
