// SPDX-License-Identifier: Apache-2.0
// What the operations on unsteady flows share: their parameters, the way through a series, and lines as a dataset.
#pragma once
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "filter/flow/seeds/seeds.h"
#include "filter/flow/unsteady/particles.h"

namespace sg {

enum class CarriedAttribute { fields, none };
constexpr auto enum_words(CarriedAttribute) {
  using enum CarriedAttribute;
  return std::array{Word{"fields", fields}, Word{"none", none}};
}

struct UnsteadyParams {
  FieldName field;
  std::string times;
  std::optional<double> start, time;
  TimeInterpolation interpolation = TimeInterpolation::linear;
  IntegrationParams integration;
  int64_t max_steps = 100000;
  SeedParams seeds;
  bool geographic = false;  ///< see flow/geographic.h
  std::vector<CarriedAttribute> attributes{CarriedAttribute::fields};
};
/// `start`, `time`: the sentences of these two, whose meaning belongs to the operation.
void describe(Schema& s, UnsteadyParams& p, const std::string& start, const std::string& time);

/// A run through the series from the start to the time shown.
class UnsteadyRun {
 public:
  /// Opens the first interval and makes the seeds (random ones where something flows then). `others`: at most one, the seeds' mesh.
  /// Throws Error(usage) naming `who` for times outside the series and, unless `backward`, for one before the start.
  UnsteadyRun(const Series& series, const std::vector<Data>& others, const UnsteadyParams& p, std::string who, bool backward,
              Context& context);

  UnsteadyFlow flow;
  TraceOptions options;
  double start = 0, time = 0;
  int sign = 1;
  std::vector<Vec3> seeds;
  bool carries = true;  ///< other fields

  /// Opens one interval after the other and calls f(until): the end of the interval, or the time shown.
  template <class F>
  void each_interval(F&& f) {
    size_t k = flow.interval_of(start, sign);
    for (const size_t last = flow.interval_of(time, -sign);; k = size_t(ptrdiff_t(k) + sign)) {
      context_.check();
      flow.open(k, context_);
      const bool ends = k == last;
      f(ends ? time : sign > 0 ? flow.end() : flow.begin());
      const double done = time == start ? 1 : std::abs((sign > 0 ? flow.end() : flow.begin()) - start) / std::abs(time - start);
      context_.progress(std::min(done, 1.0), who_);
      if (ends) return;
    }
  }
  /// Ends with an Error(usage) when nothing of `moved` particles has begun.
  void require_some(size_t started) const;
  /// What was traced, with velocities as they are in the file.
  DatasetPtr finished(DatasetPtr traced) const;
  const Field& velocity() const { return flow.steps()[flow.base()].field(); }

 private:
  std::string who_;
  bool geographic_ = false;
  Context& context_;
};

/// Points of lines, one line after the other; a line of one point is a vertex.
struct LinePoints {
  std::vector<Vec3> x, v;
  std::vector<size_t> begin{0};  ///< lines + 1
  std::vector<int64_t> seed;     ///< per line
  size_t lines() const { return begin.size() - 1; }
};

/// SurfaceMesh of poly-lines (vertices first) with the point fields `first` (one value per point, the active one), "speed" and the
/// velocity, and `per_line` as cell fields beside `id`, the lines' seeds (f32 positions about the origin, or about the box' centre when
/// that is far).
DatasetPtr lines_of(const LinePoints& lines, Field first, const Field& velocity, double time, FieldSet more, std::vector<Field> per_line,
                    const char* id = "seed");
/// Only the points.
DatasetPtr points_of(const LinePoints& lines, Field first, const Field& velocity, double time, FieldSet more);

}  // namespace sg
