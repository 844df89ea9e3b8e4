// SPDX-License-Identifier: Apache-2.0
#include "render/trace/squares.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "data/memory/memory_budget.h"
#include "render/composite/marks.h"
#include "render/prepare/shared_progress.h"
#include "render/trace/integrators/first_met.h"
#include "render/trace/light/luminance.h"
#include "render/trace/progress/pixel_noise.h"
#include "render/trace/sampling/random_stream.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

namespace {

constexpr int side = 8;  // of the squares of pixels that are finished together
constexpr int most_pixels = side * side;
constexpr uint32_t most_of_pixel = 4;  // paths of a pixel that are followed together
static_assert(most_pixels == most_paths);

struct Square {
  uint32_t paths = 0;
  double variance = 0;  ///< as displayed, mean of its pixels
  bool reached = false;
};
using Sums = std::vector<PixelSum, HugeAllocator<PixelSum>>;

}  // namespace

struct SquaresSoFar {
  std::vector<Square> squares;
  Sums sums;
  Frame frame;
  Plane<float> behind, variance, error;
  size_t bytes() const {
    return squares.size() * sizeof(Square) + sums.size() * sizeof(PixelSum) + frame.pixels() * 24 +
           4 * (behind.size() + variance.size() + error.size());
  }
};

namespace {

class Drawing {
 public:
  Drawing(const LitPicture& picture, const Integrator& integrator, Frame& frame, Plane<float>& behind, Plane<float>& variance,
          Plane<float>& error)
      : picture_(picture),
        integrator_(integrator),
        frame_(frame),
        behind_(behind),
        variance_(variance),
        error_(error),
        filled_(picture.camera.pixels_of(picture.world.bounds())),
        across_(size_t(frame.width + side - 1) / side),
        most_(uint32_t(picture.options.stop > 0 ? std::min(picture.options.stop, picture.options.paths) : picture.options.paths)),
        squares_(across_ * (size_t(frame.height + side - 1) / side)) {
    if (picture.backdrop.seen) behind_.assign(3 * frame.pixels(), 0);
  }

  size_t size() const { return squares_.size(); }
  bool finished(size_t square) const { return squares_[square].reached || squares_[square].paths >= most_; }
  uint32_t most() const { return most_; }
  uint32_t paths(size_t square) const { return squares_[square].paths; }

  int pixels(size_t square) const { return place(square).count(); }

  /// Up to so many paths a pixel, unless the noise is reached before.
  void draw(size_t square, uint32_t to, PixelSum* sums) {
    const PixelBox at = place(square);
    const LightOptions& o = picture_.options;
    Sampler sampler(o.sampler, o.seed, o.paths);
    Square& told = squares_[square];
    while (told.paths < std::min(to, most_) && !told.reached) {
      const uint32_t n = told.paths, end = std::min({to, most_, n + pass_ - n % pass_});
      for (uint32_t k = n; k < end; k += most_of_pixel) add_paths(at, k, std::min(end, k + most_of_pixel), sampler, sums);
      told.paths = end, told.variance = 0;
      for (int p = 0; p < at.count() && end > 1; ++p)
        told.variance += displayed_variance(sums[p].mean(end), sums[p].variance(end)) / at.count();
      // Looked at where the next pass would begin, however the way there was divided.
      told.reached = (end % pass_ == 0 || end == most_) && end > 1 && told.variance <= o.noise * o.noise;
    }
  }

  void develop(size_t square, const PixelSum* sums) {
    const PixelBox at = place(square);
    const uint32_t n = squares_[square].paths;
    for (int p = 0; p < at.count(); ++p) {
      const size_t i = pixel(at, p);
      for (int c = 0; c < 3; ++c) {
        frame_.rgba[4 * i + size_t(c)] = float(sums[p].light[c] / n);
        if (picture_.backdrop.seen) behind_[3 * i + size_t(c)] = float(sums[p].behind[c] / n);
      }
      frame_.rgba[4 * i + 3] = float(1 - sums[p].passed / n);
      if (n < 2) continue;
      const double variance = sums[p].variance(n);
      variance_[i] = float(variance), error_[i] = float(std::sqrt(displayed_variance(sums[p].mean(n), variance)));
    }
  }

