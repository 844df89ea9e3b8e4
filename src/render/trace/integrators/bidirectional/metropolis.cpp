// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "render/trace/integrators/bidirectional/path_of_point.h"
#include "render/trace/integrators/bidirectional/picture_integrator.h"
#include "render/trace/sampling/distribution.h"

namespace sg::trace {

namespace {

constexpr double large_share = 0.3;   // of the steps
constexpr size_t chains_a_pass = 64;  // fixed, so that pictures depend on no number of threads
// Of the bootstrap, over all kinds: an eighth of all, within bounds.
constexpr double least_draws = 1 << 14, most_draws = 1 << 17;

/// Sums of independent values.
struct Sum {
  double count = 0, sum = 0, squares = 0;
  void add(double v) { ++count, sum += v, squares += v * v; }
  void add(const Sum& o) { count += o.count, sum += o.sum, squares += o.squares; }
  double mean() const { return count > 0 ? sum / count : 0; }
  double variance_of_mean() const { return count > 1 ? std::max(0.0, squares / count - mean() * mean()) / (count - 1) : 0; }
};

class Metropolis : public PictureIntegrator {
 public:
  Metropolis(const PathScene& scene, const LightOptions& options) : scene_(scene), options_(options), seed_(random_bits(options.seed, 31)) {
    scene_.roulette = false;  // every path has the turns that are wanted, or is nothing
  }

  int pass_size() const override { return std::clamp(options_.paths / 4, 1, 16); }

  void pass(uint32_t from, uint32_t to, PassFilm& film, Context& context) override {
    if (!started_) bootstrap(context);
    straight(from, to, film, context);
    if (!(first_.total > 0)) return;
    // Every pass has chains of its own, so that passes are independent and differ by what the picture's error is.
    const double steps_in_all = scene_.camera.pixels() * (to - from);
    const auto steps = std::max<uint32_t>(1, uint32_t(std::ceil(steps_in_all / double(chains_a_pass))));
    const double weight = steps_in_all / (double(steps) * double(chains_a_pass));
    // By how much each kind counts more than its share of the first points.
    std::vector<double> more;
    const double now = brightness();
    for (size_t i = 0; i < known_.size(); ++i)
      more.push_back(first_.of_kind[i] > 0 ? known_[i].mean() / first_.of_kind[i] * (first_.total / now) : 0);
    std::vector<std::vector<Sum>> found(chains_a_pass, std::vector<Sum>(known_.size()));
    parallel_for(
        chains_a_pass, 1,
        [&](size_t begin, size_t end) {
          PathOfPoint tracer(scene_);
          for (size_t c = begin; c < end; ++c) {
            const uint64_t key = random_bits(random_bits(seed_, 1 + from), c);
            // Systematic: the chains of a pass start at even distances along the sum of all first points.
            const double at = (double(c) + random_unit(random_bits(seed_, 1 + from), chains_a_pass)) / double(chains_a_pass);
            walk(tracer, first_point(at), key, steps, weight, more, film, found[c]);
          }
        },
        &context);
    for (const auto& of_chain : found)
      for (size_t i = 0; i < known_.size(); ++i) known_[i].add(of_chain[i]);
  }

  double factor() const override { return brightness(); }
  double factor_error() const override {
    double variance = 0;
    for (const Sum& s : known_) variance += s.variance_of_mean();
    const double b = brightness();
    return b > 0 ? std::sqrt(variance) / b : 0;
  }

 private:
  /// b, the mean brightness of the picture in paths that turn.
  double brightness() const {
    double b = 0;
    for (const Sum& s : known_) b += s.mean();
    return b;
  }
  uint64_t key_of(size_t kind, size_t draw) const { return random_bits(random_bits(seed_, ~uint64_t(kind)), draw); }

