// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/unsteady/pathlines.h"

#include <fmt/core.h>

#include "base/parallel.h"

namespace sg {

void describe(Schema& s, PathlinesParams& p) {
  describe(s, p, "Time at which particles start; default: the first time of the series.",
           "Time at which they end, before the start to go backwards; default: the last time of the series.");
}

DatasetPtr pathlines(const Series& series, const std::vector<Data>& others, const PathlinesParams& p, Context& context) {
  UnsteadyRun run(series, others, p, "pathlines", true, context);
  std::vector<Particle> particles(run.seeds.size());
  for (size_t i = 0; i < particles.size(); ++i) particles[i].x = run.seeds[i], particles[i].t = run.start;
  Way way;
  CarriedFields carried;
  run.each_interval([&](double until) {
    const size_t before = way.size();
    advance(run.flow, particles, until, run.sign, run.options, context, &way);
    if (run.carries) carried.sample(run.flow, std::span(way.x).subspan(before), std::span(way.t).subspan(before), context);
  });

  // Places of one particle together, in their order.
  std::vector<size_t> count(particles.size() + 1, 0);
  for (const size_t i : way.particle) ++count[i];
  exclusive_scan(count);
  std::vector<size_t> at = count, order(way.size());
  for (size_t k = 0; k < way.size(); ++k) order[at[way.particle[k]]++] = k;
  LinePoints lines;
  lines.x.resize(way.size()), lines.v.resize(way.size());
  double* time = nullptr;
  float* arc = nullptr;
  Array times = Array::make<double>(way.size(), 1, &time), arcs = Array::make<float>(way.size(), 1, &arc);
  std::vector<uint8_t> stop;
  for (size_t i = 0; i < particles.size(); ++i) {
    if (count[i] == at[i]) continue;
    double length_so_far = 0;
    for (size_t k = count[i]; k < at[i]; ++k) {
      lines.x[k] = way.x[order[k]], lines.v[k] = way.v[order[k]], time[k] = way.t[order[k]];
      if (k > count[i]) length_so_far += length(lines.x[k] - lines.x[k - 1]);
      arc[k] = float(length_so_far);
    }
    lines.begin.push_back(at[i]), lines.seed.push_back(int64_t(i));
    stop.push_back(uint8_t(particles[i].ended ? particles[i].why : StopReason::time));
  }
  run.require_some(lines.lines());
  if (lines.lines() < particles.size())
    context.info(fmt::format("pathlines: {} of {} seeds lie outside the flow", particles.size() - lines.lines(), particles.size()));
  FieldSet more;
  more.add({"length", Association::point, arcs, "", Role::none});
  for (const Field& f : carried.take(order)) more.add(f);
  std::vector<Field> per_line;
  per_line.push_back({"stop", Association::cell, Array::from_vector(std::move(stop)), "", Role::labels});
  return run.finished(lines_of(lines, {"time", Association::point, times, "", Role::scalars}, run.velocity(), run.time, std::move(more),
                               std::move(per_line)));
}

}  // namespace sg