  /// What the middle of each pixel sees.
  void look(size_t square, MediaWalk* media) {
    const PixelBox at = place(square);
    if (at.overlaps(filled_)) see_first_met(picture_.world, picture_.camera, media, at, frame_);
  }

  /// What was drawn so far leaves, or comes back.
  void give(SquaresSoFar& so_far) {
    so_far.squares = std::move(squares_), so_far.frame = std::move(frame_);
    so_far.behind = std::move(behind_), so_far.variance = std::move(variance_), so_far.error = std::move(error_);
  }
  void take(SquaresSoFar& so_far) {
    squares_ = std::move(so_far.squares), frame_ = std::move(so_far.frame);
    behind_ = std::move(so_far.behind), variance_ = std::move(so_far.variance), error_ = std::move(so_far.error);
  }

  void report(TraceReport& r) const {
    r.paths = 0, r.reached = true;
    double variance = 0;
    const double all = double(frame_.width) * double(frame_.height);
    for (size_t s = 0; s < squares_.size(); ++s) {
      const double share = pixels(s) / all;
      r.paths += squares_[s].paths * share, variance += squares_[s].variance * share;
      r.reached = r.reached && squares_[s].reached;
    }
    r.noise = std::sqrt(variance);
  }

 private:
  /// Paths k to `end` of each pixel of a square, those of a pixel after each other.
  void add_paths(const PixelBox& at, uint32_t k, uint32_t end, Sampler& sampler, PixelSum* sums) const {
    const int of_pixel = int(end - k), pixels = most_paths / of_pixel;
    for (int p = 0; p < at.count(); p += pixels) {
      CameraPath paths[most_paths];
      Estimate found[most_paths];
      const int n = std::min(pixels, at.count() - p) * of_pixel;
      const bool filled = at.overlaps(filled_);
      for (int i = 0; i < n && (filled || picture_.backdrop.seen); ++i)
        paths[i] = first_ray(at, p + i / of_pixel, k + uint32_t(i % of_pixel), sampler);
      if (filled) integrator_.along_all(picture_.world, {paths, size_t(n)}, sampler, found);
      else std::fill_n(found, n, Estimate{.passed = 1});
      for (int i = 0; i < n; ++i) {
        const int of = p + i / of_pixel;
        Vec3f around = picture_.backdrop.seen ? picture_.backdrop.radiance(paths[i].ray.direction) : picture_.around[size_t(at.row(of))];
        if (picture_.marks) around = seen_behind(*picture_.marks, pixel(at, of), around);
        sums[of].add(found[i], around);
      }
    }
  }
  CameraPath first_ray(const PixelBox& at, int p, uint32_t k, Sampler& sampler) const {
    const auto x = uint32_t(at.column(p)), y = uint32_t(at.row(p));
    sampler.start(x, y, k);
    const Vec2f in_pixel = sampler.next2(), on_lens = picture_.camera.has_lens() ? concentric_disc(sampler.next2()) : Vec2f();
    const Vec2f in_picture{float(x) + in_pixel.x, float(y) + in_pixel.y};
    CameraPath path{picture_.camera.ray(in_picture, on_lens), {}, x, y, k, sampler.dimension()};
    if (picture_.world.has_pictures()) path.footprint = picture_.camera.footprint(in_picture);
    return path;
  }
  PixelBox place(size_t square) const {
    const int x = int(square % across_) * side, y = int(square / across_) * side;
    return {x, y, std::min(side, frame_.width - x), std::min(side, frame_.height - y)};
  }
  size_t pixel(const PixelBox& at, int p) const { return size_t(at.row(p)) * size_t(frame_.width) + size_t(at.column(p)); }

  const LitPicture& picture_;
  const Integrator& integrator_;
  const uint32_t pass_ = integrator_.pass();
  Frame& frame_;
  Plane<float>&behind_, &variance_, &error_;
  const PixelBox filled_;  // outside of which there is nothing but what lies around the scene
  size_t across_;
  uint32_t most_;
  std::vector<Square> squares_;
};

}  // namespace

void PixelSum::add(const Estimate& e, Vec3f around) {
  const Vec3f seen = around * e.passed;
  const auto y = double(luminance(e.radiance + seen));
  light += Vec3(e.radiance), behind += Vec3(seen), passed += e.passed, sum += y, square += y * y;
}