  // Independent points of every kind: how bright the picture is, and where chains start.
  void bootstrap(Context& context) {
    started_ = true;
    const auto kinds = size_t(PathOfPoint(scene_).kinds());
    known_.assign(kinds, {});
    if (kinds == 0) return;
    const double draws = std::clamp(scene_.camera.pixels() * options_.paths / 8, least_draws, most_draws);
    const size_t each = std::clamp<size_t>(size_t(draws) / kinds, 64, 1 << 14);
    std::vector<float> bright(kinds * each);
    parallel_for(
        bright.size(), 512,
        [&](size_t begin, size_t end) {
          PathOfPoint tracer(scene_);
          Lit lit;
          for (size_t i = begin; i < end; ++i) {
            PrimarySpace point(key_of(i / each, i % each), 0);
            tracer.trace(point, int(i / each) + 1, lit);
            bright[i] = float(lit.brightness);
          }
        },
        &context);
    for (size_t i = 0; i < bright.size(); ++i) known_[i / each].add(double(bright[i]));
    first_.each = each;
    for (const Sum& s : known_) first_.of_kind.push_back(s.mean()), first_.total += s.mean();
    if (first_.total > 0) first_.points = Distribution1D(bright);
  }

  struct FirstPoint {
    uint64_t key;
    size_t kind;
  };
  FirstPoint first_point(double at) const {
    const size_t i = first_.points.sample(float(at)).cell;
    return {key_of(i / first_.each, i % first_.each), i / first_.each + 1};
  }

  void walk(PathOfPoint& tracer, FirstPoint first, uint64_t key, uint32_t steps, double weight, const std::vector<double>& more,
            PassFilm& film, std::vector<Sum>& found) const {
    PrimarySpace point(first.key, key);
    Lit now, next;
    tracer.trace(point, int(first.kind), now);
    if (!(now.brightness > 0)) return;
    const double scale = weight * more[first.kind - 1];
    double waited = 0;  // what the present point is due
    const auto splat = [&](const Lit& lit, double share) {
      if (share > 0)
        for (const Lit::Splat& s : lit.splats) film.splats.add(s.pixel, s.value * (scale * share / lit.brightness));
    };
    for (uint32_t k = 0; k < steps; ++k) {
      const bool large = random_unit(key, 2 * uint64_t(k)) < large_share;
      point.propose(large);
      tracer.trace(point, int(first.kind), next);
      if (large) found[first.kind - 1].add(next.brightness);
      // Both points count, each by the chance to be the next one.
      const double accepts = std::min(1.0, next.brightness / now.brightness);
      waited += 1 - accepts;
      if (accepts > 0 && random_unit(key, 2 * uint64_t(k) + 1) < accepts) {
        splat(now, waited);
        point.accept();
        std::swap(now, next);
        waited = accepts;
      } else {
        splat(next, accepts);
        point.reject();
      }
    }
    splat(now, waited);
  }

  // What is seen without a turn is no matter of chains.
  void straight(uint32_t from, uint32_t to, PassFilm& film, const Context& context) const {
    const int width = scene_.camera.width();
    parallel_for(
        size_t(scene_.camera.height()), 1,
        [&](size_t begin, size_t end) {
          Sampler sampler(options_.sampler, options_.seed, options_.paths);
          SamplerNumbers numbers(sampler);
          const Media::Borrowed media = scene_.world.borrow_media();
          SubPath path;
          for (size_t y = begin; y < end; ++y)
            for (int x = 0; x < width; ++x)
              for (uint32_t k = from; k < to; ++k) {
                sampler.start(uint32_t(x), uint32_t(y), k);
                const Vec2f in_pixel = sampler.next2();
                walk_from_camera(scene_, media.get(), {float(x) + in_pixel.x, float(y) + in_pixel.y}, 1, numbers, path);
                film.own[y * size_t(width) + size_t(x)] += Vec3(path.straight);
                film.passed[y * size_t(width) + size_t(x)] += path.passed;
              }
        },
        &context);
  }

  PathScene scene_;
  LightOptions options_;
  uint64_t seed_;
  bool started_ = false;
  std::vector<Sum> known_;  // of each kind, from independent points
  struct {
    size_t each = 0;  // of one kind
    std::vector<double> of_kind;
    double total = 0;
    Distribution1D points;
  } first_;
};

}  // namespace

std::unique_ptr<PictureIntegrator> metropolis_integrator(const PathScene& scene, const LightOptions& options) {
  return std::make_unique<Metropolis>(scene, options);
}

}  // namespace sg::trace
