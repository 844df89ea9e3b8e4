// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/lattice/space/space_ahead.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"

namespace sg::volume {

namespace {

/// Behind both ends of a row: the cubes go on there.
constexpr size_t beyond = 16;

/// The largest empty cubes of one octant. Such a cube is one longer than the least of those that begin at the next bricks: along each axis,
/// each two and all three.
class Octant {
 public:
  Octant(const uint8_t* distance, const std::array<size_t, 3>& dims, const std::array<bool, 3>& up, uint8_t* out)
      : distance_(distance), n_(dims), up_(up), out_(out), row_(dims[0] + 2 * beyond, farthest_told), next_(row_) {}

  void find() {
    for (size_t k = 0; k < n_[2]; ++k)
      for (size_t j = 0; j < n_[1]; ++j) find_row(up_[1] ? n_[1] - 1 - j : j, up_[2] ? n_[2] - 1 - k : k, j > 0, k > 0);
  }

 private:
  uint8_t* row(size_t j, size_t k) const { return out_ + n_[0] * (j + n_[1] * k); }

  void find_row(size_t j, size_t k, bool any_j, bool any_k) {
    const size_t nx = n_[0], j1 = up_[1] ? j + 1 : j - 1, k1 = up_[2] ? k + 1 : k - 1;
    uint8_t *own = row(j, k), *a = row_.data() + beyond, *b = next_.data() + beyond;
    std::fill_n(a, nx, farthest_told);
    const auto nearer = [nx, a](const uint8_t* from) {
      for (size_t i = 0; i < nx; ++i) a[i] = std::min(a[i], from[i]);
    };
    if (any_j) nearer(row(j1, k));
    if (any_k) nearer(row(j, k1));
    if (any_j && any_k) nearer(row(j1, k1));
    const uint8_t* drawn = distance_ + n_[0] * (j + n_[1] * k);
    ptrdiff_t on = up_[0] ? 1 : -1;
    for (size_t i = 0; i < nx; ++i) {
      const uint8_t least = std::min(a[i], a[ptrdiff_t(i) + on]);
      b[i] = drawn[i] == 0 ? 0 : uint8_t(std::min<int>(least + 1, farthest_told));
    }
    // The next brick of the row itself: as from any further one, and so much longer.
    for (int s = 1; s < farthest_told; s *= 2, on *= 2) {
      std::swap(a, b);
      for (size_t i = 0; i < nx; ++i) b[i] = std::min(a[i], uint8_t(a[ptrdiff_t(i) + on] + s));
    }
    std::copy_n(b, nx, own);
  }

  const uint8_t* distance_;
  const std::array<size_t, 3> n_;
  const std::array<bool, 3> up_;
  uint8_t* out_;
  std::vector<uint8_t> row_, next_;
};

}  // namespace

Ways Ways::of(const Projection& p, const Mat3& to_q) {
  Ways r{};
  // In perspective the directions of the corners, not of length 1, bound all others.
  const double x[2] = {-p.middle_x() / p.scale, (p.width - p.middle_x()) / p.scale};
  const double y[2] = {(p.middle_y() - p.height) / p.scale, p.middle_y() / p.scale};
  for (int a = 0; a < 3; ++a) {
    const Vec3 line{to_q.m[a][0], to_q.m[a][1], to_q.m[a][2]};
    double least = dot(line, p.forward), most = least;
    if (!p.parallel) {
      const double right[2] = {x[0] * dot(line, p.right), x[1] * dot(line, p.right)},
                   over[2] = {y[0] * dot(line, p.up), y[1] * dot(line, p.up)};
      least += std::min(right[0], right[1]) + std::min(over[0], over[1]), most += std::max(right[0], right[1]) + std::max(over[0], over[1]);
    }
    // Which way a ray goes that goes hardly any is for rounding to say.
    const double hardly =
        1e-6 * (length(line) * (1 + (p.parallel ? 0 : std::abs(x[0]) + std::abs(x[1]) + std::abs(y[0]) + std::abs(y[1]))));
    r.down[size_t(a)] = !(least > hardly), r.up[size_t(a)] = !(most < -hardly);
  }
  return r;
}

size_t Ways::octants() const {
  size_t n = 1;
  for (size_t a = 0; a < 3; ++a) n *= size_t(down[a]) + size_t(up[a]);
  return n;
}

SpaceAhead::SpaceAhead(const Distances& distance, const std::array<size_t, 3>& dims, const Ways& ways) : octants(ways.octants()) {
  const size_t n = dims[0] * dims[1] * dims[2];
  if (distance.size() != n + 3) fail_internal("space ahead: expected the distances of all bricks");
  if (octants * n >= size_t(1) << 31) fail_internal("space ahead: too many bricks");
  bricks.resize(octants * n + 3);
  std::fill(bricks.end() - 3, bricks.end(), farthest_told);
  size_t step = n;
  for (size_t a = 0; a < 3; ++a)
    if (ways.down[a] && ways.up[a]) up[a] = int32_t(step), step *= 2;
  parallel_for(octants, 1, [&](size_t begin, size_t end) {
    for (size_t o = begin; o < end; ++o) {
      std::array<bool, 3> goes_up;
      size_t rest = o;
      for (size_t a = 0; a < 3; ++a) {
        goes_up[a] = !ways.down[a];
        if (up[a]) goes_up[a] = rest & 1, rest >>= 1;
      }
      Octant(distance.data(), dims, goes_up, &bricks[o * n]).find();
    }
  });
}

}  // namespace sg::volume