double PixelSum::variance(uint32_t n) const {
  const double m = mean(n);
  return std::max(0.0, square / n - m * m) / (n - 1);
}

void add_behind(const Plane<float>& behind, Frame& frame) {
  for (size_t i = 0; i < frame.pixels(); ++i) {
    for (size_t c = 0; c < 3; ++c) frame.rgba[4 * i + c] += behind[3 * i + c];
    frame.rgba[4 * i + 3] = 1;
  }
}

namespace {

// The picture swept over until nothing is left or enough is seen.
void draw_sweeps(Drawing& drawing, const LitPicture& picture, Sweeps& sweeps, Sums& sums, Frame& frame, const Plane<float>& behind,
                 TraceReport& report, Context& context) {
  std::vector<size_t> left;
  uint32_t n = drawing.most();  // of what is left all squares have so many at least: some of a sweep that was cut short have more
  for (size_t i = 0; i < drawing.size(); ++i)
    if (!drawing.finished(i)) left.push_back(i), n = std::min(n, drawing.paths(i));
  while (!left.empty()) {
    double pixels = 0;
    for (const size_t square : left) pixels += drawing.pixels(square);
    const uint32_t paths = sweeps.next(n, n == 0 ? 2 : 1, pixels);
    if (paths == 0) break;
    context.progress(double(n) / double(drawing.most()), "following light");
    parallel_for(
        left.size(), 1,
        [&](size_t i, size_t) {
          PixelSum* own = &sums[left[i] * most_pixels];
          if (n == 0) {
            const Media::Borrowed media = picture.world.borrow_media();
            drawing.look(left[i], media.get());
          }
          drawing.draw(left[i], n + paths, own);
          drawing.develop(left[i], own);
        },
        &context);
    sweeps.done();
    n = std::min(n + paths, drawing.most());
    std::erase_if(left, [&](size_t square) { return drawing.finished(square); });
    if (left.empty()) break;
    if (!sweeps.wanted()) continue;
    drawing.report(report);
    Frame shown;
    if (!behind.empty()) shown = frame, add_behind(behind, shown);
    if (!sweeps.show(behind.empty() ? frame : shown, report)) break;
  }
  drawing.report(report);
  if (!left.empty()) report.stopped = int(drawing.paths(left[0]));
}

}  // namespace

void draw_squares(const LitPicture& picture, const Integrator& integrator, Sweeps& sweeps, Frame& frame, Plane<float>& behind,
                  Plane<float>& variance, TraceReport& report, Context& context) {
  Drawing drawing(picture, integrator, frame, behind, variance, report.planes.error);
  // In one go, pixels need no memory for their sums.
  if (!sweeps.any()) {
    SharedProgress progress(context, drawing.size(), "following light");
    parallel_for(
        drawing.size(), 1,
        [&](size_t square, size_t) {
          const Media::Borrowed media = picture.world.borrow_media();
          PixelSum sums[most_pixels];
          drawing.draw(square, drawing.most(), sums);
          drawing.develop(square, sums);
          drawing.look(square, media.get());
          progress.step();
        },
        &context);
    return drawing.report(report);
  }

  need_memory(double(drawing.size()) * double(most_pixels * sizeof(PixelSum)),
              fmt::format("{}x{} pixels lit in sweeps", frame.width, frame.height), "render", "make a smaller picture: --size");
  Sums sums;
  LightSoFar* const kept = sweeps.so_far();
  if (kept && kept->squares && kept->squares->frame.width == frame.width && kept->squares->frame.height == frame.height) {
    sums = std::move(kept->squares->sums);
    drawing.take(*kept->squares);
    *kept = {};
  } else {
    sums.assign(drawing.size() * most_pixels, PixelSum());
  }
  try {
    draw_sweeps(drawing, picture, sweeps, sums, frame, behind, report, context);
  } catch (const Error& e) {
    if (!kept || e.kind() != ErrorKind::cancelled) throw;
    kept->squares = std::make_shared<SquaresSoFar>();
    drawing.give(*kept->squares);
    kept->squares->sums = std::move(sums);
    kept->bytes = kept->squares->bytes();
    throw;
  }
}

}  // namespace sg::trace
