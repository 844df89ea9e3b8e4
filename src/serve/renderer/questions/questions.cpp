// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/questions/questions.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "pipeline/picture/scene/picture_scene.h"
#include "scene/choose/histogram.h"
#include "serve/renderer/questions/line.h"
#include "serve/renderer/questions/measures.h"
#include "serve/renderer/questions/place_values.h"
#include "serve/renderer/questions/probed_cell.h"
#include "serve/renderer/questions/rows.h"
#include "serve/renderer/questions/transfer_questions.h"
#include "serve/renderer/wish.h"

namespace sg::serve {

namespace {

Json vector_json(Vec3 v) { return numbers({v.x, v.y, v.z}); }

Json::Members answer_histogram(const Json& q, const Data& data, Context& context) {
  constexpr size_t bins = 64;
  const std::string name = bytes_of_text(q["field"].text());
  std::vector<size_t> sum(bins);
  Range range;
  std::vector<std::pair<DatasetPtr, const Field*>> fields;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    if (const Field* f = d->fields().find(name)) fields.emplace_back(d, f), range.add(d->range(*f));
  });
  if (fields.empty()) fail_usage(fmt::format("there is no field '{}'", printable(name)), "histogram");
  if (!range.empty() && range.lo < range.hi)
    for (const auto& [d, f] : fields) {
      const std::vector<size_t> counts = histogram(*f, -1, range.lo, range.hi, bins, context);
      for (size_t i = 0; i < bins; ++i) sum[i] += counts[i];
    }
  std::vector<Json> counts;
  for (const size_t n : sum) counts.emplace_back(uint64_t(n));
  return {{"range", range.empty() ? Json() : numbers({range.lo, range.hi})}, {"counts", Json(std::move(counts))}};
}

}  // namespace

Json::Members nothing_there() { return {{"position", Json()}, {"show", Json()}, {"values", Json(std::vector<Json>{})}, {"cell", Json()}}; }

Json::Members probe_picture(const DrawnPlanes& drawn, double x, double y, const PipelineFile& file, const PreparedPicture& prepared,
                            const std::shared_ptr<Cache>& cache, Context& context) {
  const size_t i = size_t(std::max(y, 0.0)) * size_t(drawn.width) + size_t(std::max(x, 0.0));
  if (!(x >= 0 && y >= 0 && x < drawn.width) || i >= drawn.seen.depth.size() || !std::isfinite(drawn.seen.depth[i])) return nothing_there();
  const double depth = double(drawn.seen.depth[i]);
  const Projection::Ray ray = drawn.projection.ray(std::floor(x) + 0.5 - drawn.area.x, std::floor(y) + 0.5 - drawn.area.y);
  Vec3 at = ray.origin + ray.direction * (depth * ray.per_depth);
  const Vec3& stretch = prepared.shown[0].stretch;
  for (int a = 0; a < 3; ++a) at[a] /= stretch[a];
  const uint32_t show = i < drawn.seen.show.size() ? drawn.seen.show[i] : 0;
  Json::Members answer{{"position", vector_json(at)}, {"show", show > 0 ? Json(uint64_t(show - 1)) : Json()}};
  std::vector<Json> values;
  std::optional<size_t> cell;
  if (show > 0 && show <= file.show.size()) {
    DatasetPtr nearest;
    Vec3 local = at;  // in the data's own coordinates, which a node of the scene has moved
    const std::vector<Affine> places = places_of_show(file, show - 1, cache, context);
    for_each_dataset(result_of(file, shown_step(file, show - 1), cache, context), [&](const std::string&, const DatasetPtr& d) {
      Box3 b = d->bounds();
      const double hair = 1e-3 * b.diagonal();
      for (const Affine& place : places) {
        const Vec3 there = inverse(place)(at);
        bool inside = !b.empty();
        for (int a = 0; a < 3; ++a) inside = inside && there[a] >= b.lo[a] - hair && there[a] <= b.hi[a] + hair;
        if (inside && !nearest) nearest = d, local = there;
      }
    });
    if (nearest) cell = probed_cell(nearest, local, context), values = values_at(nearest, local, cell, context);
  }
  answer.emplace_back("values", Json(std::move(values)));
  answer.emplace_back("cell", cell ? Json(uint64_t(*cell)) : Json());
  return answer;
}

Json::Members answer_about_steps(const Json& question, const PipelineFile& file, const PreparedPicture& prepared,
                                 const std::shared_ptr<Cache>& cache, const DrawnArea* area, Context& context) {
  const auto wish = wish_of(question);
  if (wish == Wish::proposals) return answer_proposals(question, prepared, context);
  if (wish == Wish::plane) return answer_plane(question, prepared, context);
  const Data data = result_of(file, bytes_of_text(question["step"].text()), cache, context);
  if (wish == Wish::rows) return answer_rows(question, data);
  if (wish == Wish::line) return answer_line(question, data, context);
  if (wish == Wish::histogram) return answer_histogram(question, data, context);
  if (wish == Wish::measures)
    return measures_of(data, selection_from(question["among"], area), bytes_of_text(question["field"].text()), context);
  fail_usage("that is no question", "question", "docs/protocol.md has them");
}

}  // namespace sg::serve
